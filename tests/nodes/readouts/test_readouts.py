"""Read-outs of modules behind a small scene whose two axes are unlike in everything."""

import cmath
import math

import numpy as np
import pytest

from battery_settings import EXAMPLES, SMALL_PUPIL
from core.chain.wires import transfer_plane
from library_battery import DECLARED
from node_bench import NodeBench
from planck_truth import band_radiance

COLUMNS, ROWS = 24, 16
FOV_X_DEG, FOV_Y_DEG = 2.0, 3.0
DX = math.radians(FOV_X_DEG) * 1000 / COLUMNS  # mrad
DY = math.radians(FOV_Y_DEG) * 1000 / ROWS
NYQUIST_X, NYQUIST_Y = 0.5 / DX, 0.5 / DY  # cycles/mrad: 0.344 and 0.153
SCENE = {
    "kind": "two_panel", "width": COLUMNS, "height": ROWS,
    "fov_x_deg": FOV_X_DEG, "fov_y_deg": FOV_Y_DEG, "cut_on_um": 8.0, "cut_off_um": 12.0,
}  # fmt: skip
FOCAL_LENGTH_MM = 20.0
PITCH_X_UM, PITCH_Y_UM = 30.0, 50.0
FILL_X, FILL_Y = 0.9, 0.7
RANGE_M = 400.0
F_NUMBER = 1.5
VELOCITY_M_PER_S = 60.0
SCAN_MRAD_PER_S = 8000.0
INIT = {
    "detector_x_um": PITCH_X_UM, "detector_y_um": PITCH_Y_UM, "focal_length_mm": FOCAL_LENGTH_MM,
    "fill_x": FILL_X, "fill_y": FILL_Y, "range_m": RANGE_M, "f_number": F_NUMBER,
    "velocity_m_per_s": VELOCITY_M_PER_S, "scan_velocity_mrad_per_s": SCAN_MRAD_PER_S,
}  # fmt: skip
IFOV_X, IFOV_Y = (FILL_X * PITCH_X_UM / FOCAL_LENGTH_MM, FILL_Y * PITCH_Y_UM / FOCAL_LENGTH_MM)
LOST = 0.001
PACKETS = cmath.exp(-2j * math.pi * NYQUIST_X * PITCH_X_UM / FOCAL_LENGTH_MM)
TRANSFER = (1 - LOST) / (1 - LOST * PACKETS)
CORNER = math.hypot(NYQUIST_X, NYQUIST_Y)
MEAN_UM = 10.0
# 0.423·k²·∫Cn²·(z/L)^(5/3) dz: a spherical wave's mean weight is 3/8 (Fried 1966).
R0_M = (0.423 * (2 * math.pi / 10e-6) ** 2 * 1e-13 * RANGE_M * 3 / 8) ** (-3 / 5)
DEPTH = 0.5 * RANGE_M / 1000
CUTOFF = 0.2  # between the two Nyquist frequencies
BLUR = {"sigma_x_mrad": 0.4, "sigma_y_mrad": 1.3}
WITH_MTF = [
    key
    for key, declared in DECLARED.items()
    if any(readout.name == "mtf_at_nyquist_x" for readout in declared.readouts)
]


def bench_of(folder, key, params, *, init=None, scene=None, more=()):
    """The module as node `it` behind the scene, Init & Trans and what `more` there is."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", {**INIT, **(init or {})}),
        **dict(more),
        "it": (key, params),
    }
    return NodeBench(folder, nodes)


def gaussian(sigma_mrad, frequency):
    """Transfer function of a Gaussian blur."""
    return math.exp(-2 * (math.pi * sigma_mrad * frequency) ** 2)


def sinc(x):
    """The field's sinc, sin(πx)/(πx)."""
    return float(np.sinc(x))


def fried(rho, r0_m):
    return math.exp(-3.44 * (MEAN_UM * rho / (1000 * r0_m)) ** (5 / 3))


def disc(share):
    """MTF of a circular aperture at a share of its cutoff."""
    return 2 / math.pi * (math.acos(share) - share * math.sqrt(1 - share**2))


def blurs(velocity):
    return 1000 * velocity * 0.02 / RANGE_M


MOTION = {
    "image_velocity_x": 5.0, "platform_velocity_x": 25.0, "image_velocity_y": 61.0,
    "platform_velocity_y": 10.0, "integration_time_s": 0.02,
}  # fmt: skip
# What a blur tells beside its MTF at Nyquist.
CASES = [
    ("detector_mtf", {}, {"ifov_x_mrad": IFOV_X, "ifov_y_mrad": IFOV_Y,
                          "first_zero_x": 1 / IFOV_X, "first_zero_y": 1 / IFOV_Y}),
    ("charge_eff_phase", {"detectors_per_line": 500, "efficiency": 1 - LOST, "nyquist": "detector"},
     {"ptf_at_nyquist_x": 500 * cmath.phase(TRANSFER)}),
    ("crosstrack_mtf", {"dwell_time_s": 2e-4}, {"blur_mrad": 2e-4 * SCAN_MRAD_PER_S}),
    ("alongtrack_mtf", {"integration_time_s": 0.02}, {"blur_y_mrad": blurs(VELOCITY_M_PER_S)}),
    *(("relative_motion_mtf", {**MOTION, "model": model},
       {"blur_x_mrad": blurs(20.0), "blur_y_mrad": blurs(-51.0)})
      for model in ("published", "line")),
    ("jitter_mtf", {"sigma_mrad": 0.5},
     {"half_contrast": math.sqrt(2 * math.log(2)) / (2 * math.pi * 0.5)}),
    ("vibration_mtf", {"amplitude_x_mrad": 0.3, "frequency_Hz": 12.0, "integration_time_s": 0.25},
     {"periods": 3.0}),
    ("atmosphere_mtf", {"turbulence": "long_exposure", "fried_r0_m": 0.01, "turbidity": "none"},
     {"r0_m": 0.01, "optical_depth": 0.0, "largest_change": 1 - fried(CORNER, 0.01),
      "negligible": "no"}),
    ("atmosphere_mtf", {"turbulence": "long_exposure", "cn2": 1e-13, "turbidity": "custom",
                        "scattering_per_km": 0.5, "turbidity_cutoff_cyc_per_mrad": CUTOFF},
     {"r0_m": R0_M, "optical_depth": DEPTH, "negligible": "no",
      "largest_change": 1 - fried(CORNER, R0_M) * math.exp(-DEPTH)}),
    ("atmosphere_mtf", {"turbulence": "none", "turbidity": "custom", "scatter_depth": 0.003},
     {"r0_m": None, "optical_depth": 0.003, "largest_change": 1 - math.exp(-0.003),
      "negligible": "yes"}),
]  # fmt: skip


def check(found, expected):
    assert found.keys() == expected.keys()
    for name, value in expected.items():
        if isinstance(value, float):
            assert found[name] == pytest.approx(value, rel=1e-11), name
        else:
            assert found[name] == value, name


def of_samples(found):
    """Without what is at the pixels' Nyquist frequency, which is the same law at another place."""
    return {name: value for name, value in found.items() if "pixel_nyquist" not in name}


@pytest.mark.parametrize(("key", "params", "expected"), CASES)
def test_readouts_of_a_blur(tmp_path, key, params, expected):
    found = of_samples(bench_of(tmp_path, key, params).readouts("it"))
    check({name: value for name, value in found.items() if not name.startswith("mtf_at")}, expected)


def test_the_mtf_of_a_gaussian_blur_at_both_nyquist_frequencies(tmp_path):
    found = bench_of(tmp_path, "gaussian_mtf", BLUR).readouts("it")
    for axis, pitch_um, nyquist in (("x", PITCH_X_UM, NYQUIST_X), ("y", PITCH_Y_UM, NYQUIST_Y)):
        pixel, sigma = 0.5 * FOCAL_LENGTH_MM / pitch_um, BLUR[f"sigma_{axis}_mrad"]
        assert found[f"mtf_at_nyquist_{axis}"] == pytest.approx(gaussian(sigma, nyquist), rel=1e-11)
        assert found[f"mtf_at_pixel_nyquist_{axis}"] == pytest.approx(gaussian(sigma, pixel), 1e-11)


@pytest.mark.parametrize("key", WITH_MTF)
def test_the_mtf_of_every_module_at_both_nyquist_frequencies(folder, key):
    """That of its transfer function, whose law other tests know."""
    optics = {"pupil": ("exit_pupil", SMALL_PUPIL)} if key == "exit_pupil_mtf" else {}
    bench = bench_of(folder, key, EXAMPLES[key], more=optics)
    found, mtf = bench.readouts("it"), bench.port("it.mtf")
    pixel = (0.5 * FOCAL_LENGTH_MM / pitch_um for pitch_um in (PITCH_X_UM, PITCH_Y_UM))
    for place, (x, y) in (("nyquist", (NYQUIST_X, NYQUIST_Y)), ("pixel_nyquist", pixel)):
        plane = transfer_plane(bench.work, mtf, np.array([0.0, x]), np.array([0.0, y]))
        for axis, value in (("x", plane[0, 1]), ("y", plane[1, 0])):
            assert found[f"mtf_at_{place}_{axis}"] == pytest.approx(abs(value), rel=1e-9, abs=1e-12)


def pupil(folder, shape, size_x=64, size_y=40, **settings):
    """A pupil of radius 15 samples, of 12/64 mm across and 20/40 mm along."""
    made = {"shape": shape, "radius": 15.0, "size_x": size_x, "size_y": size_y}
    params = {"size_x_cm": 1.2, "size_y_cm": 2.0, **settings}
    more = {"pupil": ("exit_pupil", made)}
    return bench_of(folder, "exit_pupil_mtf", params, more=more)


PITCHES = {
    "pupil_interval_x": 12 / 64 / MEAN_UM,
    "pupil_interval_y": 20 / 40 / MEAN_UM,
    "image_interval_x": 1 / (COLUMNS * DX),
    "image_interval_y": 1 / (ROWS * DY),
}


def test_readouts_of_a_disc(tmp_path):
    """Its samples are not square: a disc of samples is an ellipse of 5.6 by 15 mm."""
    bench = pupil(tmp_path, "clear")
    cutoff_x, cutoff_y = 30 * 12 / 64 / MEAN_UM, 30 * 20 / 40 / MEAN_UM
    expected = {
        **PITCHES,
        "cutoff_x": cutoff_x,
        "cutoff_y": cutoff_y,
        "estimated_error": 1e-12,  # as stated of closed forms
        "mtf_at_nyquist_x": disc(NYQUIST_X / cutoff_x),
        "mtf_at_nyquist_y": disc(NYQUIST_Y / cutoff_y),
    }
    check(of_samples(bench.readouts("it")), expected)
    assert bench.readouts("pupil") == {"aperture_radius": 15.0}


def test_readouts_of_photon_noise(tmp_path):
    bench = bench_of(tmp_path, "poisson_noise", {"percent": 30.0, "width_px": 2.0})
    noise = bench.value("it.noise")
    assert noise.std() > 0
    expected = {"noise_mean": float(noise.mean()), "noise_sigma": float(noise.std())}
    check(bench.readouts("it"), expected)


D_STAR, BANDWIDTH_HZ, GAIN = 1e9, 3e4, 0.02


def test_slices_at_both_nyquist_frequencies(tmp_path):
    bench = bench_of(tmp_path, "mtf_slices", {}, more={"blur": ("gaussian_mtf", BLUR)})
    assert bench.readouts("it") == pytest.approx(
        {
            "at_nyquist_x": gaussian(0.4, NYQUIST_X),
            "at_nyquist_y": gaussian(1.3, NYQUIST_Y),
            "at_pixel_nyquist_x": gaussian(0.4, 0.5 * FOCAL_LENGTH_MM / PITCH_X_UM),
            "at_pixel_nyquist_y": gaussian(1.3, 0.5 * FOCAL_LENGTH_MM / PITCH_Y_UM),
        },
        rel=1e-12,
    )


def noisy(folder, key, params, platform="array"):
    """A blurred level through detectors with noise and errors of gain."""
    noise = {
        "material": "manual", "d_star": D_STAR, "bandwidth_Hz": BANDWIDTH_HZ,
        "gain_percent": 100 * GAIN, "background_K": 290.0,
    }  # fmt: skip
    return bench_of(
        folder, key, params, scene={"kind": "uniform"}, init={"platform": platform},
        more={
            "blur": ("gaussian_mtf", BLUR),
            "back": ("back_transform", {}),
            "noise": ("electronics_noise", noise),
        },
    )  # fmt: skip


def detector_sigma():
    """√(A·Δf)/D*·(1 + 4F²)/π/A, per m²."""
    area_cm2 = PITCH_X_UM * FILL_X * PITCH_Y_UM * FILL_Y * 1e-8
    g_number = (1 + 4 * F_NUMBER**2) / math.pi
    return 1e4 * math.sqrt(area_cm2 * BANDWIDTH_HZ) / D_STAR * g_number / area_cm2


def test_readouts_of_the_noise_budget(tmp_path):
    bench = noisy(tmp_path, "noise_budget", {"frequency": 0.4})
    level = float(bench.value("scene.image").mean())
    one, two = detector_sigma(), GAIN * level
    assert 0.05 < one / two < 20  # neither hides the other
    found = bench.readouts("it")
    assert found == pytest.approx(
        {
            "sigma": math.hypot(one, two),
            "sigma_temporal": one,
            "sigma_fixed": two,
            "mtf_x": gaussian(0.4, 0.4 * NYQUIST_X),
            "mtf_y": gaussian(1.3, 0.4 * NYQUIST_Y),
            "xi": 0.4 * NYQUIST_X,
            "eta": 0.4 * NYQUIST_Y,
        },
        rel=1e-3,
    )


def test_readouts_of_a_pushbroom(tmp_path):
    """1000 m up; 20 and 30 µm at 40 mm are 0.5 and 0.75 m, out to the ends of a line."""
    params = {
        "kind": "pushbroom", "altitude_m": 1000.0, "ground_interval_m": 1.0, "columns": 20,
        "rows": 12, "fov_x_deg": None, "pitch_x_um": 20.0, "pitch_y_um": 30.0,
        "focal_length_mm": 40.0,
    }  # fmt: skip
    found = bench_of(tmp_path, "camera_geometry", params).readouts("it")
    assert found == pytest.approx(
        {
            "swath_m": 10.0,
            "gsd_x_m": 0.5,
            "gsd_y_m": 0.75,
            "gsd_edge_x_m": 0.5,
            "gsd_edge_y_m": 0.75,
            "panoramic_factor": 1.0,
            "interval_x_mrad": 0.5,
            "interval_y_mrad": 0.75,
            "line_spacing_m": 0.75,
            "lines": 12,
            "footprint_error": 0.0,
        },
        rel=1e-9,
    )


BACKGROUND_K, AMPLIFIER_SNR, SPREAD = 290.0, 80.0, 0.3
PARAMS = {
    "material": "manual", "d_star": D_STAR, "background_K": BACKGROUND_K,
    "amplifier_snr": AMPLIFIER_SNR, "optics_transmission": 0.8, "filter_transmission": 0.9,
    "noise_variability_percent": 100 * SPREAD, "bits": 8,
}  # fmt: skip


def slope():
    """dL/dT of Planck's law in 8 to 12 µm, by a difference."""
    up, down = (float(band_radiance(8.0, 12.0, BACKGROUND_K + d)) for d in (0.01, -0.01))
    return (up - down) / 0.02


@pytest.mark.parametrize(
    ("given", "bandwidth_Hz"),
    [
        ({}, SCAN_MRAD_PER_S / (2 * DX)),  # 1/(2τ), τ the time over one sample across
        ({"time_constant_s": 2e-5}, 25e3),
        ({"scan_mirror_rate_Hz": 2.0}, 2 * 2 * math.pi * 1000 / (2 * DX)),
        ({"bandwidth_Hz": 4e4}, 4e4),
    ],
)
def test_readouts_of_the_electronics(tmp_path, given, bandwidth_Hz):
    bench = bench_of(tmp_path, "electronics_noise", {**PARAMS, **given})
    found = bench.readouts("it")
    area_cm2 = PITCH_X_UM * FILL_X * PITCH_Y_UM * FILL_Y * 1e-8
    g_number = (1 + 4 * F_NUMBER**2) / (math.pi * 0.8 * 0.9)
    nep = math.sqrt(area_cm2 * bandwidth_Hz) / D_STAR
    ner = nep * g_number / (1e-4 * area_cm2)
    mean = float(bench.value("scene.image").mean())
    # All detectors together are noisier than one of mean noise, by the spread among them.
    detectors, amplifier = ner * math.hypot(1, SPREAD), mean / AMPLIFIER_SNR
    exact = {
        "bandwidth_Hz": bandwidth_Hz,
        "g_number": g_number,
        "d_star": D_STAR,
        "nep_W": nep,
        "ner": ner,
        "snr": mean / math.hypot(detectors, amplifier),
        "background_K": BACKGROUND_K,
    }
    kelvin = {
        "netd_detector_K": detectors / slope(),
        "netd_amplifier_K": amplifier / slope(),
        "netd_system_K": math.hypot(detectors, amplifier) / slope(),
    }
    error = bench.value("it.quantization_error")
    rounding = {"quantization_rms": math.sqrt(float(np.mean(error**2)))}
    assert found.keys() == {*exact, *kelvin, *rounding}
    for names, rel in ((exact, 1e-11), (kelvin, 1e-6), (rounding, 1e-9)):
        for name, value in names.items():
            assert found[name] == pytest.approx(value, rel=rel), name


PIXEL_X, PIXEL_Y = PITCH_X_UM / FOCAL_LENGTH_MM, PITCH_Y_UM / FOCAL_LENGTH_MM


def test_readouts_of_the_transform(tmp_path):
    found = bench_of(tmp_path, "jitter_mtf", {}).readouts("init")
    assert found == pytest.approx(
        {
            "interval_x_mrad": DX,
            "interval_y_mrad": DY,
            "ifov_x_mrad": PIXEL_X * FILL_X,
            "ifov_y_mrad": PIXEL_Y * FILL_Y,
            "frequency_interval_x": 1 / (COLUMNS * DX),
            "frequency_interval_y": 1 / (ROWS * DY),
            "nyquist_x": NYQUIST_X,
            "nyquist_y": NYQUIST_Y,
            "pixel_nyquist_x": 0.5 / PIXEL_X,
            "pixel_nyquist_y": 0.5 / PIXEL_Y,
            "oversampling_x": PIXEL_X / DX,
            "oversampling_y": PIXEL_Y / DY,
        },
        rel=1e-12,
    )


NEED_X = {"ifov_x_mrad", "oversampling_x", "pixel_nyquist_x"}
NEED_Y = {"ifov_y_mrad", "oversampling_y", "pixel_nyquist_y"}


@pytest.mark.parametrize(
    ("missing", "empty"),
    [("detector_x_um", NEED_X), ("detector_y_um", NEED_Y), ("focal_length_mm", NEED_X | NEED_Y)],
)
def test_readouts_of_the_transform_without_a_detector(tmp_path, missing, empty):
    """What needs a length that is not given is empty, and nothing else."""
    found = bench_of(tmp_path, "jitter_mtf", {}, init={missing: None}).readouts("init")
    assert {name for name, value in found.items() if value is None} == empty


@pytest.mark.parametrize("factor", [1, 3])
def test_readouts_of_the_anti_aliaser(tmp_path, factor):
    found = bench_of(tmp_path, "anti_alias", {"factor": factor}).readouts("it")
    expected = {"new_nyquist_x": NYQUIST_X / factor, "new_nyquist_y": NYQUIST_Y / factor}
    assert found == pytest.approx(expected, rel=1e-12)


def test_nyquist_of_sampled_pixels(tmp_path):
    """Half a cycle in a pixel of three by two samples of 0.5 and 0.25 mrad."""
    seen = {"width": 12, "height": 8, "fov_x_deg": math.degrees(6e-3),
            "fov_y_deg": math.degrees(2e-3)}  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "pixels": ("sample_pixels", {"factor_x": 3, "factor_y": 2}),
    }
    bench = NodeBench(tmp_path, nodes)
    assert bench.readouts("pixels") == pytest.approx({"nyquist_x": 1 / 3, "nyquist_y": 1.0})
