"""Diffraction MTF, over bands too."""

import numpy as np
import pytest
import scipy.fft

from core.errors import DataError
from core.physics.radiometry.planck import band_radiance
from cube_files import write_cube
from node_bench import NodeBench, fov_of
from reference_cases import CAMERA, reference_cases

BAND = {"cut_on_um": 3.0, "cut_off_um": 5.0}
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.0}
INIT = {"focal_length_mm": 400, "f_number": 4}


@pytest.fixture
def planned(tmp_path):
    def plan(params=(), *, mean=None, scene=(), init=INIT, camera=None, chained=False):
        if mean is None:
            mean = float(band_radiance(temperature_K=300.0, **BAND))
        np.save(tmp_path / "in.npy", np.full((12, 10), mean))
        nodes = {
            "scene": ("read_image", {"path": "in.npy", **FOV, **BAND, **dict(scene)}),
            **({} if camera is None else {"camera": ("camera", camera)}),
            "init": ("init_trans", init),
            **({"alone": ("jitter_mtf", {"apply": "filter_only"})} if chained else {}),
            "optics": ("diffraction_mtf", dict(params)),
        }
        return NodeBench(tmp_path, nodes)

    return plan


def otf(bench, xi):
    (factor,) = bench.port("optics.mtf").factors
    return factor.plane(bench.work, np.atleast_1d(np.asarray(xi, float)), np.zeros(1))[0]


@pytest.mark.parametrize("case", reference_cases("polychromatic_mtf", file=CAMERA))
@pytest.mark.parametrize("light", ["scene", "typed"])
def test_reference(planned, case, light):
    """By the radiance of a scene of that temperature, and by the temperature itself."""
    given = {name: float(value) for name, value in case["inputs"].items()}
    band = {"cut_on_um": given["cut_on_um"], "cut_off_um": given["cut_off_um"]}
    mean = float(band_radiance(temperature_K=given["source_K"], **band))
    params = {"source_K": given["source_K"]} if light == "typed" else {}
    init = {"focal_length_mm": 2 * given["aperture_mm"], "f_number": 2}
    bench = planned(params, mean=mean, scene=band, init=init)
    assert bench.plan.errors() == []
    assert bench.plan.warnings() == []
    (found,) = otf(bench, given["xi_cyc_per_mrad"])
    assert found == pytest.approx(float(case["expected"]["mtf"]), rel=1e-9)
    readouts = bench.readouts("optics")
    assert readouts["weighting_K"] == pytest.approx(given["source_K"], rel=1e-12)
    assert readouts["aperture_mm"] == pytest.approx(given["aperture_mm"])
    assert readouts["estimated_error"] <= 1e-13


def test_the_cameras_aperture_and_obscuration(planned):
    camera = {"focal_length_mm": 400, "aperture_mm": 80, "obscuration_ratio": 0.25}
    xi = np.linspace(0, 30, 31)
    bench = planned(init={}, camera=camera)
    assert bench.plan.warnings() == []
    found = otf(bench, xi)
    typed = planned({"aperture_mm": 80, "obscuration_ratio": 0.25}, init={})
    assert np.array_equal(found, otf(typed, xi))
    # An F-number on Init & Trans counts before the camera's aperture, with a warning there.
    other = planned(init={"f_number": 4}, camera=camera)
    assert other.readouts("optics")["aperture_mm"] == 100
    assert "f_number = 4 here but 5 on Camera" in " ".join(map(str, other.plan.warnings()))


@pytest.mark.parametrize(
    ("how", "expected"),
    [
        ({"scene": {"unit": "K"}, "mean": 288.0}, 288.0),
        ({"params": {"source_K": 400}}, 400.0),
        ({"scene": {"cut_on_um": 0.45, "cut_off_um": 0.9}}, 5800.0),
        ({"params": {"weighting": "uniform"}, "scene": {"unit": "counts"}}, None),
    ],
)
def test_by_whose_light(planned, how, expected):
    bench = planned(**how)
    assert bench.plan.errors() == []
    found = bench.readouts("optics")
    assert found["weighting_K"] == (None if expected is None else pytest.approx(expected, rel=1e-9))


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"init": {}}, ("aperture_mm", "Camera", "F-number")),
        ({"scene": {"unit": "counts"}}, ("source_K", "'counts'", "uniform")),
        ({"chained": True}, ("source_K", "no picture")),
        (
            {"params": {"rms_wavefront_waves": 0.17}},
            (
                "rms_wavefront_waves = 0.17 waves",
                "0 to 0.18 waves at 3 µm",
                "0.226667 waves",
                "Exit Pupils",
            ),
        ),
        (
            {
                "params": {"defocus_waves": -20, "weighting": "uniform"},
                "scene": {"cut_on_um": 0.5, "cut_off_um": 14},
            },
            ("defocus_waves = -20.0 waves", "-100 to 100 waves at 0.5 µm", "-290 waves"),
        ),
    ],
)
def test_refusals(planned, how, words):
    (error,) = planned(**how).plan.errors()
    assert error.node == "optics"
    for word in words:
        assert word in str(error)


def test_a_dark_picture_has_no_colour(planned):
    bench = planned(mean=0.0)
    with pytest.raises(DataError, match="source_K"):
        otf(bench, 3.0)


def test_defocus_turns_contrast_over(planned):
    """W20 of a wave: real, and negative over part of the band, by the form of Hopkins."""
    bench = planned({"defocus_waves": 1.0, "wavelengths": 1})
    ratio = np.linspace(0, 1, 51)
    found = otf(bench, ratio * 25.0)
    # (4/π)∫ sin²t·cos(8πv(cos t − v)) dt from 0 to acos v, by Gauss and Legendre.
    end = np.arccos(ratio)[:, np.newaxis]
    nodes, weights = np.polynomial.legendre.leggauss(60)
    t = end * (1 + nodes) / 2
    wave = np.sin(t) ** 2 * np.cos(8 * np.pi * ratio[:, np.newaxis] * (np.cos(t) - np.cos(end)))
    expected = 2 / np.pi * end[:, 0] * (wave @ weights)
    assert expected.min() < -0.05
    assert np.abs(found - expected).max() <= 1e-14


SIZE = (29, 12)
INTERVAL = 0.01
OUTER_MM, INNER_MM = 60.0, 21.0


def overlap(first, second, apart):
    """Area that two discs of these radii have in common."""
    if apart <= abs(first - second):
        return np.pi * min(first, second) ** 2
    if apart >= first + second:
        return 0.0
    along = (apart**2 + first**2 - second**2) / (2 * apart)
    areas = 0.0
    for radius, cut in ((first, along), (second, apart - along)):
        angle = np.arccos(np.clip(cut / radius, -1, 1))
        areas += radius**2 * (angle - np.sin(2 * angle) / 2)
    return areas


@np.vectorize
def annulus_otf(rho, wavelength):
    """Diffraction by an annulus: what it has in common with itself, moved by λ·ρ."""
    outer, inner, apart = OUTER_MM / 2, INNER_MM / 2, rho * wavelength
    both = overlap(outer, outer, apart) + overlap(inner, inner, apart)
    return (both - 2 * overlap(outer, inner, apart)) / (np.pi * (outer**2 - inner**2))


def band_by_band(cube, wavelengths, width):
    rows, columns = SIZE
    xi = np.arange(columns) / (2 * columns * INTERVAL)
    eta = np.arange(rows) / (2 * rows * INTERVAL)
    rho = np.hypot(xi, eta[:, np.newaxis])
    return width * sum(
        scipy.fft.idctn(scipy.fft.dctn(band) * annulus_otf(rho, one))
        for band, one in zip(cube, wavelengths, strict=True)
    )


@pytest.mark.parametrize("weighting", ["photons", "energy", "uniform"])
@pytest.mark.parametrize(
    ("wavelengths", "width"),
    [([0.675], 0.045), (np.linspace(0.46, 0.89, 13), 0.02), ([1.4, 1.6, 2.0, 4.1], 0.15)],
    ids=["one band", "visible and near infrared", "short waves to medium"],
)
def test_every_band_of_reflected_light_is_blurred_at_its_own_wavelength(
    tmp_path, wavelengths, width, weighting
):
    wavelengths = np.asarray(wavelengths)
    cube = np.random.default_rng(3).uniform(5, 50, (len(wavelengths), *SIZE))
    write_cube(tmp_path, cube, wavelengths, width)
    nodes = {
        "read": ("read_image", {"path": "cube.img", "bands": "all", **fov_of(SIZE, INTERVAL)}),
        "init": ("init_trans", {"focal_length_mm": 120.0, "f_number": 2.0}),
        "optics": ("diffraction_mtf", {"weighting": weighting, "obscuration_ratio": 0.35}),
        "back": ("back_transform", {}),
    }
    made = NodeBench(tmp_path, nodes).value("back.image")
    want = band_by_band(cube, wavelengths, width)
    assert np.abs(made - want).max() <= 1e-12 * np.abs(want).max()
