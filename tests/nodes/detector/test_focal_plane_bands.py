"""A cube on the focal plane: the electrons are those of every band's photons, added up by hand."""

import numpy as np
import pytest

from cube_files import C1_UM, C2_UM, PHOTON_J_UM, band_by_band, centres, materials_cube, write_cube
from node_bench import NodeBench, fov_of, square_detectors

SIZE = (32, 40)
INTERVAL = 0.035
BANDS = 40
PITCH_UM, F_NUMBER, TIME_S = 15.0, 2.0, 0.002
INIT = square_detectors(PITCH_UM, 100.0, F_NUMBER, platform="array")
PLANE = {"integration_time_s": TIME_S, "quantum_efficiency": 0.6, "units": "electrons"}
PER_PHOTON = TIME_S * (PITCH_UM * 1e-6) ** 2 * np.pi / (4 * F_NUMBER**2 + 1)


@pytest.fixture
def cube():
    wavelengths, width = centres(BANDS)
    return materials_cube(SIZE, wavelengths), wavelengths, width


def bench(folder, *, plane=(), read=(), optics=True):
    read = {"path": "cube.img", "bands": "all", **fov_of(SIZE, INTERVAL), **dict(read)}
    nodes = {
        "read": ("read_image", read),
        "init": ("init_trans", INIT),
        **({"optics": ("diffraction_mtf", {"aperture_mm": 50.0})} if optics else {}),
        "back": ("back_transform", {}),
        "plane": ("focal_plane", {**PLANE, **dict(plane)}),
    }
    return NodeBench(folder, nodes)


def by_hand(cube, efficiency, *, low=3.0, high=5.0, steps=20001):
    """∫ QE(λ)·λ/(hc) dλ over each band by a fine sum, with its photons at the middle."""
    _, wavelengths, width = cube
    weights = []
    for wavelength in wavelengths:
        fine = wavelength + width * ((np.arange(steps) + 0.5) / steps - 0.5)
        inside = (fine >= low) & (fine <= high)
        weights.append(np.mean(efficiency(fine) * inside) * width * wavelength / PHOTON_J_UM)
    return np.array(weights)


def test_the_mean_is_the_sum_of_every_bands_photons(tmp_path, cube):
    write_cube(tmp_path, *cube)
    plane = bench(tmp_path)
    weights = 0.6 * cube[1] * cube[2] / PHOTON_J_UM
    want = PER_PHOTON * np.dot(weights, cube[0].mean(axis=(1, 2)))
    assert plane.readouts("plane")["signal_e"] == pytest.approx(want, rel=1e-12)
    # The spectrum is known: no other way to count the photons is worth anything.
    figures = plane.value("plane.table").as_dict()
    assert figures["weighting_worth_percent"] is figures["signal_by_source_e"] is None


def test_a_response_and_a_filter_weight_every_band(tmp_path, cube):
    write_cube(tmp_path, *cube)
    (tmp_path / "qe.csv").write_text("3.0,0.2\n3.6,0.8\n4.4,0.7\n5.0,0.1\n")
    plane = {"response": "qe.csv", "cut_on_um": 3.42, "cut_off_um": 4.61}
    made = bench(tmp_path, plane=plane).readouts("plane")["signal_e"]
    weights = by_hand(
        cube,
        lambda um: np.interp(um, [3.0, 3.6, 4.4, 5.0], [0.2, 0.8, 0.7, 0.1]),
        low=3.42,
        high=4.61,
    )
    want = PER_PHOTON * np.dot(weights, cube[0].mean(axis=(1, 2)))
    assert made == pytest.approx(want, rel=1e-6)  # of the fine sum at the filter's edges


def test_every_band_is_blurred_at_its_own_wavelength_before_it_is_counted(tmp_path, cube):
    write_cube(tmp_path, *cube)
    there = bench(tmp_path)
    # What is there without noise: the node's electrons less its noise.
    made = there.value("plane.electrons") - there.value("plane.noise")
    weights = PER_PHOTON * 0.6 * cube[1] * cube[2] / PHOTON_J_UM
    want = band_by_band(cube[0], cube[1], weights, interval_mrad=INTERVAL, aperture_mm=50.0)
    assert np.abs(made - want).max() <= 1e-11 * np.ptp(want)


@pytest.mark.parametrize("unit", ["W/cm^2/sr/um", "uW/cm^2/sr/nm", "photons/s/cm^2/sr/um"])
def test_units_of_the_same_scene_give_the_same_electrons(tmp_path, cube, unit):
    samples, wavelengths, width = cube
    first = tmp_path / "watts"
    first.mkdir()
    write_cube(first, *cube)
    want = bench(first).readouts("plane")["signal_e"]
    factor = {"W/cm^2/sr/um": 1e-4, "uW/cm^2/sr/nm": 0.1}.get(unit)
    if factor is None:
        factor = (1e-4 * wavelengths / PHOTON_J_UM)[:, np.newaxis, np.newaxis]
    second = tmp_path / "other"
    second.mkdir()
    write_cube(second, samples * factor, wavelengths, width, unit=unit)
    assert bench(second).readouts("plane")["signal_e"] == pytest.approx(want, rel=1e-12)


def test_the_responsivity_is_the_difference_that_a_kelvin_makes(tmp_path):
    wavelengths, width = centres(400)

    def body(kelvin):
        spectrum = C1_UM / wavelengths**5 / np.expm1(C2_UM / wavelengths / kelvin)
        return np.ones(SIZE) * spectrum[:, np.newaxis, np.newaxis], wavelengths, width

    electrons = {}
    for kelvin in (299.95, 300.0, 300.05):
        write_cube(tmp_path, *body(kelvin))
        electrons[kelvin] = bench(tmp_path, optics=False).readouts("plane")
    want = (electrons[300.05]["signal_e"] - electrons[299.95]["signal_e"]) / 0.1
    made = electrons[300.0]["responsivity_e_per_K"]
    assert made == pytest.approx(want, rel=5e-6)  # of the bands, and of the difference
    assert electrons[300.0]["photon_weighting"] == "spectrum"
    noise = electrons[300.0]["temporal_noise_e"]
    assert electrons[300.0]["netd_K"] == pytest.approx(noise / made, rel=1e-12)
