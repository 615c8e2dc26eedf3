"""Ridges of a picture's gradient: where steps may run, at sub-sample precision."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Index = NDArray[np.intp]
Picture = NDArray[np.floating]
Single = NDArray[np.float32]

SMOOTHING = 1.5  # samples, of the Gaussian whose derivative is taken
_STRIP = 512  # rows worked on at once
_MARGIN = 8  # rows beyond a strip that its results depend on
_BLOCK = 16  # samples, side of the blocks in which noise is looked at
_QUIET = 0.25  # share of the blocks taken as free of texture
_SHARE_OF_RANGE = 0.004  # of the picture's range, a step below which is no edge in any noise
_ABOVE_NOISE = 8.0


@dataclass(frozen=True)
class RidgePoints:
    """Places where the gradient is largest along its own direction.

    Parameters
    ----------
    x, y : ndarray
        Place, samples.
    column, row : ndarray of int
        The sample it belongs to.
    angle_deg : ndarray
        Direction of the gradient, towards brighter, in [0, 360).
    strength : ndarray
        Gradient of the smoothed picture, per sample.
    """

    x: Vector
    y: Vector
    column: Index
    row: Index
    angle_deg: Vector
    strength: Vector


def rough_noise(*, picture: Picture, missing: float = 0.0) -> float:
    """Standard deviation of a sample where the picture is quietest.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns).
    missing : float
        Share of them that have no noise, as they hold no data.

    Notes
    -----
    Source: Immerkær, Fast noise variance estimation, 1996, in blocks of 16 × 16 samples of which
    the quietest quarter is taken. Good enough for thresholds.
    """
    rows, columns = (side // _BLOCK * _BLOCK for side in picture.shape)
    if rows == 0 or columns == 0:
        return 0.0
    blocks = []
    for top in range(0, rows, _STRIP):
        part = picture[top : min(rows, top + _STRIP), :columns].astype(np.float64)
        second = part[:, :-2] - 2.0 * part[:, 1:-1] + part[:, 2:]
        wide = np.zeros(part.shape)
        wide[1:-1, 1:-1] = np.abs(second[:-2] - 2.0 * second[1:-1] + second[2:])
        shape = (part.shape[0] // _BLOCK, _BLOCK, columns // _BLOCK, _BLOCK)
        blocks.append(wide.reshape(shape).mean(axis=(1, 3)).ravel())
    scale = (_BLOCK / (_BLOCK - 1)) * math.sqrt(math.pi / 2.0) / 6.0
    return float(np.quantile(np.concatenate(blocks), missing + (1.0 - missing) * _QUIET)) * scale


def ridge_points(
    *,
    picture: Picture,
    noise_sigma: float,
    check: Callable[[], None] = lambda: None,
) -> RidgePoints:
    """Find the ridges of a picture's gradient.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite.
    noise_sigma : float
        Standard deviation of a sample.
    check : callable
        Called between strips; may raise to stop.

    Notes
    -----
    Source: Canny, A computational approach to edge detection, 1986: derivative of a Gaussian, and
    of its modulus the largest along its direction; a parabola through three places gives the
    place between samples. White noise gives that gradient a standard deviation of
    σ/(√(8π)·1.5²).
    """
    level = float(np.median(picture[:: max(1, picture.shape[0] // 256)]))
    low, high = np.quantile(picture[:: max(1, picture.shape[0] // 512)], [0.001, 0.999])
    least = _ABOVE_NOISE * noise_sigma / (math.sqrt(8.0 * math.pi) * SMOOTHING**2)
    least = max(least, _SHARE_OF_RANGE * float(high - low) / (SMOOTHING * math.sqrt(2 * math.pi)))
    if not least > 0.0:
        least = math.ulp(1.0)
    strips: list[RidgePoints] = []
    rows = picture.shape[0]
    for top in range(0, rows, _STRIP):
        check()
        first, last = max(0, top - _MARGIN), min(rows, top + _STRIP + _MARGIN)
        part = (picture[first:last] - level).astype(np.float32)
        found = _ridges(_slope(part), _slope(part.T).T, least)
        own = (found.row + first >= top) & (found.row + first < top + _STRIP)
        strips.append(
            RidgePoints(
                x=found.x[own],
                y=found.y[own] + first,
                column=found.column[own],
                row=found.row[own] + first,
                angle_deg=found.angle_deg[own],
                strength=found.strength[own],
            )
        )
    return RidgePoints(
        *(np.concatenate([getattr(strip, f.name) for strip in strips]) for f in fields(RidgePoints))
    )


def _slope(part: Single) -> Single:
    """Derivative along the rows of a part smoothed along both, level beyond its borders."""
    reach = math.ceil(3.0 * SMOOTHING)
    away = np.arange(reach + 1)
    bell = np.exp(-0.5 * (away / SMOOTHING) ** 2)
    smooth = bell / (2.0 * bell.sum() - bell[0])
    steps = away * bell / (2.0 * np.sum(away**2 * bell))
    rows, columns = part.shape
    tall = np.pad(part, ((reach, reach), (0, 0)), mode="edge")
    down = np.float32(smooth[0]) * part
    for k in range(1, reach + 1):
        pair = tall[reach - k : reach - k + rows] + tall[reach + k : reach + k + rows]
        down += np.float32(smooth[k]) * pair
    wide = np.pad(down, ((0, 0), (reach, reach)), mode="edge")
    slope = np.zeros_like(part)
    for k in range(1, reach + 1):
        pair = wide[:, reach + k : reach + k + columns] - wide[:, reach - k : reach - k + columns]
        slope += np.float32(steps[k]) * pair
    return slope


def _ridges(slope_x: Picture, slope_y: Picture, least: float) -> RidgePoints:
    """The ridges in a strip."""
    strength = np.hypot(slope_x, slope_y)
    inner = np.zeros(strength.shape, np.bool_)
    inner[2:-2, 2:-2] = strength[2:-2, 2:-2] > least
    row, column = np.nonzero(inner)
    here = strength[row, column]
    unit_x, unit_y = slope_x[row, column] / here, slope_y[row, column] / here
    before = _between(strength, row - unit_y, column - unit_x)
    after = _between(strength, row + unit_y, column + unit_x)
    ridge = (here >= before) & (here > after)
    row, column, unit_x, unit_y = row[ridge], column[ridge], unit_x[ridge], unit_y[ridge]
    here, before, after = here[ridge], before[ridge], after[ridge]
    curved = 2.0 * here - before - after
    off = np.clip(0.5 * (after - before) / np.maximum(curved, 1e-30), -0.7, 0.7)
    angle = np.degrees(np.arctan2(unit_y, unit_x)) % 360.0
    return RidgePoints(
        x=(column + off * unit_x).astype(np.float64),
        y=(row + off * unit_y).astype(np.float64),
        column=column,
        row=row,
        angle_deg=angle.astype(np.float64),
        strength=here.astype(np.float64),
    )


def _between(field: Picture, row: Vector, column: Vector) -> Vector:
    """Linear interpolation of a field."""
    top, left = np.floor(row).astype(np.intp), np.floor(column).astype(np.intp)
    down, right = row - top, column - left
    upper = field[top, left] * (1 - right) + field[top, left + 1] * right
    lower = field[top + 1, left] * (1 - right) + field[top + 1, left + 1] * right
    return np.asarray(upper * (1 - down) + lower * down, np.float64)
