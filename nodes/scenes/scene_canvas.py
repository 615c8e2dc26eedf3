"""A drawing: an ordered list of strokes over the frame 0 to 1 in x and y, drawn at any size.

`add` sums products of profiles, whose area mean is exact however fine the detail; `paint_*` covers
what is below, exact as long as that is uniform within the sample. How bright a surface is, is given
when the drawing is rendered.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from core import kernels
from core.arrays import Floats
from core.machine import Empty, ForEach, in_turn
from core.records import dataclass
from nodes.scenes import coverage

BLOCK_SAMPLES = 1 << 18
FORMULA_SAMPLES = 1 << 16  # what a formula takes on its way then stays in the cache
BATCH_SAMPLES = 1 << 14  # of ellipses at once: a crown of leaves costs little more than a leaf

Radiances = Mapping[str, float]
"""Radiance by surface name [W m⁻² sr⁻¹]."""

Mix = Mapping[str, float]
"""Parts of named radiances: they sum to 1 for a surface, and to 0 for a difference."""

Place = tuple[slice, slice]
Patch = tuple[Mix, Place, Floats]
"""What is drawn, in which rows and columns of the block, and as what share of each sample.

The shares are the receiver's to change."""

Patches = Callable[[Floats], Iterable[Patch]]
"""What a stroke draws on the rows between the edges, in order."""

Term = tuple[coverage.Profile, coverage.Profile]
"""Profile in y, profile in x, or several of each."""

Side = tuple[float, float, float]
"""A level side of a trapezoid: its y, and where it begins and ends in x."""


def between(first: str, second: str, share: float) -> Mix:
    return {first: 1.0 - share, second: share}


def difference(of: str, against: str) -> Mix:
    return {of: 1.0, against: -1.0}


def radiance_of(mix: Mix, radiances: Radiances) -> float:
    return sum(part * radiances[name] for name, part in mix.items())


@dataclass(frozen=True)
class Texture:
    """How strong a texture is drawn; `name` stands for that, like a surface's for its radiance.

    `amplitude` is the strength as given, and `reach` the texture's largest value at strength 1. It
    stays within the share `limit` of the least radiance among the `surfaces` that it is on, so that
    no radiance falls below 0.
    """

    name: str
    amplitude: Mix
    reach: float
    limit: float
    surfaces: tuple[str, ...]

    def strength(self, radiances: Radiances) -> float:
        given = radiance_of(self.amplitude, radiances)
        allowed = self.limit * min(radiances[name] for name in self.surfaces)
        reach = abs(given) * self.reach
        return given * allowed / reach if reach > allowed else given


def with_textures(radiances: Radiances, textures: Sequence[Texture]) -> Radiances:
    """Radiances together with the textures' strengths, where these are not given with them."""
    strengths = {
        texture.name: texture.strength(radiances)
        for texture in textures
        if texture.name not in radiances
    }
    return {**radiances, **strengths}


@dataclass(frozen=True)
class Canvas:
    """Samples across and down, of which type, and how they are filled in.

    `for_each` draws some rows at a time, perhaps in threads; `empty` makes the array, perhaps on
    disk. All sums are in double, rounded once.
    """

    width: int
    height: int
    dtype: npt.DTypeLike
    for_each: ForEach = in_turn
    empty: Empty = np.empty

    def filled(
        self, rows: Callable[[int, int], Floats], samples: int = FORMULA_SAMPLES
    ) -> npt.NDArray[np.floating]:
        """A picture of `rows(start, stop)`, about so many samples at a time."""
        picture = self.empty((self.height, self.width), np.dtype(self.dtype))
        step = max(1, samples // self.width)

        def fill(start: int) -> None:
            stop = min(start + step, self.height)
            picture[start:stop] = rows(start, stop)

        self.for_each(fill, range(0, self.height, step))
        return picture


Stroke = tuple[float, float, frozenset[str], Callable[[Floats], Patches], bool]
"""Draws from a top to a low end, of which names; its patches, once it knows the edges of the
columns; whether it adds to what is there, and does not cover it."""


class Drawing:
    """Strokes in the order in which they are drawn, on an even background."""

    def __init__(self, background: str) -> None:
        self.background = background
        self.textures: tuple[Texture, ...] = ()
        self._strokes: list[Stroke] = []

    def add(self, mix: Mix, *terms: Term) -> None:
        """Add the sum of profile(y)·profile(x) of a difference, in one matrix product."""
        self._products(mix, terms, adds=True)

    def add_texture(self, texture: Texture, *terms: Term) -> None:
        self.textures += (texture,)
        self.add({texture.name: 1.0}, *terms)

    def paint(self, mix: Mix | str, y: coverage.Profile, x: coverage.Profile) -> None:
        """Cover with a surface, as densely as the product of two profiles from 0 to 1."""
        self._products(_mix(mix), ((y, x),), adds=False)

    def paint_box(self, mix: Mix | str, left: float, top: float, right: float, low: float) -> None:
        self.paint(mix, coverage.band(top, low), coverage.band(left, right))

    def paint_ellipse(
        self, mix: Mix | str, centre_x: float, centre_y: float, radius_x: float, radius_y: float
    ) -> None:
        shape = np.array([[centre_x], [centre_y], [radius_x], [radius_y]])
        self.paint_ellipses([_mix(mix)], *shape)

    def paint_ellipses(
        self,
        mixes: Sequence[Mix],
        centre_x: Floats,
        centre_y: Floats,
        radius_x: Floats,
        radius_y: Floats,
    ) -> None:
        shapes = np.array([centre_x, centre_y, radius_x, radius_y])

        def bind(x_edges: Floats) -> Patches:
            def patches(y_edges: Floats) -> Iterator[Patch]:
                for index, place, share in _ellipse_shares(shapes, x_edges, y_edges):
                    yield mixes[index], place, share

            return patches

        names = frozenset(name for mix in mixes for name in mix)
        top, low = float((centre_y - radius_y).min()), float((centre_y + radius_y).max())
        self._strokes.append((top, low, names, bind, False))

    def paint_trapezoid(self, mix: Mix | str, upper: Side, lower: Side) -> None:
        mixed = _mix(mix)
        (top, *at_top), (low, *at_low) = upper, lower
        sides = []
        for sign, start, end in zip((1.0, -1.0), at_top, at_low, strict=True):
            slope = (end - start) / (low - top)
            sides.append((sign, -sign * slope, sign * (start - slope * top)))
        left, right = min(at_top[0], at_low[0]), max(at_top[1], at_low[1])

        def bind(x_edges: Floats) -> Patches:
            columns = coverage.span(left, right, x_edges)
            x_part = x_edges[columns.start : columns.stop + 1]

            def patches(y_edges: Floats) -> Iterator[Patch]:
                rows = coverage.span(top, low, y_edges)
                y_part = y_edges[rows.start : rows.stop + 1]
                inside = np.clip(y_part, top, low)
                planes = [
                    coverage.half_plane_coverage(x_part, inside, normal_x=a, normal_y=b, offset=c)
                    for a, b, c in sides
                ]
                # No point lies beyond both sides: the two overlaps add up to the intersection.
                share = (np.diff(inside) / np.diff(y_part))[:, None]
                yield mixed, (rows, columns), (planes[0] + planes[1] - 1.0) * share

            return patches

        self._strokes.append((top, low, frozenset(mixed), bind, False))

    def _products(self, mix: Mix, terms: Sequence[Term], *, adds: bool) -> None:
        top, low = min(y.low for y, _ in terms), max(y.high for y, _ in terms)
        left, right = min(x.low for _, x in terms), max(x.high for _, x in terms)

        def bind(x_edges: Floats) -> Patches:
            columns = coverage.span(left, right, x_edges)
            across = _stacked([x for _, x in terms], x_edges[columns.start : columns.stop + 1])

            def patches(y_edges: Floats) -> Iterator[Patch]:
                rows = coverage.span(top, low, y_edges)
                down = _stacked([y for y, _ in terms], y_edges[rows.start : rows.stop + 1])
                yield mix, (rows, columns), down.T @ across if len(down) > 1 else down.T * across

            return patches

        self._strokes.append((top, low, frozenset(mix), bind, adds))

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(sorted({self.background}.union(*(names for _, _, names, *_ in self._strokes))))

    def bound(self, x_edges: Floats) -> list[tuple[bool, Patches]]:
        """Of each stroke in order whether it adds, and what it draws on columns that are known."""

        def there(top: float, low: float, patches: Patches) -> Patches:
            return lambda edges: patches(edges) if top < edges[-1] and low > edges[0] else ()

        return [(adds, there(top, low, bind(x_edges))) for top, low, _, bind, adds in self._strokes]

    def render(self, radiances: Radiances, canvas: Canvas) -> npt.NDArray[np.floating]:
        known = with_textures(radiances, self.textures)
        strokes = self.bound(coverage.cell_edges(count=canvas.width))

        def rows(start: int, stop: int) -> Floats:
            y_edges = coverage.cell_edges(count=canvas.height, start=start, stop=stop)
            block = np.full((stop - start, canvas.width), known[self.background])
            for adds, patches in strokes:
                for mix, place, share in patches(y_edges):
                    target, value = block[place], radiance_of(mix, known)
                    np.multiply(share, value if adds else value - target, out=share)
                    target += share
            return block

        return canvas.filled(rows, BLOCK_SAMPLES)


def _mix(mix: Mix | str) -> Mix:
    return {mix: 1.0} if isinstance(mix, str) else mix


def _stacked(profiles: Sequence[coverage.Profile], edges: Floats) -> Floats:
    return np.concatenate([np.atleast_2d(profile.means(edges)) for profile in profiles])


def _ellipse_shares(
    shapes: Floats, x_edges: Floats, y_edges: Floats
) -> Iterator[tuple[int, Place, Floats]]:
    """Index, (rows, columns) and share of the samples around each ellipse that touches them."""
    centre_x, centre_y, radius_x, radius_y = shapes
    left, right = _spans(centre_x - radius_x, centre_x + radius_x, x_edges)
    top, low = _spans(centre_y - radius_y, centre_y + radius_y, y_edges)
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
        shares = coverage.ellipse_coverage(
            x_edges[x_start[batch, None] + np.arange(wide + 1)],
            y_edges[y_start[batch, None] + np.arange(tall + 1)],
            centre_x=centre_x[batch],
            centre_y=centre_y[batch],
            radius_x=radius_x[batch],
            radius_y=radius_y[batch],
        )
        for index, share in zip(batch.tolist(), shares, strict=True):
            x, y = x_start[index], y_start[index]
            columns, rows = slice(left[index], right[index]), slice(top[index], low[index])
            own = share[rows.start - y : rows.stop - y, columns.start - x : columns.stop - x]
            yield index, (rows, columns), own


def _spans(
    low: Floats, high: Floats, edges: Floats
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    last = edges.size - 1
    first = np.clip(np.searchsorted(edges, low, side="right") - 1, 0, last)
    return first, np.maximum(np.minimum(np.searchsorted(edges, high, side="left"), last), first)


# Repeatable variety: numbers that depend on a counter alone, even places, and soft mottling.

GOLDEN_STEPS = (0.7548776662466927, 0.5698402909980532)
"""The plastic number's powers: fill the unit square evenly (Roberts 2018, R2 sequence)."""

MOTTLED = 0.4
"""Share of the least radiance within which mottling stays."""


def scatter(count: int, *, seed: int) -> Floats:
    """Numbers in 0 to 1 from counters by 64-bit mixing, the same on every machine.

    Source: Steele, Lea, Flood 2014, SplitMix64.
    """
    z = (np.arange(count, dtype=np.uint64) + np.uint64(seed * 1_000_003 + 1)) * np.uint64(
        0x9E3779B97F4A7C15
    )
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    numbers: Floats = (z ^ (z >> np.uint64(31))).astype(np.float64) / 2.0**64
    return numbers


def mottle(
    drawing: Drawing,
    amplitude: Mix,
    surfaces: tuple[str, ...],
    *,
    box: tuple[float, float, float, float],
    coarse: float,
    fine: float,
    stretch: float = 1.0,
    count: int,
    seed: int,
) -> None:
    """Add plane waves of random direction over `box` (left, top, right, low).

    The waves run from `coarse` to `fine` cycles per frame, weaker when finer, and `stretch`
    times finer in y (ground seen at a grazing angle). A plane wave is a sum of two products,
    so that its mean over each sample is exact.
    """
    left, top, right, low = box
    size = coarse * (fine / coarse) ** scatter(count, seed=seed)
    angle = np.pi * scatter(count, seed=seed + 1)
    phase = 2.0 * np.pi * scatter(count, seed=seed + 2)
    weight = np.sqrt(2.0 / count) * np.sqrt(coarse / size)
    texture = Texture(f"mottle {seed}", amplitude, float(weight.sum()), MOTTLED, surfaces)
    # A frequency of exactly 0 has no integral of this form; the sum keeps clear of it.
    fx, fy = (np.where(f == 0.0, 1e-6, f) for f in (size * np.cos(angle), size * np.sin(angle)))
    fy = fy * stretch
    for_y = (
        coverage.wave(top, low, cycles=fy, phase=0.0, height=weight),
        coverage.wave(top, low, cycles=fy, phase=-0.5 * np.pi, height=-weight),
    )
    for_x = (
        coverage.wave(left, right, cycles=fx, phase=phase),
        coverage.wave(left, right, cycles=fx, phase=phase - 0.5 * np.pi),
    )
    drawing.add_texture(texture, *zip(for_y, for_x, strict=True))


# A drawing as the share of each surface in each sample, which is shown with any radiances at once.
#
# The picture is a weighted sum of the surfaces' radiances, and few surfaces meet in one place.

SHEET_SAMPLES = 1 << 16


@dataclass(frozen=True)
class Layers:
    """Shares of surfaces, and of textures, in all samples: a sparse matrix (samples, names).

    Of a sample after the other, `shares` has those that are not 0, and `places` of which names they
    are; `ends` are where each sample's begin, and where the last one's end. `means` are over all.
    """

    shape: tuple[int, int]
    names: tuple[str, ...]
    textures: tuple[Texture, ...]
    means: Floats
    shares: npt.NDArray[np.floating]
    places: npt.NDArray[np.uint8]
    ends: npt.NDArray[np.int32]

    def picture(self, radiances: Radiances) -> npt.NDArray[np.floating]:
        known = with_textures(radiances, self.textures)
        patterns = {texture.name for texture in self.textures}
        # The surfaces' shares sum to 1. Above the least of them there is nothing that cancels, and
        # in an even picture nothing to be rounded.
        least = min(known[name] for name in self.names if name not in patterns)
        above = [known[name] - (0.0 if name in patterns else least) for name in self.names]
        dtype = self.shares.dtype
        picture = np.zeros(self.shape, dtype)
        matrix = self.ends, self.places.astype(np.int32), self.shares
        size = picture.size, len(self.names)
        kernels.sparse("csr_matvec")(*size, *matrix, np.array(above, dtype), picture.reshape(-1))
        picture += dtype.type(least)
        return picture


def layers_of(drawing: Drawing, canvas: Canvas) -> Layers:
    """Find the share of each surface in each sample; sums are in double."""
    names = drawing.names
    shares, places, counts, sums = [], [], [], np.zeros(len(names))
    for planes in _sheets(drawing, canvas):
        numbers = np.array([names.index(name) for name in planes], np.uint8)
        # Of truth values numpy finds those that are not 0 three times as fast as of numbers.
        seen = [np.flatnonzero(plane != 0.0) for plane in planes.values()]
        parts = [plane.ravel()[at] for plane, at in zip(planes.values(), seen, strict=True)]
        starts = np.cumsum([0, *map(len, seen)]).astype(np.int32)
        of_names = starts, np.concatenate(seen).astype(np.int32), np.concatenate(parts)
        size = next(iter(planes.values())).size
        # Each sample's shares in the order of drawing.
        first, which = np.empty(size + 1, np.int32), np.empty(starts[-1], np.int32)
        of_samples = first, which, np.empty(starts[-1])
        kernels.sparse("csr_tocsc")(len(planes), size, *of_names, *of_samples)
        shares.append(of_samples[2].astype(canvas.dtype))
        places.append(numbers[which])
        counts.append(np.diff(first))
        _add_sums(sums, planes, names, canvas.height, canvas.dtype)
    ends = np.cumsum(np.concatenate([np.zeros(1, np.int32), *counts]), dtype=np.int32)
    shape, both = (canvas.height, canvas.width), (np.concatenate(shares), np.concatenate(places))
    means = sums / (canvas.width * canvas.height)
    return Layers(shape, names, drawing.textures, means, *both, ends)


def mean_shares(drawing: Drawing, canvas: Canvas) -> Floats:
    """Mean share of each of the drawing's names, without the shares of all samples in memory."""
    names = drawing.names
    sums = np.zeros(len(names))
    for planes in _sheets(drawing, canvas):
        _add_sums(sums, planes, names, canvas.height, np.float64)
    return sums / (canvas.width * canvas.height)


def _add_sums(
    sums: Floats,
    planes: dict[str, Floats],
    names: Sequence[str],
    height: int,
    dtype: npt.DTypeLike,
) -> None:
    """Add the sums of shares, by tiles, those with the fewest names first.

    Means weight spectra, so another order would change the last bits of what is computed of them.
    """
    rows, width = planes[next(iter(planes))].shape
    tall, wide = min(16, height), min(16, width)
    down, across = -(-rows // tall), -(-width // wide)
    tiles = np.zeros((len(planes), down, across))
    for plane, into in zip(planes.values(), tiles, strict=True):
        seen = np.flatnonzero((plane != 0.0).any(axis=1)) // tall
        if not seen.size:
            continue
        first, stop = int(seen[0]), int(seen[-1]) + 1
        cut = plane[first * tall : stop * tall].astype(dtype)
        if cut.shape != ((stop - first) * tall, across * wide):
            edges = (0, (stop - first) * tall - len(cut)), (0, across * wide - width)
            cut = np.pad(cut, edges)
        shares = cut.reshape(-1, tall, across, wide).swapaxes(1, 2).reshape(-1, tall * wide)
        shares.sum(axis=1, dtype=np.float64, out=into[first:stop].reshape(-1))
    tiles = tiles.reshape(len(planes), -1)
    order = np.argsort(np.count_nonzero(tiles, axis=0), kind="stable")
    for name, column in zip(planes, tiles, strict=True):
        at = names.index(name)
        sums[at] = np.add.accumulate([sums[at], *column[order]])[-1]


def _sheets(drawing: Drawing, canvas: Canvas) -> Iterator[dict[str, Floats]]:
    """Shares of the names that show in some rows at a time, (rows, columns) of each."""
    width, height = canvas.width, canvas.height
    strokes = drawing.bound(coverage.cell_edges(count=width))
    step = 16 * max(1, SHEET_SAMPLES // (16 * (-(-width // 16) * 16)))
    # In turn: most strokes are small, and threads would wait for each other's Python.
    for start in range(0, height, step):
        stop = min(start + step, height)
        y_edges = coverage.cell_edges(count=height, start=start, stop=stop)
        planes: dict[str, Floats] = {}
        # From front to back: what is seen of a stroke is what later ones have left.
        clear = np.ones((stop - start, width))
        for adds, patches in reversed(strokes):
            for mix, place, share in reversed(list(patches(y_edges))):
                left = clear[place]
                np.multiply(share, left, out=share)
                if not adds:
                    left -= share
                for name, part in mix.items():
                    if name not in planes:
                        planes[name] = np.zeros(clear.shape)
                    planes[name][place] += share if part == 1.0 else part * share
        planes[drawing.background] = planes.get(drawing.background, 0.0) + clear
        yield planes
