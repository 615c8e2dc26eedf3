"""The parallelogram in which two equal strips cross, and how much of it an annulus lets through."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.optics.strip_overlap import Strip

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Crossing:
    """Two strips, by their places among all, that cross at an angle.

    `half` is half their width, `sin` and `cos` are those of the angle, not negative, and `radius`
    and `hole` are the annulus'.
    """

    pair: tuple[int, int]
    half: float
    sin: float
    cos: float
    radius: float
    hole: float

    @classmethod
    def of(
        cls, strips: tuple[Strip, ...], pair: tuple[int, int], radius: float, hole: float
    ) -> Crossing:
        """Of two of a pupil's strips."""
        a, b = (strips[index] for index in pair)
        sin, cos = abs(a.cos * b.sin - a.sin * b.cos), abs(a.cos * b.cos + a.sin * b.sin)
        return cls(pair, a.high, sin, cos, radius, hole)

    @property
    def area(self) -> float:
        """Area of the parallelogram."""
        return 4.0 * self.half**2 / self.sin

    @property
    def extent(self) -> float:
        """How far it reaches along a strip from its centre."""
        return self.half * (1.0 + self.cos) / self.sin

    @property
    def farthest(self) -> float:
        """How far its corners are from its centre."""
        return math.hypot(self.extent, self.half)

    def overlap(self, across: tuple[Floats, Floats], *, same_side: bool) -> tuple[Floats, Bools]:
        """Area in both annuli of one strip's crossing with the other, moved.

        Parameters
        ----------
        across : tuple of ndarray
            Components of the lag across the second and the first strip. The parallelogram's centre
            is that over the sine along the first strip and, from the moved centre, the second.
        same_side : bool
            Vanes: the signs of both must agree, else the one's half meets not the other's.

        Returns
        -------
        area, cut : ndarray
            Area, and where circles of both annuli cut the parallelogram, so that it is not known.
        """
        first, second = (np.abs(values) / self.sin for values in across)
        extent = self.extent
        hidden = math.sqrt(max((self.hole - self.half) * (self.hole + self.half), 0.0)) - extent
        gone = self.radius + extent
        met = (first > hidden) & (first < gone) & ((second > hidden) & (second < gone))
        if same_side:
            met &= across[0] * across[1] > 0.0
        area = np.zeros(met.shape)
        if not met.any():
            return area, np.zeros_like(met)
        clear = self.hole + extent
        whole = math.sqrt((self.radius - self.half) * (self.radius + self.half)) - extent
        cut_first, cut_second = ((at < clear) | (at > whole) for at in (first, second))
        area[met] = self.area
        once = met & (cut_first ^ cut_second)
        if once.any():
            place = np.where(cut_first, first, second)[once]
            area[once] = self._in_annulus(place)
        return area, met & (cut_first & cut_second)

    def _in_annulus(self, place: Floats) -> Floats:
        half, right = self.half, self.half / self.sin
        lean = right * self.cos
        x = (place - right - lean, place + right - lean, place + right + lean, place - right + lean)
        corners = list(zip(x, (-half, -half, half, half), strict=True))
        return _in_disc(corners, self.radius) - _in_disc(corners, self.hole)


def _in_disc(corners: list[tuple[Floats, float]], radius: float) -> Floats:
    """Area of a polygon, corners counter-clockwise, within a disc about the origin."""
    twice = np.zeros_like(corners[0][0])
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        run, rise = x1 - x0, y1 - y0
        length = np.hypot(run, rise)
        cos, sin = run / length, rise / length
        distance = x0 * sin - y0 * cos
        start, end = x0 * cos + y0 * sin, x1 * cos + y1 * sin
        reach = np.sqrt(np.maximum((radius - distance) * (radius + distance), 0.0))
        inside = np.clip(start, -reach, reach), np.clip(end, -reach, reach)
        away = np.abs(distance)
        angle = np.arctan2(end, away) - np.arctan2(inside[1], away)
        angle += np.arctan2(inside[0], away) - np.arctan2(start, away)
        twice += distance * (inside[1] - inside[0]) + radius**2 * np.copysign(angle, distance)
    return 0.5 * twice
