"""Read-out artefacts in a network: a moving scene, regions of pictures, and what is predicted."""

import numpy as np
import pytest

from core.chain.noise_power import NoisePower
from core.transfer.factors import Product
from cube_files import centres, write_cube
from linked_network import linked_network
from node_bench import NodeBench
from nodes.analysis.lineage import transfer_of
from region_checks import assert_parts
from short_chain import short_chain

SIZE, INTERVAL = 160, 0.1
ONE_SAMPLE = {"detector_x_um": 10, "detector_y_um": 10, "focal_length_mm": 100}
CHAIN = {
    "rolling_shutter": {"image_velocity_x": 9000, "image_velocity_y": -4000},
    "frame_transfer_smear": {"line_transfer_time_s": 5e-6, "passed": "above"},
    "blooming": {"full_well": 40, "anti_blooming_percent": 20},
    "charge_trails": {"serial_efficiency": 0.999, "parallel_efficiency": 0.99, "extra_serial": 30},
}
OPERATORS = [
    ("frame_transfer_smear", {"line_transfer_time_s": 5e-4}),
    ("frame_transfer_smear", {"line_transfer_time_s": 5e-4, "passed": "below"}),
    ("charge_trails", {"parallel_efficiency": 0.98, "extra_parallel": 5}),
    ("charge_trails", {"parallel_efficiency": 0.98, "amplifier": "top_right"}),
]


def made(folder, picture, module, params, **init):
    """The picture behind a module, one sample per pixel if not said otherwise."""
    bench, last = short_chain(
        folder, picture, [(module, params)], interval_mrad=INTERVAL, init={**ONE_SAMPLE, **init}
    )
    return bench, bench.port(last), bench.value(last)


def scene(x, y):
    """A sinusoid and a soft bar."""
    return 3 + np.sin(2 * np.pi * (0.11 * x + 0.06 * y)) + np.exp(-(((x - 70) / 3) ** 2))


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize(("right", "down"), [(9000, -3000), (-700, 0), (0, 4000)])
def test_each_line_shows_the_scene_where_it_was_when_exposed(tmp_path, samples, right, down):
    """Ray by ray, within 1e-3 of a sample; all samples of a line of pixels are exposed at once."""
    rows, columns = np.mgrid[:SIZE, :SIZE].astype(float)
    params = {"image_velocity_x": right, "image_velocity_y": down}
    focal = {"focal_length_mm": 100 / samples}
    bench, _, found = made(tmp_path, scene(columns, rows), "rolling_shutter", params, **focal)
    moved = 2e-5 * samples * (rows // samples)
    x, y = columns - right * moved, rows - down * moved
    inside = (x > 8) & (x < SIZE - 9) & (y > 8) & (y < SIZE - 9)
    assert inside.mean() > 0.6
    slope = 2 * np.pi * 0.11  # of the sinusoid, per sample
    assert np.abs(found - scene(x, y))[inside].max() < 1e-3 * slope
    skew = right * 2e-5 * ((SIZE - 1) // samples)
    assert bench.readouts("rolling_shutter")["skew_px"] == pytest.approx(skew)


@pytest.mark.parametrize(("axis", "velocity", "warned"), [
    ("x", 4.9e4, False), ("x", -5.2e4, True), ("y", 5.2e4, True),
])  # fmt: skip
def test_an_image_that_leaves_the_frame_is_warned_of(tmp_path, axis, velocity, warned):
    """159 lines of 20 µs: 160 pixels at 5.03e4 pixels per second."""
    params = {f"image_velocity_{axis}": velocity}
    bench, _, _ = made(tmp_path, np.ones((SIZE, SIZE)), "rolling_shutter", params)
    assert [c.check for c in bench.warnings() if c.node.startswith("rolling")] == ["away"] * warned


def test_regions_are_those_of_the_whole(tmp_path):
    nodes = {"scene": ("test_scene", {"width": 90, "height": 131})}
    nodes |= {key: (key, params) for key, params in CHAIN.items()}
    assert_parts(linked_network(nodes), [f"{key}.image" for key in CHAIN], tmp_path)


@pytest.mark.parametrize(("module", "params"), OPERATORS)
def test_noise_and_mean_are_those_of_the_pictures_of_single_rows(tmp_path, module, params):
    size = 24
    bench, image, matrix = made(tmp_path, np.eye(size), module, params)
    change = image.recipe.lineage.linear
    power = change.noise(bench.work, NoisePower.white(size, size, 1.0))
    assert power.variance == pytest.approx((matrix**2).sum() / size, rel=1e-9)
    assert change.gain == pytest.approx(matrix.sum() / size, rel=1e-9)
    np.testing.assert_allclose(change.row(bench.work, matrix[3], "y"), matrix @ matrix[3])


@pytest.mark.parametrize(("module", "params"), OPERATORS[2:])
def test_the_predicted_transfer_is_that_of_the_middle_pixel(tmp_path, module, params):
    size = 81
    bench, image, matrix = made(tmp_path, np.eye(size), module, params)
    place, eta = np.arange(size) - size // 2, np.array([0.0, 0.7, 2.1, 4.4])
    expected = np.exp(-2j * np.pi * INTERVAL * np.outer(eta, place)) @ matrix[:, size // 2]
    stages = transfer_of(image).stages
    factors = tuple(factor for stage in stages for factor in stage.factors)
    found = Product(factors).total(bench.work, np.zeros(1), eta)[:, 0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("module", [key for key in CHAIN if key != "blooming"])
def test_each_band_is_read_alone(tmp_path, module):
    """A Focal Plane behind it weights each band by its response: their sum would not do."""
    waves, width = centres(3, low=3.0, high=5.0)
    cube = np.random.default_rng(1).random((3, 30, 43)) + 1.0
    write_cube(tmp_path, cube, waves, width, kind="f8", unit="W/m^2/sr/um")
    read = {"path": "cube.img", "bands": "all", "fov_x_deg": 1, "fov_y_deg": 1}
    nodes = {"read": ("read_image", read), "it": (module, CHAIN[module])}
    bench = NodeBench(tmp_path, nodes)
    bands = bench.port("it.image").bands
    for number in range(3):
        alone = {**read, "bands": "one", "band": number}
        single = NodeBench(tmp_path, {**nodes, "read": ("read_image", alone)})
        band = bench.work.value(bands.band(number))
        np.testing.assert_allclose(band, single.value("it.image"), rtol=1e-6)
    means = bench.work.value(bands.means())
    wanted = [bench.work.value(bands.band(number)).mean() for number in range(3)]
    np.testing.assert_allclose(means, wanted, rtol=0.006)  # predicted for a uniform picture


@pytest.mark.parametrize(("well", "warned"), [(10000.0, True), (150.0, False), (None, False)])
def test_a_well_in_another_unit_is_warned_of(tmp_path, well, warned):
    bench, _, _ = made(tmp_path, 20.0 * np.eye(9), "blooming", {"full_well": well})
    found = bench.warnings()
    assert [caution.check for caution in found] == ["well"] * warned
    if warned:
        assert "10000, but the picture's largest sample is 20 W/m²/sr. Give" in str(found[0])


@pytest.mark.parametrize("module", [*CHAIN, "persistence"])
def test_digital_numbers_are_warned_of(tmp_path, module):
    np.save(tmp_path / "dn.npy", np.full((8, 8), 100.0))

    def warned(unit):
        nodes = {"file": ("read_image", {"path": "dn.npy", "unit": unit}), "it": (module, {})}
        links = [("file.image", "it.image")]
        links += [("file.image", "it.earlier")] if module == "persistence" else []
        bench = NodeBench(tmp_path, nodes, links)
        return [c.check for c in bench.warnings() if c.node == "it"]

    assert warned("DN") == ["digits"]
    assert warned("e-") == []


@pytest.mark.parametrize(
    ("module", "axis", "warned"),
    [
        ("charge_eff_mtf", "serial", True),
        ("charge_eff_phase", "serial", True),
        ("charge_eff_mtf", "parallel", False),
        ("detector_mtf", "serial", False),
    ],
)
def test_charge_transfer_that_counts_twice_is_warned_of(tmp_path, module, axis, warned):
    chain = [(module, {}), ("charge_trails", {f"{axis}_efficiency": 0.999})]
    init = {**ONE_SAMPLE, "platform": "array"}
    bench, _ = short_chain(tmp_path, np.eye(9), chain, interval_mrad=INTERVAL, init=init)
    twice = [str(caution) for caution in bench.warnings() if caution.check == "twice"]
    assert len(twice) == warned
    assert all(f"here and on {module}" in text for text in twice)


def test_what_is_left_of_an_earlier_picture(tmp_path):
    scene = {"width": 33, "height": 21}
    np.save(tmp_path / "kelvin.npy", np.full((21, 33), 300.0))
    nodes = {
        "now": ("test_scene", scene),
        "before": ("test_scene", {**scene, "kind": "sine"}),
        "small": ("test_scene", {**scene, "width": 32}),
        "it": ("persistence", {"fast_percent": 5, "delay_s": 2}),
        "wrong": ("persistence", {}),
        "kelvin": ("read_image", {"path": "kelvin.npy", "unit": "K"}),
        "mixed": ("persistence", {"fast_percent": 5}),
        "more": ("persistence", {"fast_percent": 80, "slow_percent": 30}),
    }
    links = [("now.image", "it.image"), ("before.image", "it.earlier"),
             ("now.image", "wrong.image"), ("small.image", "wrong.earlier"),
             ("now.image", "mixed.image"), ("kelvin.image", "mixed.earlier"),
             ("now.image", "more.image"), ("before.image", "more.earlier")]  # fmt: skip
    bench = NodeBench(tmp_path, nodes, links)
    expected = bench.value("now.image") + 0.05 * np.exp(-2) * bench.value("before.image")
    np.testing.assert_allclose(bench.value("it.image"), expected, rtol=1e-14)
    assert bench.readouts("it")["lag_percent"] == pytest.approx(5 * np.exp(-2))
    assert "32 × 21" in str(bench.error("wrong"))
    assert "is in 'K' and the image is in 'W/m²/sr'" in str(bench.error("mixed"))
    assert "slow_percent = 30.0 % is not allowed" in str(bench.error("more"))
