"""MTF across and along a picture, pooled over the edges of each direction."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_mtf import EdgeMtf

Vector = NDArray[np.float64]
Axis = Literal["x", "y"]

LARGEST_ANGLE_DEG = 30.0


@dataclass(frozen=True)
class PooledMtf:
    """MTF of one direction.

    Parameters
    ----------
    frequency : ndarray
        Cycles per sample along the axis.
    mtf, sigma : ndarray
        Weighted mean over the edges, and its standard error, widened by `excess`.
    edges : int
        How many there are.
    excess : float
        Root of χ² per degree of freedom of the edges about their mean; 1 where they agree within
        their errors, and for one edge.
    """

    frequency: Vector
    mtf: Vector
    sigma: Vector
    edges: int
    excess: float


def pooled_mtf(
    *, edges: Sequence[EdgeMtf], axis: Axis, largest_angle_deg: float = LARGEST_ANGLE_DEG
) -> PooledMtf | None:
    """Pool the MTFs of the edges whose normals lie near an axis.

    Parameters
    ----------
    edges : sequence of EdgeMtf
        Measured edges.
    axis : {'x', 'y'}
        Across the picture, or down it.
    largest_angle_deg : float
        Between an edge's normal and the axis.

    Returns
    -------
    PooledMtf or None
        None if there is no such edge.

    Notes
    -----
    A frequency f along a normal at an angle φ to the axis is f·cos φ along the axis. Means are
    weighted by inverse variances. Where the edges differ by more than their errors, a common
    variance is added to all (DerSimonian and Laird, Meta-analysis in clinical trials, 1986).
    """
    chosen = [edge for edge in edges if _off_axis(edge, axis) <= largest_angle_deg]
    if not chosen:
        return None
    frequency = chosen[0].frequency
    mtf, variance = [], []
    for edge in chosen:
        along_axis = edge.frequency * math.cos(math.radians(_off_axis(edge, axis)))
        mtf.append(np.interp(frequency, along_axis, edge.mtf, right=np.nan))
        variance.append(np.interp(frequency, along_axis, edge.sigma, right=np.nan) ** 2)
    return _combined(frequency, np.array(mtf), np.array(variance))


def _off_axis(edge: EdgeMtf, axis: Axis) -> float:
    """Angle between an edge's normal and an axis, 0 to 90°."""
    across_x, across_y = edge.edge.normal
    return math.degrees(math.acos(min(1.0, abs(across_x if axis == "x" else across_y))))


def _combined(
    frequency: Vector, mtf: NDArray[np.float64], variance: NDArray[np.float64]
) -> PooledMtf:
    known = np.isfinite(mtf)
    weight = np.where(known, 1.0 / np.maximum(variance, 1e-12), 0.0)
    values = np.where(known, mtf, 0.0)
    total = np.maximum(weight.sum(axis=0), 1e-300)
    mean = (weight * values).sum(axis=0) / total
    degrees = np.maximum(known.sum(axis=0) - 1, 0)
    chi2 = (weight * (values - mean) ** 2).sum(axis=0)
    spare = total - (weight**2).sum(axis=0) / total
    common = np.where(degrees > 0, np.maximum(chi2 - degrees, 0.0) / np.maximum(spare, 1e-300), 0.0)
    weight = np.where(known, 1.0 / (np.maximum(variance, 1e-12) + common), 0.0)
    total = weight.sum(axis=0)
    covered = total > 0.0
    mean = np.where(covered, (weight * values).sum(axis=0) / np.where(covered, total, 1.0), np.nan)
    sigma = np.where(covered, 1.0 / np.sqrt(np.where(covered, total, 1.0)), np.nan)
    counted = (degrees > 0) & (frequency > 0.0)
    excess = float(np.sqrt(np.mean(chi2[counted] / degrees[counted]))) if counted.any() else 1.0
    last = int(np.flatnonzero(covered)[-1]) + 1
    return PooledMtf(frequency[:last], mean[:last], sigma[:last], len(mtf), max(1.0, excess))
