"""A small sensor with every kind of noise, each of which can be had alone."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
ROWS, COLUMNS = 96, 120
QUIET = {
    "cut_on_um": 8.0,
    "cut_off_um": 12.0,
    "region": "LWIR",
    "material": "manual",
    "d_star": 1e25,
    "scan_mirror_rate_Hz": 0.01,
    "time_constant_s": 0.02,
    "use_mtf": True,
    "range_low": 0.0,
    "range_high": 80.0,
}
LENS = {"detector_x_um": 30.0, "detector_y_um": 30.0, "focal_length_mm": 20.0, "f_number": 2.0}
SOURCES = {
    "gain": {"gain_percent": 2.0},
    "bias": {"bias_percent": 2.0},
    "detector": {"d_star": 3e7, "noise_variability_percent": 30.0},
    "amplifier": {"amplifier_snr": 40.0},
    "quantization": {"bits": 6},
}


def scene():
    """Slow waves over many levels, so that rounding errors lie anywhere between two."""
    y, x = np.mgrid[:ROWS, :COLUMNS]
    return 30.0 + 4.0 * np.sin(2 * np.pi * x / 40) + 3.0 * np.cos(2 * np.pi * y / 31)


def noisy_sensor(folder: Path, *kinds, platform="array", edges="reflect", factor=2, resize=True):
    """Engine and network of a chain with these noises; its picture is `out.image`."""
    np.save(folder / "scene.npy", scene())
    electronics = dict(QUIET)
    for kind in kinds:
        electronics |= SOURCES.get(kind, {})
    photons = {"percent": 5.0 if "published photons" in kinds else 0.0}
    if "photons" in kinds:
        photons = {"mode": "photon", "photons_per_unit": 40.0}
    nodes = {
        "scene": ("read_image", {"path": "scene.npy", "fov_x_deg": 6.0, "fov_y_deg": 4.8}),
        "photons": ("poisson_noise", photons),
        "init": ("init_trans", {**LENS, "platform": platform, "edges": edges}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.6, "sigma_y_mrad": 0.4}),
        "pupil": ("exit_pupil", {"radius": 60.0, "size_x": 128, "size_y": 128}),
        "optics": (
            "exit_pupil_mtf",
            {"cut_on_um": 8.0, "cut_off_um": 12.0, "size_x_cm": 2.0, "size_y_cm": 2.0},
        ),
        "charge": ("charge_eff_mtf", {"detectors_per_line": 640, "efficiency": 0.9995}),
        "charge_phase": ("charge_eff_phase", {"detectors_per_line": 640, "efficiency": 0.9995}),
        "back": ("back_transform", {}),
        "pixels": ("combine_pixels", {"factor_x": factor, "factor_y": factor}),
        "periodic": (
            "periodic_noise",
            {"amplitude": 0.5 if "periodic" in kinds else 0.0, "xi": 0.11, "eta": 0.05},
        ),
        "electronics": ("electronics_noise", electronics),
        "out": ("interpolate", {"width": 70, "height": 77} if resize else {}),
    }
    return Engine(LIBRARY), linked_network(nodes)


def picture_of(engine, network, folder, seed):
    """The sensor's picture (an image on a wire) as another sensor of the kind takes it."""
    plan = engine.plan(replace(network, seed=seed), folder=folder)
    assert not plan.errors(), plan.errors()
    return plan.output("out.image"), engine.work(Policy(precision="double"))
