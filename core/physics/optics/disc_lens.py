"""The lens that a disc and a moved disc have in common: its area, whole and within a band.

Places count across and along the band, from the centre of the disc that rests; the moved one is
at (across, along), neither negative.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Lens:
    """What a disc of radius `fixed` and one of radius `moved`, a lag away, have in common.

    `own` and `other` are half the angles that its two arcs take of their circles, `kite` is the lag
    times half the common chord, and `meet` is true where the circles cross or touch. Where one disc
    lies in the other at all of the lags, `nested`, they are not computed.
    """

    fixed: float
    moved: float
    meet: Bools
    kite: Floats
    own: Floats
    other: Floats
    nested: bool = False

    @property
    def gap(self) -> float:
        """Difference of the radii's squares."""
        return (self.fixed - self.moved) * (self.fixed + self.moved)

    def area(self) -> Floats:
        """Its area."""
        if self.nested:
            return np.asarray(np.pi * min(self.fixed, self.moved) ** 2)
        return self.fixed**2 * self.own + self.moved**2 * self.other - self.kite

    def turned(self) -> Lens:
        """The same with the radii exchanged."""
        arrays = self.meet, self.kite, self.other, self.own
        return Lens(self.moved, self.fixed, *arrays, self.nested)

    def chosen(self, points: Bools | tuple[slice, slice]) -> Lens:
        """At some of the lags."""
        if self.nested:
            return self
        arrays = self.kite[points], self.own[points], self.other[points]
        return Lens(self.fixed, self.moved, self.meet[points], *arrays)


def lens(*, fixed: float, moved: float, square: Floats) -> Lens:
    """The lens of two discs.

    Parameters
    ----------
    fixed, moved : float
        Radii.
    square : ndarray
        Square of the distance of the centres, in the same unit.

    Returns
    -------
    Lens
        Where one disc lies in the other its circle is the lens, and where they are apart nothing.
    """
    # Heron: sixteen times the square of the area of the triangle that centres and tip make.
    short, long = (fixed - moved) ** 2, (fixed + moved) ** 2
    if square.max() < (1.0 - _TOUCH) * short:
        none = np.zeros(())
        return Lens(fixed, moved, none > 0.0, none, none, none, nested=True)
    product = (long - square) * (square - short)
    meet = product > -_TOUCH * long * long
    kite = 0.5 * np.sqrt(np.maximum(product, 0.0))
    if fixed == moved:
        own = np.arctan2(kite, 0.5 * square)
        return Lens(fixed, moved, meet, kite, own, own)
    gap = (fixed - moved) * (fixed + moved)
    own, other = np.arctan2(kite, 0.5 * (square + gap)), np.arctan2(kite, 0.5 * (square - gap))
    return Lens(fixed, moved, meet, kite, own, other)


_TOUCH = 1e-12  # apart by less than a few roundings circles may be taken to touch


@dataclass(frozen=True)
class Band:
    """The strip low <= across <= high, and what is the same for all lenses of one lag in it.

    `skew` is the lag's middle less the band's, across; None where they are one.
    """

    across: Floats
    along: Floats
    low: Floats | float
    high: float
    skew: Floats | None
    square: Floats
    slope: Floats
    tolerance: Floats

    @classmethod
    def at_rest(cls, across: Floats, along: Floats, square: Floats, half_width: float) -> Band:
        """The band of a strip that rests, symmetric about the centre."""
        slope, tolerance = (2.0 * half_width) * along, half_width * square
        low, skew = -half_width, 0.5 * across
        return cls(across, along, low, half_width, skew, square, slope, tolerance)

    @classmethod
    def common(cls, across: Floats, along: Floats, square: Floats, half_width: float) -> Band:
        """What a strip and its moved self have in common, of no width beyond twice `half_width`."""
        low = np.minimum(across - half_width, half_width)
        left = 0.5 * (half_width - low)
        slope, tolerance = (2.0 * left) * along, left * square
        return cls(across, along, low, half_width, None, square, slope, tolerance)


def half_chord(radius: float, place: Floats | float) -> Floats:
    """Half the chord of a circle at a distance from its centre, 0 beyond it."""
    chord: Floats = np.sqrt(np.maximum((radius - place) * (radius + place), 0.0))
    return chord


def half_segment(radius: float, place: Floats | float) -> Floats:
    """Integral of the half chord from the centre to a place."""
    t = np.minimum(np.maximum(place, -radius), radius)
    chord = half_chord(radius, t)
    # Not the arc sine: near the rim it would magnify the quotient's rounding.
    area: Floats = 0.5 * (t * chord + radius**2 * np.arctan2(t, chord))
    return area


@dataclass(frozen=True)
class Cut:
    """What a moved disc's circle does in a band.

    `place` lies in the band, and in the disc where that comes that far; `bottom` and `top` are its
    ends there along, `share` is half its area in the band.
    """

    radius: float
    place: Floats | float
    bottom: Floats
    top: Floats
    share: Floats

    @classmethod
    def of(cls, band: Band, radius: float) -> Cut:
        """Of one radius."""
        centred = band.skew is not None
        place: Floats | float = 0.0 if centred else 0.5 * band.across
        if band.across.max() > (radius if centred else 2.0 * radius):
            place = np.maximum(place, band.across - radius)
        chord = half_chord(radius, place - band.across)
        share = half_segment(radius, band.high - band.across)
        share = share - half_segment(radius, band.low - band.across)
        return cls(radius, place, band.along - chord, band.along + chord, share)


def lens_in_band(part: Lens, band: Band, cut: Cut) -> Floats:
    """Area of a lens within a band.

    Parameters
    ----------
    part : Lens
        The lens; it may rest in the band's middle only if its own disc reaches that far.
    band : Band
        The strip.
    cut : Cut
        The lens' moved disc in it.

    Returns
    -------
    ndarray
        Area, absolute error about 1e-15 of a disc's.

    Notes
    -----
    Where no tip of the lens lies in the band, the same circles bound it throughout: the area is a
    sum of segments, which depend on one component of the lag. Else it is the difference of what
    lies left of the band's two edges.
    """
    if part.nested and part.moved < part.fixed:
        return 2.0 * cut.share
    met = cut.place < min(band.high, part.fixed)
    own = (half_segment(part.fixed, band.high) - half_segment(part.fixed, band.low)) * met
    if part.nested:
        return 2.0 * own
    share = cut.share * met
    chord = half_chord(part.fixed, cut.place)
    crossed = np.where((cut.bottom <= chord) & met, (own + share) - band.slope, 0.0)
    area = np.where(cut.bottom > -chord, crossed, 2.0 * own)
    area = np.where(cut.top > chord, area, 2.0 * share)
    # Tips are (aim ± along · kite) / lag² across.
    aim = 0.5 * part.gap * band.across
    if band.skew is not None:
        aim = band.skew * band.square + aim
    tip = np.abs(np.abs(aim) - band.along * part.kite) <= band.tolerance
    tip &= part.meet
    if tip.any():
        area[tip] = _between_edges(part.chosen(tip), band, tip)
    return area


def _between_edges(part: Lens, band: Band, points: Bools) -> Floats:
    across, along, low = (
        np.broadcast_to(values, points.shape)[points]
        for values in (band.across, band.along, band.low)
    )
    turn = np.arctan2(along, across)
    area: Floats = _left_of(part, across, along, turn, band.high)
    return area - _left_of(part, across, along, turn, low)


def _left_of(
    part: Lens, across: Floats, along: Floats, turn: Floats, edge: Floats | float
) -> Floats:
    """Area of a lens where the place across is below an edge: arcs and a chord (Green).

    `turn` is the lag's direction from the axis across. Angles count from that axis, on the moved
    circle from its opposite.
    """
    fixed, moved = part.fixed, part.moved
    rest = half_chord(fixed, edge)
    begin = np.arctan2(rest, edge)
    low, high = turn - part.own, turn + part.own
    if fixed < moved:
        high = np.minimum(high, 2.0 * np.pi - begin)
    arcs = np.maximum(high - np.maximum(low, begin), 0.0) + np.maximum(-begin - low, 0.0)
    twice = fixed**2 * arcs
    # On the moved circle the lag itself adds to the moment.
    distance = np.minimum(np.maximum(across - edge, -moved), moved)
    chord = half_chord(moved, distance)
    end = np.arctan2(chord, distance)
    skew, at_end = along * (across - edge), moved**2 * end - across * chord
    low, high = turn - part.other, turn + part.other
    start_moment = np.where(low >= -end, moved**2 * low + part.kite, skew - at_end)
    end_moment = np.where(high <= end, moved**2 * high - part.kite, skew + at_end)
    twice += np.where(low < end, end_moment - start_moment, 0.0)
    if moved < fixed:
        behind = moved**2 * (high - 2.0 * np.pi) - part.kite - (skew - at_end)
        twice += np.where(high > 2.0 * np.pi - end, behind, 0.0)
    length = np.minimum(rest, along + chord) - np.maximum(-rest, along - chord)
    area: Floats = 0.5 * (twice + edge * np.maximum(length, 0.0))
    return area
