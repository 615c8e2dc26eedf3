"""What image quality equations take of a chain: its edge response, its signal over noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.results import CurveData, Series, TableData, TableRow
from core.errors import DataError
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.lineage.linear_change import LevelChange
from core.modules.caution import Caution
from core.physics.acquisition.edge_response import (
    edge_overshoot,
    edge_response,
    relative_edge_response,
)
from core.physics.acquisition.giqe import INCH_M, beyond_limits, giqe_3, giqe_4, giqe_5
from core.transfer.grid import Grid
from nodes.analysis.lineage import ImageNoise
from nodes.analysis.lineage.line_transfer import Line, Stage, stage_along
from nodes.analysis.merit.threshold_curves import HORIZONTAL, VERTICAL
from nodes.analysis.merit.unseen_scene import Unseen, unseen

Vector = NDArray[np.float64]
_DRAWN = np.linspace(-4.0, 4.0, 129)  # samples beside the edge


@dataclass(frozen=True)
class EdgeQuality:
    """Relative edge response and overshoot across and along, and the responses as curves."""

    rer: tuple[float, float]
    overshoot: tuple[float, float]
    response: tuple[Vector, Vector]


@ends_lineage
def edge_quality(work: Work, *, stages: tuple[Stage, ...], grid: Grid) -> EdgeQuality:
    """Of the whole chain, sample by sample of the picture."""
    results = []
    for line, sample_mrad in ((HORIZONTAL, grid.interval_x_mrad), (VERTICAL, grid.interval_y_mrad)):

        def mtf(frequency: Vector, line: Line = line) -> Vector:
            total = np.ones(len(frequency))
            for stage in stages:
                work.check()
                total = total * stage_along(work, stage, "mtf", line, frequency)
            return total

        results.append(
            (
                relative_edge_response(mtf=mtf, sample_mrad=sample_mrad),
                edge_overshoot(mtf=mtf, sample_mrad=sample_mrad),
                edge_response(mtf=mtf, places_px=_DRAWN, sample_mrad=sample_mrad),
            )
        )
    rer, overshoot, response = zip(*results, strict=True)
    return EdgeQuality(rer, overshoot, response)


@ends_lineage
def signal_over_noise(
    work: Work,
    seen: ImageNoise,
    *levels: LevelChange,
    gain: float | None,
    gain_before: float,
) -> float | Unseen:
    """Mean of the scene's share of the picture over the temporal noise; infinite without noise.

    Raises
    ------
    DataError
        If noise cannot be followed to the picture, or there is no signal.
    """
    seen.require_known()
    if gain is None:
        raise DataError("gain_model literal scales the picture by the gain error; take per_pixel")
    gain *= math.prod(level.gain for level in levels)
    clipped = unseen(gain, levels, "it has no signal")
    if clipped is not None:
        return clipped
    mean = levels[0].signal / levels[0].gain / gain_before if levels else seen.mean / gain
    if not mean > 0.0:
        raise DataError(f"the picture's signal is {mean:.6g}: its SNR needs one above zero")
    noise = math.sqrt(max(seen.total.variances.temporal, 0.0)) / gain
    return mean / noise if noise > 0.0 else math.inf


@dataclass(frozen=True)
class View:
    """How the ground is seen: range, angle off nadir, and what the sharpening does.

    `overshoot` is None where the chain's own counts.
    """

    range_m: float
    off_nadir_deg: float
    noise_gain: float
    overshoot: float | None


@ends_lineage
def quality_table(
    work: Work, edge: EdgeQuality, snr: float | Unseen, *, grid: Grid, view: View
) -> TableData:
    """The equations and what they are made of; those of the noise are empty without a signal."""
    across = grid.interval_x_mrad * view.range_m / 1000.0
    along = (
        grid.interval_y_mrad * view.range_m / 1000.0 / math.cos(math.radians(view.off_nadir_deg))
    )
    gsd_m, rer = math.sqrt(across * along), _mean("relative edge response", edge.rer)
    overshoot = view.overshoot
    if overshoot is None:
        overshoot = _mean("height beside the edge", edge.overshoot)
    gsd_inch = gsd_m / INCH_M
    why = snr.reason if isinstance(snr, Unseen) else ""
    fifth = fourth = third = shown_snr = None
    if not isinstance(snr, Unseen):
        known = {"gsd_inch": gsd_inch, "rer": rer, "snr": snr}
        sharpened = {"overshoot": overshoot, "noise_gain": view.noise_gain}
        fifth = float(giqe_5(**known))
        fourth, third = (float(giqe(**known, **sharpened)) for giqe in (giqe_4, giqe_3))
        shown_snr = snr if math.isfinite(snr) else None
    rows: tuple[tuple[Any, ...], ...] = (
        ("giqe5", fifth, "NIIRS", "GIQE 5, of the picture as it is", why),
        ("giqe4", fourth, "NIIRS", "GIQE 4, with H and G", why),
        ("giqe3", third, "NIIRS", "GIQE 3, with H and G", why),
        ("gsd_m", gsd_m, "m", "ground sample distance, geometric mean"),
        ("gsd_across_m", across, "m", "across"),
        ("gsd_along_m", along, "m", "along"),
        ("gsd_inch", gsd_inch, "in", "geometric mean"),
        ("rer", rer, "", "relative edge response, geometric mean"),
        ("rer_x", edge.rer[0], "", "across"),
        ("rer_y", edge.rer[1], "", "along"),
        ("overshoot", overshoot, "", "edge overshoot H, geometric mean"),
        ("noise_gain", view.noise_gain, "", "noise gain G of the sharpening"),
        ("snr", shown_snr, "", "signal over temporal noise", why),
    )
    return TableData(tuple(TableRow(*row) for row in rows))


def _mean(what: str, values: tuple[float, float]) -> float:
    if min(values) <= 0.0:
        across, along = values
        raise DataError(
            f"the {what} is {across:.6g} across and {along:.6g} along: the image quality "
            "equations need both above zero"
        )
    return math.sqrt(values[0] * values[1])


@ends_lineage
def edge_curve(work: Work, edge: EdgeQuality) -> CurveData:
    """The edge responses across and along."""
    series = tuple(
        Series(name, _DRAWN, response)
        for name, response in zip(("across", "along"), edge.response, strict=True)
    )
    return CurveData("Edge response", "samples beside the edge", "response", series)


@ends_lineage
def limits_caution(work: Work, table: TableData) -> Caution | None:
    """Values outside those that the equations were fitted to."""
    figures = table.as_dict()
    values = {name: figures[name] for name in ("gsd_inch", "rer", "overshoot", "snr")}
    known = {name: math.inf if value is None else float(value) for name, value in values.items()}
    beyond = beyond_limits(**known)
    if not beyond:
        return None
    return Caution(
        f"beyond the limits of the image quality equations: {', '.join(beyond)}",
        "take NIIRS as an extrapolation there",
    )
