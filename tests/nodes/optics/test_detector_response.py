"""Optics whose wavelengths are weighted by the light and by what the detector counts of it."""

import numpy as np
import pytest

from core.evaluation.work import Policy
from cube_files import C2_UM, centres, disc_otf, materials_cube, write_cube
from node_bench import NodeBench, fov_of

INTERVAL = 0.02
SHAPE = (16, 64)
APERTURE_MM = 100.0
POINTS = ((3.2, 0.0), (3.6, 0.8), (4.4, 0.5), (4.5, 0.1))
WAVES = 3.0 + 2.0 * (np.arange(200_000) + 0.5) / 200_000
RESPONSE = np.interp(WAVES, *zip(*POINTS, strict=True), left=0.0, right=0.0)
BODY = WAVES**-4 / np.expm1(C2_UM / WAVES / 300.0)
KINDS = {
    "diffraction_mtf": {"source_K": 300.0},
    "exit_pupil_mtf": {
        "wavelengths": 200, "weighting": "photons", "source_K": 300.0,
        "size_x_cm": 12.8, "size_y_cm": 12.8,
    },
}  # fmt: skip


@pytest.fixture
def folder(tmp_path):
    lines = [f"{place}, {value}" for place, value in POINTS]
    (tmp_path / "detector.csv").write_text("um,QE\n" + "\n".join(lines) + "\n", encoding="utf-8")
    np.save(tmp_path / "flat.npy", np.ones(SHAPE))
    return tmp_path


def bench(folder, key, params, *, read=None, filtered=None):
    read = {"path": "flat.npy", "cut_on_um": 3.0, "cut_off_um": 5.0} if read is None else read
    nodes = {"read": ("read_image", {**fov_of(SHAPE, INTERVAL), **read})}
    if filtered is not None:
        nodes["filter"] = ("spectral_response", filtered)
    nodes["init"] = ("init_trans", {"focal_length_mm": 200.0, "f_number": 2.0})
    if key == "exit_pupil_mtf":
        nodes["pupil"] = ("exit_pupil", {"size_x": 128, "size_y": 128, "radius": 50})
    return NodeBench(folder, {**nodes, "otf": (key, {**KINDS[key], **params})})


def across(there):
    """Frequencies across, and the MTF along them."""
    grid = there.port("otf.mtf").grid
    (factor,) = there.port("otf.mtf").factors
    work = there.engine.work(Policy("double", 0.0))
    return grid.xi(), factor.plane(work, grid.xi(), np.zeros(1))[0]


def weighted_otf(xi, light):
    return np.array([np.sum(light * disc_otf(one, WAVES, APERTURE_MM)) for one in xi]) / light.sum()


@pytest.mark.parametrize("key", KINDS)
def test_a_detectors_response_weights_the_light(folder, key):
    xi, mtf = across(bench(folder, key, {"response": "detector.csv"}))
    want = weighted_otf(xi, BODY * RESPONSE)
    assert np.abs(mtf - want).max() <= (1e-9 if key == "diffraction_mtf" else 2e-5)
    assert np.abs(want - weighted_otf(xi, BODY)).max() > 0.01


@pytest.mark.parametrize("key", KINDS)
def test_a_filter_that_the_picture_has_come_through_counts_too(folder, key):
    filtered = {"shape": "file", "path": "detector.csv", "source_K": 300.0}
    xi, mtf = across(bench(folder, key, {}, filtered=filtered))
    assert np.array_equal(mtf, across(bench(folder, key, {"response": "detector.csv"}))[1])
    both = bench(folder, key, {"response": "detector.csv"}, filtered=filtered)
    want = weighted_otf(xi, BODY * RESPONSE**2)
    assert np.abs(across(both)[1] - want).max() <= (1e-9 if key == "diffraction_mtf" else 2e-5)


@pytest.mark.parametrize("key", KINDS)
def test_of_a_picture_in_bands_the_mean_is_that_of_what_is_counted(folder, key):
    wavelengths, width = centres(6)
    samples = materials_cube(SHAPE, wavelengths)
    write_cube(folder, samples, wavelengths, width)
    read = {"path": "cube.img", "bands": "all"}
    xi, mtf = across(bench(folder, key, {"response": "detector.csv"}, read=read))
    means = np.array([band.mean() for band in samples])
    light = []
    for mean, wavelength in zip(means, wavelengths, strict=True):
        inside = np.abs(WAVES - wavelength) <= width / 2
        light.append(mean * wavelength * RESPONSE[inside].mean())
    otfs = np.array([disc_otf(xi, one, APERTURE_MM) for one in wavelengths])
    want = np.array(light) @ otfs / np.sum(light)
    assert np.abs(mtf - want).max() <= 1e-5  # of the mean response over a band by samples


@pytest.mark.parametrize("key", KINDS)
@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("missing.csv", None, "missing.csv"),
        ("far.csv", "8, 1\n12, 1\n", "above 0 somewhere in the band"),
        ("long.csv", "3, 1\n4, 1.5\n", "line 2"),
    ],
)
def test_refusals(folder, key, name, text, words):
    if text is not None:
        (folder / name).write_text(text, encoding="utf-8")
    (error,) = bench(folder, key, {"response": name}).plan.errors()
    assert error.node == "otf"
    assert words in str(error)
