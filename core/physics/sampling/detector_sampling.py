"""Sampling of a frame in angle and in frequency, and the footprint of a detector element."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Complex, Floats, Index, Vector
from core.errors import DataError, ParameterError, several
from core.physics.numerics import mean_of_waves, positive, within
from core.physics.optics.wavefront import autocorrelation

# Far below any optics, and so far above the least number that frequencies have squares.
LEAST_FIELD_DEG = 1e-30


def interval_mrad(*, fov_deg: float, samples: int, name: str = "fov_deg") -> float:
    """Angle from one sample to the next, of a field of view from 1e-30° and below 180°.

    `name` is that of the parameter, for people.
    Source: Tantalo 1996, eq. 4.1: the angle itself is divided, not its tangent.
    """
    angle = positive(name, fov_deg, unit="deg")
    if not LEAST_FIELD_DEG <= angle < 180.0:
        allowed = f"at least {LEAST_FIELD_DEG:g} and below 180"
        raise ParameterError(name, fov_deg, allowed, unit="deg")
    return angle * (math.pi / 180.0) * 1000.0 / _count(samples)


def field_of_view_deg(*, pixels: int, pixel_mrad: float) -> float:
    """Field of view of a row or column of pixels behind a rectilinear lens: 2·atan(N·p/(2f)).

    A pixel's angle is pitch over focal length, that on the axis. N·p/f itself is 5° too wide at
    57°.

    Source: Holst 2008, Electro-Optical Imaging System Performance, chapter 2.
    """
    half = 0.5 * _count(pixels) * positive("pixel_mrad", pixel_mrad, unit="mrad") / 1000.0
    return math.degrees(2.0 * math.atan(half))


def nyquist_cyc_per_mrad(*, interval_mrad: float) -> float:
    """Highest frequency the samples carry: 1/(2·interval) (Tantalo 1996, eq. 4.2)."""
    return 0.5 / positive("interval_mrad", interval_mrad, unit="mrad")


def frequency_interval_cyc_per_mrad(*, interval_mrad: float, samples: int) -> float:
    """Step from one frequency to the next: 1/(samples·interval) (Tantalo 1996, eq. 4.3)."""
    return 1.0 / (positive("interval_mrad", interval_mrad, unit="mrad") * _count(samples))


def ifov_mrad(*, pitch_um: float, focal_length_mm: float, fill: float = 1.0) -> float:
    """Instantaneous field of view of one detector element: pitch·fill/focal length.

    The fill is the sensitive share of the pitch along this axis, above 0 and up to 1; 1 gives the
    plain IFOV, less the effective one.

    Source: Tantalo 1996, eqs. 4.41-4.42 (IFOV) and 4.48 (effective IFOV).
    """
    share = positive("fill", fill)
    if share > 1.0:
        raise ParameterError("fill", fill, "above 0 and up to 1")
    pitch = positive("pitch_um", pitch_um, unit="µm")
    return pitch / positive("focal_length_mm", focal_length_mm, unit="mm") * share


def _count(samples: int) -> int:
    if within("samples", samples, 1, 2**53) != int(samples):
        raise ParameterError("samples", samples, "a whole number, 1 or above")
    return int(samples)


# How far the OTF of a sampled pupil may be from that of the aperture it stands for.

# An edge that comes off by d moves the overlap by up to 2d per length and the pupil's own area by
# d; over all lags and the shapes of this library their quotient changes by at most 1.5 d per area.
_STRAIGHT_EDGE_FACTOR = 1.5
# Runs of a stair round a curve or a slant err independently; the largest error over all lags is
# below this many times the root of the sum of their squared lengths.
_STAIR_FACTOR = 1.2


def error_estimate(
    pupil: ArrayLike, *, correlation: Complex, edge_uncertainty_samples: float = 0.5
) -> float:
    """Estimate that covers the largest error of a sampled pupil's OTF over all lags.

    Parameters
    ----------
    pupil : array_like
        Amplitude transmission, real or complex, shape (rows, columns).
    correlation : ndarray
        Its raw autocorrelation, from `autocorrelation`.
    edge_uncertainty_samples : float
        How far the true edges along rows or columns may lie from the pixel borders: half a sample
        when nothing is known, 0 when the edges are the pixels' own.

    The sum of: straight edges along the grid, whose position is known to half a sample only (the
    largest term by far where there are any); stairs round curves and slants, which average out;
    what the samples of a wavefront miss, from the four half-resolution pupils; and the curvature
    between lags, as they are interpolated. A feature narrower than a sample may leave no trace in
    the samples: no estimate from them can cover its loss.
    """
    samples = np.asarray(pupil)
    samples = samples / np.max(np.abs(samples))
    area = float(np.sum(np.abs(samples) ** 2))
    runs = np.concatenate([_edge_runs(np.abs(samples)), _edge_runs(np.abs(samples).T)])
    # A circle's flat side runs for 2 sqrt(2 R) samples; what is longer is a straight edge.
    extent = float(np.max(np.ptp(np.argwhere(np.abs(samples) > 0.0), axis=0))) + 1.0
    straight = runs > 1.0 + 2.0 * np.sqrt(extent)
    edges = _STRAIGHT_EDGE_FACTOR * edge_uncertainty_samples * float(np.sum(runs[straight]))
    stairs = _STAIR_FACTOR * float(np.sqrt(np.sum(runs[~straight] ** 2)))
    total = (edges + stairs) / area
    if np.iscomplexobj(samples) and np.any(samples.imag):
        total += _half_resolution_spread(samples, correlation)
    total += _curvature(correlation) + _curvature(correlation.T)
    return min(total, 2.0)


def _edge_runs(amplitude: Floats) -> Floats:
    """Lengths of the unbroken stretches of pixel borders along rows that carry an edge."""
    steps = np.diff(np.pad(amplitude, ((1, 1), (1, 1))), axis=0)
    signs = np.sign(np.where(np.abs(steps) > 0.25, steps, 0.0)).ravel()
    ends = np.flatnonzero(np.diff(signs, prepend=0.0, append=0.0))
    lengths = np.diff(ends).astype(np.float64)
    return np.asarray(lengths[signs[ends[:-1]] != 0.0], dtype=np.float64)


def _half_resolution_spread(samples: Complex, correlation: Complex) -> float:
    """Largest difference at even lags from the pupil with every other row and column."""
    rows, columns = samples.shape
    largest = 0.0
    for first_row in range(min(2, rows)):
        for first_column in range(min(2, columns)):
            part = samples[first_row::2, first_column::2]
            if not np.any(part):
                return 2.0
            coarse = autocorrelation(part)
            reach_y, reach_x = (2 * (size // 2) for size in coarse.shape)
            fine = correlation[
                rows - 1 - reach_y : rows + reach_y : 2,
                columns - 1 - reach_x : columns + reach_x : 2,
            ]
            largest = max(largest, float(np.max(np.abs(fine - coarse))))
    return largest


def _curvature(correlation: Complex) -> float:
    """Largest second difference across, over 8; the cusp on the axis is a node."""
    columns = correlation.shape[1]
    if columns < 5:
        return 0.0
    half = correlation[:, columns // 2 :]
    return float(np.max(np.abs(np.diff(half, n=2, axis=1)))) / 8.0


# Transfer functions of resampling: means of pixels, and interpolation between them.


def block_mean_mtf(*, frequency: ArrayLike, interval_mrad: float, samples: int) -> Vector:
    """Mean of neighbouring samples, about the middle of the block.

    sin(πnfd)/(n·sin(πfd)) of n samples, signed, 1 at zero frequency.
    Source: Bracewell 1986, The Fourier Transform and Its Applications, the row of n impulses.
    """
    step = positive("interval_mrad", interval_mrad, unit="mrad")
    return mean_of_waves(np.asarray(frequency, np.float64) * step, samples)


def interpolation_mtf(
    *, frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> Vector:
    """Interpolation of `old` samples to `new` ones over the same field, the mean over these.

    Parameters
    ----------
    frequency : array_like
        Cycles/mrad.
    interval_mrad : float
        From one old sample to the next, above zero.
    order : 0, 1 or 3
        Nearest sample, linear, or cubic convolution with a = −1/2.
    old, new : int
        Numbers of samples, 1 or more. The new ones lie at new/gcd(old, new) different places
        between the old ones; of very many, this is the transform of the interpolating kernel.

    Returns
    -------
    ndarray
        Signed, 1 at zero frequency. The places are symmetric about the old samples, so that this
        is all, but where `takes_the_later` of two: there `interpolation_ptf` belongs to it.

    Source: Keys 1981, IEEE Trans. ASSP 29, for the cubic weights; Park and Schowengerdt 1982,
    Applied Optics 21, for the mean over the places of samples.
    """
    response = _mean_response(frequency, interval_mrad, order, old, new)
    if takes_the_later(order=order, old=old, new=new):
        return np.asarray(np.abs(response) * _sign(response, old, new), np.float64)
    return np.asarray(response.real, np.float64)


def interpolation_ptf(
    *, frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> Vector:
    """Phase of the same mean: 0 but for nearest samples that lie half-way between two.

    Radians, between −π and π. Of every second, fourth, … sample it is πf·interval: the picture
    moves by half an old sample to −x, and loses nothing of its contrast.
    """
    response = _mean_response(frequency, interval_mrad, order, old, new)
    if takes_the_later(order=order, old=old, new=new):
        return np.asarray(np.angle(response * _sign(response, old, new)), np.float64)
    return np.zeros(response.shape)


def takes_the_later(*, order: int, old: int, new: int) -> bool:
    """Whether nearest samples include some half-way between two old ones, of which one is taken."""
    # At (2k + 1)·old/new/2 a whole number, which takes an even number of old ones a place.
    return order == 0 and (old // math.gcd(old, new)) % 2 == 0


def _sign(response: NDArray[np.complex128], old: int, new: int) -> Vector:
    """Sign of the MTF: of the real part, but for a shift of all samples alike."""
    return np.where((response.real < 0.0) & (old % new != 0), -1.0, 1.0)


def _mean_response(
    frequency: ArrayLike, interval_mrad: float, order: int, old: int, new: int
) -> NDArray[np.complex128]:
    """Mean over the places of new samples of what a wave of unit amplitude shows there."""
    step = positive("interval_mrad", interval_mrad, unit="mrad")
    cycles = 2.0 * np.pi * np.asarray(frequency, np.float64) * step
    places = new // math.gcd(old, new)
    total = np.zeros(cycles.shape, np.complex128)
    for place in range(places):
        # Where the sample lies from the old one before it, in whole numbers of 1/(2·new).
        t = ((2 * place + 1) * old - new) % (2 * new) / (2 * new)
        for offset, weight in _weights(t, order):
            total += weight * np.exp(1j * cycles * (offset - t))
    return np.asarray(total / places)


def _weights(t: float, order: int) -> tuple[tuple[int, float], ...]:
    """Old samples, counted from the one before, and what each weighs at t from it."""
    if order == 0:
        return ((0 if t < 0.5 else 1, 1.0),)
    return ((0, 1.0 - t), (1, t)) if order == 1 else cubic_weights(t)


def cubic_weights(t: Any) -> tuple[tuple[int, Any], ...]:
    """Samples, counted from the one before a place, and their weights at t from it.

    Source: Catmull and Rom 1974; Keys 1981, IEEE Trans. ASSP 29, with a = −1/2.
    """
    return (
        (-1, t * (-0.5 + t * (1.0 - 0.5 * t))),
        (0, 1.0 + t * t * (-2.5 + 1.5 * t)),
        (1, t * (0.5 + t * (2.0 - 1.5 * t))),
        (2, t * t * (-0.5 + 0.5 * t)),
    )


# What samples made of other samples do to a wave, on average over where they lie.


def resampling_response(
    *,
    frequency: Vector,
    places: Vector,
    base: Index,
    further: Sequence[tuple[Index, Vector]],
    share: Vector | None = None,
) -> Vector:
    """Modulus of the mean response of samples made of others, 1 at zero.

    `frequency` is in cycles per old sample, and the new samples lie at `places` counted in old
    ones. Each starts from the old sample `base`; `further` adds weight·(old sample at index − old
    sample at base). All count alike in the mean, or by their `share`. Where new samples lie evenly
    between old ones it is the transform of the interpolation's kernel, sinc² if linear; the fewer
    their places, the more it may differ.

    The mean is what an edge shows that crosses samples at all their places: what differs from
    place to place averages out. Source: Park & Schowengerdt 1982, Image sampling, reconstruction,
    and the effect of sample-scene phasing, Applied Optics 21, 3142.
    """
    share = np.ones(len(base)) if share is None else share
    own = share.copy()
    total = np.zeros(len(frequency), np.complex128)
    for index, weight in further:
        own -= share * weight
        total += _waves(frequency, index - places) @ (share * weight)
    total += _waves(frequency, base - places) @ own
    return np.asarray(np.abs(total) / np.sum(share), np.float64)


def _waves(frequency: Vector, away: Vector) -> NDArray[np.complex128]:
    return np.asarray(np.exp(2j * np.pi * np.outer(frequency, away)), np.complex128)


def folded(frequency: Vector) -> Vector:
    """Cycles per sample between −1/2 and 1/2 at which samples show the same wave."""
    return np.asarray(frequency - np.rint(frequency), np.float64)


# Where pixels lie among the samples of a scene, and the shift of their picture.

_WHOLE = 1e-6  # of a pixel that may lack at the frame's end: ratios come of rounded data sheets


def pixel_count(*, samples: int, ratio: float) -> int:
    """Whole pixels of `ratio` samples, which need not be whole, that fit a frame.

    At least 1; a millionth of the last pixel may lie beyond the frame. Refused where not one fits.
    """
    count = math.floor(samples / positive("ratio", ratio) + _WHOLE)
    if count < 1:
        raise DataError(
            f"a pixel is {ratio:g} samples wide, but the frame has {several(samples, 'sample')}"
        )
    return count


def pixel_places(*, samples: int, ratio: float, offset: float = 0.0) -> Vector:
    """Middles of the pixels, counted in samples from the middle of the first sample.

    (m + 1/2 + offset)·ratio − 1/2, the offset in pixels. Without an offset, pixel m covers the same
    part of the frame as a block of samples, so that the picture does not move.
    """
    number = np.arange(pixel_count(samples=samples, ratio=ratio))
    return np.asarray((number + 0.5 + offset) * ratio - 0.5, np.float64)


def shifted_samples_ptf(*, frequency: ArrayLike, shift_mrad: float) -> Vector:
    """Phase of samples that lie `shift_mrad` further to +x than they are taken for.

    2π·frequency·shift, radians: the picture moves to −x. By the shift theorem.
    """
    return np.asarray(2.0 * np.pi * shift_mrad * np.asarray(frequency, np.float64), np.float64)
