"""Blur by Gaussians, by stray light, by measured tables and by point spread functions."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Array
from core.errors import DataError, ParameterError
from core.kernels import special
from core.physics.numerics import all_from_zero, gauss_legendre, non_negative, positive, within
from core.records import dataclass

# Gaussian blur: optics, random line-of-sight jitter and a turbulent blur spot.


def gaussian_mtf(*, frequency: ArrayLike, sigma_mrad: float) -> NDArray[np.float64]:
    """MTF of a Gaussian blur along one axis, or of a round one against radial frequency.

    Parameters
    ----------
    frequency : array_like
        Frequencies in cycles/mrad, any shape, finite.
    sigma_mrad : float
        Standard deviation of the blur spot in mrad, zero or above.

    Returns
    -------
    ndarray of float64
        exp(−2π²σ²·frequency²), of the shape of `frequency`.

    Source: Tantalo 1996, eqs. 4.22 and 4.36. Erratum: eq. 4.36 calls σ² the variance and takes
    it in µrad; here σ is in mrad, as the frequencies are per mrad.
    """
    sigma = non_negative("sigma_mrad", sigma_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = sigma * np.asarray(frequency, dtype=np.float64)
        return np.asarray(np.exp(-2.0 * math.pi**2 * np.square(turns)), dtype=np.float64)


def fwhm_to_sigma_mrad(*, fwhm_mrad: float) -> float:
    """Standard deviation of a Gaussian by its full width at half maximum: FWHM/(2·√(2·ln 2)).

    Source: definition of the normal density. Erratum: the width parameter of Tantalo 1996,
    eqs. 4.8-4.9, is damaged in print; this is the relation they stand for.
    """
    width = non_negative("fwhm_mrad", fwhm_mrad, unit="mrad")
    return width / (2.0 * math.sqrt(2.0 * math.log(2.0)))


# Stray light of a lens as a wide second part of its point spread function.

_MANY = 300.0  # 2π × cycles/rad, from which the part beyond the horizon is a short series
_TERMS, _NODES = 4, 900


def veiling_glare_mtf(*, rho: ArrayLike, share: float, length_mrad: float) -> NDArray[np.float64]:
    """MTF of a lens that spreads a share of its light widely.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad, 0 or above.
    share : float
        Of the light that is spread, 0 to 1.
    length_mrad : float
        Length ℓ of the spread ℓ/(2π(r² + ℓ²)^(3/2)), above 0; half of it falls within √3·ℓ.

    Returns
    -------
    ndarray
        1 − g + g·e^(−2πℓρ), of the shape of `rho`; 1 at 0.

    Source: Bracewell 2000, The Fourier Transform and Its Applications, Hankel transforms.
    """
    frequency = all_from_zero("rho", rho)
    spread = within("share", share, 0.0, 1.0)
    length = positive("length_mrad", length_mrad, unit="mrad")
    with np.errstate(under="ignore"):
        return np.asarray(1.0 + spread * np.expm1(-2.0 * np.pi * length * frequency))


def harvey_scatter(*, b_per_sr: float, s: float, l_mrad: float) -> float:
    """Share of the light that a surface scatters into the half space, refused above 1.

    Parameters
    ----------
    b_per_sr : float
        BSDF at no angle, 0 or above.
    s : float
        Slope of the BSDF far from there, −5 to 0.
    l_mrad : float
        Shoulder: sine of the angle at which it begins to fall, above 0 and up to 1000.

    Returns
    -------
    float
        2π∫b·[1 + (β/l)²]^(s/2)·β dβ from 0 to 1.

    Source: Harvey and Shack 1978, Applied Optics 17, 3003; Stover 2012, Optical Scattering, section
    4.5.
    """
    b = non_negative("b_per_sr", b_per_sr, unit="1/sr")
    slope, length = within("s", s, -5.0, 0.0), positive("l_mrad", l_mrad, unit="mrad") / 1e3
    within("l_mrad", l_mrad, 0.0, 1000.0, unit="mrad")
    log, rest = math.log1p(length**-2), 0.5 * slope + 1.0
    total = math.pi * b * length**2 * (math.expm1(rest * log) / rest if rest else log)
    if total > 1.0:
        raise ParameterError(
            "b_per_sr",
            b,
            f"the total integrated scatter would be {total:.3g}, above 1; lower this value",
        )
    return total


def harvey_mtf(
    *, rho: ArrayLike, b_per_sr: float, s: float, l_mrad: float, surfaces: int = 1
) -> NDArray[np.float64]:
    """MTF of surfaces that scatter by Harvey's law, between the direct light and its tail.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad, 0 or above; angles and their sines are taken alike.
    b_per_sr, s, l_mrad
        As for `harvey_scatter`.
    surfaces : int
        Alike, one behind the other.

    Returns
    -------
    ndarray
        (1 − T + T·S)ⁿ: T is the scatter, S the Hankel transform of the BSDF up to the horizon over
        its value at 0, within 1e-7.

    Source: Harvey and Shack 1978; DLMF 10.22.46 (without the horizon); by parts beyond it.
    """
    share = harvey_scatter(b_per_sr=b_per_sr, s=s, l_mrad=l_mrad)
    k = 2e3 * np.pi * all_from_zero("rho", rho)
    length, near = l_mrad / 1e3, k < _MANY
    spread = np.empty(k.shape)
    spread[near] = _by_sum(k[near], s, length)
    spread[~near] = _by_series(k[~near], s, length)
    spread *= 2.0 * np.pi * b_per_sr
    return np.asarray(np.where(k > 0.0, (1.0 - share + spread) ** surfaces, 1.0))


def _by_sum(k: NDArray[np.float64], s: float, length: float) -> NDArray[np.float64]:
    """∫[1 + (β/l)²]^(s/2)·J₀(kβ)·β dβ from 0 to 1, by Gauss and Legendre in asinh(β/l)."""
    nodes, weights = gauss_legendre(_NODES)
    end = math.asinh(1.0 / length)
    t = 0.5 * end * (nodes + 1.0)
    beta = length * np.sinh(t)
    parts = 0.5 * end * weights * beta * length * np.cosh(t) ** (s + 1.0)
    return np.asarray(special("j0")(np.multiply.outer(k, beta)) @ parts, np.float64)


def _by_series(k: NDArray[np.float64], s: float, length: float) -> NDArray[np.float64]:
    """The same of large k: the integral to infinity, less the part beyond the horizon."""
    order = -0.5 * s - 1.0
    with np.errstate(under="ignore"):
        whole = special("kv")(order, k * length) * (0.5 * k / length) ** order
        whole *= length ** (-s) * special("rgamma")(order + 1.0)
    before, bessel = special("j0")(k), special("j1")(k)
    height, beyond = (1.0 + length**-2) ** (0.5 * s), np.zeros(k.shape)
    for n in range(_TERMS):
        beyond += height * bessel / k ** (n + 1)
        before, bessel = bessel, 2.0 * (n + 1) / k * bessel - before
        height *= -(s - 2.0 * n) / (1.0 + length**2)
    return np.asarray(whole + beyond, np.float64)


# MTF and PTF of a table of points: monotone between them, nothing beyond the last.

Column = tuple[float, ...]
ROUNDED = 1e-3  # by which a table's MTF(0) may differ from 1: three decimals, as tables have
_SLACK = 1e-12  # of the last frequency: one in another unit is the last one too


def tabulated_mtf(*, frequency: ArrayLike, frequencies: Column, values: Column) -> Array:
    """MTF of a table: monotone cubic between its points, 0 beyond the last.

    Parameters
    ----------
    frequency : array_like
        Frequencies of either sign, in the unit of the table.
    frequencies, values : tuple of float
        Those of the table, from 0, rising, and the MTF at them.

    Notes
    -----
    Piecewise cubic Hermite interpolation (PCHIP) with the slopes of Fritsch and Butland 1984, SIAM
    J. Sci. Stat. Comput. 5, 300: no overshoot, and monotone where the table is. Even in frequency.
    """
    place = np.abs(np.asarray(frequency, np.float64))
    return _interpolated(place, frequencies, values)


def radial_tabulated_mtf(*, rho: ArrayLike, frequencies: Column, values: Column) -> Array:
    """MTF of a table against the radial frequency; arguments and errors of `tabulated_mtf`."""
    return tabulated_mtf(frequency=rho, frequencies=frequencies, values=values)


def tabulated_ptf(*, frequency: ArrayLike, frequencies: Column, values: Column) -> Array:
    """PTF of a table in radians, odd in frequency as that of every real spread function.

    Parameters, interpolation and errors as of `tabulated_mtf`, the first value 0.
    """
    signed = np.asarray(frequency, np.float64)
    phase = np.sign(signed) * _interpolated(np.abs(signed), frequencies, values)
    return np.asarray(phase, np.float64)


def from_zero(
    frequencies: Column, values: Column, *, at_zero: float, normalised: bool = False
) -> tuple[Column, Column]:
    """A table, rising in frequency, of which the first point is at frequency 0.

    `at_zero` is what the function is there by its definition: 1 of an MTF, 0 of a PTF. A table that
    begins above 0 gets that point; one that is within 0.001 of it there, it exactly. `normalised`
    divides by the first value, which has to be at frequency 0.
    """
    if frequencies[0] > 0.0:
        if normalised:
            raise DataError(
                f"the table begins at frequency {frequencies[0]:g}, so there is no value at 0 "
                "to normalise by"
            )
        return (0.0, *frequencies), (at_zero, *values)
    if normalised:
        if not values[0] > 0.0:
            raise DataError(
                f"the table has {values[0]:g} at frequency 0, so it cannot be normalised"
            )
        values = tuple(value / values[0] for value in values)
    if abs(values[0] - at_zero) > ROUNDED:
        advice = ". Correct the table, or set normalise = at_zero" if at_zero else ""
        raise DataError(
            f"the table has {values[0]:g} at frequency 0; allowed: {at_zero:g} ± "
            f"{ROUNDED:g}{advice}"
        )
    return frequencies, (at_zero, *values[1:])


def _interpolated(place: Array, frequencies: Column, values: Column) -> Array:
    knots, heights, slopes = _table(frequencies, values)
    inside = np.minimum(place, knots[-1])
    index = np.clip(np.searchsorted(knots, inside, side="right") - 1, 0, len(knots) - 2)
    width = knots[index + 1] - knots[index]
    share = (inside - knots[index]) / width
    rest = 1.0 - share
    result = heights[index] * (1.0 + 2.0 * share) * rest * rest
    result += heights[index + 1] * share * share * (3.0 - 2.0 * share)
    result += width * share * rest * (slopes[index] * rest - slopes[index + 1] * share)
    result = np.where(place > knots[-1] * (1.0 + _SLACK), 0.0, result)
    return np.asarray(np.where(place == 0.0, heights[0], result), np.float64)


@lru_cache(maxsize=64)
def _table(frequencies: Column, values: Column) -> tuple[Array, Array, Array]:
    knots, heights = np.array(frequencies, np.float64), np.array(values, np.float64)
    steps = np.diff(knots)
    if len(knots) != len(heights) or len(knots) < 2 or knots[0] != 0.0 or not np.all(steps > 0.0):
        raise DataError(
            "an MTF table needs two or more frequencies that rise from 0, each with a value"
        )
    return knots, heights, monotone_slopes(steps, np.diff(heights) / steps)


def monotone_slopes(steps: Array, secants: Array) -> Array:
    """Slopes at the knots of a monotone cubic, from the intervals' widths and secants.

    Within: the harmonic mean of the secants on both sides, weighted by the widths, and 0 at an
    extremum. At an end: the parabola's of three points, limited so that nothing overshoots.
    """
    if len(secants) == 1:
        return np.repeat(secants, 2)
    before, after = secants[:-1], secants[1:]
    one, other = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    alike = (np.sign(before) == np.sign(after)) & (before != 0.0)
    safe = np.where(alike, before, 1.0), np.where(alike, after, 1.0)
    inner = np.where(alike, (one + other) / (one / safe[0] + other / safe[1]), 0.0)
    first = _end_slope(steps[0], steps[1], secants[0], secants[1])
    last = _end_slope(steps[-1], steps[-2], secants[-1], secants[-2])
    return np.concatenate([[first], inner, [last]])


def _end_slope(step: float, next_step: float, secant: float, next_secant: float) -> float:
    slope = ((2.0 * step + next_step) * secant - step * next_secant) / (step + next_step)
    if np.sign(slope) != np.sign(secant):
        return 0.0
    if np.sign(secant) != np.sign(next_secant) and abs(slope) > 3.0 * abs(secant):
        return 3.0 * secant
    return float(slope)


# OTF of a sampled point spread function: its own Fourier sum at any frequencies.

_NYQUIST_SLACK = 1e-12  # of the samples' Nyquist frequency, which counts as within
_PAIRS = 1 << 20  # complex numbers held at a time where frequencies come in pairs


@dataclass(frozen=True)
class PointSpread:
    """A point spread function whose samples sum up to 1, shape (rows, columns), row 0 at the top.

    `column`, `row` are where the point is, counted from the first sample and between samples if
    need be; the centroid is its centre of gravity, likewise. `total` is the sum of the samples as
    they were.
    """

    weights: NDArray[np.float64]
    column: float
    row: float
    centroid_column: float
    centroid_row: float
    total: float

    @classmethod
    def of(
        cls, samples: ArrayLike, *, background: float = 0.0, keep_centroid: bool = True
    ) -> "PointSpread":
        """Normalise samples, less a background; noise may make some negative.

        `keep_centroid`: whether the point is at the middle of the array, so that a centroid beside
        it shifts a picture; else it is at the centroid, and nothing is shifted.
        """
        values = np.asarray(samples, np.float64) - background
        if values.ndim != 2 or values.size == 0:
            raise DataError(
                f"a point spread function has shape {values.shape}; it must be two-dimensional "
                "(rows, columns) and not empty"
            )
        total = float(values.sum())
        # Of noise about 0 the sum is rounding and chance, by which nothing can be divided.
        if not total > 1e-6 * float(np.abs(values).sum()):
            raise DataError(
                f"the samples of a point spread function, minus a background of {background:g}, "
                f"sum to {total:g}; allowed: above 0"
            )
        weights = values / total
        rows, columns = weights.shape
        column = float(weights.sum(axis=0) @ np.arange(columns))
        row = float(weights.sum(axis=1) @ np.arange(rows))
        x, y = ((columns - 1) / 2, (rows - 1) / 2) if keep_centroid else (column, row)
        return cls(weights, x, y, column, row, total)


def sampled_psf_otf(
    *, xi: ArrayLike, eta: ArrayLike, psf: PointSpread, pitch_x_mrad: float, pitch_y_mrad: float
) -> Array:
    """OTF of a sampled point spread function, by its exact sum.

    Parameters
    ----------
    xi, eta : array_like
        Angular frequencies across and along, cycles/mrad; they broadcast, soonest as one row and
        one column.
    pitch_x_mrad, pitch_y_mrad : float
        From one sample to the next.

    Returns
    -------
    ndarray of complex128
        Σ w·exp(−2πi(xi·x + eta·y)), x to the right and y downwards from the point: a tail to the
        right makes tails to the right. Exactly 1 at frequency 0. Beyond the Nyquist frequency of
        the samples, where the sum only repeats itself, 0: a function sampled finely enough has
        nothing there.

    Source: Goodman 2005, Introduction to Fourier Optics, eq. 6-26 (OTF as the normalised transform
    of the point spread function); Shannon's theorem.
    """
    xi, eta = np.asarray(xi, np.float64), np.asarray(eta, np.float64)
    x_mrad = positive("pitch_x_mrad", pitch_x_mrad, unit="mrad")
    y_mrad = positive("pitch_y_mrad", pitch_y_mrad, unit="mrad")
    rows, columns = psf.weights.shape
    x = x_mrad * (np.arange(columns) - psf.column)
    y = y_mrad * (np.arange(rows) - psf.row)
    if xi.ndim == eta.ndim == 2 and xi.shape[0] == eta.shape[1] == 1:
        # Rows first: they come in blocks, and the columns' waves are then few.
        otf = (_waves(eta[:, 0], y) @ psf.weights) @ _waves(x, xi[0])
    else:
        shape = np.broadcast_shapes(xi.shape, eta.shape)
        across, along = (np.broadcast_to(one, shape).ravel() for one in (xi, eta))
        otf = np.empty(across.size, np.complex128)
        step = max(1, _PAIRS // (rows + columns))
        for start in range(0, across.size, step):
            part = slice(start, start + step)
            sums = _waves(along[part], y) @ psf.weights
            otf[part] = np.sum(sums * _waves(across[part], x), axis=1)
        otf = otf.reshape(shape)
    known = (np.abs(xi) <= (0.5 + _NYQUIST_SLACK) / x_mrad) & (
        np.abs(eta) <= (0.5 + _NYQUIST_SLACK) / y_mrad
    )
    otf = np.where(known, otf, 0.0)
    return np.asarray(np.where((xi == 0.0) & (eta == 0.0), 1.0, otf), np.complex128)


def edge_share(psf: PointSpread) -> float:
    """Energy that a pedestal as high as the border's mean would have, a share of the whole.

    Of an aperture's diffraction pattern it is about the energy beyond the border: both fall with
    its distance.
    """
    weights = psf.weights
    border = np.concatenate([weights[0], weights[-1], weights[1:-1, 0], weights[1:-1, -1]])
    return float(abs(border.mean()) * weights.size)


def coarseness(psf: PointSpread) -> float:
    """Largest modulus of the OTF at the samples' Nyquist frequencies across and along.

    Above 0 the function has finer detail than its samples, which alias.
    """
    rows, columns = psf.weights.shape
    across = psf.weights.sum(axis=0) @ (-1.0) ** np.arange(columns)
    along = psf.weights.sum(axis=1) @ (-1.0) ** np.arange(rows)
    return float(max(abs(across), abs(along)))


def _waves(one: Array, other: Array) -> Array:
    return np.asarray(np.exp(-2j * np.pi * np.multiply.outer(one, other)), np.complex128)
