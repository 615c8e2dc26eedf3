"""Focal Plane behind Spectral Response, and of cubes with gaps: temperature, NETD, electrons."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from cube_files import C1_UM, C2_UM, PHOTON_J_UM, write_cube
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()

SIZE = (6, 7)
LOW, HIGH = 3.7, 4.8
PITCH_UM, F_NUMBER, TIME_S, QE = 15.0, 4.0, 0.004, 0.7
PER_PHOTON = QE * TIME_S * (PITCH_UM * 1e-6) ** 2 * np.pi / (4 * F_NUMBER**2 + 1)
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
        "init": (
            "init_trans",
            {
                "detector_x_um": PITCH_UM,
                "detector_y_um": PITCH_UM,
                "focal_length_mm": 100.0,
                "f_number": F_NUMBER,
                "platform": "array",
            },
        ),
        "back": ("back_transform", {}),
        "plane": (
            "focal_plane",
            {"integration_time_s": TIME_S, "quantum_efficiency": QE, **dict(plane)},
        ),
        "merit": ("figures_of_merit", {}),
    }
    return NodeBench(LIBRARY, folder, nodes)


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
    nodes = {
        "read": (
            "read_image",
            {"path": "scene.npy", "cut_on_um": low, "cut_off_um": high, "fov_x_deg": 1.0,
             "fov_y_deg": 1.0},
        ),
        "filter": ("spectral_response", {"shape": "file", "path": "q.csv"}),
        "init": (
            "init_trans",
            {"detector_x_um": PITCH_UM, "detector_y_um": PITCH_UM, "focal_length_mm": 100.0,
             "f_number": F_NUMBER},
        ),
        "plane": ("focal_plane", {"integration_time_s": TIME_S, "quantum_efficiency": QE}),
    }  # fmt: skip
    made = NodeBench(LIBRARY, tmp_path, nodes).readouts("plane")["signal_e"]
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
