"""What an image viewer asks and is answered: samples, mapping, comparison, keys. No Qt."""

import numpy as np
import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.picture.picture_facts import grey_levels
from app.editor.viewers.picture.picture_query import (
    PictureQuery,
    index_at,
    probe,
    sample_text,
)
from app.editor.viewers.picture.plots_below import along_line
from core.errors import ImagechainError
from core.evaluation.work import Policy
from picture_bench import PictureBench
from planck_truth import band_radiance


@pytest.fixture
def bench():
    return PictureBench()


def test_samples_are_those_of_the_wire_and_not_copied(bench):
    picture = bench.answer(PictureQuery("back.image"))
    assert picture.samples is bench.value("back.image")
    for array in (picture.samples, picture.grey):
        assert not array.flags.writeable
    facts = picture.facts
    assert (facts.rows, facts.columns, facts.unit) == (41, 48, "W/m²/sr")
    assert facts.band_um == (8.0, 12.0)
    assert picture.levels == (float(picture.samples.min()), float(picture.samples.max()))
    assert not picture.logarithmic
    picture = bench.answer(PictureQuery("back.image", mapping="log"))
    logarithm = np.log10(np.abs(picture.samples.astype(float)))
    assert picture.levels == pytest.approx((logarithm.min(), logarithm.max()), abs=1e-6)
    assert picture.logarithmic


def test_centred_spectrum_of_a_picture(bench):
    picture = bench.answer(PictureQuery("back.image", mapping="spectrum"))
    samples = bench.value("back.image").astype(float)
    modulus = np.fft.fftshift(np.abs(np.fft.fft2(samples)))
    assert np.allclose(picture.samples, modulus, rtol=1e-4, atol=1e-6 * modulus.max())
    assert picture.samples[41 // 2, 48 // 2] == pytest.approx(samples.sum(), rel=1e-6)
    assert picture.levels[1] == pytest.approx(np.log10(modulus.max()), abs=1e-6)
    assert picture.logarithmic


def test_planes_have_zero_frequency_in_the_middle(bench):
    port = "jitter.magnitude"
    picture = bench.answer(PictureQuery(port))
    plane = bench.value(port)
    assert (picture.samples == np.fft.fftshift(plane)).all()
    facts, grid = picture.facts, bench.plan.output(port).grid
    assert facts.kind == "plane"
    for axis, frequencies in ((facts.across, grid.xi()), (facts.along, grid.eta())):
        ordered = np.fft.fftshift(frequencies)
        places = [axis.at(index) for index in range(len(ordered))]
        assert places == pytest.approx(ordered.tolist(), abs=1e-12)
        assert axis.unit == "cyc/mrad"
        assert "cyc/mrad" in axis.title


def test_a_difference_is_grey_at_zero_and_a_wipe_has_the_same_levels_on_both_sides(bench):
    picture = bench.answer(PictureQuery("back.image", "scene.image", "difference"))
    wanted = bench.value("back.image") - bench.value("scene.image")
    assert (picture.samples == wanted).all()
    reach = float(np.abs(wanted).max())
    assert picture.levels == (-reach, reach)
    assert grey_levels(np.zeros((1, 1), np.float32), *picture.levels)[0, 0] in (127, 128)
    picture = bench.answer(PictureQuery("scene.image", "pixels.image", "wipe"))
    assert picture.other.levels == picture.levels
    assert (picture.other.samples == bench.value("pixels.image")).all()
    assert picture.other.grey.shape == (41, 24)


@pytest.mark.parametrize(
    ("query", "words"),
    [
        (PictureQuery("init.context"), "init.context is of type context"),
        (PictureQuery("nothing.image"), "no node 'nothing'"),
        (PictureQuery("lonely.image"), "input"),
        (PictureQuery("scene.image", "pixels.image", "difference"), "48 × 41 .* 24 × 41"),
    ],
)
def test_what_cannot_be_shown_says_why(bench, query, words):
    with pytest.raises(ImagechainError, match=words) as caught:
        bench.answer(query)
    assert "\n" not in str(caught.value)


def test_the_key_tells_whether_the_picture_would_change(bench):
    query = PictureQuery("scene.image")
    key = query.key(bench.plan)
    assert query.key(bench.changed("jitter", "sigma_mrad", 0.1)) == key
    assert query.key(bench.changed("scene", "temperature_K", 250.0)) != key
    assert query.key(bench.changed("scene", "fov_x_deg", 4.0)) != key
    assert PictureQuery("scene.image", mapping="log").key(bench.plan) != key
    both = PictureQuery("scene.image", "back.image", "wipe")
    assert both.key(bench.changed("jitter", "sigma_mrad", 0.1)) != both.key(bench.plan)
    alone = PictureQuery("scene.image", "back.image", "alone")
    assert alone.key(bench.changed("jitter", "sigma_mrad", 0.1)) == alone.key(bench.plan)


def test_probe_of_a_plane_tells_frequencies(bench):
    picture = bench.answer(PictureQuery("jitter.mtf"))
    row, column = index_at(picture.facts, 0.0, 0.0)
    assert (row, column) == (20, 24)
    assert probe(picture, row, column) == (1.0, None)
    assert sample_text(picture, (row, column)) == "ξ 0  η 0 cyc/mrad:  1"
    difference = bench.answer(PictureQuery("back.image", "scene.image", "difference"))
    assert probe(difference, 7, 31)[1] is None


def test_values_along_a_line_across_a_slope():
    rows, columns = np.mgrid[0:20, 0:30]
    slope = (2.0 * columns + 5.0 * rows).astype(np.float32)
    x, y = np.linspace(0.1, 0.9, 7), np.linspace(0.2, 0.95, 7)
    wanted = 2.0 * (30 * x - 0.5) + 5.0 * (20 * y - 0.5)
    assert along_line(slope, x, y) == pytest.approx(wanted, rel=1e-12)
    assert np.isnan(along_line(slope, np.array([0.5, 1.2]), np.array([-0.1, 0.5]))).all()


PORT = "back.image"


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
