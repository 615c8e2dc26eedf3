"""What differs over the field of a lens: illumination, microlenses, distortion, blur."""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.polynomial import polynomial as powers
from numpy.typing import ArrayLike, NDArray

from core import kernels
from core.arrays import Array
from core.physics.numerics import all_from_zero, positive, within
from core.physics.optics.blur import tabulated_mtf
from core.records import dataclass

# Relative illumination over the field of a lens: natural vignetting and measured curves.

Row = tuple[float, ...]


def relative_illumination(
    *,
    tangent: ArrayLike,
    natural: bool,
    scale: float | None = None,
    heights: Row = (),
    values: Row = (),
    coefficients: Row = (),
) -> NDArray[np.float64]:
    """Illumination of the focal plane, 1 on the axis.

    Parameters
    ----------
    tangent : array_like
        Tangent of the field angle, 0 or above.
    natural : bool
        Whether cos⁴ of the field angle is a factor.
    scale : float, optional
        Makes the height of the tangent: the focal length for mm. None: the height is the field
        angle in degrees.
    heights, values : tuple of float
        Measured curve, a monotone cubic (PCHIP) between its points; the heights rise from 0. Beyond
        the last point its value holds. Empty: none.
    coefficients : tuple of float
        c₁, c₂, … of a factor 1 + c₁h² + c₂h⁴ + …, h the height.

    Source: Kingslake 1983, Optical System Design, chapter 6 (cos⁴ law).
    """
    t = all_from_zero("tangent", tangent)
    light = 1.0 / np.square(1.0 + t * t) if natural else np.ones(t.shape)
    if heights or coefficients:
        height = np.degrees(np.arctan(t)) if scale is None else t * scale
        if heights:
            within = np.minimum(height, heights[-1])
            light *= tabulated_mtf(frequency=within, frequencies=heights, values=values)
        square = height * height
        light *= powers.polyval(square, (1.0, *coefficients))
    return np.asarray(light, np.float64)


# Response of a pixel behind its microlens, over the field.

MOST_DEG = 75.0


def microlens_response(
    *,
    tangent: ArrayLike,
    corner: float,
    chief_ray_deg: float,
    matched_deg: float,
    half_response_deg: float = 20.0,
    angles: Row = (),
    values: Row = (),
) -> NDArray[np.float64]:
    """Response to the chief ray, 1 where it meets the microlens as the pixel is made for.

    Both angles grow as rays from one point do: their tangents are in proportion to the height.
    The response is R(δ) of the angle δ between the ray and the one that the microlens is shifted
    for: half at `half_response_deg`, R = 2^(−(δ/δ_half)²), or a measured curve.

    Parameters
    ----------
    tangent : array_like
        Tangent of the field angle, 0 or above; the image height over the focal length.
    corner : float
        The same at the corner of the detector, above 0.
    chief_ray_deg, matched_deg : float
        Angle at the corner of the lens's chief ray, and of that for which the microlenses are
        shifted, from −75 to 75 degrees.
    half_response_deg : float
        Angle δ at which half of the response is left, degrees.
    angles, values : tuple of float
        Measured R over δ in degrees, which rises from 0: a monotone cubic (PCHIP). Beyond the last
        point its value holds. Empty: none.

    Source: Catrysse and Wandell 2002, J. Opt. Soc. Am. A 19, 1610 (pixel vignetting, and
    microlenses shifted for the chief ray).
    """
    height = all_from_zero("tangent", tangent) / positive("corner", corner)
    ray, lens = (
        np.arctan(height * math.tan(math.radians(within(name, angle, -MOST_DEG, MOST_DEG))))
        for name, angle in (("chief_ray_deg", chief_ray_deg), ("matched_deg", matched_deg))
    )
    apart = np.degrees(np.abs(ray - lens))
    if angles:
        apart = np.minimum(apart, angles[-1])
        return np.asarray(tabulated_mtf(frequency=apart, frequencies=angles, values=values))
    half = positive("half_response_deg", half_response_deg, unit="deg")
    return np.asarray(np.exp2(-np.square(apart / half)))


# Distortion of a lens: the rays that land at places of its picture, and samples along them.

_STEPS = 16  # of Newton; each doubles the digits, but for rays close to the fold
_RESIDUAL, _ENOUGH = 1e-11, 1e-14
_TAPS = np.arange(-3, 5)


@dataclass(frozen=True)
class Distortion:
    """Brown–Conrady or fisheye, as OpenCV defines them; all lengths are over the focal length.

    With x, y of the pinhole camera and r² = x² + y², `brown` has x' = x(1 + k₁r² + k₂r⁴ + k₃r⁶) +
    2p₁xy + p₂(r² + 2x²), y' = y(1 + …) + p₁(r² + 2y²) + 2p₂xy. `fisheye` has r' = θ(1 + k₁θ² + k₂θ⁴
    + k₃θ⁶ + k₄θ⁸), tan θ = r; with all k at 0 it is f-θ.

    Sources: Brown 1966, Photogrammetric Engineering 32, 444; Kannala and Brandt 2006, IEEE Trans.
    PAMI 28, 1335.
    """

    model: Literal["brown", "fisheye"]
    k: tuple[float, ...]
    p: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def odd(self) -> Array:
        """The polynomial r(1 + k₁r² + …), lowest power first."""
        odd = np.zeros(2 * len(self.k) + 2)
        odd[1], odd[3::2] = 1.0, self.k
        return odd

    @cached_property
    def fold(self) -> float:
        """Where it stops rising and the picture folds back; at most π/2 for an angle."""
        roots = powers.polyroots(powers.polyder(self.odd))
        real = roots[(np.abs(roots.imag) < 1e-9) & (roots.real > 0.0)].real
        most = math.inf if self.model == "brown" else 0.5 * math.pi
        return float(real.min(initial=most))

    def undistorted(self, x: Array, y: Array) -> tuple[Array, Array]:
        """The pinhole camera's places of the rays that land at x, y, by Newton's method.

        NaN where no ray lands: beyond the picture's fold.
        """
        with np.errstate(all="ignore"):  # what diverges is NaN at the end
            if self.model == "brown":
                return self._by_two(x, y)
            r = theta = np.hypot(x, y)
            slope = powers.polyder(self.odd)
            for _ in range(_STEPS):
                theta = np.clip(
                    theta - (powers.polyval(theta, self.odd) - r) / powers.polyval(theta, slope),
                    0,
                    2,
                )
            off = np.abs(powers.polyval(theta, self.odd) - r)
            theta = np.where((off < _RESIDUAL) & (theta < self.fold), theta, np.nan)
            share = np.where(r > 0.0, np.tan(theta) / r, 1.0)
            return x * share, y * share

    def _by_two(self, x: Array, y: Array) -> tuple[Array, Array]:
        u, v = x, y
        for _ in range(_STEPS):
            found_x, found_y, jxx, jxy, jyy = self._landed(u, v)
            a, b, det = x - found_x, y - found_y, jxx * jyy - jxy * jxy
            if max(np.abs(a).max(), np.abs(b).max()) < _ENOUGH:
                break
            u, v = u + (jyy * a - jxy * b) / det, v + (jxx * b - jxy * a) / det
        good = (np.hypot(a, b) < _RESIDUAL) & (np.hypot(u, v) < self.fold) & (det > 0.0)
        return np.where(good, u, np.nan), np.where(good, v, np.nan)

    def _landed(self, x: Array, y: Array) -> tuple[Array, Array, Array, Array, Array]:
        """x', y' and the derivatives dx'/dx, dx'/dy = dy'/dx, dy'/dy."""
        (p1, p2), u = self.p, x * x + y * y
        radial = powers.polyval(u, (1.0, *self.k))
        slope = 2.0 * powers.polyval(u, powers.polyder((1.0, *self.k)))
        return (
            x * radial + 2.0 * p1 * x * y + p2 * (u + 2.0 * x * x),
            y * radial + p1 * (u + 2.0 * y * y) + 2.0 * p2 * x * y,
            radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
            radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        )


def samples_at(*, picture: Array, x: Array, y: Array) -> Array:
    """A picture between its samples: Lagrange's polynomial of 8 samples along each axis.

    Columns x and rows y count from the middle of the first sample; only the part around them is
    read. Beyond the picture its outermost samples continue. A wave of f cycles/sample comes out
    displaced by less than 1e-3 sample up to f = 0.2, and its amplitude within 6e-4 up to f = 0.15.

    Source: Hamming 1986, Numerical Methods for Scientists and Engineers, chapter 14.
    """
    rows, columns = picture.shape
    x, y = np.clip(x, 0.0, columns - 1.0), np.clip(y, 0.0, rows - 1.0)
    left, top = np.floor(x).astype(np.intp), np.floor(y).astype(np.intp)
    first_x, first_y = left.min() + _TAPS[0], top.min() + _TAPS[0]
    read_x = np.clip(np.arange(first_x, left.max() + _TAPS[-1] + 1), 0, columns - 1)
    read_y = np.clip(np.arange(first_y, top.max() + _TAPS[-1] + 1), 0, rows - 1)
    part = picture[read_y[0] : read_y[-1] + 1][:, read_x[0] : read_x[-1] + 1]
    part = part[np.ix_(read_y - read_y[0], read_x - read_x[0])]
    across, along = (_weights(t).astype(picture.dtype) for t in (x - left, y - top))
    start = (top - first_y + _TAPS[0]) * part.shape[1] + (left - first_x + _TAPS[0])
    total = np.zeros(x.shape, picture.dtype)
    for row, weight in enumerate(along):
        line = np.zeros_like(total)
        for column, share in enumerate(across):
            line += share * part.take(start + (row * part.shape[1] + column), mode="clip")
        total += weight * line
    return total


def _weights(t: Array) -> Array:
    """Of the 8 samples around places t after the fourth, shape (8, …)."""
    away = [t - tap for tap in _TAPS]
    made = []
    for own, tap in enumerate(_TAPS):
        others = [index for index in range(len(_TAPS)) if index != own]
        scale = math.prod(int(tap - _TAPS[index]) for index in others)
        made.append(math.prod((away[index] for index in others), start=1.0 / scale))
    return np.stack(made)


# Blur that changes over the field, in overlapping tiles.
#
# The frame is parted into square cells. Each corner of a cell has the OTF of its place; within the
# cell the pictures blurred by these four are weighted bilinearly. So every sample has a PSF that is
# interpolated between the corners, with an error that falls with the square of the cell's side.
#
# Source: Nagy and O'Leary 1998, SIAM J. Sci. Comput. 19, 1063 (interpolated PSFs).


@dataclass(frozen=True)
class Cell:
    """Cells of one axis: samples `start` … `stop` − 1 lie between the nodes at `low` and `high`."""

    start: int
    stop: int
    low: float
    high: float

    @property
    def weights(self) -> tuple[Array, Array]:
        """Of the lower and the higher node, for each sample."""
        share = (np.arange(self.start, self.stop) - self.low) / (self.high - self.low)
        return 1.0 - share, share


def cells_of(*, size: int, tile: int) -> tuple[Cell, ...]:
    """Cells that cover `size` samples, `tile` samples wide and symmetric about the middle."""
    count = max(1, math.ceil((size - 1) / tile))
    first = 0.5 * (size - 1 - count * tile)
    nodes = [first + number * tile for number in range(count + 1)]
    starts = [0, *(math.ceil(node) for node in nodes[1:-1]), size]
    ends = zip(starts[:-1], starts[1:], nodes[:-1], nodes[1:], strict=True)
    return tuple(Cell(*end) for end in ends)


def field_frequencies(*, xi: Array, eta: Array, x: float, y: float) -> tuple[Array, Array]:
    """Frequencies across and along of a lens' data, at the place x, y of the field.

    The data belong to a place straight above the axis: their columns run across, their rows point
    to the axis. So the tangential frequency, along the radius, is the second one.
    """
    angle = math.atan2(x, -y) if x or y else 0.0
    cos, sin = math.cos(angle), math.sin(angle)
    return xi * cos + eta * sin, eta * cos - xi * sin


def blended(*, patch: Array, otfs: Sequence[Array], along: Cell, across: Cell, reach: int) -> Array:
    """A cell's samples, blurred by the OTFs at its corners, those of the upper ones first.

    The patch, of shape (n, n), begins `reach` samples before the cell; the OTFs are at the
    frequencies of its `rfft2`.
    """
    spectrum = kernels.rfft2(patch)
    weights = [np.multiply.outer(v, h) for v in along.weights for h in across.weights]
    rows, columns = weights[0].shape
    total = np.zeros((rows, columns), patch.dtype)
    for otf, weight in zip(otfs, weights, strict=True):
        made = kernels.irfft2(spectrum * otf, patch.shape)
        total += made[reach : reach + rows, reach : reach + columns] * weight.astype(patch.dtype)
    return total


def light_within(*, otf: Array, side: int, reach: int) -> float:
    """Share of a PSF's light that falls within `reach` samples along both axes."""
    psf = kernels.irfft2(otf, (side, side))
    near = np.abs(np.fft.fftfreq(side, 1.0 / side)) <= reach
    return float(psf[near][:, near].sum() / psf.sum())


def blending_error(*, otfs: Sequence[Array], own: Array, side: int, reach: int) -> float:
    """Limit of a sample's error that blends these OTFs alike, as a share of the picture's range.

    Half the sum of the moduli of the difference of the PSFs, and what of its own PSF lies beyond
    `reach` samples, which a patch of this side folds back. Both are seen through a mean of
    neighbours, 1/4, 1/2, 1/4: for pictures without detail at Nyquist's frequency.
    """
    means = [np.square(np.cos(np.pi * f)) for f in
             (np.fft.fftfreq(side), np.fft.rfftfreq(side))]  # fmt: skip
    smooth = np.multiply.outer(*means)
    mean = sum(otfs[1:], start=otfs[0]) / len(otfs)
    blend = kernels.irfft2((mean - own) * smooth, (side, side))
    spread = kernels.irfft2(own * smooth, (side, side))
    far = np.abs(np.fft.fftfreq(side, 1.0 / side)) > reach
    beyond = np.abs(spread[far[:, np.newaxis] | far]).sum()
    return float(0.5 * np.abs(blend).sum() + beyond)
