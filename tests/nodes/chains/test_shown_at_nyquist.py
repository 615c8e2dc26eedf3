"""Looked-at transfer functions of even frames against what becomes of a point in a picture."""

import numpy as np
import pytest

from node_bench import NodeBench

PUPIL = {"size_x": 32, "size_y": 32, "radius": 12.0, "zernike_waves": [0, 0, 0, 0.1, 0.2, 0, 0.15]}
BAND = {"cut_on_um": 8.0, "cut_off_um": 12.0, "size_x_cm": 1.0, "size_y_cm": 1.2}
CHARGE = {"detectors_per_line": 640, "efficiency": 0.9995, "model": "published"}
STAGES = {
    "line": [("relative_motion_mtf", {
        "image_velocity_x": 3.0, "image_velocity_y": -4.0, "integration_time_s": 0.2,
        "range_m": 500.0, "model": "line",
    })],
    "aberrations": [("exit_pupil_mtf", BAND)],
    "charge": [("charge_eff_mtf", CHARGE), ("charge_eff_phase", CHARGE)],
    "all": [],
}  # fmt: skip
STAGES["all"] = [stage for name in ("line", "aberrations", "charge") for stage in STAGES[name]]


def chain(folder, stages, rows, columns):
    """What acts, by the FFT of a point's picture; what the wires show of it; each stage's own."""
    point = np.zeros((rows, columns))
    point[0, 0] = 1.0
    np.save(folder / "in.npy", point)
    fov = {"fov_x_deg": np.degrees(columns * 0.9e-3), "fov_y_deg": np.degrees(rows * 1.1e-3)}
    nodes = {
        "in": ("read_image", {"path": "in.npy", **fov}),
        "init": ("init_trans", {"edges": "periodic"}),
        "pupil": ("exit_pupil", PUPIL),
        **{f"s{number}": stage for number, stage in enumerate(stages)},
        "back": ("back_transform", {}),
    }
    bench = NodeBench(folder, nodes, tolerance=0.0)
    assert bench.plan.errors() == []
    return np.fft.fft2(bench.value("back.image")), bench.value


@pytest.mark.parametrize(("rows", "columns"), [(12, 16), (12, 15), (13, 16), (2, 2), (1, 8)])
@pytest.mark.parametrize("name", ["line", "aberrations"])
def test_what_is_shown_acts(tmp_path, name, rows, columns):
    acting, get = chain(tmp_path, STAGES[name], rows, columns)
    shown = get("s0.mtf").astype(complex)
    if name == "aberrations":
        shown = shown * np.exp(1j * get("s0.ptf"))
    np.testing.assert_allclose(shown, acting, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("rows", "columns"), [(12, 16), (13, 16), (7, 9)])
@pytest.mark.parametrize("name", STAGES)
def test_every_array_is_that_of_a_real_picture(tmp_path, name, rows, columns):
    """H(−f) = H*(f), which at Nyquist is no law of H but of samples."""
    _, get = chain(tmp_path, STAGES[name], rows, columns)
    for number, (key, _) in enumerate(STAGES[name]):
        parts = {"charge_eff_phase": ("ptf",), "exit_pupil_mtf": ("mtf", "ptf")}
        for part in parts.get(key, ("mtf",)):
            shown = get(f"s{number}.{part}")
            value = np.exp(1j * shown) if part == "ptf" else shown.astype(complex)
            turned = value[-np.arange(rows)][:, -np.arange(columns)]
            np.testing.assert_allclose(value, turned.conj(), rtol=0, atol=1e-12, err_msg=key)


def test_phases_of_many_turns_stay_unwrapped(tmp_path):
    """Off Nyquist the array is the law's, −k(w − sin w), beyond π in size."""
    _, get = chain(tmp_path, [("charge_eff_phase", {**CHARGE, "efficiency": 0.98})], 4, 64)
    w = 2 * np.pi * np.fft.fftfreq(64)
    expected = -640 * 0.02 * (w - np.sin(w))
    off = np.arange(64) != 32
    np.testing.assert_allclose(get("s0.ptf")[0, off], expected[off], atol=1e-9)
    assert np.abs(expected).max() > 9
    assert np.sin(get("s0.ptf")[0, 32]) == pytest.approx(0.0, abs=1e-12)
