"""Electrons and SNR of the same cameras by pyBSM, where it is installed.

Uniform scenes of two temperatures, or of two brightnesses of one source; the contrast SNR is the
difference of their electrons over the noise of the brighter one. Both programs model photon noise,
self-emission of the optics, dark current, read noise and quantization; neither fill factor nor
obscuration differ here.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata
from typing import Any

import numpy as np

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table
from app.bench.measuring.loaded_network import network_of
from app.bench.peers.peer_imports import load, why_missing
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.physics.radiometry.planck import band_radiance
from nodes.library import standard_library

_PYBSM = "pybsm"
_SAMPLES = 2001  # wavelengths of pyBSM's sums
_FIGURES = (("electrons", "e-"), ("noise", "e-"), ("contrast SNR", ""))


@dataclass(frozen=True)
class SharedCamera:
    """A camera that both programs can describe.

    Parameters
    ----------
    name : str
        What it is.
    band_um : (float, float)
        Cut-on and cut-off.
    target_K, background_K : float
        Temperatures of the scenes that are told apart; of reflected light those whose radiance in
        the band they have, with the spectrum of `source_K`.
    source_K : float or None
        Temperature of the source, None where the scenes shine by themselves.
    optics_K : float or None
        Temperature of the optics, None for no emission.
    """

    name: str
    band_um: tuple[float, float]
    target_K: float
    background_K: float
    pitch_um: float
    focal_length_mm: float
    f_number: float
    transmission: float
    efficiency: float
    time_s: float
    stages: int
    dark_e_per_s: float
    read_e: float
    well_e: float
    bits: int
    source_K: float | None = None
    optics_K: float | None = None


CAMERAS = (
    SharedCamera(
        "cooled, 3.7 to 4.8 µm",
        *((3.7, 4.8), 294.15, 293.15, 15.0, 100.0, 4.0, 0.765, 0.7, 4e-3, 1),
        *(0.0, 400.0, 7e6, 14),
    ),
    SharedCamera(
        "cooled, 8 to 10 µm, warm optics",
        *((8.0, 10.0), 301.0, 300.0, 20.0, 100.0, 2.0, 0.8, 0.6, 5e-5, 1),
        *(1e8, 800.0, 3e7, 14, None, 300.0),
    ),
    SharedCamera(
        "satellite with TDI, 0.5 to 0.8 µm",
        *((0.5, 0.8), 1288.0, 1270.0, 8.0, 10_000.0, 14.3, 0.7, 0.6, 6.94e-5, 32),
        *(1e4, 20.0, 3e4, 12, 5800.0),
    ),
)


def cameras(_settings: Settings) -> list[Table]:
    """Electrons, noise and contrast SNR side by side."""
    missing = why_missing(_PYBSM)
    version = "" if missing else metadata.version(_PYBSM)
    rows: list[dict[str, Any]] = []
    for camera in CAMERAS:
        ours = of_ours(camera)
        try:
            theirs = (None, None, None) if missing else of_pybsm(camera)
            note = missing
        except Exception as error:  # another program's failure is a row of the table, not ours
            theirs, note = (None, None, None), f"failed: {type(error).__name__}: {error}"[:120]
        for (figure, unit), own, other in zip(_FIGURES, ours, theirs, strict=True):
            difference = None if other is None else 100.0 * (own / other - 1.0)
            rows.append(
                {
                    "camera": camera.name,
                    "figure": figure,
                    "unit": unit,
                    "ours": own,
                    "pybsm": other,
                    "percent": difference,
                    "note": note,
                }
            )
    heads = {
        "camera": "camera",
        "figure": "figure",
        "ours": "imagechain",
        "pybsm": f"pyBSM {version}".strip(),
        "unit": "",
        "percent": "difference, %",
        "note": "",
    }
    text = (
        "Uniform scenes; the contrast SNR is the difference of two scenes' electrons over the "
        "noise of the brighter. pyBSM's converter has 2^bits steps, ours one less, and it sums "
        f"over {_SAMPLES} wavelengths."
    )
    title = "Photons to electrons: noise and SNR of cameras beside pyBSM"
    return [Table("peer_cameras", title, heads, tuple(rows), text, brief=tuple(heads))]


def of_ours(camera: SharedCamera) -> tuple[float, float, float]:
    """Electrons of the brighter scene, their noise, and the contrast SNR."""
    bright, dim = (_readouts(camera, kelvin) for kelvin in (camera.target_K, camera.background_K))
    noise = bright["temporal_noise_e"]
    return bright["signal_e"], noise, (bright["signal_e"] - dim["signal_e"]) / noise


def _readouts(camera: SharedCamera, kelvin: float) -> dict[str, Any]:
    low, high = camera.band_um
    scene = {
        "kind": "uniform", "width": 4, "height": 4, "fov_x_deg": 1.0, "fov_y_deg": 1.0,
        "cut_on_um": low, "cut_off_um": high, "temperature_K": kelvin,
    }  # fmt: skip
    sensor = {
        "detector_x_um": camera.pitch_um, "detector_y_um": camera.pitch_um,
        "focal_length_mm": camera.focal_length_mm, "f_number": camera.f_number,
        "platform": "array",
    }  # fmt: skip
    plane: dict[str, Any] = {
        "integration_time_s": camera.time_s, "tdi_stages": camera.stages,
        "quantum_efficiency": camera.efficiency, "optics_transmission": camera.transmission,
        "optics_K": camera.optics_K, "dark_current_e_per_s": camera.dark_e_per_s,
        "read_noise_e": camera.read_e, "full_well_e": camera.well_e, "bits": camera.bits,
    }  # fmt: skip
    if camera.source_K is not None:
        plane |= {"photon_weighting": "source", "source_K": camera.source_K}
    network = network_of(
        {
            "scene": ("test_scene", scene),
            "init": ("init_trans", sensor),
            "camera": ("focal_plane", plane),
        },
        [
            ("scene.image", "init.image"),
            ("scene.image", "camera.image"),
            ("init.context", "camera.context"),
        ],
    )
    engine = Engine(standard_library())
    return dict(engine.readouts(engine.plan(network), "camera", engine.work(Policy("double"))))


def of_pybsm(camera: SharedCamera) -> tuple[float, float, float]:
    """The same by the function `photon_detector_SNR`."""
    simulation, radiance = load("pybsm.simulation"), load("pybsm.radiance")
    wavelengths = np.linspace(*camera.band_um, _SAMPLES) * 1e-6
    ends = np.array([0.99 * wavelengths[0], 1.01 * wavelengths[-1]])
    sensor = simulation.Sensor(
        name=camera.name,
        D=camera.focal_length_mm / camera.f_number * 1e-3,
        f=camera.focal_length_mm * 1e-3,
        p_x=camera.pitch_um * 1e-6,
        opt_trans_wavelengths=ends,
        qe_wavelengths=ends,
        qe=np.full(2, camera.efficiency),
        int_time=camera.time_s,
        n_tdi=float(camera.stages),
        dark_current=camera.dark_e_per_s,
        read_noise=camera.read_e,
        max_n=camera.well_e,
        max_well_fill=1.0,
        bit_depth=float(camera.bits),
        optics_temperature=camera.optics_K or 70.0,
        optics_emissivity=1.0 - camera.transmission if camera.optics_K else 0.0,
    )
    sensor.optics_transmission = np.full(2, camera.transmission)

    def spectral(kelvin: float) -> Any:
        if camera.source_K is None:
            return radiance.blackbody_radiance(lambda0=wavelengths, T=kelvin)
        low, high = camera.band_um
        wanted, source = (
            float(band_radiance(temperature_K=one, cut_on_um=low, cut_off_um=high))
            for one in (kelvin, camera.source_K)
        )
        shape = radiance.blackbody_radiance(lambda0=wavelengths, T=camera.source_K)
        return shape * wanted / source

    target, background = spectral(camera.target_K), spectral(camera.background_K)
    found = radiance.photon_detector_SNR(
        sensor=sensor,
        radiance_wavelengths=wavelengths,
        target_radiance=target,
        background_radiance=background,
    )
    others = float(found.self_emission_noise) ** 2 + float(found.dark_current_noise) ** 2
    return float(found.tgt_n) - others, float(found.total_noise), float(found.snr)
