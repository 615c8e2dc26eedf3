"""Blocks of rows of the planar factors: by low rank, kept whole, tabulated or evaluated anew."""

from collections.abc import Callable

import numpy as np

from core.arrays import Array
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.records import dataclass, field
from core.transfer.factors import Edges, Grid, Planar, Product

# A function of the radial frequency, tabulated for linear interpolation.

Function = Callable[[Array], Array]  # values at radii, shape (radii,)

INTERVALS = (1 << 8, 1 << 11, 1 << 13)  # tried in turn
MOST_ROUGH = 0.1  # share of the last one's intervals that may be too rough to interpolate


@dataclass(frozen=True)
class RadialTable:
    """Values at even radii and the steps between them.

    Steps are NaN where interpolation would not do, as at the edge of a support: the function itself
    is evaluated there. Beyond the end the last value holds.
    """

    per_radius: float
    values: Array
    steps: Array

    @classmethod
    def of(cls, function: Function, *, reach: float, error: float) -> "RadialTable | None":
        """Tabulate a function of radii up to `reach`; None where too much of it is rough.

        `error` is the largest one of interpolated values, as that of places halfway between others
        shows.
        """
        for intervals in INTERVALS:
            values = np.asarray(function(np.linspace(0.0, reach, 2 * intervals + 1)), np.float64)
            halfway = 0.5 * (values[:-1:2] + values[2::2])
            # Within half the interval the error is a quarter of this, at a kink at most a half.
            rough = np.abs(halfway - values[1::2]) > 2.0 * error
            rough[1:] |= rough[:-1]
            rough[:-1] |= rough[1:]
            allowed = MOST_ROUGH * intervals if intervals == INTERVALS[-1] else 0
            if np.count_nonzero(rough) <= allowed:
                steps = np.where(np.repeat(rough, 2), np.nan, np.diff(values))
                return cls(2 * intervals / reach, values, np.append(steps, 0.0))
        return None

    @property
    def rough(self) -> bool:
        return bool(np.isnan(self.steps).any())

    def at(self, square: Array, function: Function) -> Array:
        """Values at the squares of radii, of the function that was tabulated."""
        radius = np.sqrt(square)
        place = radius * self.per_radius
        np.minimum(place, len(self.values) - 1, out=place)
        index = place.astype(np.intp)
        place -= index
        values: Array = self.steps.take(index)
        values *= place
        values += self.values.take(index)
        rough = np.isnan(values)
        if rough.any():
            values[rough] = function(radius[rough])
        return values


SINGLE_TOLERANCE = 1e-7  # below the rounding of single-precision samples
BLOCK_SAMPLES = 1 << 16  # samples of a plane per block of rows
SMALLEST = 128  # smaller planes are evaluated sooner than approximated or kept
THIN_SAMPLES = 1 << 19  # smaller planes are read from a radial table sooner than approximated


Precomputed = tuple[Array, Array] | Array | RadialTable | None
"""What is known of a factor on a quarter: two thin matrices, the plane, a table, or nothing."""


class Planes:
    """The product of a chain's planar factors, symmetric ones only, by blocks of rows."""

    def __init__(self, work: Work, product: Product, grid: Grid, axes: Edges) -> None:
        self._work = work
        self.xi, self.eta = grid.axes(axes)
        self._parts: list[tuple[Planar, Quarter, Precomputed]] = []
        for factor in product.planar:
            quarter = Quarter.of(self.xi, self.eta, factor.cutoff)
            known: Precomputed = None
            if _is_precomputed(grid, axes):
                known = work.value(Known(factor, grid, axes, node=factor.node))
            self._parts.append((factor, quarter, known))

    def block(self, rows: slice) -> Array | None:
        """Product at all columns of these rows; None without planar factors."""
        result: Array | None = None
        for factor, quarter, known in self._parts:
            part = self._part(factor, quarter, known, rows)
            result = part if result is None else result * part
        return result

    def _part(self, factor: Planar, quarter: "Quarter", known: Precomputed, rows: slice) -> Array:
        lines, which = quarter.rows(rows)
        if isinstance(known, tuple):
            values = thin_product(known[0][lines], known[1])
        elif isinstance(known, np.ndarray):
            values = np.asarray(known[lines])
        else:
            values = _evaluated(self._work, factor, known, quarter, lines)
        if which is None and len(quarter.xi) == quarter.columns:
            return values
        height = len(values) if which is None else len(which)
        part = np.zeros((height, quarter.columns), values.dtype)
        part[slice(None) if which is None else which, : len(quarter.xi)] = values
        return part


@dataclass(frozen=True, eq=False)
class Known(Recipe):
    """One factor on one grid.

    The plane is kept where it takes at most a quarter of the store. Tables and low rank are for
    single precision: kinks that lie between its probes can cost 1e-7.
    """

    factor: Planar
    grid: Grid
    axes: Edges
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.factor.key, self.grid, self.axes

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        return self.factor.law.inputs

    def compute(self, work: Work) -> Precomputed:
        """Compute in double, keep in the evaluation's precision."""
        factor = self.factor
        quarter = Quarter.of(*self.grid.axes(self.axes), factor.cutoff)
        table = None
        if work.policy.precision == "single":
            table = _radial_table(work, factor, quarter)
            thin = _thin(work, factor, table, quarter)
            if thin is not None:
                return thin
        dtype = work.policy.dtype
        if quarter.samples * dtype.itemsize > work.store.capacity_bytes // 4:
            return table
        plane = np.empty((len(quarter.eta), len(quarter.xi)), dtype)
        height = max(1, BLOCK_SAMPLES // len(quarter.xi))

        def one(start: int) -> None:
            rows = slice(start, start + height)
            plane[rows] = _evaluated(work, factor, table, quarter, rows)

        work.for_each(one, range(0, len(quarter.eta), height))
        return plane


def known_planes(product: Product, grid: Grid, axes: Edges) -> list[Recipe]:
    """The recipes that `Planes` reads."""
    if not product.symmetric or not _is_precomputed(grid, axes):
        return []
    return [Known(factor, grid, axes, node=factor.node) for factor in product.planar]


def _is_precomputed(grid: Grid, axes: Edges) -> bool:
    columns = grid.columns if axes == "reflect" else grid.columns // 2 + 1
    return min(columns, grid.rows) >= SMALLEST


def _evaluated(
    work: Work, factor: Planar, table: RadialTable | None, quarter: "Quarter", lines: slice | Array
) -> Array:
    """Rows of the factor, with the same bits whether they are then kept or not."""
    across, along = quarter.xi[np.newaxis, :], quarter.eta[lines][:, np.newaxis]
    if table is not None:
        values = table.at(_square(factor, across, along), _of_radius(work, factor))
    else:
        values = factor.transfer(work, across, along)
    return values.astype(work.policy.dtype)


def _square(factor: Planar, across: Array, along: Array) -> Array:
    across, along = across * factor.ratios[0], along * factor.ratios[1]
    return across * across + along * along


def _radial_table(work: Work, factor: Planar, quarter: "Quarter") -> RadialTable | None:
    if not factor.radial or quarter.samples == 1:
        return None
    reach = float(np.sqrt(_square(factor, quarter.xi[-1], quarter.eta[-1])))
    if factor.cutoff is not None:
        reach = min(reach, (1.0 + MARGIN) * factor.cutoff[0] * factor.ratios[0])
    function = _of_radius(work, factor)
    return RadialTable.of(function, reach=reach, error=0.5 * SINGLE_TOLERANCE)


def _of_radius(work: Work, factor: Planar) -> Function:
    ratio, zero = factor.ratios[0], np.zeros(1)
    return lambda radii: np.asarray(factor.transfer(work, radii / ratio, zero), np.float64)


def _thin(
    work: Work, factor: Planar, table: RadialTable | None, quarter: "Quarter"
) -> tuple[Array, Array] | None:
    """Thin matrices of a radial factor without kinks, such as the edge of a support is."""
    if table is None or table.rough or quarter.samples < THIN_SAMPLES:
        return None
    function = _of_radius(work, factor)

    def evaluate(rows: Array, columns: Array) -> Array:
        across, along = quarter.xi[columns][np.newaxis, :], quarter.eta[rows][:, np.newaxis]
        return table.at(_square(factor, across, along), function)

    thin = cross_approximation(evaluate, len(quarter.eta), len(quarter.xi), SINGLE_TOLERANCE)
    if thin is None:
        return None
    dtype = work.policy.dtype
    return thin[0].astype(dtype), thin[1].astype(dtype)


# The quarter of a spectrum on which a symmetric factor is evaluated: within its support.

MARGIN = 1e-9  # of a cutoff: so much further the factor is evaluated, and found to be 0


@dataclass(frozen=True)
class Quarter:
    """Frequencies across and along, neither negative, and where a grid's rows are among them.

    Both ascend as far as the factor is not 0. `places` has for every row of the grid its place in
    `eta`; beyond the end the row is 0, as are the `columns` from ``len(xi)`` on.
    """

    xi: Array
    eta: Array
    places: Array
    columns: int

    @classmethod
    def of(cls, xi: Array, eta: Array, cutoff: tuple[float, float] | None) -> "Quarter":
        columns, lines = len(xi), np.abs(eta)
        places = np.arange(len(lines))
        if np.any(eta < 0.0):
            lines, places = np.unique(lines, return_inverse=True)
        if cutoff is None:
            return cls(xi, lines, places, columns)
        across, along = ((1.0 + MARGIN) * limit for limit in cutoff)
        return cls(xi[xi <= across], lines[lines <= along], places, columns)

    @property
    def samples(self) -> int:
        return len(self.xi) * len(self.eta)

    def rows(self, rows: slice) -> tuple[slice | Array, Array | None]:
        """Places in `eta` of those of the grid's rows that are not 0, and which these are.

        The places are a slice where they can be, and which is None for all rows.
        """
        places = self.places[rows]
        inside = places < len(self.eta)
        if inside.all():
            return _sliced(places), None
        return _sliced(places[inside]), inside


def _sliced(places: Array) -> slice | Array:
    """A slice instead of indices in steps of one."""
    if len(places) == 0:
        return slice(0, 0)
    first, last = int(places[0]), int(places[-1])
    step = 1 if last >= first else -1
    if abs(last - first) + 1 != len(places) or np.any(np.diff(places) != step):
        return places
    end = last + step
    return slice(first, end if end >= 0 else None, step)


# Low-rank approximation of a planar factor on a grid, from a few of its rows and columns.
#
# In the central band a disc's OTF is smooth but for the cusp at zero, and numerically of low
# rank: 20 at 1e-8. Complete pivoting on a coarse grid of probes chooses rows and columns that span
# the plane, which is then the product of two thin matrices (Bebendorf 2000, Numer. Math. 86, 565).

Evaluate = Callable[[Array, Array], Array]  # (row indices, column indices) → block

HIGHEST_RANK = 48  # beyond it the matrices' product takes longer than reading the plane
PROBES = 40  # rows and columns spread evenly, and as many dense at the start
ROUNDS = 2  # of probes, each between the ones before
PRODUCT_TERMS, PRODUCT_COLUMNS = 1 << 19, 1 << 10  # of one piece of the product
LINES = 4  # whole rows and columns on which the result is checked


def cross_approximation(
    evaluate: Evaluate, rows: int, columns: int, tolerance: float
) -> tuple[Array, Array] | None:
    """Thin matrices U (rows × r) and V (r × columns) with U·V equal to the plane.

    `evaluate` gives the block of the plane at row indices × column indices. The largest absolute
    error is kept on the probes, which are drawn evenly and include the first rows and columns,
    where an OTF has its cusp, and on some whole lines between them. None where the rank is not low
    or the plane has zeros: then it is evaluated directly.
    """
    highest = min(HIGHEST_RANK, min(rows, columns) // 4)
    every_row, every_column = np.arange(rows), np.arange(columns)
    i_probes, j_probes = _probes(rows, 0), _probes(columns, 0)
    for turn in range(1, ROUNDS + 1):
        values = evaluate(i_probes, j_probes)
        if not np.all(values):
            return None  # the edge of the support is in the plane, and it is no low-rank curve
        pivot = _pivots(values, 0.5 * tolerance, highest)
        if pivot is None:
            return None
        i, j, left, right = pivot
        # At the pivots' rows and columns the factors on the probes are triangular.
        u = evaluate(every_row, j_probes[j]) @ np.linalg.inv(right[:, j])
        v = np.linalg.inv(left[i]) @ evaluate(i_probes[i], every_column)
        i_between, j_between = _probes(rows, turn), _probes(columns, turn)
        error = evaluate(i_between, j_between) - u[i_between] @ v[:, j_between]
        if np.abs(error).max() <= tolerance and _lines_fit(evaluate, u, v, tolerance):
            return u, v
        # A kink that one set of probes misses, another meets.
        i_probes, j_probes = np.union1d(i_probes, i_between), np.union1d(j_probes, j_between)
    return None


def thin_product(u: Array, v: Array) -> Array:
    """U·V by small pieces.

    Called from several threads at once a matrix product that starts threads of its own takes a
    hundred times as long (66 ms instead of 0.6 ms at 1024² and rank 19); small ones start none.
    """
    rows, columns = len(u), v.shape[1]
    product = np.empty((rows, columns), u.dtype)
    height = max(1, PRODUCT_TERMS // (PRODUCT_COLUMNS * max(1, len(v))))
    for top in range(0, rows, height):
        lines = slice(top, top + height)
        for left in range(0, columns, PRODUCT_COLUMNS):
            part = slice(left, left + PRODUCT_COLUMNS)
            np.matmul(u[lines], v[:, part], out=product[lines, part])
    return product


def _pivots(
    values: Array, tolerance: float, highest: int
) -> tuple[Array, Array, Array, Array] | None:
    """Rows and columns of the pivots, and the two factors; None where the rank is not low."""
    residual = values.copy()
    left, right = np.empty((len(values), highest)), np.empty((highest, values.shape[1]))
    i, j = np.empty(highest, np.intp), np.empty(highest, np.intp)
    for rank in range(highest + 1):
        at = int(np.argmax(np.abs(residual)))
        row, column = divmod(at, residual.shape[1])
        if abs(residual[row, column]) <= tolerance:
            return i[:rank], j[:rank], left[:, :rank], right[:rank]
        if rank == highest:
            break
        i[rank], j[rank] = row, column
        left[:, rank] = residual[:, column]
        right[rank] = residual[row] / residual[row, column]
        residual -= np.multiply.outer(left[:, rank], right[rank])
    return None


def _lines_fit(evaluate: Evaluate, u: Array, v: Array, tolerance: float) -> bool:
    """Whether whole rows and columns between the probes agree."""
    rows, columns = len(u), v.shape[1]
    golden = (np.arange(1, LINES + 1) * 0.6180339887498949) % 1.0
    i, j = (golden * rows).astype(np.int64), (golden * columns).astype(np.int64)
    across = evaluate(i, np.arange(columns)) - u[i] @ v
    along = evaluate(np.arange(rows), j) - u @ v[:, j]
    return bool(max(np.abs(across).max(), np.abs(along).max()) <= tolerance)


def _probes(size: int, turn: int) -> Array:
    """Indices spread evenly, dense at the start; every turn's lie between those before."""
    count, shift = min(size, PROBES), (0.0, 0.5, 0.25, 0.75)[turn]
    places = np.minimum((np.arange(count) + shift) / max(count - 1, 1), 1.0)
    dense = np.arange(min(size, 8)) + int(8 * shift)
    spread = np.concatenate([(size - 1) * places, (size - 1) * places**3]).round()
    chosen = np.minimum(np.concatenate([dense, spread]), size - 1).astype(np.int64)
    return np.flatnonzero(np.bincount(chosen))  # np.unique loads np.ma first
