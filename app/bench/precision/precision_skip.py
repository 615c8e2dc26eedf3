"""The choice of the error budget that is spent on leaving out stages."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.loaded_network import Chain, network_of, stages_in_turn
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth.truth_pictures import WeakStages, mirrored_frame
from core.chain.back_transformed import Delivered
from core.evaluation.policy import Policy, Precision
from core.network.network import Network

Array = NDArray[Any]
INTERVAL_MRAD = math.radians(25.0) * 1000.0 / 1024  # the shipped Kodak's, whatever the size
SENSOR: dict[str, Any] = {
    "aperture_mm": 90.0,
    "wavelength_um": 4.0,
    "aberration_mrad": 0.1,
    "pixel_mrad": 0.125,
}
# Two stages a decade: those up to a decade together stay within its tolerance.
STRENGTHS = tuple(0.4 * 10.0**decade for decade in range(-9, -1))
TOLERANCES = (0.0, None, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
END = "back.image"


def skipping(settings: Settings) -> list[Table]:
    """Tolerances from nothing left out to a hundredth of the picture's range."""
    network, sensor = weak_chain(settings.small)
    first = Chain(network, Policy(tolerance=0.0))
    expected = mirrored_frame(first.scene, sensor)
    t0 = round_trip(first.scene, first.policy.workers)
    rows = []
    kinds: tuple[Precision, ...] = ("single", "double")
    for kind in kinds:
        for tolerance in TOLERANCES:
            policy = Policy(precision=kind, tolerance=tolerance)
            chain = Chain(network, policy, first.scene)
            timing = paired(partial(chain.cold, network, END), t0, pairs=settings.pairs)
            skipped = len(_delivered(chain).spent(chain.work)[1])
            shown = "default" if tolerance is None else f"{tolerance:.0e}".replace("e-0", "e-")
            rows.append(
                {
                    "precision": kind,
                    "tolerance": policy.budget,
                    "skipped": skipped,
                    "mark": f"{shown.replace('0e+00', '0')} ({skipped})",
                    **timing.facts(),
                    "error": _rms(chain.value(network, END), expected),
                }
            )
    heads = {
        "precision": "precision",
        "tolerance": "tolerance",
        "skipped": f"left out of {2 * len(STRENGTHS)}",
        "t0": "T0",
        "ms": "ms",
        "error": "rms error / (max − min)",
    }
    text = (
        "Default an eighth of the samples' rounding: what it leaves out cannot be distinguished "
        "from rounding; a greater tolerance is kept to as well, and saves time. T0 is that of "
        "single precision in all rows."
    )
    title = f"Stages left out: {2 * len(STRENGTHS)} weak stages, {settings.small}², mirrored"
    chart = Chart(
        "t0",
        "error",
        "time (T0)",
        "rms error / (max − min)",
        "mark",
        "precision",
        lines=True,
        title=f"{title}: tolerance (stages left out)",
    )
    return [Table("skipping", title, heads, tuple(rows), text, chart)]


def weak_chain(size: int) -> tuple[Network, WeakStages]:
    """Pupil, aberration and pixel with stages ever weaker, and the same for the truth."""
    corner = math.sqrt(0.5) / INTERVAL_MRAD
    sigmas = tuple(math.sqrt(0.5 * strength) / (math.pi * corner) for strength in STRENGTHS)
    lag_mm = SENSOR["wavelength_um"] * corner
    r0_mm = tuple(lag_mm * (3.44 / strength) ** 0.6 for strength in STRENGTHS)
    nodes = {name: (key, params) for name, key, params in _nodes(size, sigmas, r0_mm)}
    stages = [name for name in nodes if name not in ("scene", "init", "pupil", "back")]
    links = [
        ("scene.image", "init.image"),
        ("pupil.pupil", "optics.pupil"),
        ("init.phase", "optics.phase"),
        *stages_in_turn(stages),
    ]
    sensor = WeakStages(INTERVAL_MRAD, **SENSOR, sigmas_mrad=sigmas, fried_r0_mm=r0_mm)
    return network_of(nodes, links), sensor


def _nodes(
    size: int, sigmas: tuple[float, ...], r0_mm: tuple[float, ...]
) -> Iterator[tuple[str, str, dict[str, Any]]]:
    wavelength, field_deg = SENSOR["wavelength_um"], math.degrees(INTERVAL_MRAD * 1e-3 * size)
    field = {"fov_x_deg": field_deg, "fov_y_deg": field_deg}
    band = {"cut_on_um": wavelength, "cut_off_um": wavelength}
    yield "scene", "test_scene", {"kind": "dormitory", "width": size, "height": size, **field}
    pitch = {
        "detector_x_um": 1e3 * SENSOR["pixel_mrad"],
        "detector_y_um": 1e3 * SENSOR["pixel_mrad"],
    }
    yield "init", "init_trans", {"focal_length_mm": 1e3, **pitch}
    yield "pupil", "exit_pupil", {"size_x": 512, "size_y": 512, "radius": 128.0}
    across = {"size_x_cm": 0.2 * SENSOR["aperture_mm"], "size_y_cm": 0.2 * SENSOR["aperture_mm"]}
    yield "optics", "exit_pupil_mtf", {**band, **across}
    sigma = SENSOR["aberration_mrad"]
    yield "aberration", "gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}
    yield "pixel", "detector_mtf", {}
    for number, (sigma, r0) in enumerate(zip(sigmas, r0_mm, strict=True)):
        yield f"blur_{number}", "gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}
        air = {"turbulence": "long_exposure", "fried_r0_m": r0 / 1e3, "wavelength_um": wavelength}
        yield f"air_{number}", "atmosphere_mtf", air
    yield "back", "back_transform", {}


def _delivered(chain: Chain) -> Delivered:
    recipe = chain.engine.plan(chain.network).output(END).recipe
    assert isinstance(recipe, Delivered)
    return recipe


def _rms(picture: Array, expected: Array) -> float:
    wrong = np.asarray(picture, np.float64) - expected
    return float(np.sqrt(np.mean(wrong * wrong)) / (expected.max() - expected.min()))


MEASURES = (skipping,)
