"""Electrons, noise and SNR of cameras as pyBSM computes them, where it is installed.

Both model photon noise, the optics' emission, dark current, read noise and quantization. pyBSM's
converter has 2^bits steps, ours one fewer; it sums over 2001 wavelengths.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from app.bench.peers import load, why_missing
from app.bench.timing import sensor_network
from core.physics.radiometry.planck import band_radiance
from node_bench import NodeBench

SAMPLES = 2001


@dataclass(frozen=True)
class Camera:
    """A camera that both programs can describe, and the temperatures of two uniform scenes.

    Of reflected light they are those whose radiance in the band the scenes have, with the spectrum
    of the plane's `source_K`.
    """

    name: str
    band_um: tuple[float, float]
    scenes_K: tuple[float, float]
    pitch_um: float
    focal_length_mm: float
    f_number: float
    plane: dict[str, Any]
    obscuration_ratio: float = 0.0


_COOLED = {
    "integration_time_s": 4e-3, "quantum_efficiency": 0.7, "optics_transmission": 0.765,
    "dark_current_e_per_s": 0.0, "read_noise_e": 400.0, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip
CAMERAS = (
    Camera("cooled, 3.7 to 4.8 µm", (3.7, 4.8), (294.15, 293.15), 15.0, 100.0, 4.0, _COOLED),
    Camera("the same with a mirror lens, obscuration 0.6", (3.7, 4.8), (294.15, 293.15), 15.0,
           100.0, 4.0, _COOLED, 0.6),
    Camera("cooled, 8 to 10 µm, warm optics", (8.0, 10.0), (301.0, 300.0), 20.0, 100.0, 2.0, {
        "integration_time_s": 5e-5, "quantum_efficiency": 0.6, "optics_transmission": 0.8,
        "dark_current_e_per_s": 1e8, "read_noise_e": 800.0, "full_well_e": 3e7, "bits": 14,
        "optics_K": 300.0,
    }),
    Camera("satellite with TDI, obscuration 0.35", (0.5, 0.8), (1288.0, 1270.0), 8.0, 1e4, 14.3, {
        "integration_time_s": 6.94e-5, "quantum_efficiency": 0.6, "optics_transmission": 0.7,
        "dark_current_e_per_s": 1e4, "read_noise_e": 20.0, "full_well_e": 3e4, "bits": 12,
        "tdi_stages": 32, "photon_weighting": "source", "source_K": 5800.0,
    }, 0.35),
)  # fmt: skip


def of_ours(camera: Camera) -> dict[str, float]:
    low, high = camera.band_um
    band = {"cut_on_um": low, "cut_off_um": high, "fov_x_deg": 1.0, "fov_y_deg": 1.0}
    sensor = {
        "detector_x_um": camera.pitch_um, "detector_y_um": camera.pitch_um,
        "focal_length_mm": camera.focal_length_mm, "f_number": camera.f_number,
        "obscuration_ratio": camera.obscuration_ratio, "platform": "array",
    }  # fmt: skip
    found = []
    for kelvin in camera.scenes_K:
        scene = {"kind": "uniform", "width": 4, "height": 4, "temperature_K": kelvin, **band}
        plane = {"camera": ("focal_plane", camera.plane)}
        network = sensor_network(("test_scene", scene), sensor, {}, plane)
        found.append(NodeBench(None, network).readouts("camera"))
    bright, dim = (float(one["signal_e"]) for one in found)
    noise = float(found[0]["temporal_noise_e"])
    return {"electrons": bright, "noise": noise, "contrast SNR": (bright - dim) / noise}


def of_pybsm(camera: Camera) -> dict[str, Any]:
    """The same by the function `photon_detector_SNR`."""
    simulation, radiance = load("pybsm.simulation"), load("pybsm.radiance")
    wavelengths = np.linspace(*camera.band_um, SAMPLES) * 1e-6
    ends = np.array([0.99 * wavelengths[0], 1.01 * wavelengths[-1]])
    plane = camera.plane
    warm_K, source_K = plane.get("optics_K"), plane.get("source_K")
    sensor = simulation.Sensor(
        name=camera.name, D=camera.focal_length_mm / camera.f_number * 1e-3,
        f=camera.focal_length_mm * 1e-3, p_x=camera.pitch_um * 1e-6, opt_trans_wavelengths=ends,
        qe_wavelengths=ends, qe=np.full(2, plane["quantum_efficiency"]),
        int_time=plane["integration_time_s"], n_tdi=float(plane.get("tdi_stages", 1)),
        dark_current=plane["dark_current_e_per_s"], read_noise=plane["read_noise_e"],
        max_n=plane["full_well_e"], max_well_fill=1.0, bit_depth=float(plane["bits"]),
        optics_temperature=warm_K or 70.0,
        optics_emissivity=1.0 - plane["optics_transmission"] if warm_K else 0.0,
    )  # fmt: skip
    sensor.eta = camera.obscuration_ratio
    sensor.optics_transmission = np.full(2, plane["optics_transmission"])

    def spectral(kelvin: float) -> Any:
        shape = radiance.blackbody_radiance(lambda0=wavelengths, T=source_K or kelvin)
        if source_K is None:
            return shape
        low, high = camera.band_um
        wanted, source = (
            float(band_radiance(temperature_K=one, cut_on_um=low, cut_off_um=high))
            for one in (kelvin, source_K)
        )
        return shape * wanted / source

    target, background = map(spectral, camera.scenes_K)
    found = radiance.photon_detector_SNR(
        sensor=sensor, radiance_wavelengths=wavelengths,
        target_radiance=target, background_radiance=background,
    )  # fmt: skip
    others = float(found.self_emission_noise) ** 2 + float(found.dark_current_noise) ** 2
    electrons, noise = float(found.tgt_n) - others, float(found.total_noise)
    return {"electrons": electrons, "noise": noise, "contrast SNR": float(found.snr)}


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda camera: camera.name)
def test_electrons_noise_and_snr(camera):
    ours = of_ours(camera)
    assert all(value > 0 for value in ours.values())
    if not why_missing("pybsm"):
        assert ours == pytest.approx(of_pybsm(camera), rel=1e-4)
