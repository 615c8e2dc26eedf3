"""OTF of a pupil in angular frequency, for one wavelength or a band."""

import math
from collections.abc import Iterable, Iterator
from functools import partial
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Array, Floats, Mask
from core.errors import DataError
from core.physics.numerics import positive
from core.physics.optics.diffraction_otf import annular_defocus_otf
from core.physics.optics.overlap_area import (
    Band,
    Cut,
    Lens,
    annular_otf,
    half_chord,
    half_disc_overlap_area,
    half_segment,
    lens,
    lens_in_band,
)
from core.physics.optics.pupil_shapes import PupilShape, by_tiles, part_of, vane_direction
from core.physics.optics.strip_overlap import (
    Strip,
    StripPupil,
    strip_overlap_area,
    strip_pupil_area,
)
from core.physics.optics.wavefront import sampled_otf
from core.records import dataclass

# Overlap area of an annulus with strips that hide where they cross, as a sum over strips.
#
# With A the annulus and V the strips, which may meet nowhere in A,
#
#     A(1 − ΣV)·A'(1 − ΣV') = AA' − Σ AA'V − Σ AA'V' + ΣΣ AA'VV'
#
# where a dash is the moved one. The single sums are lenses within bands. In the double sum a strip
# and itself make a narrower band, two others a parallelogram that is nearly always whole or hidden.

Index = Mask | tuple[slice, slice]


def strips_add_up(*, pupil: StripPupil) -> bool:
    """Whether `strip_sum_area` holds for this pupil: its strips meet behind the obscuration only.

    Strips must be of one width, bars all or vanes all, and lie evenly about the centre.
    """
    half, hole = pupil.strips[0].high, pupil.inner_radius
    bars = pupil.symmetric
    if any(s.high != half or s.low != -half or s.half == bars for s in pupil.strips):
        return False
    if any(crossing.farthest > hole for crossing in _crossings(pupil)):
        return False
    if bars:
        return True
    if half >= hole:
        return False  # the blunt ends show
    inner, outer = (math.sqrt((r - half) * (r + half)) for r in (hole, pupil.radius))
    return 3.0 * inner >= hole and pupil.radius - inner <= outer + inner


def strip_sum_area(*, pupil: StripPupil, lag_x: Floats, lag_y: Floats) -> Floats:
    """Overlap area of a pupil for which `strips_add_up` with itself moved.

    Lags in its length unit have two axes, are nowhere both zero and broadcast: what depends on one
    of them alone is computed once. The absolute error is about 1e-15 of a disc's.
    """
    half, bars = pupil.strips[0].high, pupil.symmetric
    square = lag_x * lag_x + lag_y * lag_y
    rings = _rings(pupil, square)
    area = rings[0].area()
    for ring, count in zip(rings[1:], (-2.0, 1.0), strict=False):
        area += count * ring.area()
    twice = 2.0 if bars else 1.0  # the other vane's half is the same vane's for the opposite lag
    seen = [_components(strip, lag_x, lag_y) for strip in pupil.strips]
    for across, along in seen:
        n, t = np.abs(across), np.abs(along)
        area -= twice * _in_band(rings, Band.at_rest(n, t, square, half))
        near = _where(n < 2.0 * half, area.shape)
        if near is not None:
            n, t, apart = (_taken(coordinate, near) for coordinate in (n, t, square))
            common = Band.common(n, t, apart, half)
            some = [ring.chosen(near) for ring in rings]
            area[near] += _in_band(some, common) if bars else _beyond_hole(some, common, pupil)
    for crossing in _crossings(pupil):
        first, second = (seen[index][0] for index in crossing.pair)
        part, cut = crossing.overlap((second, first), same_side=not bars)
        if cut.any():
            part[cut] = _cut_area(pupil, crossing, cut, lag_x, lag_y)
        area += twice * part
    return np.maximum(area, 0.0)


def _cut_area(
    pupil: StripPupil, crossing: "Crossing", points: Mask, lag_x: Floats, lag_y: Floats
) -> Floats:
    """Area of the parallelogram of two strips in both annuli."""
    x, y = (np.broadcast_to(lag, points.shape)[points] for lag in (lag_x, lag_y))
    alone, other = (
        StripPupil(pupil.radius, pupil.inner_radius, _outside(pupil.strips[index], pupil.radius))
        for index in crossing.pair
    )
    return strip_overlap_area(pupil=alone, lag_x=x, lag_y=y, other=other)


def _outside(strip: Strip, radius: float) -> tuple[Strip, Strip]:
    far = 2.0 * radius
    return (
        Strip(strip.cos, strip.sin, strip.high, far, False),
        Strip(strip.cos, strip.sin, -far, strip.low, False),
    )


def _components(strip: Strip, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Across and along; a strip along an axis keeps arrays of one row or column as they are."""
    if strip.sin == 0.0:
        return strip.cos * y, strip.cos * x
    if strip.cos == 0.0:
        return -strip.sin * x, strip.sin * y
    return strip.across(x, y), strip.along(x, y)


Rings = list[Lens]
"""Annulus and moved annulus: the lens of outer discs, less two mixed ones, plus the inner."""


def _rings(pupil: StripPupil, square: Floats) -> Rings:
    """Lenses that some of the lags have."""
    radius, hole = pupil.radius, pupil.inner_radius
    nearest = math.sqrt(square.min())
    rings = [lens(fixed=radius, moved=radius, square=square)]
    if hole > 0.0 and nearest < radius + hole:
        rings.append(lens(fixed=radius, moved=hole, square=square))
    if hole > 0.0 and nearest < 2.0 * hole:
        rings.append(lens(fixed=hole, moved=hole, square=square))
    return rings


def _in_band(rings: Rings, band: Band) -> Floats:
    """Overlap in a band that rests, or in one and its moved self: then mixed ones are alike."""
    cut = Cut.of(band, rings[0].moved)
    area = lens_in_band(rings[0], band, cut)
    if len(rings) > 1:
        small = Cut.of(band, rings[1].moved)
        mixed = lens_in_band(rings[1], band, small)
        area -= 2.0 * mixed if band.skew is None else mixed
        if band.skew is not None:
            area -= lens_in_band(rings[1].turned(), band, cut)
    for inner in rings[2:]:
        area += lens_in_band(inner, band, small)
    return area


def _beyond_hole(rings: Rings, band: Band, pupil: StripPupil) -> Floats:
    """Overlap in a vane and its moved self: half the bars' without what lies between the holes."""
    half, hole = band.high, pupil.inner_radius
    reach = float(half_chord(hole, half))
    between = band.slope - 2.0 * (half_segment(hole, half) - half_segment(hole, band.low))
    for inner in rings[2:]:
        between = between + lens_in_band(inner, band, Cut.of(band, hole))
    area = _in_band(rings, band) - np.where(band.along > 2.0 * reach, between, 0.0)
    return np.where(band.along < pupil.radius - reach, 0.5 * area, 0.0)


def _where(wanted: Mask, shape: tuple[int, ...]) -> Index | None:
    """Rows and columns that hold the wanted points, or these alone where they depend on both."""
    if not wanted.any():
        return None
    if wanted.shape == shape:
        return wanted
    rows, columns = (np.flatnonzero(wanted.any(axis=axis)) for axis in (1, 0))
    one_row, one_column = (size == 1 for size in wanted.shape)
    return (
        slice(None) if one_row else slice(rows[0], rows[-1] + 1),
        slice(None) if one_column else slice(columns[0], columns[-1] + 1),
    )


def _taken(values: Floats, index: Index) -> Floats:
    if isinstance(index, tuple):
        return part_of(values, index)
    return np.broadcast_to(values, index.shape)[index]


def _crossings(pupil: StripPupil) -> "Iterator[Crossing]":
    for pair in combinations(range(len(pupil.strips)), 2):
        a, b = (pupil.strips[index] for index in pair)
        sin, cos = abs(a.cos * b.sin - a.sin * b.cos), abs(a.cos * b.cos + a.sin * b.sin)
        yield Crossing(pair, a.high, sin, cos, pupil.radius, pupil.inner_radius)


# The parallelogram in which two equal strips cross, and how much of it an annulus lets through.


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

    @property
    def extent(self) -> float:
        """How far it reaches along a strip from its centre."""
        return self.half * (1.0 + self.cos) / self.sin

    @property
    def farthest(self) -> float:
        """How far its corners are from its centre."""
        return math.hypot(self.extent, self.half)

    def overlap(self, across: tuple[Floats, Floats], *, same_side: bool) -> tuple[Floats, Mask]:
        """Area in both annuli of a strip's crossing with the moved other, and where none is known.

        The parallelogram's centre lies the lag's component across the second strip over the sine
        along the first one and, from the moved centre, likewise for the second. Circles of both
        annuli may cut the parallelogram: there the area is not known. `same_side` is for vanes:
        both signs must agree, else the one's half meets not the other's.
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
        area[met] = 4.0 * self.half**2 / self.sin
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


def geometric_pupil_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    shape: PupilShape,
    pitch_x_mm: float,
    pitch_y_mm: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a geometric pupil without wavefront error, exact.

    Parameters
    ----------
    xi, eta : array_like
        Angular frequencies across and along, cycles/mrad; they broadcast.
    shape : PupilShape
        The pupil, lengths in samples.
    pitch_x_mm, pitch_y_mm : float
        Size of one pupil sample; unequal ones turn circles into ellipses.
    wavelengths_um, weights : tuple of float
        Wavelengths of the band and their weights, which sum to 1.

    Returns
    -------
    ndarray of float64
        Σ w·γ(λ·xi/pitch_x, λ·eta/pitch_y), γ the normalised autocorrelation of the pupil.

    Source: Tantalo 1996, eqs. 4.13 to 4.19 (after Gaskill 1979), with λ in µm times cycles/mrad
    giving the lag in mm. Erratum: the cutoff 12.8 cycles/mrad of eq. 4.21 is that of the array's
    half width; the aperture's is its diameter over the wavelength.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    x_mm = positive("pitch_x_mm", pitch_x_mm, unit="mm")
    y_mm = positive("pitch_y_mm", pitch_y_mm, unit="mm")

    def at(wavelength: float) -> Array:
        return geometric_otf(shape, lag_x=wavelength * xi / x_mm, lag_y=wavelength * eta / y_mm)

    return _over_band(map(at, wavelengths_um), weights)


def circular_pupil_otf(
    *,
    rho: ArrayLike,
    diameter_mm: float,
    obscuration_ratio: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a disc or annulus without wavefront error at radial frequencies, cycles/mrad; exact.

    The band as of `geometric_pupil_otf`. Source: as there; Tantalo 1996, appendix E.
    """
    diameter = positive("diameter_mm", diameter_mm, unit="mm")

    def tile(rho: Array) -> Array:
        ratios = (wavelength * rho / diameter for wavelength in wavelengths_um)
        at = partial(annular_otf, obscuration_ratio=obscuration_ratio)
        return _over_band((at(frequency_ratio=ratio) for ratio in ratios), weights)

    return by_tiles(tile, np.asarray(rho, np.float64))


def defocused_disc_otf(
    *,
    rho: ArrayLike,
    diameter_mm: float,
    w20_waves: float,
    reference_um: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
) -> Array:
    """OTF of a clear circular pupil with defocus, at radial frequencies in cycles/mrad, exact.

    Real and signed; `w20_waves` is at the rim, in waves of the reference wavelength. The band as of
    `geometric_pupil_otf`. Source: as `annular_defocus_otf`.
    """
    rho = np.asarray(rho, np.float64)
    diameter = positive("diameter_mm", diameter_mm, unit="mm")
    reference = positive("reference_um", reference_um, unit="µm")

    def at(wavelength: float) -> Array:
        w20 = w20_waves * reference / wavelength
        return annular_defocus_otf(frequency_ratio=wavelength * rho / diameter, w20_waves=w20)

    return _over_band(map(at, wavelengths_um), weights)


def sampled_pupil_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    correlations: tuple[Array, ...],
    pitch_x_mm: float,
    pitch_y_mm: float,
    wavelengths_um: tuple[float, ...],
    weights: tuple[float, ...],
    interpolation: str,
    real: bool,
) -> Array:
    """OTF of a sampled pupil from its normalised autocorrelation.

    There is one for all wavelengths where there is no wavefront error (the OTF then depends on λ·xi
    only), else one for each wavelength. `interpolation` is "linear" or "bilinear"; `real` says that
    the pupil is real, and with it the OTF. Else as `geometric_pupil_otf`.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    if real:
        correlations = tuple(np.real(correlation) for correlation in correlations)
    return _over_band(
        (
            sampled_otf(
                correlations[min(index, len(correlations) - 1)],
                lag_x=wavelength * xi / pitch_x_mm,
                lag_y=wavelength * eta / pitch_y_mm,
                interpolation=interpolation,
            )
            for index, wavelength in enumerate(wavelengths_um)
        ),
        weights,
    )


def _over_band(otfs: Iterable[Array], weights: tuple[float, ...]) -> Array:
    """Weighted sum, in order: the weights then add up to exactly 1 at zero frequency."""
    total: Array | float = 0.0
    for otf, weight in zip(otfs, weights, strict=True):
        total = total + weight * otf
    return np.asarray(total)


# Exact OTF of a geometric exit pupil without wavefront error.


def geometric_otf(shape: PupilShape, *, lag_x: ArrayLike, lag_y: ArrayLike) -> Floats:
    """OTF of a geometric pupil: the overlap with itself moved, over its own area.

    Parameters
    ----------
    shape : PupilShape
        The pupil.
    lag_x, lag_y : array_like
        Lags across and along [samples], of either sign; they broadcast. For frequencies, wavelength
        times frequency over the size of a pupil sample.

    Returns
    -------
    ndarray
        Real OTF in [0, 1], even in either lag, exactly 1 at zero lag; absolute error near 1e-15.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-31; Tantalo 1996, eqs. 4.15 and
    4.16; closed form in arcs and chords.
    """
    x, y = (np.abs(np.asarray(lag, dtype=np.float64)) for lag in (lag_x, lag_y))
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(y))):
        raise DataError("the pupil's OTF was requested at a lag that is not finite")
    # In radii, and no further than beyond the diameter, so that no size overflows.
    x, y = (np.minimum(lag, 3.0 * shape.radius) / shape.radius for lag in (x, y))
    hole, strips = shape.inner_radius / shape.radius, _strips(shape)
    if strips:
        return _strip_otf(StripPupil(1.0, hole, strips), x, y)
    if shape.shape == "half_moon":
        return by_tiles(_half_disc_otf, x, y)
    return by_tiles(partial(_annular_otf, hole), x, y)


def _half_disc_otf(x: Floats, y: Floats) -> Floats:
    otf = half_disc_overlap_area(radius=1.0, lag_x=x, lag_y=y) / (0.5 * np.pi)
    return np.where((x == 0.0) & (y == 0.0), 1.0, np.minimum(otf, 1.0))


def _annular_otf(hole: float, x: Floats, y: Floats) -> Floats:
    return annular_otf(frequency_ratio=0.5 * np.sqrt(x * x + y * y), obscuration_ratio=hole)


def _strip_otf(pupil: StripPupil, x: Floats, y: Floats) -> Floats:
    whole = strip_pupil_area(pupil=pupil)
    if strips_add_up(pupil=pupil):
        return by_tiles(partial(_sum_otf, pupil, whole), x, y)
    x, y = np.broadcast_arrays(x, y)
    square = x * x + y * y
    otf = np.where(square == 0.0, 1.0, 0.0)
    apart = (square > 0.0) & (square < 4.0)
    area = strip_overlap_area(pupil=pupil, lag_x=x[apart], lag_y=y[apart])
    otf[apart] = np.minimum(area / whole, 1.0)
    return otf


def _sum_otf(pupil: StripPupil, whole: float, x: Floats, y: Floats) -> Floats:
    square = x * x + y * y
    if square.min() >= 4.0:
        return np.zeros(square.shape)
    area = strip_sum_area(pupil=pupil, lag_x=x, lag_y=y)
    otf = np.where(square < 4.0, np.minimum(area / whole, 1.0), 0.0)
    otf[square == 0.0] = 1.0
    return otf


def _strips(shape: PupilShape) -> tuple[Strip, ...]:
    """The shape's bar or vanes, for unit radius; opposite vanes are one bar."""
    if shape.bar_width > 0.0:
        half = shape.bar_width / (2.0 * shape.radius)
        return (Strip(0.0, 1.0, -half, half, False),)
    count = shape.vane_count
    half = shape.vane_width / (2.0 * shape.radius)
    paired = count % 2 == 0
    directions = [
        vane_direction(index=index, count=count) for index in range(count // 2 if paired else count)
    ]
    return tuple(Strip(cos, sin, -half, half, not paired) for cos, sin in directions)
