"""Sampling of a frame in angle and in frequency, and the footprint of a detector element."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import positive, within
from core.physics.optics.sampled_otf import Complexes, autocorrelation

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

Floats = NDArray[np.float64]
# An edge that comes off by d moves the overlap by up to 2d per length and the pupil's own area by
# d; over all lags and the shapes of this library their quotient changes by at most 1.5 d per area.
_STRAIGHT_EDGE_FACTOR = 1.5
# Runs of a stair round a curve or a slant err independently; the largest error over all lags is
# below this many times the root of the sum of their squared lengths.
_STAIR_FACTOR = 1.2


def error_estimate(
    pupil: ArrayLike, *, correlation: Complexes, edge_uncertainty_samples: float = 0.5
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

    Notes
    -----
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


def _half_resolution_spread(samples: Complexes, correlation: Complexes) -> float:
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


def _curvature(correlation: Complexes) -> float:
    """Largest second difference across, over 8; the cusp on the axis is a node."""
    columns = correlation.shape[1]
    if columns < 5:
        return 0.0
    half = correlation[:, columns // 2 :]
    return float(np.max(np.abs(np.diff(half, n=2, axis=1)))) / 8.0
