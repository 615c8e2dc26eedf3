"""A kept picture beside the present one: the same levels, and a refusal where they do not fit."""

import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.picture.picture_query import PictureQuery, sample_text
from core.evaluation.work import Policy
from picture_bench import PictureBench
from planck_truth import band_radiance

PORT = "back.image"


@pytest.fixture
def bench():
    return PictureBench()


def kept_of(bench, port=PORT, plan=None):
    work = bench.engine.work(Policy())
    passing = Passing(bench.engine, plan or bench.plan, work)
    return PictureQuery(port).kept_picture(passing)


def test_another_size_is_refused_in_one_line(bench):
    kept = kept_of(bench, plan=bench.changed("scene", "width", 64))
    picture = bench.answer(PictureQuery(PORT, kept=kept))
    assert picture.other is None
    assert picture.refused == "not compared: A has 64 × 41 samples, B 48 × 41"
    assert (picture.samples == bench.value(PORT)).all()  # B is shown all the same


def test_the_probe_reads_both_in_radiance_and_kelvin(bench):
    kept = kept_of(bench)
    picture = bench.answer(
        PictureQuery(PORT, kept=kept), bench.changed("jitter", "sigma_mrad", 3.0)
    )
    row, column = 20, 22
    text = sample_text(picture, (row, column), kept=True)
    where, a, b, difference = text.replace(":  A", "  |  A").split("  |  ")
    assert where == f"row {row}  column {column}"
    assert a.startswith(f"A {float(kept.samples[row, column]):.6g} W/m²/sr")
    assert b.startswith(f"B {float(picture.samples[row, column]):.6g} W/m²/sr")
    kelvins = []
    for part, samples in ((a, kept.samples), (b, picture.samples)):
        kelvin = float(part.split()[-2])
        assert part.endswith(" K")
        value = float(samples[row, column])
        # The radiance rises with temperature: half of the last digit shown on either side.
        assert band_radiance(8.0, 12.0, kelvin - 0.0051) < value
        assert value < band_radiance(8.0, 12.0, kelvin + 0.0051)
        kelvins.append(kelvin)
    shown = float(difference.replace("−", "-").removeprefix("B - A ").removesuffix(" K"))
    assert shown == pytest.approx(kelvins[1] - kelvins[0], abs=0.011)
