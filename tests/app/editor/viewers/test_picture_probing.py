"""The probe, the line profile and the choices of an image viewer. No Qt."""

import numpy as np
import pytest

from app.editor.viewers.pixels.picture_facts import Choices, laid_over, picture_facts
from app.editor.viewers.pixels.picture_query import PictureQuery
from app.editor.viewers.pixels.probing import along_line, index_at, probe, probe_text
from core.physics.radiometry.planck import band_radiance
from picture_bench import PictureBench


@pytest.fixture
def bench():
    return PictureBench()


def test_probe_tells_the_sample_and_its_temperature(bench):
    picture = bench.answer(PictureQuery("back.image"))
    samples = bench.value("back.image")
    found = probe(picture, 7, 31)
    assert found.value == float(samples[7, 31])
    # The blackbody of that temperature has that radiance in the band.
    radiance = band_radiance(cut_on_um=8.0, cut_off_um=12.0, temperature_K=found.temperature_K)
    assert radiance == pytest.approx(found.value, rel=1e-10)
    text = probe_text(picture, found)
    assert text.startswith("row 7  column 31:")
    assert f"{found.value:.6g} W/m²/sr" in text
    assert text.endswith(f"{found.temperature_K:.2f} K")
    assert "K" not in probe_text(picture, found, difference=True).split(":")[1]


def test_probe_of_a_plane_tells_frequencies(bench):
    picture = bench.answer(PictureQuery("jitter.mtf"))
    row, column = index_at(picture.facts, 0.0, 0.0)
    assert (row, column) == (20, 24)
    found = probe(picture, row, column)
    assert (found.value, found.temperature_K) == (1.0, None)
    assert probe_text(picture, found) == "ξ 0  η 0 cyc/mrad:  1"


def test_probe_outside_tells_nothing(bench):
    picture = bench.answer(PictureQuery("back.image"))
    assert probe(picture, -1, 0) is None
    assert probe(picture, 41, 0) is None
    assert probe(picture, 0, 48) is None


def test_a_preview_lies_where_the_full_picture_does(bench):
    image = bench.plan.output("back.image")
    full = picture_facts(image)
    small = bench.answer(PictureQuery("pixels.image"), reduced=4).facts
    laid = laid_over(small, full)
    assert laid.across.step == 2.0  # 24 columns over 48
    assert laid.across.first == 0.5  # the middle of columns 0 and 1
    assert laid.across.at(23) == 46.5
    assert (laid.along.first, laid.along.step) == (0.0, 1.0)


def test_profile_of_a_slope():
    rows, columns = np.mgrid[0:20, 0:30]
    slope = (2.0 * columns + 5.0 * rows).astype(np.float32)
    distance, value = along_line(slope, (2.5, 3.0), (22.5, 18.0))
    assert distance[0] == 0.0
    assert distance[-1] == pytest.approx(25.0)
    x, y = 2.5 + 0.8 * distance, 3.0 + 0.6 * distance
    assert value == pytest.approx(2.0 * x + 5.0 * y, rel=1e-12)


def test_profile_is_cut_off_at_the_edges():
    picture = np.ones((4, 6))
    distance, value = along_line(picture, (-3.0, 1.0), (9.0, 1.0))
    assert distance == pytest.approx([3.0, 4.0, 5.0, 6.0, 7.0, 8.0])
    assert value.tolist() == [1.0] * 6
    assert all(len(part) == 0 for part in along_line(picture, (-5.0, -1.0), (9.0, -1.0)))


def test_manual_levels_hold_for_one_picture_only():
    chosen = Choices("a.image", levels=(1.0, 2.0))
    assert chosen.with_(port="b.image").levels == "percentiles"
    assert chosen.with_(mapping="log", levels="percentiles").levels == "percentiles"
    assert chosen.with_(levels=(1.0, 3.0)).levels == (1.0, 3.0)
