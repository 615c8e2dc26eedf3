"""Test targets with exact edges, between a background and a signal radiance.

Angles and circles are in samples, which are taken as square; the frame's centre is the middle of
the middle sample, or the corner between the four middle samples.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from core.errors import ParameterError
from nodes.scenes import coverage
from nodes.scenes.scene_canvas import Canvas, Drawing, difference

Rows = Callable[[int, int], coverage.FloatArray]
"""The samples of the rows from one number to another."""

Shares = Callable[[int, int], tuple[coverage.FloatArray, ...]]
"""Shares of these samples, whose product is the signal's."""

STAR_RADIUS = 0.45
"""Radius of the star as a share of the frame's shorter side."""

BAR_GROUPS = 12
BAR_MINIMUM = 9.0
MAX_SPOKES = 1024
_WARMER = difference("signal", "background")


def draw_target(
    kind: str,
    canvas: Canvas,
    *,
    background: float,
    signal: float,
    angle_deg: float = 0.0,
    frequency: float = 0.0,
) -> npt.NDArray[np.floating]:
    """One of the targets; parameters as for `nodes.scenes.draw.draw_radiances`."""
    width, height = canvas.width, canvas.height
    if kind in ("two_panel", "four_bar"):
        drawing = Drawing("background")
        if kind == "two_panel":
            drawing.add(_WARMER, (coverage.band(0.0, 1.0), coverage.band(0.5, 1.0)))
        else:
            _four_bar(drawing, width, height, frequency)
        return drawing.render({"background": background, "signal": signal}, canvas)
    if kind == "sine":
        return canvas.filled(_sine(width, height, background, signal, angle_deg, frequency))
    if kind == "slanted_edge":
        shares = _slanted_edge(width, height, angle_deg)
    elif kind == "siemens_star":
        shares = _siemens_star(width, height, frequency)
    else:
        row, column = (height // 2, width // 2) if kind == "point" else (-1, 0)
        return canvas.filled(_even(width, background, row, column, signal))
    return canvas.filled(_between(background, signal, shares))


def _even(width: int, background: float, row: int, column: int, signal: float) -> Rows:
    """The background, with the signal in one sample, if that is in the frame."""

    def rows(start: int, stop: int) -> coverage.FloatArray:
        block = np.full((stop - start, width), background)
        if start <= row < stop:
            block[row - start, column] = signal
        return block

    return rows


def _between(background: float, signal: float, shares: Shares) -> Rows:
    """From the background at shares of 0 to the signal where all of them are 1."""

    def rows(start: int, stop: int) -> coverage.FloatArray:
        above: float | coverage.FloatArray = signal - background
        for share in shares(start, stop):
            above = above * share
        return np.asarray(background + above)

    return rows


def _sample_edges(*, count: int, start: int, stop: int) -> coverage.FloatArray:
    """Edges of samples `start` to `stop`, in samples from the frame's centre."""
    return np.arange(start, stop + 1, dtype=np.float64) - 0.5 * count


def _slanted_edge(width: int, height: int, angle_deg: float) -> Shares:
    """Share of the signal on one side of an edge through the centre.

    The edge's normal points `angle_deg` from +x (to the right) towards +y (down) into the
    signal, so that 0 is a vertical edge with the signal on the right.
    """
    turn = np.deg2rad(angle_deg)
    x_edges = _sample_edges(count=width, start=0, stop=width)

    normal = {"normal_x": float(np.cos(turn)), "normal_y": float(np.sin(turn))}

    def shares(start: int, stop: int) -> tuple[coverage.FloatArray]:
        y_edges = _sample_edges(count=height, start=start, stop=stop)
        return (coverage.half_plane_coverage(x_edges, y_edges, **normal, offset=0.0),)

    return shares


def _sine(
    width: int, height: int, background: float, signal: float, angle_deg: float, frequency: float
) -> Rows:
    """A sinusoid of radiance between `background` and `signal`, a crest at the centre.

    It varies along `angle_deg` from +x towards +y with `frequency` / width cycles per sample,
    and every sample holds its mean over the sample: the swing falls by a sinc per axis.
    """
    turn = np.deg2rad(angle_deg)
    along_x = frequency / width * float(np.cos(turn))
    along_y = frequency / width * float(np.sin(turn))
    swing = 0.5 * (signal - background) * float(np.sinc(along_x) * np.sinc(along_y))

    def middle(count: int, start: int, stop: int) -> coverage.FloatArray:
        edges = _sample_edges(count=count, start=start, stop=stop)
        return 0.5 * (edges[1:] + edges[:-1])

    x_phase = 2.0 * np.pi * along_x * middle(width, 0, width)
    x_cosine, x_sine = swing * np.cos(x_phase), swing * np.sin(x_phase)

    def rows(start: int, stop: int) -> coverage.FloatArray:
        phase = 2.0 * np.pi * along_y * middle(height, start, stop)[:, None]
        mean = 0.5 * (signal + background)
        picture: coverage.FloatArray = mean + np.cos(phase) * x_cosine - np.sin(phase) * x_sine
        return picture

    return rows


def _siemens_star(width: int, height: int, frequency: float) -> Shares:
    """Share of a disc of `frequency` sectors of signal, the first about the +x axis.

    Sectors and disc are exact; where a sector meets the rim their product is taken.
    """
    if frequency != round(frequency) or not 1 <= frequency <= MAX_SPOKES:
        raise ParameterError("frequency", frequency, f"a whole number of spokes, 1 to {MAX_SPOKES}")
    radius = STAR_RADIUS * min(width, height)
    x_edges = _sample_edges(count=width, start=0, stop=width)

    def shares(start: int, stop: int) -> tuple[coverage.FloatArray, coverage.FloatArray]:
        y_edges = _sample_edges(count=height, start=start, stop=stop)
        disc = coverage.ellipse_coverage(
            x_edges, y_edges, centre_x=0.0, centre_y=0.0, radius_x=radius, radius_y=radius
        )
        return disc, coverage.star_coverage(x_edges, y_edges, spokes=int(frequency))

    return shares


def _four_bar(drawing: Drawing, width: int, height: int, frequency: float) -> None:
    """Pairs of four-bar targets, upright and level, each √2 finer than the one before.

    The coarsest has `frequency` cycles per shorter side of the frame. A bar is 7 times as long
    as wide, so that four bars and three gaps fill a square. Pairs fill the frame in rows.
    """
    if not frequency >= BAR_MINIMUM:
        allowed = f"at least {BAR_MINIMUM:g}, so that the coarsest pair of bars fits"
        raise ParameterError("frequency", frequency, allowed)
    short = min(width, height)
    unit_x, unit_y = short / width, short / height
    for left, top, bar in _bar_layout(frequency, 1.0 / unit_x, 1.0 / unit_y):
        starts = 2.0 * bar * np.arange(4)
        side = 7.0 * bar
        across = left + 9.0 * bar
        upright = coverage.steps((left + starts) * unit_x, (left + starts + bar) * unit_x)
        level = coverage.steps((top + starts) * unit_y, (top + starts + bar) * unit_y)
        drawing.add(_WARMER, (coverage.band(top * unit_y, (top + side) * unit_y), upright))
        drawing.add(_WARMER, (level, coverage.band(across * unit_x, (across + side) * unit_x)))


def _bar_layout(frequency: float, room_x: float, room_y: float) -> list[tuple[float, float, float]]:
    """Left, top and bar width of each pair, in shorter sides of the frame."""
    places: list[tuple[float, float, float]] = []
    left = top = shelf = widest = 0.0
    for group in range(BAR_GROUPS):
        bar = 0.5 / (frequency * 2.0 ** (0.5 * group))
        if left + 16.0 * bar > room_x - 0.1 and shelf > 0.0:
            left, top, shelf = 0.0, top + shelf, 0.0
        if top + 7.0 * bar > room_y - 0.1:
            break
        places.append((left, top, bar))
        widest = max(widest, left + 16.0 * bar)
        left += 18.5 * bar
        shelf = max(shelf, 9.5 * bar)
    low = max(top + 7.0 * bar for _, top, bar in places)
    aside, above = 0.5 * (room_x - widest), 0.5 * (room_y - low)
    return [(left + aside, top + above, bar) for left, top, bar in places]
