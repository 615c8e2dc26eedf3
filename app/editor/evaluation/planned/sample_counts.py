"""Parameters that modules count in samples, for pictures that have fewer of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from core.chain.engine import PlannedNode
from core.physics.electronics.filters import dwell_time_s

Ratio = tuple[int, int]
"""How many times fewer samples a picture has across and along."""

Count = Callable[[PlannedNode, Ratio], Mapping[str, Any] | None]
"""Gives the parameters to change; None: none."""


def _size(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Interpolate: a part of a sample more or less only changes the interval."""
    module: Any = planned.module
    sizes = {"width": (module.width, ratio[0]), "height": (module.height, ratio[1])}
    return {name: max(1, round(size / by)) for name, (size, by) in sizes.items() if size}


def _factor(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Anti-Aliaser: the nearest whole number of samples."""
    module: Any = planned.module
    return {"factor": max(1, round(module.factor / _mean(ratio)))}


def _width(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Poisson Noise: the weights of the local mean keep their width in mrad."""
    module: Any = planned.module
    return {"width_px": module.width_px / _mean(ratio)}


def _probe(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Examine Image: the block that has the sample."""
    module: Any = planned.module
    if module.probe_x is None:
        return None
    return {"probe_x": module.probe_x // ratio[0], "probe_y": module.probe_y // ratio[1]}


def _transfers(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Charge transfer between samples: as many as give the same loss at low frequencies.

    With w = 2π·xi·Δ, −ln MTF = N(1−ε)(1 − cos w) starts as w², the phase as w, or by eq. 4.58 as
    w³.
    """
    module: Any = planned.module
    if module.nyquist != "image":
        return None
    power = 2
    if planned.node.module == "charge_eff_phase":
        power = 3 if module.model == "published" else 1
    return {"detectors_per_line": round(module.detectors_per_line / ratio[0] ** power)}


def _dwell(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:  # noqa: ARG001
    """Electronics & Noise: a detector dwells no longer because the preview's samples are larger."""
    module: Any = planned.module
    context = planned.inputs["context"]
    velocity = module.scan_velocity(context)
    if module.time_constant_s is not None or velocity == 0:
        return None
    interval = context.grid.interval_x_mrad
    time = dwell_time_s(interval_mrad=interval, scan_velocity_mrad_per_s=velocity)
    return {"time_constant_s": time}


def _pattern(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Periodic Noise: the first sample is the middle of a block, further into the picture."""
    module: Any = planned.module
    image = planned.inputs["image"]
    if image.interval_x_mrad is None or image.interval_y_mrad is None:
        return None
    x, y = (ratio[0] - 1) / 2 * image.interval_x_mrad, (ratio[1] - 1) / 2 * image.interval_y_mrad

    def moved(phase_deg: float, xi: float, eta: float) -> float:
        return phase_deg + 360.0 * math.fmod(xi * x + eta * y, 1.0)

    return {
        "phase_deg": moved(module.phase_deg, module.xi, module.eta),
        "modulation_phase_deg": moved(
            module.modulation_phase_deg, module.modulation_xi, module.modulation_eta
        ),
    }


def _camera(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Camera Geometry: the same field of the same scene, both in fewer and larger samples."""
    module: Any = planned.module
    image = planned.inputs["image"]
    camera, ground = module.camera(image), module.ground(image)
    columns, rows = max(1, camera.columns // ratio[0]), max(1, camera.rows // ratio[1])
    across, along = camera.columns / columns, camera.rows / rows
    focal_length_mm = module.focal_length_mm or 1.0
    changed = {
        "ground_interval_m": ground.interval_x_m * image.columns / (image.columns // ratio[0]),
        "ground_interval_y_m": ground.interval_y_m * image.rows / (image.rows // ratio[1]),
        "columns": columns,
        "rows": rows,
        "fov_x_deg": None,
        "focal_length_mm": focal_length_mm,
        "pitch_x_um": camera.step_x_mrad * across * focal_length_mm,
        "pitch_y_um": camera.step_y_mrad * along * focal_length_mm,
    }
    if camera.kind != "framing":
        changed["velocity_m_per_s"] = camera.line_spacing_m * along
        changed["line_rate_Hz"] = 1.0
    return changed


def _mean(ratio: Ratio) -> float:
    return math.sqrt(ratio[0] * ratio[1])


IN_SAMPLES: Mapping[str, Count] = MappingProxyType(
    {
        "interpolate": _size,
        "anti_alias": _factor,
        "poisson_noise": _width,
        "examine_image": _probe,
        "charge_eff_mtf": _transfers,
        "charge_eff_phase": _transfers,
        "electronics_noise": _dwell,
        "periodic_noise": _pattern,
        "camera_geometry": _camera,
    }
)
