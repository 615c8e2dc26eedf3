"""The product of a chain's factors, kept as two axis vectors and a few planar factors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.transfer.factors import Factor, Planar, Separable

if TYPE_CHECKING:
    from core.evaluation.work import Work

Array = NDArray[Any]


class Product:
    """H(xi, eta) = Hx(xi)·Hy(eta)·Π planar factors, evaluated only where needed.

    Parameters
    ----------
    factors : sequence of Factor
        Factors of the magnitude and of the phase wire together; modulus and phase of one law
        become that complex law again.
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
        """H(0, 0), which is real: 1 for every passive chain.

        Parameters
        ----------
        work : Work or None
            Needed where a law has a recipe bound.
        axes : complex, optional
            Hx(0)·Hy(0), where it is known already.
        """
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
