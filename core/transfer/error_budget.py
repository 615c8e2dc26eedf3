"""Leaving out stages that change the picture by less than the error budget.

A stage's bound is the largest |1 − H| over the band. Stages are left out in the order of their
bounds while the sum stays within the tolerance t. What remains is passive, so by Parseval's
theorem the picture changes by at most t times the rms of its contrast.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.work import Work
from core.transfer.factors import Factor, Planar, Separable

Array = NDArray[Any]
RADII = 513  # places along the radius on which a radial factor is bounded


@dataclass(frozen=True)
class Skipped:
    """A stage left out, and how much it could have changed."""

    label: str
    node: str | None
    bound: float


def spend(
    work: Work, factors: Sequence[Factor], xi: Array, eta: Array, *, spent: float = 0.0
) -> tuple[tuple[Factor, ...], tuple[Skipped, ...]]:
    """Factors to keep, in their order, and what is left out.

    Parameters
    ----------
    work : Work
        Its policy has the tolerance; at 0 everything is kept.
    factors : sequence of Factor
        MTFs and PTFs of one chain.
    xi, eta : ndarray
        Frequencies of the band across and along, cycles/mrad.
    spent : float
        Part of the budget that something else takes already.
    """
    left = work.policy.budget - spent
    if left <= 0.0:
        return tuple(factors), ()
    corner = _farthest(xi), _farthest(eta)
    bounds = []
    for factor in factors:
        # Most stages exceed the budget at the band's corner alone, by the same bound.
        bound = stage_bound(work, factor, *corner, radii=1)
        bounds.append(bound if bound > left else stage_bound(work, factor, xi, eta))
    skipped = {}
    for index in sorted(range(len(factors)), key=lambda i: bounds[i]):
        if bounds[index] > left:
            break
        left -= bounds[index]
        skipped[index] = Skipped(factors[index].label, factors[index].node, bounds[index])
    needed = tuple(f for index, f in enumerate(factors) if index not in skipped)
    return needed, tuple(skipped.values())


def _farthest(frequency: Array) -> Array:
    """The frequency that is largest in size, as an array of one."""
    place = int(np.argmax(np.abs(frequency)))
    return frequency[place : place + 1]


def stage_bound(work: Work, factor: Factor, xi: Array, eta: Array, *, radii: int = RADII) -> float:
    """Upper bound of |1 − H| over the band; infinite where it is not cheap to find."""
    if isinstance(factor, Separable):
        across = _axis_change(work, factor, factor.x, xi)
        along = _axis_change(work, factor, factor.y, eta)
        # |1 − ab| ≤ |1 − a| + |a|·|1 − b| and |a| ≤ 1 + |1 − a|
        return across + (1.0 + across) * along
    if _is_radial(factor):
        corner = float(np.hypot(np.abs(xi).max(), np.abs(eta).max()))
        line = factor.transfer(work, corner * np.linspace(1.0, 0.0, radii), np.zeros(1))
        return float(np.abs(1.0 - line).max())
    return float("inf")


def _is_radial(factor: Planar) -> bool:
    return factor.radial and factor.ratios[0] == factor.ratios[1]


def _axis_change(work: Work, factor: Separable, law: Any, frequency: Array) -> float:
    value = factor.axis(work, law, frequency)
    if value is None:
        return 0.0
    # |1 − exp(iφ)| = 2|sin(φ/2)|
    change = 1.0 - value if factor.part == "mtf" else 2.0 * np.sin(0.5 * value)
    return float(np.abs(change).max())
