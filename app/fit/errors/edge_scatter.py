"""Errors of a fit from the scatter between edges, where they leave more than noise.

Real edges are never ideal: what one leaves is of a shape of its own, the same in all its samples,
and a sum of squares over samples takes it for many independent errors. Edges are independent of
each other; so each is left out in turn, and what that moves is the error (Quenouille 1956, Tukey
1958: the jackknife; here one step of the linearized model for each). Of few edges the deviation is
itself uncertain, and Student's distribution widens it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, stdtrit

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_ALIKE = 3e-3  # of the largest singular value, below which a direction is not known at all
_RIDGE = 1e-9  # of what is known of a direction, where all of it stems from one edge
_LEAST_FREEDOM = 1.0  # degrees of freedom of a scatter


def widened_by_scatter(
    *, jacobian: Matrix, residual: Vector, edge: NDArray[np.intp]
) -> tuple[Matrix, Vector]:
    """Derivatives with which errors are at least those of the scatter between edges.

    Parameters
    ----------
    jacobian : ndarray
        Derivatives of the residuals, shape (samples, parameters), in units of their errors.
    residual : ndarray
        In the same units, what is each edge's own taken out.
    edge : ndarray of int
        Which edge a sample is of; below 0 for those of none.

    Returns
    -------
    jacobian : ndarray
        As given, less where edges scatter by more than it says; never more.
    edges : ndarray
        On how many edges each parameter rests: (Σ h)² / Σ h² of their shares h of its information.
    """
    lengths = np.linalg.norm(jacobian, axis=0) + 1e-300
    left, singular, rows = np.linalg.svd(jacobian / lengths, full_matrices=False)
    good = singular >= _ALIKE * singular[0]
    known = left[:, good]
    numbers = np.unique(edge[edge >= 0])
    parts = [known[edge == number] for number in numbers]
    shares = np.array([part.T @ part for part in parts])
    scores = np.array(
        [part.T @ residual[edge == n] for part, n in zip(parts, numbers, strict=True)]
    )
    others = np.eye(known.shape[1]) * (1.0 + _RIDGE) - shares
    moved = np.linalg.solve(others, scores[..., np.newaxis])[..., 0]
    many = len(numbers)
    spread, axes = np.linalg.eigh((many - 1.0) / many * moved.T @ moved)
    wider = np.ones(len(spread))
    for place, axis in enumerate(axes.T):
        factor = student_factor(_count(shares, axis))
        wider[place] = max(1.0, float(spread[place]) * factor**2)
    left[:, good] = known @ (axes / np.sqrt(wider)) @ axes.T
    reached = (rows[good] / singular[good, np.newaxis]).T
    edges = np.array([_count(shares, one) for one in reached])
    return np.asarray((left * singular) @ rows * lengths, np.float64), edges


def of_each_edge(residual: Matrix, count: int) -> tuple[Vector, NDArray[np.intp]]:
    """Residuals in a row, with as many samples as that, and which edge each is of, or -1."""
    many, longest = residual.shape
    row, edge = np.zeros(count), np.full(count, -1, np.intp)
    row[: many * longest] = residual.ravel()
    edge[: many * longest] = np.repeat(np.arange(many), longest)
    return row, edge


def student_factor(edges: float) -> float:
    """By which a deviation of so few is multiplied for an interval that covers 68 %."""
    return float(stdtrit(max(_LEAST_FREEDOM, edges - 1.0), ndtr(1.0)))


def _count(shares: Matrix, axis: Vector) -> float:
    """Of how many edges a direction is known."""
    taken = np.einsum("i,eij,j->e", axis, shares, axis)
    total = float(taken.sum())
    return total**2 / float(taken @ taken) if total > 0.0 and math.isfinite(total) else 0.0
