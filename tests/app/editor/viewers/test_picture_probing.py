"""The probe, the line profile and the choices of an image viewer. No Qt."""

import numpy as np
import pytest

from app.editor.viewers.picture.plots_below import along_line
from app.editor.viewers.pixels.picture_query import PictureQuery
from app.editor.viewers.pixels.probing import index_at, probe, probe_text
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
    difference = bench.answer(PictureQuery("back.image", "scene.image", "difference"))
    assert probe(difference, 7, 31).temperature_K is None


def test_probe_of_a_plane_tells_frequencies(bench):
    picture = bench.answer(PictureQuery("jitter.mtf"))
    row, column = index_at(picture.facts, 0.0, 0.0)
    assert (row, column) == (20, 24)
    found = probe(picture, row, column)
    assert (found.value, found.temperature_K) == (1.0, None)
    assert probe_text(picture, found) == "ξ 0  η 0 cyc/mrad:  1"


def test_values_along_a_line_across_a_slope():
    rows, columns = np.mgrid[0:20, 0:30]
    slope = (2.0 * columns + 5.0 * rows).astype(np.float32)
    x, y = np.linspace(0.1, 0.9, 7), np.linspace(0.2, 0.95, 7)
    wanted = 2.0 * (30 * x - 0.5) + 5.0 * (20 * y - 0.5)
    assert along_line(slope, x, y) == pytest.approx(wanted, rel=1e-12)
    assert np.isnan(along_line(slope, np.array([0.5, 1.2]), np.array([-0.1, 0.5]))).all()
