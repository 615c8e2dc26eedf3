"""What a measured MTF is expected to be: the chain's own, along the same direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.measurement.edges.slanted_edge import falls_to
from core.physics.numerics.sinc import sinc
from core.transfer.factors import factor_at
from core.transfer.grid import Grid
from nodes.analysis.lineage import transfer_of
from nodes.analysis.lineage.line_transfer import Stage
from nodes.analysis.mtf.mtf_measuring import Measured

Vector = NDArray[np.float64]
_FINE = 513
_AREA, _UNKNOWN = "area of its samples", "not known"


@dataclass(frozen=True)
class Expected:
    """An expected MTF; frequencies in cycles per pixel, up to Nyquist or where less is known.

    Figures are None where they lie beyond.
    """

    frequency: Vector
    mtf: Vector
    mtf50: float | None
    at_nyquist: float | None
    largest_difference: float
    largest_difference_at: float
    scene: str


def chain_behind(image: Image) -> dict[str, Any] | None:
    """What `expected` needs of a picture; None where not all of its way from the source is known.

    A test scene's samples are means over their area, which blurs too. The scene in a file may be
    blurred by anything: its own MTF is unknown, and of a picture straight from a file no MTF is
    expected.
    """
    try:
        transfer = transfer_of(image)
    except DataError:
        return None
    is_scene = transfer.area_means
    if not is_scene and (transfer.source.inputs or not transfer.stages):
        return None
    return {
        "stages": transfer.part("mtf"),
        "grid": transfer.grid,
        "source_grid": transfer.source_grid,
        "is_scene": is_scene,
    }


@ends_lineage
def expected(
    work: Work,
    measured: Measured,
    *,
    stages: tuple[Stage, ...],
    grid: Grid,
    source_grid: Grid,
    is_scene: bool,
    differences: bool,
) -> Expected:
    """The modulus of all stages along the normal that was measured.

    With `differences` as the mean of rows shows it: the derivative of samples one pixel apart
    takes sin(πf)/(πf) of a frequency f. What is folded back from beyond Nyquist does not count.
    """
    normal = math.radians(measured.angle_deg)
    # A cycle per pixel along the normal, in cycles/mrad across and along.
    xi_per_pixel = math.cos(normal) / grid.interval_x_mrad
    eta_per_pixel = math.sin(normal) / grid.interval_y_mrad

    def mtf(frequency: Vector) -> Vector:
        xi, eta = frequency * xi_per_pixel, frequency * eta_per_pixel
        total = np.ones(len(frequency))
        for stage in stages:
            work.check()
            for factor in stage.factors:
                total = total * factor_at(work, factor, xi, eta)
        if is_scene:
            total = total * sinc(xi * source_grid.interval_x_mrad)
            total = total * sinc(eta * source_grid.interval_y_mrad)
        return np.abs(total * sinc(frequency)) if differences else np.abs(total)

    end = _end(source_grid, abs(xi_per_pixel), abs(eta_per_pixel))
    frequency = measured.frequency[measured.frequency <= end]
    here = mtf(frequency)
    fine = np.linspace(0.0, end, _FINE)
    apart = np.abs(measured.mtf[: len(frequency)] - here)
    largest = int(np.argmax(apart))
    return Expected(
        frequency,
        here,
        falls_to(frequency=fine, mtf=mtf(fine), level=0.5),
        float(mtf(np.array([0.5]))[0]) if end == 0.5 else None,
        float(apart[largest]),
        float(frequency[largest]),
        _AREA if is_scene else _UNKNOWN,
    )


def _end(source: Grid, xi_per_pixel: float, eta_per_pixel: float) -> float:
    """Nyquist, or where the source's samples end if these are coarser."""
    ends = [
        nyquist / per_pixel
        for nyquist, per_pixel in (
            (source.nyquist_x, xi_per_pixel),
            (source.nyquist_y, eta_per_pixel),
        )
        if per_pixel > 0.0
    ]
    least = min(ends)
    return 0.5 if least >= 0.5 * (1.0 - 1e-9) else least
