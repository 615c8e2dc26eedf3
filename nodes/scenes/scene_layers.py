"""A drawing as the share of each surface in each sample: shown with any radiances at once.

The picture is a weighted sum of the surfaces' radiances, and few surfaces meet in one place. So
the shares are kept in small tiles, each with the surfaces that it shows.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from core.machine import ForEach, in_turn
from nodes.scenes.coverage import FloatArray, cell_edges
from nodes.scenes.scene_canvas import (
    Canvas,
    Drawing,
    Place,
    Radiances,
    Texture,
    with_textures,
)

TILE = 16
BLOCK_SAMPLES = 1 << 16

Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Tiles:
    """Tiles that show equally many surfaces: where they lie, counted in tiles, and which these are.

    `surfaces` has the shape (tiles, surfaces), `shares` (tiles, surfaces, samples).
    """

    rows: Indices
    columns: Indices
    surfaces: Indices
    shares: npt.NDArray[np.floating]


@dataclass(frozen=True)
class Layers:
    """Shares of surfaces, and of textures, in all tiles of a picture."""

    shape: tuple[int, int]
    tile: tuple[int, int]
    names: tuple[str, ...]
    textures: tuple[Texture, ...]
    tiles: tuple[Tiles, ...]

    def means(self) -> FloatArray:
        height, width = self.shape
        return _share_sums(self.tiles, len(self.names)) / (width * height)

    def picture(
        self, radiances: Radiances, for_each: ForEach = in_turn
    ) -> npt.NDArray[np.floating]:
        """The picture for these radiances, of the shares' type."""
        known = with_textures(radiances, self.textures)
        patterns = {texture.name for texture in self.textures}
        # The surfaces' shares sum to 1. Above the least of them there is nothing that cancels, and
        # in an even picture nothing to be rounded.
        least = min(known[name] for name in self.names if name not in patterns)
        above = [known[name] - (0.0 if name in patterns else least) for name in self.names]
        dtype = self.tiles[0].shares.dtype
        radiance = np.array(above, dtype=dtype)
        (height, width), (tall, wide) = self.shape, self.tile
        down, across = -(-height // tall), -(-width // wide)
        picture = np.empty((down * tall, across * wide), dtype=dtype)
        places = picture.reshape(down, tall, across, wide).swapaxes(1, 2)

        def fill(tiles: Tiles) -> None:
            # Matrix products of this size would start threads of their own.
            samples = np.einsum("nk,nkp->np", radiance[tiles.surfaces], tiles.shares)
            samples += least
            places[tiles.rows, tiles.columns] = samples.reshape(-1, tall, wide)

        for_each(fill, self.tiles)
        return np.ascontiguousarray(picture[:height, :width])


def layers_of(drawing: Drawing, canvas: Canvas) -> Layers:
    """Find the share of each surface in each sample; sums are in double."""
    tile = min(TILE, canvas.height), min(TILE, canvas.width)
    shape = canvas.height, canvas.width
    tiles = tuple(_tiles(drawing, canvas))
    return Layers(shape, tile, drawing.names, drawing.textures, tiles)


def mean_shares(drawing: Drawing, canvas: Canvas) -> FloatArray:
    """Mean share of each of the drawing's names, without the shares of all samples in memory."""
    tiles = _tiles(drawing, replace(canvas, dtype=np.float64))
    return _share_sums(tiles, len(drawing.names)) / (canvas.width * canvas.height)


def _share_sums(tiles: Iterable[Tiles], names: int) -> FloatArray:
    sums = np.zeros(names)
    for several in tiles:
        # Beyond the frame tiles show nothing.
        np.add.at(sums, several.surfaces, several.shares.sum(axis=2, dtype=np.float64))
    return sums


def _tiles(drawing: Drawing, canvas: Canvas) -> Iterator[Tiles]:
    width, height = canvas.width, canvas.height
    tall, wide = min(TILE, height), min(TILE, width)
    down, across = -(-height // tall), -(-width // wide)
    strokes = drawing.bound(cell_edges(count=width))
    step = min(max(1, BLOCK_SAMPLES // (tall * wide * across)), down)
    sheet = _Sheet(step, across, (tall, wide))
    # In turn: most strokes are small, and threads would wait for each other's Python.
    for first in range(0, down, step):
        last = min(first + step, down)
        start, stop = first * tall, min(last * tall, height)
        y_edges = cell_edges(count=height, start=start, stop=stop)
        # From front to back: what is seen of a stroke is what later ones have left.
        clear = np.ones((stop - start, width))
        for adds, patches in reversed(strokes):
            for mix, place, share in reversed(list(patches(y_edges))):
                left = clear[place]
                np.multiply(share, left, out=share)
                if not adds:
                    left -= share
                for name, part in mix.items():
                    sheet.add(name, place, part, share)
        sheet.add(drawing.background, (slice(0, stop - start), slice(0, width)), 1.0, clear)
        yield from sheet.taken(first, last - first, drawing.names, canvas.dtype)


class _Sheet:
    """Shares in some rows of tiles, one plane for each surface that shows there."""

    def __init__(self, down: int, across: int, tile: tuple[int, int]) -> None:
        self._across, self._tile = across, tile
        self._shape = (down * tile[0], across * tile[1])
        self._planes: dict[str, FloatArray] = {}
        self._used: dict[str, None] = {}

    def add(self, name: str, place: Place, part: float, shares: FloatArray) -> None:
        """Add `part` of these shares to a surface's."""
        if name not in self._planes:
            self._planes[name] = np.zeros(self._shape)
        self._used[name] = None
        self._planes[name][place] += shares if part == 1.0 else part * shares

    def taken(
        self, first: int, down: int, names: Sequence[str], dtype: npt.DTypeLike
    ) -> Iterator[Tiles]:
        """What was drawn on `down` rows of tiles, the picture's from `first` on; then forgotten."""
        (tall, wide), across = self._tile, self._across
        planes = [self._planes[name].reshape(-1, tall, across, wide)[:down] for name in self._used]
        shown = np.array([_squares(plane).ravel() > 0.0 for plane in planes])
        count = np.count_nonzero(shown, axis=0)
        surface, place = np.nonzero(shown)
        # Tiles with one surface come first, then those with two, each with its surfaces together.
        order = np.lexsort((surface, place, count[place]))
        to = np.empty_like(order)
        to[order] = np.arange(order.size)
        shares = np.empty((order.size, tall * wide), dtype=dtype)
        for number, plane in enumerate(planes):
            own = surface == number
            rows, columns = np.divmod(place[own], across)
            shares[to[own]] = plane[rows, :, columns].reshape(rows.size, tall * wide)
            plane[:] = 0.0  # new planes would cost more: the system has to find their pages
        kinds = np.array([names.index(name) for name in self._used])[surface[order]]
        self._used.clear()
        start = 0
        for several in np.unique(count):
            where = np.flatnonzero(count == several)
            part = slice(start, start + where.size * several)
            start = part.stop
            yield Tiles(
                first + where // across,
                where % across,
                kinds[part].reshape(where.size, several),
                shares[part].reshape(where.size, several, tall * wide),
            )


def _squares(plane: FloatArray) -> FloatArray:
    """Sum of the squares in each tile of a plane of shape (down, tall, across, wide)."""
    down, tall, across, wide = plane.shape
    lines = plane.reshape(down, tall, across * wide)
    sums = np.einsum("dtc,dtc->dc", lines, lines).reshape(down, across, wide)
    return np.asarray(sums.sum(axis=2))
