"""Truth for pupils: overlap areas as integrals of chord lengths, without the measured code."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Intervals = list[tuple[Array, Array]]


@dataclass(frozen=True)
class Aperture:
    """A disc, or half, without an inner disc, a bar |x| ≤ half_bar and a beam |y| ≤ half_beam."""

    radius: float
    inner: float = 0.0
    half_bar: float = 0.0
    half_beam: float = 0.0
    half_moon: bool = False

    def otf(self, shift_x: float, shift_y: float) -> float:
        """Overlap with itself moved, over its area."""
        return self._overlap(shift_x, shift_y) / self._overlap(0.0, 0.0)

    def _overlap(self, shift_x: float, shift_y: float) -> float:
        """Integral over y of the length common to a row and the row moved onto it.

        Between all crossings of the edges the length is smooth but for square roots at the ends,
        which the double exponential rule takes.
        """
        breaks = [y for y in self._breaks(shift_x, shift_y) if abs(y) <= self.radius]
        places = np.array(sorted({-self.radius, self.radius, *breaks}))
        node, weight = _double_exponential()
        total = 0.0
        for low, high in pairwise(places):
            y = low + (high - low) * node
            here, moved = self._row(y), self._row(y - shift_y)
            length: Any = 0.0
            for a, b in here:
                for c, d in moved:
                    length = length + np.maximum(
                        np.minimum(b, d + shift_x) - np.maximum(a, c + shift_x), 0.0
                    )
            total += (high - low) * float(np.sum(weight * length))
        return total

    def _row(self, y: Array) -> Intervals:
        outer = np.sqrt(np.maximum((self.radius - y) * (self.radius + y), 0.0))
        outer = np.where(np.abs(y) <= self.half_beam, 0.0, outer)
        if self.half_moon:
            return [(np.zeros_like(outer), outer)]
        hole = np.sqrt(np.maximum((self.inner - y) * (self.inner + y), 0.0))
        blocked = np.minimum(np.maximum(hole, self.half_bar), outer)
        return [(-outer, -blocked), (blocked, outer)]

    def _breaks(self, shift_x: float, shift_y: float) -> list[float]:
        circles, lines = [], []
        for x, y in ((0.0, 0.0), (shift_x, shift_y)):
            circles += [(x, y, r) for r in (self.radius, self.inner) if r > 0]
            lines += [x - self.half_bar, x + self.half_bar]
        breaks = [y + sign * r for _, y, r in circles for sign in (-1, 1)]
        breaks += [y + sign * self.half_beam for y in (0.0, shift_y) for sign in (-1, 1)]
        for x, y, r in circles:
            roots = [math.sqrt(r * r - (line - x) ** 2) for line in lines if abs(line - x) <= r]
            breaks += [y + sign * root for root in roots for sign in (-1, 1)]
        for first, second in combinations(circles, 2):
            breaks += _crossings(first, second)
        return breaks


def _crossings(
    first: tuple[float, float, float], second: tuple[float, float, float]
) -> list[float]:
    """Heights at which two circles cross."""
    (x0, y0, r0), (x1, y1, r1) = first, second
    dx, dy = x1 - x0, y1 - y0
    apart = math.hypot(dx, dy)
    if apart == 0 or apart > r0 + r1 or apart < abs(r0 - r1):
        return []
    along = (apart**2 + r0**2 - r1**2) / (2 * apart)
    across = math.sqrt(max(r0**2 - along**2, 0.0))
    return [y0 + (along * dy + sign * across * dx) / apart for sign in (-1, 1)]


def _double_exponential() -> tuple[Array, Array]:
    """Nodes in (0, 1) and weights of the tanh-sinh rule."""
    step = 1 / 32
    t = np.arange(-112, 113) * step
    u = 0.5 * np.pi * np.sinh(t)
    weight = step * 0.25 * np.pi * np.cosh(t) / np.cosh(u) ** 2
    return 1 / (1 + np.exp(-2 * u)), weight
