"""A drawing: an ordered list of strokes over the frame 0 to 1 in x and y, drawn at any size.

`add` sums products of profiles, which keeps the area mean exact however fine the detail;
`paint_*` covers what is below, exact as long as that is uniform within the sample.

Strokes give where which surface is, not how bright it is: that is given when it is rendered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from core.machine import ForEach, in_turn
from core.scratch import Empty
from nodes.scenes.coverage import (
    FloatArray,
    Mix,
    Radiances,
    Texture,
    cell_edges,
    ellipse_coverage,
    half_plane_coverage,
    radiance_of,
)
from nodes.scenes.profiles import Profile, band, span

BLOCK_SAMPLES = 1 << 18
FORMULA_SAMPLES = 1 << 16  # what a formula takes on its way then stays in the cache

Place = tuple[slice, slice]
Patch = tuple[Mix, Place, FloatArray]
"""What is drawn, in which rows and columns of the block, and as what share of each sample.

The shares are the receiver's to change."""

Patches = Callable[[FloatArray], Iterator[Patch]]
"""What a stroke draws on the rows between the edges, in order."""

Bind = Callable[[FloatArray], Patches]
"""Prepares a stroke for the columns between the edges."""

Term = tuple[Profile, Profile]
"""Profile in y, profile in x, or several of each."""


@dataclass(frozen=True)
class Stroke:
    """Draws between `top` and `low`: over what is there, or added to it."""

    top: float
    low: float
    names: frozenset[str]
    bind: Bind
    adds: bool = False


class Bound:
    """A stroke on columns that are known."""

    def __init__(self, stroke: Stroke, x_edges: FloatArray) -> None:
        self.adds = stroke.adds
        self._top, self._low = stroke.top, stroke.low
        self._patches = stroke.bind(x_edges)

    def patches(self, y_edges: FloatArray) -> Iterable[Patch]:
        """What it draws on the rows between the edges."""
        if self._top < y_edges[-1] and self._low > y_edges[0]:
            return self._patches(y_edges)
        return ()


class Drawing:
    """Strokes in the order in which they are drawn, on an even background."""

    def __init__(self, background: str) -> None:
        self.background = background
        self.textures: tuple[Texture, ...] = ()
        self._strokes: list[Stroke] = []

    def add(self, mix: Mix, *terms: Term) -> None:
        """Add the sum of profile(y)·profile(x) of a difference, in one matrix product."""
        top, low = min(y.low for y, _ in terms), max(y.high for y, _ in terms)
        left, right = min(x.low for _, x in terms), max(x.high for _, x in terms)

        def bind(x_edges: FloatArray) -> Patches:
            columns = span(left, right, x_edges)
            across = _stacked([x for _, x in terms], x_edges[columns.start : columns.stop + 1])

            def patches(y_edges: FloatArray) -> Iterator[Patch]:
                rows = span(top, low, y_edges)
                down = _stacked([y for y, _ in terms], y_edges[rows.start : rows.stop + 1])
                yield mix, (rows, columns), down.T @ across if len(down) > 1 else down.T * across

            return patches

        self._strokes.append(Stroke(top, low, frozenset(mix), bind, adds=True))

    def add_texture(self, texture: Texture, *terms: Term) -> None:
        """Add a pattern whose strength follows from the radiances."""
        self.textures += (texture,)
        self.add({texture.name: 1.0}, *terms)

    def paint(self, mix: Mix | str, y: Profile, x: Profile) -> None:
        """Cover with a surface, as densely as the product of two profiles from 0 to 1."""
        mixed = _mix(mix)

        def bind(x_edges: FloatArray) -> Patches:
            columns = x.span(x_edges)
            across = x.means(x_edges[columns.start : columns.stop + 1])

            def patches(y_edges: FloatArray) -> Iterator[Patch]:
                rows = y.span(y_edges)
                down = y.means(y_edges[rows.start : rows.stop + 1])
                yield mixed, (rows, columns), down[:, None] * across

            return patches

        self._strokes.append(Stroke(y.low, y.high, frozenset(mixed), bind))

    def paint_box(self, mix: Mix | str, left: float, top: float, right: float, low: float) -> None:
        """Cover a rectangle given by its borders."""
        self.paint(mix, band(top, low), band(left, right))

    def paint_ellipse(
        self, mix: Mix | str, centre_x: float, centre_y: float, radius_x: float, radius_y: float
    ) -> None:
        """Cover an ellipse with axes along x and y."""
        shape = np.array([[centre_x], [centre_y], [radius_x], [radius_y]])
        self.paint_ellipses([_mix(mix)], *shape)

    def paint_ellipses(
        self,
        mixes: Sequence[Mix],
        centre_x: FloatArray,
        centre_y: FloatArray,
        radius_x: FloatArray,
        radius_y: FloatArray,
    ) -> None:
        """Cover ellipses with axes along x and y, one after the other."""
        ellipses = Ellipses(centre_x, centre_y, radius_x, radius_y)

        def bind(x_edges: FloatArray) -> Patches:
            def patches(y_edges: FloatArray) -> Iterator[Patch]:
                for index, place, share in ellipses.shares(x_edges, y_edges):
                    yield mixes[index], place, share

            return patches

        names = frozenset(name for mix in mixes for name in mix)
        self._strokes.append(Stroke(ellipses.top, ellipses.low, names, bind))

    def paint_trapezoid(
        self,
        mix: Mix | str,
        *,
        top: float,
        low: float,
        top_span: tuple[float, float],
        low_span: tuple[float, float],
    ) -> None:
        """Cover a trapezoid with level upper and lower sides, given by their x spans."""
        mixed = _mix(mix)
        height = low - top
        sides = []
        for sign, at_top, at_low in zip((1.0, -1.0), top_span, low_span, strict=True):
            slope = (at_low - at_top) / height
            sides.append((sign, -sign * slope, sign * (at_top - slope * top)))
        left, right = min(top_span[0], low_span[0]), max(top_span[1], low_span[1])

        def bind(x_edges: FloatArray) -> Patches:
            columns = span(left, right, x_edges)
            x_part = x_edges[columns.start : columns.stop + 1]

            def patches(y_edges: FloatArray) -> Iterator[Patch]:
                rows = span(top, low, y_edges)
                y_part = y_edges[rows.start : rows.stop + 1]
                inside = np.clip(y_part, top, low)
                planes = [
                    half_plane_coverage(x_part, inside, normal_x=a, normal_y=b, offset=c)
                    for a, b, c in sides
                ]
                # No point lies beyond both sides: the two overlaps add up to the intersection.
                share = (np.diff(inside) / np.diff(y_part))[:, None]
                yield mixed, (rows, columns), (planes[0] + planes[1] - 1.0) * share

            return patches

        self._strokes.append(Stroke(top, low, frozenset(mixed), bind))

    @property
    def names(self) -> tuple[str, ...]:
        """Surfaces and textures that it draws."""
        return tuple(sorted({self.background}.union(*(s.names for s in self._strokes))))

    def bound(self, x_edges: FloatArray) -> list[Bound]:
        """The strokes, ready for columns."""
        return [Bound(stroke, x_edges) for stroke in self._strokes]

    def render(
        self,
        radiances: Radiances,
        *,
        width: int,
        height: int,
        dtype: npt.DTypeLike,
        for_each: ForEach = in_turn,
        empty: Empty = np.empty,
    ) -> npt.NDArray[np.floating]:
        """Draw at `width` × `height` samples; sums are in double, rounded once."""
        known = with_textures(radiances, self.textures)
        strokes = self.bound(cell_edges(count=width))

        def rows(start: int, stop: int) -> FloatArray:
            y_edges = cell_edges(count=height, start=start, stop=stop)
            block = np.full((stop - start, width), known[self.background])
            for stroke in strokes:
                for mix, place, share in stroke.patches(y_edges):
                    target, value = block[place], radiance_of(mix, known)
                    np.multiply(share, value if stroke.adds else value - target, out=share)
                    target += share
            return block

        return by_blocks(
            width=width,
            height=height,
            dtype=dtype,
            rows=rows,
            samples=BLOCK_SAMPLES,
            for_each=for_each,
            empty=empty,
        )


def with_textures(radiances: Radiances, textures: Sequence[Texture]) -> Radiances:
    """Radiances together with the textures' strengths, where these are not given with them."""
    strengths = {
        texture.name: texture.strength(radiances)
        for texture in textures
        if texture.name not in radiances
    }
    return {**radiances, **strengths}


def by_blocks(
    *,
    width: int,
    height: int,
    dtype: npt.DTypeLike,
    rows: Callable[[int, int], FloatArray],
    for_each: ForEach,
    samples: int = FORMULA_SAMPLES,
    empty: Empty = np.empty,
) -> npt.NDArray[np.floating]:
    """Fill a picture from `rows(start, stop)`, about so many samples at a time.

    `empty` makes the array, perhaps on disk.
    """
    picture = empty((height, width), np.dtype(dtype))
    step = max(1, samples // width)

    def fill(start: int) -> None:
        stop = min(start + step, height)
        picture[start:stop] = rows(start, stop)

    for_each(fill, range(0, height, step))
    return picture


def _mix(mix: Mix | str) -> Mix:
    return {mix: 1.0} if isinstance(mix, str) else mix


def _stacked(profiles: Sequence[Profile], edges: FloatArray) -> FloatArray:
    return np.concatenate([np.atleast_2d(profile.means(edges)) for profile in profiles])


# Many ellipses at once: a crown of leaves costs little more than a leaf.

BATCH_SAMPLES = 1 << 14


class Ellipses:
    """Ellipses with axes along x and y."""

    def __init__(
        self, centre_x: FloatArray, centre_y: FloatArray, radius_x: FloatArray, radius_y: FloatArray
    ) -> None:
        self._shapes = np.array([centre_x, centre_y, radius_x, radius_y])
        self._low_x, self._high_x = centre_x - radius_x, centre_x + radius_x
        self._low_y, self._high_y = centre_y - radius_y, centre_y + radius_y

    @property
    def top(self) -> float:
        """Upper end of all."""
        return float(self._low_y.min())

    @property
    def low(self) -> float:
        """Lower end of all."""
        return float(self._high_y.max())

    def shares(
        self, x_edges: FloatArray, y_edges: FloatArray
    ) -> Iterator[tuple[int, tuple[slice, slice], FloatArray]]:
        """Index, (rows, columns) and share of the samples around each ellipse that touches them."""
        left, right = _spans(self._low_x, self._high_x, x_edges)
        top, low = _spans(self._low_y, self._high_y, y_edges)
        touching = np.flatnonzero((left < right) & (top < low))
        if not touching.size:
            return
        # All have frames of the largest's size, shifted inward at the picture's borders.
        wide, tall = (right - left)[touching].max(), (low - top)[touching].max()
        x_start = np.minimum(left, x_edges.size - 1 - wide)
        y_start = np.minimum(top, y_edges.size - 1 - tall)
        count = max(1, BATCH_SAMPLES // int(wide * tall))
        for begin in range(0, touching.size, count):
            batch = touching[begin : begin + count]
            centre_x, centre_y, radius_x, radius_y = self._shapes[:, batch]
            shares = ellipse_coverage(
                x_edges[x_start[batch, None] + np.arange(wide + 1)],
                y_edges[y_start[batch, None] + np.arange(tall + 1)],
                centre_x=centre_x,
                centre_y=centre_y,
                radius_x=radius_x,
                radius_y=radius_y,
            )
            for index, share in zip(batch.tolist(), shares, strict=True):
                x, y = x_start[index], y_start[index]
                columns, rows = slice(left[index], right[index]), slice(top[index], low[index])
                own = share[rows.start - y : rows.stop - y, columns.start - x : columns.stop - x]
                yield index, (rows, columns), own


def _spans(
    low: FloatArray, high: FloatArray, edges: FloatArray
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """First sample that each touches, and the one after the last."""
    last = edges.size - 1
    first = np.clip(np.searchsorted(edges, low, side="right") - 1, 0, last)
    return first, np.maximum(np.minimum(np.searchsorted(edges, high, side="left"), last), first)
