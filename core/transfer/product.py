"""The product of a chain's factors, kept as two axis vectors and a few planar factors."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.work import Work
from core.transfer.factors import Factor, Planar, Separable

Array = NDArray[Any]


class Product:
    """H(xi, eta) = Hx(xi)·Hy(eta)·Π planar factors, evaluated only where needed.

    It is made of the factors of the magnitude and of the phase wire together; modulus and phase of
    one law become that complex law again.
    """

    def __init__(self, factors: Sequence[Factor]) -> None:
        self.separable = tuple(f for f in factors if isinstance(f, Separable))
        self.planar = _rejoin([f for f in factors if isinstance(f, Planar)])

    @property
    def symmetric(self) -> bool:
        """Whether every planar factor is real and even in xi and in eta."""
        return all(f.symmetric and f.take == "real" for f in self.planar)

    @property
    def has_phase_x(self) -> bool:
        """Whether some factor shifts phases across."""
        return any(f.part == "ptf" and f.x is not None for f in self.separable)

    @property
    def has_phase_y(self) -> bool:
        """Whether some factor shifts phases along."""
        return any(f.part == "ptf" and f.y is not None for f in self.separable)

    def across(self, work: Work | None, xi: Array) -> Array:
        """Hx at `xi`: real unless `has_phase_x`."""
        return self._axis(work, xi, "x")

    def along(self, work: Work | None, eta: Array) -> Array:
        """Hy at `eta`: real unless `has_phase_y`."""
        return self._axis(work, eta, "y")

    def plane(self, work: Work | None, xi: Array, eta: Array) -> Array | None:
        """Product of the planar factors for xi (columns,) × eta (rows,); None without any."""
        if not self.planar:
            return None
        value: Array | None = None
        for factor in self.planar:
            values = factor.transfer(work, xi[np.newaxis, :], eta[:, np.newaxis])
            value = values if value is None else value * values
        return value

    def total(self, work: Work | None, xi: Array, eta: Array) -> Array:
        """H on the plane of xi (columns,) × eta (rows,)."""
        value = np.multiply.outer(self.along(work, eta), self.across(work, xi))
        plane = self.plane(work, xi, eta)
        return value if plane is None else value * plane

    def at_zero(self, work: Work | None, axes: complex | None = None) -> float:
        """H(0, 0), real, 1 for every passive chain; `axes` is Hx(0)·Hy(0), where that is known."""
        zero = np.zeros(1)
        if axes is None:
            axes = (self.along(work, zero) * self.across(work, zero))[0]
        plane = self.plane(work, zero, zero)
        return float(np.real(axes if plane is None else axes * plane[0, 0]))

    def _axis(self, work: Work | None, frequency: Array, axis: str) -> Array:
        modulus = np.ones(len(frequency))
        phase: Array | None = None
        for factor in self.separable:
            value = factor.axis(work, factor.x if axis == "x" else factor.y, frequency)
            if value is None:
                continue
            if factor.part == "mtf":
                modulus = modulus * value
            else:
                phase = value if phase is None else phase + value
        return modulus if phase is None else modulus * np.exp(1j * phase)


def _rejoin(planar: list[Planar]) -> tuple[Planar, ...]:
    """Put modulus and phase of one law together, so that neither is ever computed."""
    joined: list[Planar] = []
    for factor in planar:
        other = {"modulus": "phase", "phase": "modulus"}.get(factor.take)
        for index, earlier in enumerate(joined) if other else ():
            same = earlier.law.key == factor.law.key and earlier.ratios == factor.ratios
            if earlier.take == other and same:
                joined[index] = replace(earlier, take="complex")
                break
        else:
            joined.append(factor)
    return tuple(joined)


# What acts at the Nyquist row and column of an even frame: the Hermitian part of H.
#
# There +Nyquist and −Nyquist are one frequency of the samples, whose spectrum must stay that of a
# real picture: the mean of H at both acts (Oppenheim and Schafer 1989, Discrete-Time Signal
# Processing, on the symmetries of the transform of a real sequence).

OnPlane = Callable[[Array, Array], Array]
Lines = tuple[slice | int, slice | int]


def nyquist_lines(function: OnPlane, xi: Array, eta: Array) -> Iterator[tuple[Lines, Array]]:
    """Means over both signs of Nyquist's frequencies, on the lines where there are two.

    The function of xi (columns,) and eta (rows,), which are in the order of a plain FFT, gives
    values of shape (rows, columns). Yields the index of a row, or a column, and the mean there.
    """
    across, along = _turned(xi), _turned(eta)
    for axis, signs in ((0, along), (1, across)):
        if signs is None:
            continue
        place = len(signs) // 2
        on_line = slice(place, place + 1)
        whole: Lines = (place, slice(None)) if axis == 0 else (slice(None), place)
        total: Array | None = None
        for x in (xi, xi if across is None else across):
            for y in (eta, eta if along is None else along):
                value = function(x, y[on_line]) if axis == 0 else function(x[on_line], y)
                total = value if total is None else total + value
        assert total is not None
        yield whole, 0.25 * total.ravel()


def _turned(frequency: Array) -> Array | None:
    """The same frequencies with Nyquist's of the other sign; None of an odd size."""
    size = len(frequency)
    if size % 2:
        return None
    turned = np.array(frequency, np.float64)
    turned[size // 2] *= -1.0
    return turned


# Leaving out stages that change the picture by less than the error budget.
#
# A stage's bound is the largest |1 − H| over the band. Stages are left out in the order of their
# bounds while the sum stays within the tolerance t. What remains is passive, so by Parseval's
# theorem the picture changes by at most t times the rms of its contrast.

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
    """Factors to keep, in their order, and what is left out on the band xi × eta.

    The policy has the tolerance, of which something else may have `spent` a part; at 0 everything
    is kept.
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
