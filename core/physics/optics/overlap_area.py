"""Overlap areas of discs, annuli and half discs, without cancellation.

All come from Green's theorem over the overlap's boundary: arcs and chords, no quadrature.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats, Mask
from core.errors import DataError, ParameterError
from core.records import dataclass


def arc_half_angle(*, radius: ArrayLike, disc_radius: ArrayLike, distance: ArrayLike) -> Floats:
    """Half the angle of the arc of a circle that lies inside a disc, about the disc's direction.

    Lengths in one unit, which broadcast; 0 where no point of the circle is inside, π where all are,
    and 0 for equal radii at zero distance. Heron's product replaces the arc cosine, which loses
    half the digits near tangency.
    """
    own, disc, apart = (np.asarray(v, dtype=np.float64) for v in (radius, disc_radius, distance))
    adjacent = (own - disc) * (own + disc) + apart * apart
    return np.asarray(np.arctan2(_four_triangle_areas(own, disc, apart), adjacent))


def _four_triangle_areas(a: Floats, b: Floats, c: Floats) -> Floats:
    """Four times the area of the triangle of these sides, 0 where there is none (Heron)."""
    # In descending order the factors keep their relative precision (Kahan).
    low, high = np.minimum(a, b), np.maximum(a, b)
    x, z = np.maximum(high, c), np.minimum(low, c)
    y = np.maximum(low, np.minimum(high, c))
    product = (x + (y + z)) * (z - (x - y)) * (z + (x - y)) * (x + (y - z))
    return np.asarray(np.sqrt(np.maximum(product, 0.0)))


def angle_minus_sine(angle: ArrayLike) -> Floats:
    """``x - sin(x)`` for x >= 0 at full relative precision, also for small x."""
    x = np.asarray(angle, dtype=np.float64)
    least = np.minimum(x, 1.0)
    square = least * least
    series = np.ones_like(square)
    for k in range(10, 0, -1):
        series = 1.0 - series * square / ((2 * k + 2) * (2 * k + 3))
    small = least * square / 6.0 * series
    if x.max(initial=0.0) >= 1.0:
        small = np.where(x < 1.0, small, x - np.sin(x))
    return np.asarray(small)


def disc_overlap_fraction(*, distance_ratio: ArrayLike) -> Floats:
    """Overlap of two equal discs over one disc's area, by the distance over the diameter.

    Exactly 0 from a `distance_ratio` of 1 on, and of relative precision up to there.
    """
    v = np.minimum(np.atleast_1d(np.asarray(distance_ratio, dtype=np.float64)), 1.0)
    chord = np.sqrt((1.0 - v) * (1.0 + v))
    half = np.arctan2(chord, v)
    fraction = (half - v * chord) * (2.0 / np.pi)
    fraction[v == 0.0] = 1.0
    slight = (v > _SLIGHT) & (v < 1.0)
    if slight.any():
        fraction[slight] = angle_minus_sine(2.0 * half[slight]) / np.pi
    return np.asarray(fraction.reshape(np.shape(distance_ratio)))


_SLIGHT = 0.9  # beyond it the segments' angle and sine cancel


def annulus_overlap_fraction(*, distance_ratio: ArrayLike, obscuration_ratio: float) -> Floats:
    """Overlap of two equal annuli over one annulus' area, by the distance over the outer diameter.

    The absolute error is near 1e-15 for any `obscuration_ratio` up to 1 - 1e-9 and beyond. The sum
    of four disc overlaps would lose all of 1/(1 - ratio). Near zero lag what is missing of the full
    ring is summed instead, and far from it, for thin rings, the two kites in which they cross: the
    terms are then as small as the result.
    """
    s = 2.0 * np.asarray(distance_ratio, dtype=np.float64).ravel()
    r = float(obscuration_ratio)
    ring = (1.0 - r) * (1.0 + r)
    beyond = s >= 1.0 + r
    near = ~beyond & (s < _NEAR_LAG * ring)
    apart = near & (s <= 1.0 - r)
    rest = ~(beyond | near)
    forms = (
        (apart, _overlap_inside),
        (near & ~apart, _near_overlap),
        (rest & (s < 2.0 * r), _two_kites),
        (rest & (s >= 2.0 * r), _far_overlap),
    )
    fraction = np.empty_like(s)
    for chosen, form in forms:
        if chosen.any():
            fraction[chosen] = np.clip(form(s[chosen], r) / (np.pi * ring), 0.0, 1.0)
    fraction[beyond] = disc_overlap_fraction(distance_ratio=s[beyond] / 2.0) / ring
    fraction[s == 0.0] = 1.0
    return fraction.reshape(np.shape(distance_ratio))


_TINY = 1e-300
_NEAR_LAG = 60.0  # in ring thicknesses: where the errors of the two forms, 1e-14, are alike


def _overlap_inside(s: Floats, r: float) -> Floats:
    """Annulus minus what the outer and inner discs miss of each other.

    Neither inner disc may reach beyond the other's outer one.
    """
    missing = _missing_of_disc(s / 2.0) + r * r * _missing_of_disc(s / (2.0 * r))
    return np.asarray(np.pi * ((1.0 - r) * (1.0 + r)) - missing)


def _near_overlap(s: Floats, r: float) -> Floats:
    """The same, plus the lunes of each inner disc outside the other outer one."""
    # Angle of the moved inner disc's lune seen from the outer centre, and the small angle between
    # the two radii at the lune's tip.
    seen = arc_half_angle(radius=1.0, disc_radius=r, distance=s)
    tip = np.arctan2(_four_triangle_areas(np.ones(1), np.full(1, r), s), 1.0 + r * r - s * s)
    ring = (1.0 - r) * (1.0 + r)
    lunes = 2.0 * r * r * (tip - np.cos(2.0 * seen + tip) * np.sin(tip))
    return np.asarray(_overlap_inside(s, r) + lunes - ring * angle_minus_sine(2.0 * seen))


def _missing_of_disc(ratio: Floats) -> Floats:
    """Area of a unit disc outside its copy, moved by `ratio` diameters."""
    t = np.minimum(ratio, 1.0)
    return np.asarray(2.0 * (np.arcsin(t) + t * np.sqrt((1.0 - t) * (1.0 + t))))


def _two_kites(s: Floats, r: float) -> Floats:
    """The two curved kites in which two rings cross: straight ones plus and minus segments."""
    ring = (1.0 - r) * (1.0 + r)
    outer_y = np.sqrt(np.maximum((1.0 - s / 2.0) * (1.0 + s / 2.0), 0.0))
    inner_y = np.sqrt(np.maximum((r - s / 2.0) * (r + s / 2.0), 0.0))
    straight = ring * ring / (s * (outer_y + inner_y))
    arc = arc_half_angle(radius=1.0, disc_radius=1.0, distance=s)
    arc = arc - arc_half_angle(radius=1.0, disc_radius=r, distance=s)
    inner_arc = arc_half_angle(radius=r, disc_radius=1.0, distance=s)
    inner_arc = inner_arc - arc_half_angle(radius=r, disc_radius=r, distance=s)
    segments = angle_minus_sine(np.abs(arc)) - r * r * angle_minus_sine(np.abs(inner_arc))
    return np.asarray(straight + 2.0 * segments)


def _far_overlap(s: Floats, r: float) -> Floats:
    """Lens of the outer discs less those with the other's inner disc; the inner ones are apart."""
    lens = angle_minus_sine(2.0 * arc_half_angle(radius=1.0, disc_radius=1.0, distance=s))
    seen = angle_minus_sine(2.0 * arc_half_angle(radius=1.0, disc_radius=r, distance=s))
    back = angle_minus_sine(2.0 * arc_half_angle(radius=r, disc_radius=1.0, distance=s))
    return np.asarray(lens - seen - r * r * back)


def checked_aperture(frequency_ratio: ArrayLike, obscuration_ratio: float) -> tuple[Floats, float]:
    """Sizes of frequencies over the cutoff, and the obscuration, which must leave an opening."""
    ratio = float(obscuration_ratio)
    if not 0.0 <= ratio < 1.0:
        raise ParameterError(
            "obscuration_ratio", ratio, "at least 0 and below 1 (an opening must remain)"
        )
    v = np.abs(np.asarray(frequency_ratio, dtype=np.float64))
    if not np.all(np.isfinite(v)):
        raise DataError("frequency_ratio holds a value that is not finite")
    return v, ratio


def annular_otf(
    *, frequency_ratio: ArrayLike, obscuration_ratio: float = 0.0
) -> NDArray[np.float64]:
    """OTF of a disc or annulus: the overlap of the aperture with itself moved.

    Parameters
    ----------
    frequency_ratio : array_like
        Radial frequency over the cutoff (aperture diameter over wavelength), of either sign.
    obscuration_ratio : float
        Inner radius divided by outer radius, at least 0 and below 1.

    Returns
    -------
    ndarray
        Real OTF, shape of `frequency_ratio`: 1 at zero, 0 from the cutoff on.

    Raises
    ------
    ParameterError
        If the obscuration leaves no opening.
    DataError
        If a frequency is not finite.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-32 (disc); O'Neill 1956, JOSA 46,
    285 (annulus). Relative precision holds up to the cutoff, where arc cosine forms cancel.
    """
    v, ratio = checked_aperture(frequency_ratio, obscuration_ratio)
    if ratio == 0.0:
        return disc_overlap_fraction(distance_ratio=v)
    return annulus_overlap_fraction(distance_ratio=v, obscuration_ratio=ratio)


def half_disc_overlap_area(*, radius: float, lag_x: ArrayLike, lag_y: ArrayLike) -> Floats:
    """Overlap area of the half disc x >= 0 with itself moved by lags in the unit of its radius."""
    a, b = (np.abs(np.asarray(lag, dtype=np.float64)) / radius for lag in (lag_x, lag_y))
    a, b = np.minimum(a, 1.0), np.minimum(b, 2.0)
    square = a * a + b * b
    # Lower right of the two points where the circles cross.
    slope = np.sqrt(np.maximum(1.0 - 0.25 * square, 0.0) / np.maximum(square, _TINY))
    x, y = 0.5 * a + slope * b, 0.5 * b - slope * a
    chord = np.sqrt((1.0 - a) * (1.0 + a))
    angle = np.arctan2(a, chord)
    # From the moved straight edge to that point the upper circle and the lower moved one bound the
    # overlap, and beyond it, where it lies below the axis, the circle alone.
    crossed = 0.5 * (np.arctan2(x, y) + np.arctan2(x - a, b - y) + a * (b + y) - b * x)
    crossed = crossed - 0.5 * (a * chord + angle)
    segment = 0.5 * np.pi - (a * chord + angle)
    area = np.maximum(np.where(x > a, crossed, (y < 0.0) * segment), 0.0)
    return np.asarray(np.where(square == 0.0, 0.5 * np.pi, area) * radius**2)


# The lens that a disc and a moved disc have in common: its area, whole and within a band.
#
# Places count across and along the band, from the centre of the disc that rests; the moved one is
# at (across, along), neither negative.


@dataclass(frozen=True)
class Lens:
    """What a disc of radius `fixed` and one of radius `moved`, a lag away, have in common.

    `own` and `other` are half the angles that its two arcs take of their circles, `kite` is the lag
    times half the common chord, and `meet` is true where the circles cross or touch. Where one disc
    lies in the other at all of the lags, `nested`, they are not computed.
    """

    fixed: float
    moved: float
    meet: Mask
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

    def turned(self) -> "Lens":
        """The same with the radii exchanged."""
        arrays = self.meet, self.kite, self.other, self.own
        return Lens(self.moved, self.fixed, *arrays, self.nested)

    def chosen(self, points: Mask | tuple[slice, slice]) -> "Lens":
        """At some of the lags."""
        if self.nested:
            return self
        arrays = self.kite[points], self.own[points], self.other[points]
        return Lens(self.fixed, self.moved, self.meet[points], *arrays)


def lens(*, fixed: float, moved: float, square: Floats) -> Lens:
    """The lens of two discs, by the square of the distance of their centres.

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
    def at_rest(cls, across: Floats, along: Floats, square: Floats, half_width: float) -> "Band":
        """The band of a strip that rests, symmetric about the centre."""
        slope, tolerance = (2.0 * half_width) * along, half_width * square
        low, skew = -half_width, 0.5 * across
        return cls(across, along, low, half_width, skew, square, slope, tolerance)

    @classmethod
    def common(cls, across: Floats, along: Floats, square: Floats, half_width: float) -> "Band":
        """What a strip and its moved self have in common, of no width beyond twice `half_width`."""
        low = np.minimum(across - half_width, half_width)
        left = 0.5 * (half_width - low)
        slope, tolerance = (2.0 * left) * along, left * square
        return cls(across, along, low, half_width, None, square, slope, tolerance)


def half_chord(radius: float, place: Floats | float) -> Floats:
    """Half the chord of a circle at a distance from its centre, 0 beyond it."""
    return np.asarray(np.sqrt(np.maximum((radius - place) * (radius + place), 0.0)))


def half_segment(radius: float, place: Floats | float) -> Floats:
    """Integral of the half chord from the centre to a place."""
    t = np.minimum(np.maximum(place, -radius), radius)
    chord = half_chord(radius, t)
    # Not the arc sine: near the rim it would magnify the quotient's rounding.
    return np.asarray(0.5 * (t * chord + radius**2 * np.arctan2(t, chord)))


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
    def of(cls, band: Band, radius: float) -> "Cut":
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
    """Area of a lens within a band; absolute error about 1e-15 of a disc's.

    The lens may rest in the band's middle only if its own disc reaches that far; `cut` is its moved
    disc in the band. Where no tip of the lens lies in the band, the same circles bound it
    throughout: the area is a sum of segments, which depend on one component of the lag. Else it is
    the difference of what lies left of the band's two edges.
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


def _between_edges(part: Lens, band: Band, points: Mask) -> Floats:
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
    return np.asarray(0.5 * (twice + edge * np.maximum(length, 0.0)))
