"""A kept picture beside the present one: the same levels, and a refusal where they do not fit."""

import numpy as np
import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.pixels.grey_levels import grey_levels
from app.editor.viewers.pixels.picture_facts import Choices
from app.editor.viewers.pixels.picture_query import PictureQuery
from app.editor.viewers.pixels.probing import facts_text, sample_text
from core.evaluation.policy import Policy
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


def test_the_samples_are_referred_to_and_not_copied(bench):
    kept = kept_of(bench)
    assert kept.samples is bench.value(PORT)
    assert not kept.samples.flags.writeable


@pytest.mark.parametrize("levels", ["extremes", "percentiles", (5.0, 40.0)])
def test_a_is_drawn_by_the_levels_of_b(bench, levels):
    kept = kept_of(bench)
    after = bench.changed("jitter", "sigma_mrad", 3.0)
    picture = bench.answer(PictureQuery(PORT, levels=levels, kept=kept), after)
    alone = bench.answer(PictureQuery(PORT, levels=levels), after)
    assert picture.levels == picture.other.levels == alone.levels
    assert (picture.grey == alone.grey).all()
    assert (picture.other.grey == grey_levels(kept.samples, *alone.levels)).all()
    assert picture.other.samples is kept.samples
    assert not picture.other.grey.flags.writeable


@pytest.mark.parametrize("mapping", ["log", "spectrum"])
def test_a_is_mapped_as_b_is(bench, mapping):
    kept = kept_of(bench)
    before = bench.answer(PictureQuery(PORT, mapping=mapping))
    picture = bench.answer(PictureQuery(PORT, mapping=mapping, kept=kept))
    assert (picture.other.grey == before.grey).all()
    assert picture.other.facts == before.facts
    assert (picture.other.samples == before.samples).all()


def test_another_size_is_refused_in_one_line(bench):
    kept = kept_of(bench, plan=bench.changed("scene", "width", 64))
    picture = bench.answer(PictureQuery(PORT, kept=kept))
    assert picture.other is None
    assert picture.refused == "not compared: A has 64 × 41 samples, B 48 × 41"
    assert (picture.samples == bench.value(PORT)).all()  # B is shown all the same


def test_another_kind_and_unit_are_refused(bench):
    picture = bench.answer(PictureQuery("jitter.mtf", kept=kept_of(bench)))
    assert (
        picture.refused == "not compared: A is a picture, B a plane; A is in W/m²/sr, B in no unit"
    )


def test_a_preview_is_compared_whatever_its_size(bench):
    kept = kept_of(bench, plan=bench.changed("scene", "width", 96))
    assert bench.answer(PictureQuery(PORT, kept=kept), reduced=2).other is not None


def test_the_probe_reads_both_in_radiance_and_kelvin(bench):
    kept = kept_of(bench)
    picture = bench.answer(
        PictureQuery(PORT, kept=kept), bench.changed("jitter", "sigma_mrad", 3.0)
    )
    row, column = 20, 22
    text = sample_text(picture, (row, column), Choices(PORT), kept=True)
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


def test_a_wipe_of_two_wires_reads_kelvin_on_both_sides(bench):
    picture = bench.answer(PictureQuery(PORT, "scene.image", "wipe"))
    text = sample_text(picture, (3, 4), Choices(PORT, "scene.image", "wipe"))
    left, right = text.split("  |  ")
    assert left.endswith(" K")
    assert right.endswith(" K")
    assert f"{float(bench.value('scene.image')[3, 4]):.6g} W/m²/sr" in right


def test_what_is_compared_is_named(bench):
    picture = bench.answer(PictureQuery(PORT, kept=kept_of(bench)))
    assert facts_text(picture, Choices(PORT), "Snapshot 1", "wipe").startswith(
        "A Snapshot 1 on the left, B now on the right · 48 × 41"
    )
    assert facts_text(picture, Choices(PORT), "Snapshot 1", "flip").startswith("A Snapshot 1 ·")


def test_other_bands_are_named(bench):
    kept = kept_of(bench, plan=bench.changed("scene", "cut_on_um", 9.0))
    picture = bench.answer(PictureQuery(PORT, kept=kept))
    text = facts_text(picture, Choices(PORT), "Snapshot 1", "wipe")
    assert text.endswith("A in 9 to 12 µm, B in 8 to 12 µm")
    assert np.isfinite(picture.other.samples).all()
