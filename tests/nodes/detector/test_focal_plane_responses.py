"""Focal Plane: responses and binning."""

import math

import mpmath
import numpy as np
import pytest

from cube_files import C1_UM, C2_UM, PHOTON_J_UM, write_cube
from focal_plane_bench import CAMERA_SHEET, focal_plane_bench
from node_bench import NodeBench, square_detectors

SIZE = (6, 7)
LOW, HIGH = 3.7, 4.8
PITCH_UM, F_NUMBER, TIME_S, QE = 15.0, 4.0, 0.004, 0.7
PER_PHOTON = QE * TIME_S * (PITCH_UM * 1e-6) ** 2 * np.pi / (4 * F_NUMBER**2 + 1)
LENS = square_detectors(PITCH_UM, 100.0, F_NUMBER)
PLANE = {"integration_time_s": TIME_S, "quantum_efficiency": QE}
RESPONSES = {
    "grey": ({"shape": "rectangle", "peak": 0.5}, lambda um: 0.5 + 0 * um),
    "narrow": (
        {"shape": "rectangle", "centre_um": 4.3, "width_um": 0.4, "peak": 0.8},
        lambda um: 0.8 * (np.abs(um - 4.3) <= 0.2),
    ),
    "gaussian": (
        {"shape": "gaussian", "centre_um": 4.25, "width_um": 0.6, "peak": 0.9},
        lambda um: 0.9 * np.exp(-4 * np.log(2) * ((um - 4.25) / 0.6) ** 2),
    ),
    "file": (
        {"shape": "file", "path": "r.csv"},
        lambda um: np.interp(um, [3.5, 4.0, 5.0], [0.1, 1.0, 0.3]),
    ),
}


def planck(um, kelvin):
    return C1_UM / um**5 / np.expm1(C2_UM / um / kelvin)


def fine(low, high, count=220_000):
    """Middles of cells, whose edges meet those of the responses."""
    return low + (high - low) * (np.arange(count) + 0.5) / count


def electrons(law, kelvin, *, parts=((LOW, HIGH),)):
    """Of a black body, by fine sums."""
    total = 0.0
    for low, high in parts:
        um = fine(low, high)
        total += (high - low) * np.mean(law(um) * planck(um, kelvin) * um)
    return PER_PHOTON * total / PHOTON_J_UM


def figures(folder, read, response, plane=(), *, warm=True):
    there = bench(folder, read, response, plane)
    return there.readouts("plane"), there.readouts("merit") if warm else {}


def bench(folder, read, response, plane):
    (folder / "r.csv").write_text("3.5,0.1\n4,1\n5,0.3\n")
    nodes = {
        "read": ("read_image", {"fov_x_deg": 0.1, "fov_y_deg": 0.1, **read}),
        "filter": ("spectral_response", response),
        "init": ("init_trans", {**LENS, "platform": "array"}),
        "back": ("back_transform", {}),
        "plane": ("focal_plane", {**PLANE, **dict(plane)}),
        "merit": ("figures_of_merit", {}),
    }
    return NodeBench(folder, nodes)


def cube(folder, parts, *, kelvin=300.0, width=0.01):
    wavelengths = np.concatenate(
        [low + width * (np.arange(round((high - low) / width)) + 0.5) for low, high in parts]
    )
    samples = planck(wavelengths, kelvin)[:, np.newaxis, np.newaxis] * np.ones(SIZE)
    write_cube(folder, samples, wavelengths, width)
    return {"path": "cube.img", "bands": "all"}


def expected_netd(law, parts=((LOW, HIGH),)):
    warm, cold = (electrons(law, kelvin, parts=parts) for kelvin in (300.05, 299.95))
    return np.sqrt(electrons(law, 300.0, parts=parts)) / ((warm - cold) / 0.1)


@pytest.mark.parametrize("name", RESPONSES)
def test_a_warm_band_behind_a_response_has_the_electrons_and_netd_of_its_black_body(tmp_path, name):
    params, law = RESPONSES[name]
    um = fine(LOW, HIGH)
    np.save(tmp_path / "scene.npy", np.full(SIZE, (HIGH - LOW) * planck(um, 300.0).mean()))
    read = {"path": "scene.npy", "cut_on_um": LOW, "cut_off_um": HIGH}
    made, _ = figures(tmp_path, read, params)
    assert made["signal_e"] == pytest.approx(electrons(law, 300.0), rel=2e-6)  # of the fine sums
    assert made["netd_K"] == pytest.approx(expected_netd(law), rel=2e-6)


def test_light_in_the_gaps_of_a_cube_is_no_part_of_its_temperature(tmp_path):
    parts = [(3.7, 4.0), (4.5, 4.8)]
    made, _ = figures(tmp_path, cube(tmp_path, parts), {})
    want = expected_netd(np.ones_like, parts)
    assert made["signal_e"] == pytest.approx(electrons(np.ones_like, 300.0, parts=parts), rel=2e-5)
    assert made["netd_K"] == pytest.approx(want, rel=2e-5)


def test_reflected_light_behind_a_response_is_counted_by_its_source(tmp_path):
    low, high = 0.5, 0.9
    um = fine(low, high)
    law = np.interp(um, [0.5, 0.6, 0.9], [0.0, 1.0, 0.2])
    light = planck(um, 5800.0)
    np.save(tmp_path / "scene.npy", np.full(SIZE, 20.0))
    (tmp_path / "q.csv").write_text("0.5,0\n0.6,1\n0.9,0.2\n")
    read = {"path": "scene.npy", "cut_on_um": low, "cut_off_um": high}
    nodes = {
        "read": ("read_image", {**read, "fov_x_deg": 1.0, "fov_y_deg": 1.0}),
        "filter": ("spectral_response", {"shape": "file", "path": "q.csv"}),
        "init": ("init_trans", LENS),
        "plane": ("focal_plane", PLANE),
    }  # fmt: skip
    made = NodeBench(tmp_path, nodes).readouts("plane")["signal_e"]
    want = PER_PHOTON * 20.0 * np.mean(law * light * um) / np.mean(light) / PHOTON_J_UM
    assert made == pytest.approx(want, rel=2e-6)


SHEET = {"read_noise_e": 20.0, "full_well_e": 1e6, "bits": 12, "tdi_stages": 8}


def snr_by_hand(law, parts, radiance, pedestal_e=0.0):
    """Of a flat spectrum: electrons by quadrature between the places where the law bends."""
    exposure = 8 * TIME_S * (PITCH_UM * 1e-6) ** 2 * mpmath.pi / (4 * F_NUMBER**2 + 1)
    photons = sum(mpmath.quad(lambda um: law(um) * um, part) for part in parts) / PHOTON_J_UM
    electrons = radiance * exposure * photons
    rounding = SHEET["full_well_e"] / 4095 / mpmath.sqrt(12)
    noise = mpmath.sqrt(electrons + pedestal_e + 20**2 + rounding**2)
    return float(electrons / noise)


@pytest.mark.parametrize("gap", [False, True])
def test_the_snr_at_a_reference_radiance_is_that_of_its_photons(tmp_path, gap):
    """A response, then a QE within a filter, of one band or of a cube with a gap."""
    (tmp_path / "q.csv").write_text("0.4,0.2\n0.7,0.9\n1.0,0.3\n")
    plane = {**SHEET, "response": "q.csv", "cut_on_um": 0.5, "cut_off_um": 0.85}
    plane |= {"reference_radiance": 3.0, "dark_current_e_per_s": 1e4}
    filtered = {"shape": "rectangle", "centre_um": 0.7, "width_um": 0.3, "peak": 0.6}
    read = {"path": "scene.npy", "cut_on_um": 0.45, "cut_off_um": 0.9}
    np.save(tmp_path / "scene.npy", np.full(SIZE, 1.0))
    parts = [(0.55, 0.7), (0.7, 0.85)]
    if gap:
        read = cube(tmp_path, [(0.5, 0.6), (0.7, 0.85)], kelvin=3000.0)
        parts = [(0.55, 0.6), (0.7, 0.85)]
    made, _ = figures(tmp_path, read, filtered, plane, warm=False)

    def law(um):
        return 0.6 * (0.2 + (um - 0.4) / 0.3 * 0.7 if um < 0.7 else 0.9 - (um - 0.7) / 0.3 * 0.6)

    expected = snr_by_hand(law, parts, 3.0, pedestal_e=1e4 * TIME_S * 8)
    assert made["snr_at_reference"] == pytest.approx(expected, rel=1e-9)


def test_a_reference_radiance_that_clips_has_no_snr(tmp_path):
    np.save(tmp_path / "scene.npy", np.full(SIZE, 1e-3))
    read = {"path": "scene.npy", "cut_on_um": 0.45, "cut_off_um": 0.9}
    plane = {**SHEET, "reference_radiance": 1e6}
    there = bench(tmp_path, read, {}, plane)
    made = there.readouts("plane")
    assert made["snr"] > 0.0
    assert made["snr_at_reference"] is None
    texts = map(str, there.warnings())
    (said,) = (text for text in texts if "snr_at_reference" in text)
    assert "reference_radiance reaches" in said
    assert "is clipped: snr_at_reference is left out" in said


PATTERNS = {"prnu_percent": 1.0, "dsnu_e": 300.0, "offset_dn": 20.0, "dark_current_e_per_s": 1e6}
SIGNAL_E = 584765.21021844287024  # of the reference camera, 300 K in 4 ms
BINS = {"binning_x": 3, "binning_y": 2}
MODES = ("charge", "digital")


def bench_of(folder, params, **how):
    return focal_plane_bench(folder, {**CAMERA_SHEET, **PATTERNS, **params}, **how)


def summed(picture, x=3, y=2):
    rows, columns = picture.shape[0] // y, picture.shape[1] // x
    blocks = picture[: rows * y, : columns * x].astype(np.float64).reshape(rows, y, columns, x)
    return blocks.sum(axis=(1, 3))


@pytest.mark.parametrize("mode", MODES)
def test_figures_of_a_bin_by_hand_and_in_a_picture(tmp_path, mode):
    bench = bench_of(tmp_path, {**BINS, "binning": mode}, size=(300, 200))
    found, reads = bench.readouts("it"), 1 if mode == "charge" else 6
    total = 6 * (SIGNAL_E + 4000.0)
    # The full wells of six pixels give the last number of one conversion, or of six.
    gain = 7e6 * (6 if mode == "charge" else 1) / 16383
    wanted = {
        "signal_e": 6 * SIGNAL_E, "dark_e": 24_000.0, "shot_noise_e": math.sqrt(total),
        "read_noise_e": 400 * math.sqrt(reads), "gain_e_per_dn": gain,
        "quantization_noise_e": gain / math.sqrt(12) * math.sqrt(reads),
        "fixed_pattern_e": math.hypot(0.01 * total, 300 * 6) / math.sqrt(6),
        "mean_dn": total / gain + 20 * reads, "well_fill_percent": 100 * total / (6 * 7e6),
    }  # fmt: skip
    for name, value in wanted.items():
        assert found[name] == pytest.approx(value, rel=1e-9), name
    temporal = math.sqrt(total + reads * (400**2 + gain**2 / 12))
    assert found["temporal_noise_e"] == pytest.approx(temporal, rel=1e-9)
    assert found["nei_photons_per_cm2"] == pytest.approx(
        temporal / 0.7 / (6 * (15e-4 * 0.95) ** 2), rel=1e-9
    )
    spread = math.hypot(temporal, found["fixed_pattern_e"]) / gain
    image = bench.value("it.image")
    assert image.shape == (100, 100)
    assert image.std() == pytest.approx(spread, rel=4 / math.sqrt(2 * image.size))
    assert image.mean() == pytest.approx(found["mean_dn"], abs=4 * spread / 100)
    port, before = bench.port("it.image"), bench.port("scene.image")
    assert port.interval_x_mrad == pytest.approx(3 * before.interval_x_mrad)
    assert port.interval_y_mrad == pytest.approx(2 * before.interval_y_mrad)
    assert port.pixel_mrad == (None, None)


def test_a_bin_of_charge_is_one_larger_pixel(tmp_path):
    """2 × 2 of 15 µm are 30 µm: the same signal and NETD, with dark current by area."""
    dense = {**CAMERA_SHEET, "dark_current_A_per_cm2": 1e-6, "full_well_e": 28e6}
    larger = focal_plane_bench(
        tmp_path, dense, init={"detector_x_um": 30, "detector_y_um": 30}
    ).readouts("it")
    bins = {**dense, "full_well_e": 7e6, "binning_x": 2, "binning_y": 2}
    found = focal_plane_bench(tmp_path, bins).readouts("it")
    assert found.keys() == larger.keys()
    for name, value in found.items():
        assert value == (value if isinstance(value, str | None) else pytest.approx(
            larger[name], rel=1e-12)), name  # fmt: skip


@pytest.mark.parametrize("units", ["dn", "electrons", "radiance"])
def test_digital_bins_are_sums_of_the_pixels_that_are_read(tmp_path, units):
    params = {"units": units, "bad_pixel_percent": 2.0}
    scene = {"kind": "dormitory"}
    pixels, bins = (
        bench_of(tmp_path, {**params, **more}, scene=scene, size=(62, 43))
        for more in ({}, {**BINS, "binning": "digital"})
    )
    scale = 1 / 6 if units == "radiance" else 1.0
    np.testing.assert_allclose(
        bins.value("it.image"), scale * summed(pixels.value("it.image")), rtol=1e-12
    )
    for port in ("electrons", "noise"):
        np.testing.assert_allclose(
            bins.value(f"it.{port}"), summed(pixels.value(f"it.{port}")), rtol=1e-9, atol=1e-6
        )
    marked = summed(pixels.value("it.saturated"))
    np.testing.assert_allclose(bins.value("it.saturated"), marked / 6)
    assert bins.readouts("it")["saturated_pixels"] == np.count_nonzero(marked) > 0


def test_bins_of_charge_are_sums_before_one_reading(tmp_path):
    """The scene's electrons are summed; dead pixels give nothing and hot ones a full well."""
    params = {"bad_pixel_percent": 5.0, "read_noise_e": 0.0, "bits": 0, "units": "electrons"}
    scene = {"kind": "dormitory"}
    pixels, bins = (
        bench_of(tmp_path, {**params, **more}, scene=scene, size=(62, 43)) for more in ({}, BINS)
    )
    np.testing.assert_allclose(bins.value("it.image"), summed(pixels.value("it.image")), rtol=1e-12)
    back = bench_of(tmp_path, {**params, **BINS, "bad_pixel_percent": 0.0, "units": "radiance",
                               "integration_time_s": 0.04, "full_well_e": 7e8}, scene=scene,
                    size=(62, 43))  # fmt: skip
    mean = summed(back.value("scene.image")) / 6
    np.testing.assert_allclose(back.value("it.image"), mean, rtol=0.05)


def test_pixel_and_register_fill_first_where_they_are_smaller(tmp_path):
    scene = {"kind": "two_panel", "delta_K": 80}
    params = {"prnu_percent": 0.0, "dsnu_e": 0.0, "read_noise_e": 0.0, "bits": 0,
              "units": "electrons", "full_well_e": 1e6, **BINS}  # fmt: skip
    full = bench_of(tmp_path, params, scene=scene)
    assert full.value("it.electrons").max() == 6e6
    assert full.readouts("it")["saturated_pixels"] > 0
    register = bench_of(tmp_path, {**params, "register_well_e": 4e6}, scene=scene)
    assert register.value("it.electrons").max() == 4e6
    fill = register.readouts("it")["well_fill_percent"] / full.readouts("it")["well_fill_percent"]
    assert fill == pytest.approx(6 / 4, rel=1e-12)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("units", ["dn", "radiance"])
def test_noise_follows_the_bins_into_budget_and_netd(tmp_path, mode, units):
    params = {**BINS, "binning": mode, "units": units, "nonlinearity_percent": 5.0}
    bench = bench_of(tmp_path, params, size=(96, 80), behind=("figures_of_merit", "noise_budget"))
    own, budget = bench.readouts("it"), bench.readouts("noise_budget")
    assert bench.readouts("figures_of_merit")["netd_K"] == pytest.approx(own["netd_K"], rel=1e-6)
    if units == "dn":
        gain = own["gain_e_per_dn"]
        assert budget["sigma_temporal"] * gain == pytest.approx(own["temporal_noise_e"], rel=1e-6)
        assert budget["sigma_fixed"] * gain == pytest.approx(own["fixed_pattern_e"], rel=1e-3)


def test_the_mtf_of_bins_is_their_width(tmp_path):
    """A sine of 4 cycles in 96 pixels, in bins of 3: sin(3πf)/(3·sin(πf)) at 4/96 per pixel."""
    scene = {"kind": "sine", "frequency": 4, "delta_K": 2, "angle_deg": 0}
    quiet = {"read_noise_e": 0.0, "prnu_percent": 0.0, "dsnu_e": 0.0, "bits": 0}
    contrast = []
    for x in (1, 3):
        params = {**quiet, "binning_x": x, "units": "electrons"}
        bench = bench_of(tmp_path, params, scene=scene, size=(96, 48))
        clean = bench.value("it.electrons") - bench.value("it.noise")
        line = np.abs(np.fft.rfft(clean.mean(axis=0)))
        contrast.append(line[4] / line[0])
    f = 4 / 96
    wanted = math.sin(3 * math.pi * f) / (3 * math.sin(math.pi * f))
    assert contrast[1] / contrast[0] == pytest.approx(wanted, rel=1e-6)


def test_bins_larger_than_the_picture_are_refused(tmp_path):
    error = bench_of(tmp_path, {"binning_x": 100}).error("it")
    assert "blocks of 100 × 1 do not fit an image of 64 × 48" in str(error)
