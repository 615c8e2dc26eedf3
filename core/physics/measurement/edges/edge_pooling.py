"""MTF across and down a picture, pooled over its edges."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_mtf import EdgeMtf

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Axis = Literal["x", "y"]

LARGEST_ANGLE_DEG = 30.0
_DIRECTIONS = 0.3  # of 1 − MTF, by which directions may differ
_LAW = 0.15  # of 1 − MTF, by which an edge across the axis may depart from the law of directions
_LEAST_VARIANCE = 1e-12


@dataclass(frozen=True)
class PooledMtf:
    """MTF of one direction.

    Parameters
    ----------
    frequency : ndarray
        Cycles per sample along the axis.
    mtf, sigma : ndarray
        Of the edges together, and its standard error, widened by `excess`.
    edges : int
        How many lie within `largest_angle_deg` of the axis.
    excess : float
        Root of the mean square of all edges' departures over their errors; 1 where they agree
        within their errors, and for one edge.
    """

    frequency: Vector
    mtf: Vector
    sigma: Vector
    edges: int
    excess: float


def pooled_mtf(
    *, edges: Sequence[EdgeMtf], axis: Axis, largest_angle_deg: float = LARGEST_ANGLE_DEG
) -> PooledMtf | None:
    """Pool the MTFs of a picture's edges to that along an axis.

    Parameters
    ----------
    edges : sequence of EdgeMtf
        Measured edges of any direction, all at the same frequencies.
    axis : {'x', 'y'}
        Across the picture, or down it.
    largest_angle_deg : float
        Between the axis and a normal, within which at least one edge must lie.

    Returns
    -------
    PooledMtf or None
        None if no edge lies near the axis.

    Notes
    -----
    At a frequency f along a normal at an angle φ to the axis, the MTF is taken as
    M + A·sin²φ + B·sin φ·cos φ, which is what blurs, motion and pixels do to second order in f: a
    round blur has A = B = 0, and an edge off the axis is then as good as one on it. A and B are
    assumed to be about 0.3·(1 − M), or as large as edges of other directions show, and follow from
    the edges where these have several directions; the law is trusted to 0.15·(1 − M)·sin²φ. What
    all edges share (what is assumed of their tails) is not made smaller by their number. Where
    the edges differ by more than their errors, a common variance is added to all (DerSimonian and
    Laird, Meta-analysis in clinical trials, 1986); A and B take fewer degrees of freedom than two
    from the edges, as far as they are assumed.
    """
    angles = np.array([_off_axis(edge, axis) for edge in edges])
    near = np.abs(angles) <= math.radians(largest_angle_deg)
    if not near.any():
        return None
    mtf = np.array([edge.mtf for edge in edges])
    shared = np.array([edge.shared_sigma for edge in edges])
    own = np.maximum(np.array([edge.sigma for edge in edges]) ** 2 - shared**2, _LEAST_VARIANCE)
    design = np.stack([np.ones(len(angles)), np.sin(angles) ** 2, np.sin(2 * angles) / 2], axis=1)
    here = _mean(mtf[near], own[near])
    there = here if near.all() else _mean(mtf[~near], own[~near])
    lost = np.maximum(1.0 - np.minimum(here, there), 1e-6)
    doubt = np.hypot(_DIRECTIONS * lost, there - here)
    own = own + (_LAW * lost * design[:, 1:2]) ** 2
    value, variance, part, terms = _fitted(design, mtf, own, doubt)
    chi2 = np.sum((mtf - part) ** 2 / own, axis=0)
    degrees = len(edges) - terms
    common, excess = np.zeros(len(chi2)), 1.0
    if len(edges) > design.shape[1]:
        spare = np.sum(1.0 / own, axis=0) * degrees / len(edges)
        common = np.maximum(chi2 - degrees, 0.0) / spare
        value, variance, _, _ = _fitted(design, mtf, own + common, doubt)
        excess = math.sqrt(float(np.mean((chi2 / degrees)[1:])))
    share = np.sum(shared / (own + common), axis=0) / np.sum(1.0 / (own + common), axis=0)
    return PooledMtf(
        frequency=edges[0].frequency,
        mtf=value,
        sigma=np.sqrt(variance + share**2),
        edges=int(near.sum()),
        excess=max(1.0, excess),
    )


def _mean(values: Matrix, variance: Matrix) -> Vector:
    """Mean over edges, weighted by inverse variance."""
    weight = 1.0 / variance
    return np.asarray(np.sum(weight * values, axis=0) / np.sum(weight, axis=0), np.float64)


def _off_axis(edge: EdgeMtf, axis: Axis) -> float:
    """Angle from an axis to an edge's normal, radians, −π/2 to π/2."""
    angle = edge.edge.angle_deg - (0.0 if axis == "x" else 90.0)
    return math.radians((angle + 90.0) % 180.0 - 90.0)


def _fitted(
    design: Matrix, mtf: Matrix, variance: Matrix, doubt: Vector
) -> tuple[Vector, Vector, Matrix, Vector]:
    """Value on the axis, its variance, the fit at the edges, and how many terms these determine."""
    weighted = design.T[:, :, np.newaxis] / variance  # terms, edges, frequencies
    normal = np.einsum("aef,eb->fab", weighted, design)
    alone = normal.copy()
    normal[:, 1, 1] += 1.0 / doubt**2
    normal[:, 2, 2] += 1.0 / doubt**2
    right = np.einsum("aef,ef->fa", weighted, mtf)
    inverse = np.linalg.inv(normal)
    terms = np.einsum("fab,fb->fa", inverse, right)
    determined = np.einsum("fab,fba->f", inverse, alone)
    return terms[:, 0], inverse[:, 0, 0], design @ terms.T, determined
