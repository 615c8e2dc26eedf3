"""A drawing: an ordered list of strokes over the frame 0 to 1 in x and y, drawn at any size.

`add` sums products of profiles, which keeps the area mean exact however fine the detail;
`paint_*` covers what is below, exact as long as that is uniform within the sample.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from nodes.scenes.coverage import FloatArray, cell_edges, ellipse_coverage, half_plane_coverage
from nodes.scenes.profiles import Profile, band

BLOCK_SAMPLES = 1 << 19

Paint = Callable[[FloatArray, FloatArray], None]
"""Draws on the block (second) of the rows between the edges (first)."""

Bind = Callable[[FloatArray], Paint]
"""Prepares a stroke for the columns between the edges."""

Term = tuple[float, Profile, Profile]
"""Weight, profile in y, profile in x."""


def by_blocks(
    *,
    width: int,
    height: int,
    dtype: npt.DTypeLike,
    rows: Callable[[int, int], FloatArray],
) -> npt.NDArray[np.floating]:
    """Fill a picture from `rows(start, stop)`, a few rows at a time to bound the memory."""
    picture = np.empty((height, width), dtype=dtype)
    step = max(1, BLOCK_SAMPLES // width)
    for start in range(0, height, step):
        stop = min(start + step, height)
        picture[start:stop] = rows(start, stop)
    return picture


class Drawing:
    """Strokes in the order in which they are drawn."""

    def __init__(self, background: float) -> None:
        self._background = background
        self._strokes: list[Bind] = []

    def add(self, terms: Sequence[Term]) -> None:
        """Add the sum of weight·profile(y)·profile(x), in one matrix product."""
        weights = np.array([weight for weight, _, _ in terms])
        in_y, in_x = [y for _, y, _ in terms], [x for _, _, x in terms]

        def bind(x_edges: FloatArray) -> Paint:
            columns = _common_span(in_x, x_edges)
            x_part = x_edges[columns.start : columns.stop + 1]
            across = np.array([profile.means(x_part) for profile in in_x])

            def draw(y_edges: FloatArray, block: FloatArray) -> None:
                rows = _common_span(in_y, y_edges)
                if rows.start == rows.stop or columns.start == columns.stop:
                    return
                y_part = y_edges[rows.start : rows.stop + 1]
                down = np.array([profile.means(y_part) for profile in in_y]) * weights[:, None]
                target = block[rows, columns]
                if len(terms) == 1:
                    target += down.T * across
                else:
                    target += down.T @ across

            return draw

        self._strokes.append(bind)

    def paint(self, value: float, y: Profile, x: Profile) -> None:
        """Cover with `value`, as densely as the product of two profiles from 0 to 1."""

        def bind(x_edges: FloatArray) -> Paint:
            columns = x.span(x_edges)
            across = x.means(x_edges[columns.start : columns.stop + 1])

            def draw(y_edges: FloatArray, block: FloatArray) -> None:
                rows = y.span(y_edges)
                if rows.start < rows.stop and columns.start < columns.stop:
                    down = y.means(y_edges[rows.start : rows.stop + 1])
                    target = block[rows, columns]
                    target += down[:, None] * across * (value - target)

            return draw

        self._strokes.append(bind)

    def paint_box(self, value: float, left: float, top: float, right: float, low: float) -> None:
        """Cover a rectangle given by its borders."""
        self.paint(value, band(top, low), band(left, right))

    def paint_ellipse(
        self, value: float, centre_x: float, centre_y: float, radius_x: float, radius_y: float
    ) -> None:
        """Cover an ellipse with axes along x and y."""

        def cover(x_edges: FloatArray, y_edges: FloatArray) -> FloatArray:
            return ellipse_coverage(
                x_edges,
                y_edges,
                centre_x=centre_x,
                centre_y=centre_y,
                radius_x=radius_x,
                radius_y=radius_y,
            )

        box = (band(centre_y - radius_y, centre_y + radius_y), centre_x - radius_x)
        self._paint_shape(value, box[0], band(box[1], centre_x + radius_x), cover)

    def paint_trapezoid(
        self,
        value: float,
        *,
        top: float,
        low: float,
        top_span: tuple[float, float],
        low_span: tuple[float, float],
    ) -> None:
        """Cover a trapezoid with level upper and lower sides, given by their x spans."""
        height = low - top
        sides = []
        for sign, at_top, at_low in zip((1.0, -1.0), top_span, low_span, strict=True):
            slope = (at_low - at_top) / height
            sides.append((sign, -sign * slope, sign * (at_top - slope * top)))

        def cover(x_edges: FloatArray, y_edges: FloatArray) -> FloatArray:
            inside = np.clip(y_edges, top, low)
            share = np.diff(inside) / np.diff(y_edges)
            planes = [
                half_plane_coverage(x_edges, inside, normal_x=a, normal_y=b, offset=c)
                for a, b, c in sides
            ]
            # No point lies beyond both sides, so the two overlaps add up to the intersection.
            covered: FloatArray = (planes[0] + planes[1] - 1.0) * share[:, None]
            return covered

        left, right = min(top_span[0], low_span[0]), max(top_span[1], low_span[1])
        self._paint_shape(value, band(top, low), band(left, right), cover)

    def _paint_shape(
        self,
        value: float,
        y: Profile,
        x: Profile,
        cover: Callable[[FloatArray, FloatArray], FloatArray],
    ) -> None:
        def bind(x_edges: FloatArray) -> Paint:
            columns = x.span(x_edges)
            x_part = x_edges[columns.start : columns.stop + 1]

            def draw(y_edges: FloatArray, block: FloatArray) -> None:
                rows = y.span(y_edges)
                if rows.start < rows.stop and columns.start < columns.stop:
                    target = block[rows, columns]
                    share = cover(x_part, y_edges[rows.start : rows.stop + 1])
                    target += share * (value - target)

            return draw

        self._strokes.append(bind)

    def render(self, *, width: int, height: int, dtype: npt.DTypeLike) -> npt.NDArray[np.floating]:
        """Draw at `width` × `height` samples; sums are in double, rounded once."""
        x_edges = cell_edges(count=width)
        strokes = [bind(x_edges) for bind in self._strokes]

        def rows(start: int, stop: int) -> FloatArray:
            y_edges = cell_edges(count=height, start=start, stop=stop)
            block = np.full((stop - start, width), self._background)
            for draw in strokes:
                draw(y_edges, block)
            return block

        return by_blocks(width=width, height=height, dtype=dtype, rows=rows)


def _common_span(profiles: Sequence[Profile], edges: FloatArray) -> slice:
    spans = [profile.span(edges) for profile in profiles]
    touched = [span for span in spans if span.start < span.stop]
    if not touched:
        return slice(0, 0)
    return slice(min(s.start for s in touched), max(s.stop for s in touched))
