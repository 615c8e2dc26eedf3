"""MTF from the spread of a slanted edge or line (ISO 12233:2023), with its standard error."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.edges.clipping import why_clipped
from core.physics.measurement.edges.edge_line import EdgeLine, Target, edge_line
from core.physics.measurement.edges.edge_spread import (
    BINS_PER_SAMPLE,
    EdgeSpread,
    bin_response,
    edge_spread,
    reach,
)
from core.physics.numerics import sinc

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]
Window = Literal["tukey", "hamming", "none"]

_GROUPS = 24  # of rows, each left out once for the standard error


@dataclass(frozen=True)
class SlantedEdge:
    """MTF measured from a slanted edge."""

    frequency: Vector  # cycles per sample along the edge's normal
    # modulus, 1 at zero, and its standard error
    mtf: Vector
    error: Vector
    replicas: Matrix  # modulus without each group of rows, shape (groups, frequencies)
    # the edge, and its supersampled spread
    line: EdgeLine
    spread: EdgeSpread


def slanted_edge(
    *,
    picture: Matrix,
    frequency: Vector,
    target: Target = "edge",
    window: Window = "tukey",
    check: Callable[[], None] = lambda: None,
) -> SlantedEdge:
    """Measure the MTF across an edge, or line, that runs slanted down a picture.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite, of a size near 1: squares are taken.
    frequency : ndarray
        Cycles per sample along the edge's normal, from zero to 1.
    target : {'edge', 'line'}
        Of a line the width is part of what is measured.
    window : {'tukey', 'hamming', 'none'}
        Weight of the line spread: flat over the middle half, or Hamming's.

    Returns
    -------
    SlantedEdge
        MTF, and its standard error by leaving out every 24th row (jackknife).

    Raises
    ------
    DataError
        If there is no edge that can be measured; the message states why.

    Notes
    -----
    Source: ISO 12233:2023. The responses of the bins (`bin_response`) and of the central
    difference, sinc(f/2), are divided out. Frequency is that along the normal: along a row
    the edge is stretched by 1/cos of its angle.
    """
    line = edge_line(picture=picture, target=target)
    bins = reach(line=line, columns=picture.shape[1])
    spread = edge_spread(picture=picture, line=line, bins=bins)
    check_spread(picture=picture, line=line, spread=spread, target=target)
    # Leaving out rows turns the line too little to be worth a cosine of its own.
    along_row = frequency * math.cos(math.atan(line.slope))
    waves = _waves(along_row, len(spread_to_line(spread=spread, target=target)))
    whole = _transform(spread, along_row, waves, target, window)
    group = np.arange(line.rows) % min(_GROUPS, line.rows // 2)
    replicas = np.empty((int(group.max()) + 1, len(frequency)), np.complex128)
    for left_out in range(len(replicas)):
        check()
        chosen_rows = group != left_out
        other = line.without(~chosen_rows)
        part = edge_spread(picture=picture, line=other, bins=bins, rows=chosen_rows)
        replicas[left_out] = _transform(part, along_row, waves, target, window)
    error = modulus_error(whole=whole, replicas=replicas)
    return SlantedEdge(frequency, np.abs(whole), error, np.abs(replicas), line, spread)


def _waves(along_row: Vector, bins: int) -> Complex:
    """Waves of these frequencies at the middles of so many bins about the edge."""
    away = (np.arange(bins) - (bins - 1) / 2) / BINS_PER_SAMPLE
    return np.asarray(np.exp(-2j * np.pi * np.outer(along_row, away)), np.complex128)


def _transform(
    spread: EdgeSpread, along_row: Vector, waves: Complex, target: Target, window: Window
) -> Complex:
    """Transform of a supersampled spread, 1 at zero, without the responses of its making."""
    line_spread = spread_to_line(spread=spread, target=target)
    place = np.linspace(-1.0, 1.0, len(line_spread))
    weighted = line_spread * window_weight(place=place, window=window)
    transform = waves @ weighted / float(np.sum(weighted))
    response = bin_response(frequency=along_row, variance=spread.variance)
    if target == "edge":
        response = response * sinc(2.0 * along_row / BINS_PER_SAMPLE)
    return np.asarray(transform / response, np.complex128)


def spread_to_line(*, spread: EdgeSpread, target: Target) -> Vector:
    """Line spread: the edge's central differences, or the line less what is beside it."""
    values = spread.values
    if target == "edge":
        return np.asarray((values[2:] - values[:-2]) / 2.0, np.float64)
    left, right = spread.levels
    return np.asarray(values - np.linspace(left, right, len(values)), np.float64)


def window_weight(*, place: Vector, window: Window) -> Vector:
    """Weight at places from −1 to 1, the ends of the line spread."""
    if window == "none":
        return np.ones_like(place)
    if window == "hamming":
        return np.asarray(0.54 + 0.46 * np.cos(np.pi * place), np.float64)
    outside = np.clip(2.0 * np.abs(place) - 1.0, 0.0, 1.0)
    return np.asarray(np.cos(np.pi / 2.0 * outside) ** 2, np.float64)


def modulus_error(*, whole: Complex, replicas: Complex) -> Vector:
    """Standard error of a modulus, from replicas each made without one of equal groups of rows.

    Notes
    -----
    Jackknife (Efron 1982). Noise square to the transform lengthens it: |H + i·n| is longer than
    |H| by n²/(2|H|), at most n, which is no scatter but an error all the same, and is added, for
    an |H| that is three errors less than what was measured.
    """
    modulus = np.abs(whole)
    aligned = replicas * np.where(modulus > 0.0, np.conj(whole) / np.maximum(modulus, 1e-300), 1.0)
    along = jackknife_error(replicas=aligned.real)
    across = jackknife_error(replicas=aligned.imag)
    least = np.maximum(modulus - 3.0 * along, 0.0)
    longer = across * np.minimum(1.0, across / np.maximum(2.0 * least, 1e-300))
    return np.asarray(np.hypot(along, longer), np.float64)


def jackknife_error(*, replicas: Matrix) -> Vector:
    """Standard error from values each made without one of equal groups, shape (groups, …)."""
    groups = len(replicas)
    away = replicas - np.mean(replicas, axis=0)
    return np.asarray(np.sqrt((groups - 1) / groups * np.sum(away**2, axis=0)), np.float64)


def falls_to(*, frequency: Vector, mtf: Vector, level: float) -> float | None:
    """Lowest frequency at which the MTF falls to a level, linear between points; None if none."""
    below = np.flatnonzero(mtf <= level)
    if len(below) == 0 or below[0] == 0:
        return None
    k = int(below[0])
    share = (mtf[k - 1] - level) / (mtf[k - 1] - mtf[k])
    return float(frequency[k - 1] + share * (frequency[k] - frequency[k - 1]))


# Reasons not to trust the spread of an edge, given instead of a wrong MTF.

_UNSETTLED = 0.02  # share of the contrast by which a side's level may still change
_CUT_BY_WINDOW = 0.02  # share of the step outside the window's level half


def check_spread(*, picture: Matrix, line: EdgeLine, spread: EdgeSpread, target: Target) -> None:
    """Refuse an edge that is not one, does not settle in the region, or is clipped."""
    values = spread.values
    left, right = spread.levels
    height = abs(right - left) if target == "edge" else _line_height(spread)
    count = picture.shape[0] / (BINS_PER_SAMPLE + abs(line.slope))
    error = spread.noise / np.sqrt(max(1.0, count))  # of one bin
    if height < 0.5 * float(np.ptp(values)) or height < 5.0 * error:
        raise DataError(
            f"no single {target} found: the levels beside it differ by {height:.3g} of the "
            f"region's range and by {height / max(spread.noise, 1e-300):.2g} times the noise. "
            f"Choose a region with one {target} and little else"
        )
    for side in spread.sides:
        near, far = np.array_split(values[side], 2)
        change = abs(float(np.mean(near)) - float(np.mean(far)))
        doubt = 4.0 * error * np.sqrt(2.0 / len(near))
        if change > _UNSETTLED * height + doubt:
            raise DataError(
                f"the region is too small: {spread.away[-1]:.3g} samples from the {target}, the "
                f"level still changes by {change / height:.0%} of the contrast. Widen the region"
            )
    if target == "edge":
        _refuse_narrow(spread, height, error)
        away = (np.arange(picture.shape[1]) - line.columns()[:, np.newaxis]).ravel()
        inside = np.abs(away) <= spread.away[-1]
        off = 1.5 * line.scatter * math.sqrt(2.0 / line.rows)  # samples, of its ends
        reason = why_clipped(
            value=picture.ravel()[inside],
            distance=away[inside] if right > left else -away[inside],
            extremes=(float(picture.min()), float(picture.max())),
            askew=off * BINS_PER_SAMPLE * float(np.abs(np.diff(values)).max()),
        )
        if reason:
            raise DataError(f"the edge is {reason}. Expose less, or store a wider range of values")


def _refuse_narrow(spread: EdgeSpread, height: float, error: float) -> None:
    """The window tapers over the outer half of the spread: little of the step may be there."""
    quarter = len(spread.values) // 4
    near = max(1, quarter // 8)
    left, right = (
        float(np.mean(spread.values[k - near : k + near + 1])) for k in (quarter, -1 - quarter)
    )
    outside = abs(left - spread.levels[0]) + abs(right - spread.levels[1])
    if outside > _CUT_BY_WINDOW * height + 6.0 * error / np.sqrt(near):
        raise DataError(
            f"the region is too small: {outside / height:.0%} of the edge's step lies more than "
            f"{spread.away[-1] / 2:.3g} samples from it. Widen the region"
        )


def _line_height(spread: EdgeSpread) -> float:
    background = np.linspace(*spread.levels, len(spread.values))
    return float(np.max(np.abs(spread.values - background)))
