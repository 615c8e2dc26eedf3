"""Measured MTF, and what is expected."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.errors import ParameterError
from core.network.file import load_network
from edge_pictures import edge_mtf, edge_picture
from linked_network import linked_network
from node_bench import NodeBench
from nodes.library import standard_library

ERRORS = ("mtf50_error", "at_nyquist_error")
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.5}


def measured(folder, picture, fov=FOV, precision="double", **params):
    np.save(folder / "a.npy", picture)
    nodes = {"a": ("read_image", {"path": "a.npy", **fov}), "out": ("measured_mtf", params)}
    return NodeBench(folder, nodes, precision=precision)


def intervals(picture):
    return [
        math.radians(fov) * 1000 / size
        for fov, size in zip((1.0, 1.5), picture.shape[::-1], strict=True)
    ]


@pytest.mark.parametrize("across", ["horizontal", "vertical"])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_frequencies_are_angular_along_the_normal_of_oblong_pixels(tmp_path, across, precision):
    """The picture is 80 wide and 96 high: pixels of 0.218 and 0.273 mrad."""
    upright = across == "horizontal"
    picture = edge_picture(8, 0.6, (96, 80) if upright else (80, 96))
    picture = 270 + 30 * (picture if upright else picture.T)
    x, y = intervals(picture)
    bench = measured(tmp_path, picture, precision=precision)
    curve = bench.value("out.curve")
    assert curve.x_label == "frequency (cyc/mrad)"
    # The normal in mrad, for one in pixels of (cos 8°, ∓sin 8°): lines stretch, normals shrink.
    angle = math.radians(8)
    over, down = (x, y) if upright else (y, x)
    per_mrad = math.hypot(math.cos(angle) / over, math.sin(angle) / down)
    cycles = curve.series[0].x / per_mrad
    below = cycles <= 0.5
    truth = edge_mtf(cycles, 8, 0.6)
    assert np.max(np.abs(curve.series[0].y - truth)[below]) < 0.002
    found = bench.readouts("out")
    fine = np.linspace(0, 1, 10001)
    half, tenth = (fine[np.argmax(edge_mtf(fine, 8, 0.6) < level)] for level in (0.5, 0.1))
    assert found["mtf50_per_pixel"] == pytest.approx(half, abs=0.001)
    assert found["mtf50"] == pytest.approx(half * per_mrad, rel=0.004)
    assert found["mtf10_per_pixel"] == pytest.approx(tenth, rel=0.02)
    assert found["mtf10"] == pytest.approx(tenth * per_mrad, rel=0.02)
    assert found["at_nyquist"] == pytest.approx(edge_mtf(0.5, 8, 0.6), abs=0.002)
    for name in ("expected_mtf50", "expected_at_nyquist", "largest_difference"):
        assert found[name] is None  # no chain is known behind a file
    table = bench.value("out.table").as_dict()
    assert table["direction"] == across
    assert table["contrast"] == pytest.approx(30, rel=1e-3)
    assert table["nyquist"] == pytest.approx(0.5 * per_mrad)
    assert [found[name] for name in ERRORS] == [table[name] for name in ERRORS]
    assert table["mtf50_error"] != table["at_nyquist_error"]


def test_direction_of_the_normal(tmp_path):
    """From +x towards +y, as a test scene's angle; the normal of the picture points to −8°."""
    for picture, normal in ((edge_picture(8, 1), -8), (edge_picture(8, 1).T, 98)):
        bench = measured(tmp_path, picture, {})
        assert bench.readouts("out")["edge_angle_deg"] == pytest.approx(normal, abs=0.01)


def test_only_the_region_counts(tmp_path):
    whole = np.random.default_rng(1).uniform(0, 9, (100, 120))
    whole[10:80, 30:100] = edge_picture(4, 1, (70, 70))
    region = {"region_x": 30, "region_y": 10, "region_width": 70, "region_height": 70}
    bench = measured(tmp_path, whole, axis="cyc_per_pixel", **region)
    series = bench.value("out.curve").series[0]
    np.testing.assert_allclose(series.y, edge_mtf(series.x, 4, 1), atol=0.002)


@pytest.mark.parametrize(
    ("params", "named"),
    [
        ({"region_x": 64}, "region_x"),
        ({"region_y": 99}, "region_y"),
        ({"region_x": 10, "region_width": 60}, "region_width"),
        ({"region_height": 65}, "region_height"),
    ],
)
def test_region_outside_the_picture_is_refused(tmp_path, params, named):
    bench = measured(tmp_path, edge_picture(5, 1), **params)
    error = bench.error("out")
    assert isinstance(error, ParameterError)
    assert error.parameter == named


@pytest.mark.parametrize("method", ["slanted_edge", "row_average"])
@pytest.mark.parametrize("size", [(1, 1), (1, 40), (40, 1), (7, 5), (64, 64)])
def test_pictures_without_an_edge_are_refused_in_one_line(tmp_path, method, size):
    for picture in (np.zeros(size), np.random.default_rng(2).normal(size=size)):
        measured(tmp_path, picture, method=method).refusal("out.curve", "out")


SHIPPED = Path("networks/measured_mtf.json")
SIGMA_MRAD = 0.2  # of both axes
INTERVAL = math.radians(3.0) * 1000 / 256  # 3° over 256 samples, mrad
DETECTOR = 30 / 75  # µm/mm, mrad


def gaussian(xi, eta, sigma_x, sigma_y):
    return np.exp(-2 * np.pi**2 * ((sigma_x * xi) ** 2 + (sigma_y * eta) ** 2))


def evaluated(network, folder=SHIPPED.parent, name="measured"):
    bench = NodeBench(folder, network)
    curves = {series.label: series for series in bench.value(f"{name}.curve").series}
    return curves, bench.value(f"{name}.table").as_dict()


def shipped(seed=1996, *, noise=True, **params):
    network = load_network(SHIPPED, library=standard_library())
    nodes = dict(network.nodes)
    measured = nodes["measured"]
    nodes["measured"] = replace(measured, params={**measured.params, **params})
    nodes["electronics"] = replace(nodes["electronics"], disabled=not noise)
    return evaluated(replace(network, nodes=nodes, seed=seed))


def shipped_truth(frequency, angle_deg):
    """Gaussian, square detector, and the scene's square samples, along the normal."""
    angle = math.radians(angle_deg)
    xi, eta = frequency * math.cos(angle), frequency * math.sin(angle)
    detector = np.sinc(DETECTOR * xi) * np.sinc(DETECTOR * eta)
    samples = np.sinc(INTERVAL * xi) * np.sinc(INTERVAL * eta)
    return np.abs(gaussian(xi, eta, SIGMA_MRAD, SIGMA_MRAD) * detector * samples)


def test_without_noise_the_shipped_chain_measures_what_is_expected():
    series, table = shipped(noise=False)
    expected, measured = series["expected"], series["measured"]
    truth = shipped_truth(expected.x, table["edge_angle_deg"])
    np.testing.assert_allclose(expected.y, truth, atol=1e-12)
    # Half a cycle per pixel of the normal, which is 5° from the rows.
    assert expected.x[-1] == pytest.approx(0.5 / INTERVAL, rel=1e-9)
    apart = np.abs(measured.y[: len(truth)] - truth)
    assert apart.max() < 2e-4
    assert table["largest_difference"] == pytest.approx(apart.max(), abs=1e-9)
    assert table["largest_difference_at"] == expected.x[np.argmax(apart)]
    assert table["expected_at_nyquist"] == pytest.approx(truth[-1], abs=1e-9)
    fine = np.linspace(0, 2, 200_001)
    half = fine[np.argmax(shipped_truth(fine, table["edge_angle_deg"]) < 0.5)]
    assert table["expected_mtf50"] == pytest.approx(half, abs=1e-4)
    assert table["scene_blur"] == "area of the scene's samples"


def chain(*, scene, measured, combine=None, blur=(0.3, 0.5)):
    sigma_x, sigma_y = blur
    nodes = {
        "scene": scene,
        "init": ("init_trans", {"detector_x_um": 30, "detector_y_um": 30, "focal_length_mm": 75}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": sigma_x, "sigma_y_mrad": sigma_y}),
        "back": ("back_transform", {}),
        **({} if combine is None else {"combine": ("combine_pixels", combine)}),
        "measured": ("measured_mtf", measured),
    }
    return linked_network(nodes)


def scene(angle_deg, width=192, height=160, fov_x=2.0, fov_y=2.5):
    drawn = {"kind": "slanted_edge", "angle_deg": angle_deg, "width": width, "height": height}
    return ("test_scene", {**drawn, "fov_x_deg": fov_x, "fov_y_deg": fov_y})


@pytest.mark.parametrize("angle", [5.0, 84.0])
def test_along_either_axis_of_oblong_pixels(angle):
    """Pixels of 0.18 and 0.27 mrad: the normal is another in mrad than in pixels."""
    series, table = evaluated(chain(scene=scene(angle), measured={}))
    dx, dy = math.radians(2.0) * 1000 / 192, math.radians(2.5) * 1000 / 160
    normal = math.radians(table["edge_angle_deg"])
    expected = series["expected"]
    xi, eta = math.cos(normal) / dx, math.sin(normal) / dy  # of a cycle per pixel
    cycles = expected.x / math.hypot(xi, eta)
    assert cycles[-1] == pytest.approx(0.5)
    xi, eta = cycles * xi, cycles * eta
    truth = gaussian(xi, eta, 0.3, 0.5) * np.abs(np.sinc(dx * xi) * np.sinc(dy * eta))
    np.testing.assert_allclose(expected.y, truth, atol=1e-9)
    assert table["largest_difference"] < 0.004


def test_combined_pixels_blur_too():
    """Means of 3 × 3 samples; little is left beyond their Nyquist frequency to be folded."""
    network = chain(
        scene=scene(5.0, 384, 384, 3.0, 3.0),
        measured={},
        combine={"factor_x": 3, "factor_y": 3},
        blur=(0.5, 0.5),
    )
    series, table = evaluated(network)
    d = math.radians(3.0) * 1000 / 384
    normal = math.radians(table["edge_angle_deg"])
    expected = series["expected"]
    assert expected.x[-1] == pytest.approx(0.5 / (3 * d), rel=1e-6)
    xi, eta = expected.x * math.cos(normal), expected.x * math.sin(normal)

    def block(frequency):
        waves = [np.exp(2j * np.pi * frequency * d * k) for k in (-1, 0, 1)]
        return np.mean(waves, axis=0).real

    truth = gaussian(xi, eta, 0.5, 0.5) * block(xi) * block(eta)
    truth = np.abs(truth * np.sinc(d * xi) * np.sinc(d * eta))
    np.testing.assert_allclose(expected.y, truth, atol=1e-9)
    assert table["largest_difference"] < 0.005


def test_the_mean_of_rows_is_expected_with_its_differences():
    network = chain(scene=scene(0.0), measured={"method": "row_average"}, blur=(0.5, 0.5))
    series, table = evaluated(network)
    dx = math.radians(2.0) * 1000 / 192
    xi = series["expected"].x
    truth = gaussian(xi, 0, 0.5, 0.5) * np.abs(np.sinc(dx * xi)) * np.sinc(dx * xi)
    np.testing.assert_allclose(series["expected"].y, truth, atol=1e-9)
    assert table["largest_difference"] < 0.01


def test_of_a_file_the_chain_alone_is_expected(tmp_path):
    np.save(tmp_path / "edge.npy", edge_picture(5, 0.8, (96, 96)))
    file = ("read_image", {"path": "edge.npy", "fov_x_deg": 1.0, "fov_y_deg": 1.0})
    series, table = evaluated(chain(scene=file, measured={}, blur=(0.2, 0.2)), tmp_path)
    assert table["scene_blur"] == "not known"
    interval = math.radians(1.0) * 1000 / 96
    expected = series["expected"]
    cycles = expected.x * interval
    np.testing.assert_allclose(
        expected.y, gaussian(expected.x, 0, 0.2, 0.2), atol=1e-12
    )  # the same in every direction
    both = expected.y * edge_mtf(cycles, 5, 0.8)
    np.testing.assert_allclose(series["measured"].y[: len(both)], both, atol=0.004)
