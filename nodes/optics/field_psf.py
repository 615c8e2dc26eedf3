"""Field PSF: a blur that changes from the middle of the field to its corners."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from core import kernels
from core.arrays import Array
from core.chain.step_lineage import Filtering, picture_step
from core.chain.wires import CameraSheet, Context, Image, Magnitude
from core.errors import ParameterError, several
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Param, Section, param
from core.physics.optics import field as field_optics
from core.physics.optics.blur import gaussian_mtf
from core.physics.optics.field import samples_at
from core.records import dataclass, field
from core.transfer.factors import Factor, Grid, Separable, factor_at
from nodes.optics.mtf_file import MtfFile
from nodes.optics.psf_file import PsfFile
from nodes.shared.module_ports import ImageOutput, separable
from nodes.shared.steps import stepped
from nodes.transform.resampling import within_frame

Row = tuple[float, ...]
_TURNS = 0.25  # of a PSF's outermost wave, from one frequency of its table to the next
_MOST_REACH, _LOST = 1024, 0.005  # samples around a tile; share of light
_DOUBTFUL = 5.0  # % of the range
_FIGURED = 6  # cells along each axis of a quadrant, of which the error is figured
_Path = Annotated[
    Path | None, Param("MTF or PSF file for one position, in the order of `positions`")
]


class FieldPSF(Module, key="field_psf", title="Field PSF", group="Optics"):
    """Blur the picture by a PSF that changes over the field.

    `positions` are distances from the picture's middle, as fractions of the half diagonal. For each
    position, give a Gaussian or a file that MTF File or PSF File can read. A Gaussian has a
    tangential rms width (along the radius) and a sagittal rms width (across the radius). A file
    gives the MTF or PSF of a point straight above the middle: `mtf_y` is the tangential curve, and
    the top of a PSF's picture points away from the axis. A single Zemax listing in `path_1`
    supplies a field for each position. Between positions, the widths of Gaussians or the OTFs of
    files are interpolated linearly in the square of the position; beyond the last position they
    stay constant. The PSF rotates with the direction of the point from the middle.

    The picture is blurred in overlapping tiles; within a tile, the PSFs of its four corners are
    blended. `error_percent` is an upper limit on the error of any sample, compared with a blur by
    that sample's own PSF, in per cent of the picture's range. In real scenes the error is about ten
    times smaller. Smaller tiles reduce the blending error. Around each tile, the blur uses a
    margin of half a tile, but at least 16 samples. If this margin would lose more than 0.5 % of a
    PSF's light, it is widened, up to 1024 samples. A tile is at least a quarter as wide as its
    margin. Beyond the frame the picture is mirrored, or repeated if Back Transform made it
    periodic. Budgets, MTFs and figures of merit use the PSF of the first position. Source: Nagy and
    O'Leary 1998, SIAM J. Sci. Comput. 19, 1063.
    """

    formulas = (
        Formula(
            r"L'(x)=\sum_{c}w_c(x)\,(h_c*L)(x),\quad\sum_c w_c(x)=1",
            where="c: the four corners of the tile around x; h_c: PSF at corner c; w_c: bilinear "
            "weights",
        ),
    )

    kind: Literal["gaussian", "mtf", "psf"] = param(
        "gaussian", "source of the PSFs: Gaussians, MTF files or PSF files"
    )
    positions: Row = param(
        (0.0, 0.5, 1.0), "positions in ascending order, as fractions of the half diagonal", (0, 10)
    )
    tangential_mrad: Row = param(
        (), "tangential rms width (along the radius), at each position", (0, 1e6)
    )
    sagittal_mrad: Row = param(
        (), "sagittal rms width (across the radius); empty: equal to tangential_mrad", (0, 1e6)
    )
    path_1: _Path = None
    path_2: _Path = None
    path_3: _Path = None
    path_4: _Path = None
    sample_pitch_um: float | None = param(
        None, "sampling interval of PSF files; empty: from the file", low=0, slider=(0.1, 20)
    )
    tile: int = param(64, "side of a tile", (4, 2048), unit="samples", slider=(16, 256))

    panel = (
        Section("Field", "kind positions"),
        Section("", "tangential_mrad sagittal_mrad", shown_when=("kind", ("gaussian",))),
        Section("Files", "path_1 path_2 path_3 path_4", shown_when=("kind", ("mtf", "psf"))),
        Section("", "sample_pitch_um", shown_when=("kind", ("psf",))),
        Section("Tiles", "tile"),
    )

    def check(self) -> None:
        rising = all(low < high for low, high in pairwise(self.positions))
        if not (self.positions and rising):
            allowed = "at least one number, in ascending order"
            raise ParameterError("positions", self.positions, allowed)
        for name in ("tangential_mrad", "sagittal_mrad"):
            given = getattr(self, name)
            if self.kind == "gaussian" and given and len(given) != len(self.positions):
                allowed = f"{several(len(self.positions), 'number')}, one for each position"
                raise ParameterError(name, given, allowed)

    def run(self, image: Image, here: NodeContext, context: Context | None = None) -> ImageOutput:
        if self._off:
            return ImageOutput(image)
        spread = self._spread(image, here, context)
        edges = image.edges or "reflect"
        how = {"spread": spread, "grid": image.grid(), "edges": edges, "tile": self.tile}
        return ImageOutput(stepped(image, here.step(blurred, image.recipe, **how)))

    def _spread(self, image: Image, here: NodeContext, context: Context | None) -> FieldSpread:
        if self.kind == "gaussian":
            tangential = self.tangential_mrad or (0.0,) * len(self.positions)
            pairs = zip(self.sagittal_mrad or tangential, tangential, strict=True)
            return FieldSpread(self.positions, tuple(pairs), label=self.title, node=here.node)
        sheet, grid = image.camera or CameraSheet(), image.grid()
        pitch = sheet.pitch_x_um, sheet.pitch_y_um, sheet.focal_length_mm
        known = context or Context(grid, "reflect", "array", *pitch, None, None, 1, 1, 0, 0)
        paths: tuple[Path | None, ...] = (self.path_1, self.path_2, self.path_3, self.path_4)
        if not any(paths[1:]) and self.kind == "mtf":
            paths = (self.path_1,) * len(self.positions)
        knots = []
        for number in range(len(self.positions)):
            path = paths[number] if number < len(paths) else None
            if path is None:
                name = f"path_{min(number, 3) + 1}"
                known_positions = several(len(self.positions), "position")
                allowed = f"give a file for each position ({known_positions}; at most 4 files)"
                raise ParameterError(name, None, allowed)
            of_listing = number if paths[0] is paths[-1] else 0
            lens: Any = (
                MtfFile(path=path, field=of_listing)
                if self.kind == "mtf"
                else PsfFile(path=path, sample_pitch=self.sample_pitch_um)
            )
            made = lens.run(known, Magnitude(image, grid), here)
            knots.append((*made.mtf.factors, *made.ptf.factors))
        return FieldSpread(self.positions, (), tuple(knots), label=self.title, node=here.node)

    @readout("%")
    def error_percent(self, outputs: ImageOutput) -> Step | float:
        """Upper limit on the tiling error of any sample, relative to the picture's range."""
        if self._off:
            return 0.0
        assert isinstance(outputs.image.recipe, Step)
        return Step.of(_tile_error, **dict(outputs.image.recipe.parameters))

    @warning
    def no_widths(self) -> Caution | None:
        """Files are given but Gaussians are chosen, or the Gaussians have no widths."""
        if self.kind != "gaussian":
            return None
        for name in ("path_1", "path_2", "path_3", "path_4"):
            if getattr(self, name) is not None:
                remedy = f"set kind to mtf or psf, or leave {name} empty"
                return Caution(f"{name} is not used: kind is gaussian", remedy)
        if self.tangential_mrad or self.sagittal_mrad:
            return None
        remedy = "give a width in tangential_mrad for each position"
        return Caution("nothing is blurred: tangential_mrad is empty", remedy)

    @warning
    def one_curve(self, outputs: ImageOutput) -> Caution | None:
        """The blur does not change over the field, though there are several positions."""
        if self.kind != "mtf" or self.path_2 is not None or len(self.positions) == 1:
            return None
        assert isinstance(outputs.image.recipe, Step)
        if len(set(dict(outputs.image.recipe.parameters)["spread"].knots)) > 1:
            return None
        return Caution(
            f"the blur is the same at all {len(self.positions)} positions: path_1 has one curve",
            "give a file for each position, or a Zemax listing with a field for each position",
        )

    @warning
    def tiles(self, outputs: ImageOutput) -> Step | None:
        """The tiling error is large."""
        error = self.error_percent(outputs)
        return Step.of(_error_caution, error) if isinstance(error, Step) else None

    @property
    def _off(self) -> bool:
        return self.kind == "gaussian" and not any(self.tangential_mrad + self.sagittal_mrad)


@dataclass(frozen=True)
class FieldSpread:
    """PSFs over the field: rms widths (across, along) at the positions, or OTFs as factors."""

    positions: Row
    sigmas: tuple[tuple[float, float], ...]
    knots: tuple[tuple[Factor, ...], ...] = ()
    label: str = field(default="", compare=False)
    node: str | None = field(default=None, compare=False)

    @cached_property
    def recipes(self) -> tuple[Recipe, ...]:
        """Tables of the OTFs of PSF files, which take long to make at frequencies that turn."""
        tabled = (knot for knot in self.knots if any(law.inputs for f in knot for law in f.laws))
        return tuple(Step.of(_otf_table, factors=knot, node=self.node) for knot in tabled)

    def shares(self, position: float) -> list[tuple[int, float]]:
        known = np.square(self.positions)  # aberrations are even functions of the field
        place = float(np.interp(position**2, known, np.arange(len(known))))
        number = min(int(place), max(len(self.positions) - 2, 0))
        both = [(number, 1.0 - place + number), (number + 1, place - number)]
        return [(end, share) for end, share in both if share > 0.0]

    def widened(self, shares: list[tuple[int, float]]) -> tuple[Factor, ...]:
        """The Gaussian between those of the positions."""
        x, y = (sum(share * self.sigmas[end][axis] for end, share in shares) for axis in (0, 1))
        sigma_x, sigma_y = {"sigma_mrad": x}, {"sigma_mrad": y}
        return separable(gaussian_mtf, x=sigma_x, y=sigma_y, label=self.label, node=self.node)

    def otf(self, work: Work, grid: Grid, side: int, row: float, column: float) -> Array:
        """At the frequencies of `rfft2` of a patch, at a place of the picture."""
        x = (column - 0.5 * (grid.columns - 1)) * grid.interval_x_mrad
        y = (row - 0.5 * (grid.rows - 1)) * grid.interval_y_mrad
        xi = np.fft.rfftfreq(side, grid.interval_x_mrad)[np.newaxis]
        eta = np.fft.fftfreq(side, grid.interval_y_mrad)[:, np.newaxis]
        across, along = field_optics.field_frequencies(xi=xi, eta=eta, x=x, y=y)
        shares = self.shares(2.0 * math.hypot(x, y) / math.hypot(*_extents(grid)))
        tables = self.recipes
        if self.sigmas:
            return _product(work, self.widened(shares), across, along)
        parts = [
            share * (_tabled(work.value(tables[end]), across, along) if tables
                     else _product(work, self.knots[end], across, along))
            for end, share in shares
        ]  # fmt: skip
        return np.asarray(sum(parts[1:], start=parts[0]))


def _otf_table(work: Work, *, factors: tuple[Factor, ...]) -> tuple[Array, float]:
    """OTF of a PSF file up to its Nyquist frequency, finely enough to interpolate; and the step."""
    bound = dict(factors[0].laws[0].parameters)
    pitches = bound["pitch_y_mrad"], bound["pitch_x_mrad"]
    extents = np.multiply(work.value(bound["psf"]).weights.shape, pitches)
    step = _TURNS / float(max(extents))
    count = math.ceil(0.5 / min(pitches) / step) + 8
    frequency = step * np.arange(-count, count + 1)
    return _product(work, factors, frequency[np.newaxis], frequency[:, np.newaxis]), step


def _tabled(table: tuple[Array, float], xi: Array, eta: Array) -> Array:
    values, step = table
    x, y = xi / step + values.shape[0] // 2, eta / step + values.shape[0] // 2
    real, imaginary = (samples_at(picture=part, x=x, y=y) for part in (values.real, values.imag))
    return np.asarray(real + 1j * imaginary)


def _product(work: Work, factors: tuple[Factor, ...], xi: Array, eta: Array) -> Array:
    total: Any = np.ones(xi.shape)
    for factor in factors:
        if isinstance(factor, Separable):
            value = factor_at(work, factor, xi, eta)
            total = total * (value if factor.part == "mtf" else np.exp(1j * value))
        else:
            total = total * factor.transfer(work, xi, eta)
    return np.asarray(total)


def _sides(work: Work, spread: FieldSpread, grid: Grid, tile: int) -> tuple[int, int, int]:
    """Side of a tile, the samples around it that its blur takes, and the side of both."""
    half, reach = 0.5 * math.hypot(*_extents(grid)), max(16, tile // 2)
    middle = 0.5 * (grid.rows - 1), 0.5 * (grid.columns - 1)
    out = [half * min(position, 1.0) for position in spread.positions]
    places = [(middle[0], middle[1] + far / grid.interval_x_mrad) for far in out]
    places += [(middle[0] + far / grid.interval_y_mrad, middle[1]) for far in out]
    while True:
        work.check()
        tile = max(tile, reach // 4)  # of a PSF so wide, which changes slowly
        side = kernels.next_fast_len(tile + 1 + 2 * reach, real=True)
        otfs = (spread.otf(work, grid, side, *place) for place in places)
        if reach >= _MOST_REACH or all(
            field_optics.light_within(otf=otf, side=side, reach=reach) > 1.0 - _LOST for otf in otfs
        ):
            return tile, reach, side
        reach = min(reach * 3 // 2, _MOST_REACH)


def _extents(grid: Grid) -> tuple[float, float]:
    return grid.columns * grid.interval_x_mrad, grid.rows * grid.interval_y_mrad


def _on_axis(image: Recipe, *, spread: FieldSpread, grid: Grid, edges: Any, tile: int) -> Filtering:
    factors = spread.widened([(0, 1.0)]) if spread.sigmas else spread.knots[0]
    return Filtering(factors, grid, edges, label=spread.label)


@picture_step(linear=_on_axis)
@in_blocks()
def blurred(
    work: Work, image: Array, *, spread: FieldSpread, grid: Grid, edges: Any, tile: int
) -> Array:
    made: Array = work.empty(grid.shape, image.dtype)
    tile, reach, side = _sides(work, spread, grid, tile)
    for recipe in spread.recipes:
        work.value(recipe)
    kind = np.result_type(image.dtype, np.complex64)

    def cell(place: tuple[field_optics.Cell, field_optics.Cell]) -> None:
        along, across = place
        rows, columns = (
            within_frame(np.arange(one.start - reach, one.start - reach + side), size, edges)
            for one, size in ((along, grid.rows), (across, grid.columns))
        )
        otfs = [
            spread.otf(work, grid, side, row, column).astype(kind)
            for row in (along.low, along.high)
            for column in (across.low, across.high)
        ]
        patch = image[np.ix_(rows, columns)]
        made[along.start : along.stop, across.start : across.stop] = field_optics.blended(
            patch=patch, otfs=otfs, along=along, across=across, reach=reach
        )

    all_along, all_across = (field_optics.cells_of(size=size, tile=tile) for size in grid.shape)
    work.for_each(cell, [(along, across) for along in all_along for across in all_across])
    return made


def _tile_error(work: Work, *, spread: FieldSpread, grid: Grid, edges: Any, tile: int) -> float:
    """At the middles of cells and of their sides, in a quadrant."""
    tile, reach, side = _sides(work, spread, grid, tile)
    cells = [
        one[len(one) // 2 :]
        for one in (field_optics.cells_of(size=n, tile=tile) for n in grid.shape)
    ]
    few = [[one[i] for i in np.unique(np.linspace(0, len(one) - 1, _FIGURED).astype(int))]
           for one in cells]  # fmt: skip
    worst = 0.0
    for along in few[0]:
        work.check()
        for across in few[1]:
            at = {
                (row, column): spread.otf(work, grid, side, row, column)
                for row in (along.low, along.high, 0.5 * (along.low + along.high))
                for column in (across.low, across.high, 0.5 * (across.low + across.high))
            }
            middle = 0.5 * (along.low + along.high), 0.5 * (across.low + across.high)
            corners = [at[r, c] for r in (along.low, along.high) for c in (across.low, across.high)]
            for own, ends in (
                (at[middle], corners),
                (at[along.high, middle[1]], corners[2:]),
                (at[middle[0], across.high], corners[1::2]),
            ):
                found = field_optics.blending_error(otfs=ends, own=own, side=side, reach=reach)
                worst = max(worst, found)
    return 100.0 * worst


def _error_caution(work: Work, percent: float) -> Caution | None:
    if percent <= _DOUBTFUL:
        return None
    return Caution(
        f"samples may be off by up to {percent:.2g} % of the picture's range; in most "
        "scenes, the error is a tenth of this limit",
        "reduce tile; if that does not help, the PSF is too wide: sample the scene more coarsely",
    )
