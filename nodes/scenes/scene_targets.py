"""Test targets with exact edges, between a background and a signal radiance.

Angles and circles are in samples, which are taken as square; the frame's centre is the middle of
the middle sample, or the corner between the four middle samples.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from core.errors import ParameterError
from core.machine import ForEach, in_turn
from core.scratch import Empty
from nodes.scenes.coverage import (
    FloatArray,
    difference,
    ellipse_coverage,
    half_plane_coverage,
    star_coverage,
)
from nodes.scenes.profiles import band, steps
from nodes.scenes.scene_canvas import Drawing, by_blocks

Picture = npt.NDArray[np.floating]

STAR_RADIUS = 0.45
"""Radius of the star as a share of the frame's shorter side."""

BAR_GROUPS = 12
BAR_MINIMUM = 9.0
MAX_SPOKES = 1024


def _sample_edges(*, count: int, start: int, stop: int) -> FloatArray:
    """Edges of samples `start` to `stop`, in samples from the frame's centre."""
    return np.arange(start, stop + 1, dtype=np.float64) - 0.5 * count


def uniform(
    *,
    width: int,
    height: int,
    background: float,
    dtype: npt.DTypeLike,
    empty: Empty = np.empty,
) -> Picture:
    """One radiance everywhere."""
    picture = empty((height, width), np.dtype(dtype))
    picture.fill(background)
    return picture


def point(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    dtype: npt.DTypeLike,
    empty: Empty = np.empty,
) -> Picture:
    """One sample of `signal` at row height // 2, column width // 2."""
    picture = uniform(width=width, height=height, background=background, dtype=dtype, empty=empty)
    picture[height // 2, width // 2] = signal
    return picture


def two_panel(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    dtype: npt.DTypeLike,
    empty: Empty = np.empty,
) -> Picture:
    """`background` on the left half of the frame, `signal` on the right half."""
    drawing = Drawing("background")
    drawing.add(difference("signal", "background"), (band(0.0, 1.0), band(0.5, 1.0)))
    two = {"background": background, "signal": signal}
    return drawing.render(two, width=width, height=height, dtype=dtype, empty=empty)


def slanted_edge(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    angle_deg: float,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Picture:
    """`signal` on one side of an edge through the centre.

    The edge's normal points `angle_deg` from +x (to the right) towards +y (down) into the
    signal, so that 0 is a vertical edge with the signal on the right.
    """
    turn = np.deg2rad(angle_deg)
    x_edges = _sample_edges(count=width, start=0, stop=width)

    def rows(start: int, stop: int) -> FloatArray:
        share = half_plane_coverage(
            x_edges,
            _sample_edges(count=height, start=start, stop=stop),
            normal_x=float(np.cos(turn)),
            normal_y=float(np.sin(turn)),
            offset=0.0,
        )
        return background + (signal - background) * share

    return by_blocks(
        width=width, height=height, dtype=dtype, rows=rows, for_each=for_each, empty=empty
    )


def sine(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    angle_deg: float,
    frequency: float,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Picture:
    """A sinusoid of radiance between `background` and `signal`, a crest at the centre.

    It varies along `angle_deg` from +x towards +y with `frequency` / width cycles per sample,
    and every sample holds its mean over the sample: the swing falls by a sinc per axis.
    """
    turn = np.deg2rad(angle_deg)
    along_x = frequency / width * float(np.cos(turn))
    along_y = frequency / width * float(np.sin(turn))
    swing = 0.5 * (signal - background) * float(np.sinc(along_x) * np.sinc(along_y))

    def middle(count: int, start: int, stop: int) -> FloatArray:
        edges = _sample_edges(count=count, start=start, stop=stop)
        return 0.5 * (edges[1:] + edges[:-1])

    x_phase = 2.0 * np.pi * along_x * middle(width, 0, width)
    x_cosine, x_sine = swing * np.cos(x_phase), swing * np.sin(x_phase)

    def rows(start: int, stop: int) -> FloatArray:
        phase = 2.0 * np.pi * along_y * middle(height, start, stop)[:, None]
        mean = 0.5 * (signal + background)
        picture: FloatArray = mean + np.cos(phase) * x_cosine - np.sin(phase) * x_sine
        return picture

    return by_blocks(
        width=width, height=height, dtype=dtype, rows=rows, for_each=for_each, empty=empty
    )


def siemens_star(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    frequency: float,
    dtype: npt.DTypeLike,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Picture:
    """A disc of `frequency` sectors of `signal`, the first about the +x axis.

    Sectors and disc are exact; where a sector meets the rim their product is taken.
    """
    if frequency != round(frequency) or not 1 <= frequency <= MAX_SPOKES:
        raise ParameterError("frequency", frequency, f"a whole number of spokes, 1 to {MAX_SPOKES}")
    spokes = int(frequency)
    radius = STAR_RADIUS * min(width, height)
    x_edges = _sample_edges(count=width, start=0, stop=width)

    def rows(start: int, stop: int) -> FloatArray:
        y_edges = _sample_edges(count=height, start=start, stop=stop)
        disc = ellipse_coverage(
            x_edges, y_edges, centre_x=0.0, centre_y=0.0, radius_x=radius, radius_y=radius
        )
        star = star_coverage(x_edges, y_edges, spokes=spokes)
        return background + (signal - background) * disc * star

    return by_blocks(
        width=width, height=height, dtype=dtype, rows=rows, for_each=for_each, empty=empty
    )


def four_bar(
    *,
    width: int,
    height: int,
    background: float,
    signal: float,
    frequency: float,
    dtype: npt.DTypeLike,
    empty: Empty = np.empty,
) -> Picture:
    """Pairs of four-bar targets, upright and level, each √2 finer than the one before.

    The coarsest has `frequency` cycles per shorter side of the frame. A bar is 7 times as long
    as wide, so that four bars and three gaps fill a square. Pairs fill the frame in rows.
    """
    if not frequency >= BAR_MINIMUM:
        raise ParameterError(
            "frequency", frequency, f"at least {BAR_MINIMUM:g}, so that the coarsest pair fits"
        )
    short = min(width, height)
    unit_x, unit_y = short / width, short / height
    drawing = Drawing("background")
    warmer = difference("signal", "background")
    for left, top, bar in _bar_layout(frequency, 1.0 / unit_x, 1.0 / unit_y):
        starts = 2.0 * bar * np.arange(4)
        side = 7.0 * bar
        across = left + 9.0 * bar
        upright = steps((left + starts) * unit_x, (left + starts + bar) * unit_x)
        level = steps((top + starts) * unit_y, (top + starts + bar) * unit_y)
        down = band(top * unit_y, (top + side) * unit_y)
        drawing.add(warmer, (down, upright))
        over = band(across * unit_x, (across + side) * unit_x)
        drawing.add(warmer, (level, over))
    two = {"background": background, "signal": signal}
    return drawing.render(two, width=width, height=height, dtype=dtype, empty=empty)


def _bar_layout(frequency: float, room_x: float, room_y: float) -> list[tuple[float, float, float]]:
    """Left, top and bar width of each pair, in shorter sides of the frame."""
    places: list[tuple[float, float, float]] = []
    left = top = shelf = widest = 0.0
    for group in range(BAR_GROUPS):
        bar = 0.5 / (frequency * 2.0 ** (0.5 * group))
        if left + 16.0 * bar > room_x - 0.1 and shelf > 0.0:
            left, top, shelf = 0.0, top + shelf, 0.0
        if left + 16.0 * bar > room_x - 0.1 or top + 7.0 * bar > room_y - 0.1:
            break
        places.append((left, top, bar))
        widest = max(widest, left + 16.0 * bar)
        left += 18.5 * bar
        shelf = max(shelf, 9.5 * bar)
    low = max(top + 7.0 * bar for _, top, bar in places)
    aside, above = 0.5 * (room_x - widest), 0.5 * (room_y - low)
    return [(left + aside, top + above, bar) for left, top, bar in places]
