"""Measured MTF: from an edge or a line in any picture."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array, Vector, block_means
from core.chain.wires import Curve, CurveData, CurveMark, Image, Series, Table, TableData
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Region, Step, marked
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.physics.measurement import slanted_edge
from core.physics.measurement.row_average import row_average
from core.physics.numerics import sinc
from core.records import dataclass
from core.transfer.factors import Grid, factor_at
from nodes.analysis.lineage import Stages, transfer_of
from nodes.shared.module_ports import TableFigures

Direction = Literal["automatic", "horizontal", "vertical"]
_BLOCK = 4

Figure = tuple[float | None, float | None]
"""A value and its standard error, None where not known."""


@dataclass(frozen=True)
class Measured:
    """An MTF measured in a picture, whatever the method; frequencies in cycles per pixel."""

    frequency: Vector
    mtf: Vector
    error: Vector
    per_mrad: float | None
    direction: str
    angle_deg: float
    mtf50: Figure
    mtf10: Figure
    nyquist: Figure
    contrast: float
    noise: float
    away: Vector
    spread: Vector
    line_spread: Vector


def _size(*, where: Region, **_: Any) -> tuple[int, int]:
    return where.shape


@marked(held_size=_size)
def measured_slanted(
    work: Work,
    image: Array,
    *,
    where: Region,
    intervals: tuple[float, float] | None,
    direction: Direction,
    target: slanted_edge.Target,
    window: slanted_edge.Window,
    samples: int,
) -> Measured:
    region, scale, across = _region(image, where, direction)
    frequency = np.linspace(0.0, 1.0, samples)
    # The figures are those of fine steps, however few points the curve has.
    fine = np.linspace(0.0, 1.0, 257)
    edge = slanted_edge.slanted_edge(
        picture=np.ascontiguousarray(region),
        frequency=np.concatenate([frequency, fine]),
        target=target,
        window=window,
        check=work.check,
    )
    levels = edge.spread.levels
    lines = slanted_edge.spread_to_line(spread=edge.spread, target=target)
    height = levels[1] - levels[0] if target == "edge" else float(lines[np.argmax(np.abs(lines))])
    away = edge.spread.away * math.cos(math.radians(edge.line.angle_deg))
    inner = slice(1, -1) if target == "edge" else slice(None)
    return Measured(
        frequency,
        edge.mtf[:samples],
        edge.error[:samples],
        _per_mrad(intervals, across, edge.line.slope),
        across,
        -edge.line.angle_deg if across == "horizontal" else 90.0 + edge.line.angle_deg,
        _crossing(fine, edge.mtf[samples:], edge.replicas[:, samples:], 0.5),
        _crossing(fine, edge.mtf[samples:], edge.replicas[:, samples:], 0.1),
        (float(edge.mtf[samples + 128]), float(edge.error[samples + 128])),
        abs(height) * scale,
        edge.spread.noise * scale,
        away[inner],
        edge.spread.values[inner] * scale,
        lines * scale,
    )


@marked(held_size=_size)
def measured_rows(
    work: Work,
    image: Array,
    *,
    where: Region,
    intervals: tuple[float, float] | None,
    direction: Direction,
    target: slanted_edge.Target,
    clip_left: int | None,
    clip_right: int | None,
) -> Measured:
    """MTF across an upright edge or line from the mean of rows, from 0 to Nyquist."""
    region, scale, across = _region(image, where, direction)
    work.check()
    average = row_average(picture=region, target=target, clip_left=clip_left, clip_right=clip_right)
    spread = np.diff(average.clipped) if target == "edge" else average.clipped
    from_sample = np.arange(len(spread), dtype=np.float64) + (0.5 if target == "edge" else 0.0)
    nyquist = len(average.frequency) - 1
    at_nyquist = float(np.interp(0.5, average.frequency, average.mtf))
    curve = {"frequency": average.frequency, "mtf": average.mtf}
    return Measured(
        average.frequency,
        average.mtf,
        average.error,
        _per_mrad(intervals, across, 0.0),
        across,
        0.0 if across == "horizontal" else 90.0,
        (slanted_edge.falls_to(level=0.5, **curve), None),
        (slanted_edge.falls_to(level=0.1, **curve), None),
        (at_nyquist, float(average.error[nyquist])),
        average.contrast * scale,
        average.noise * scale,
        from_sample,
        np.interp(from_sample, np.arange(len(average.clipped)), average.clipped) * scale,
        spread * scale,
    )


def _region(
    image: Array, where: Region, direction: Direction
) -> tuple[NDArray[np.float64], float, str]:
    """The region from 0 to 1, the range it had, and across what it changes, along rows from now."""
    region = np.asarray(image[where.slices], np.float64)
    if not np.isfinite(region).all():
        raise DataError("the region contains samples that are not finite; move the region")
    lowest, highest = float(region.min()), float(region.max())
    if not highest - lowest > 1e-12 * max(abs(lowest), abs(highest)):
        raise DataError("no edge found: the region is uniform; move the region to an edge")
    scaled = (region - lowest) / (highest - lowest)
    across = direction if direction != "automatic" else _direction(scaled)
    return scaled if across == "horizontal" else scaled.T, highest - lowest, across


def _direction(region: NDArray[np.float64]) -> str:
    """Across what the picture changes most; means of blocks, which noise changes little."""
    if min(region.shape) >= 2 * _BLOCK:
        region = block_means(region, _BLOCK)
    across, along = (float(np.sum(np.diff(region, axis=axis) ** 2)) for axis in (1, 0))
    return "horizontal" if across >= along else "vertical"


def _per_mrad(intervals: tuple[float, float] | None, across: str, slope: float) -> float | None:
    """Cycles per mrad in a cycle per pixel, along the normal; pixels may be oblong."""
    if intervals is None:
        return None
    over, down = intervals if across == "horizontal" else intervals[::-1]
    in_pixels = math.cos(math.atan(slope))
    in_angle = math.cos(math.atan(slope * over / down))
    return in_pixels / in_angle / over


def _crossing(frequency: Vector, mtf: Vector, replicas: Array, level: float) -> Figure:
    value = slanted_edge.falls_to(frequency=frequency, mtf=mtf, level=level)
    crossings = [
        slanted_edge.falls_to(frequency=frequency, mtf=one, level=level) for one in replicas
    ]
    known = [one for one in crossings if one is not None]
    if value is None or len(known) < len(crossings):
        return value, None
    return value, float(slanted_edge.jackknife_error(replicas=np.array(known)))


# What a measured MTF is expected to be: the chain's own, along the same direction.

_FINE = 513
_AREA, _UNKNOWN = "area of the scene's samples", "not known"


@dataclass(frozen=True)
class Expected:
    """An expected MTF; frequencies in cycles per pixel, figures None where they lie beyond."""

    frequency: Vector
    mtf: Vector
    mtf50: float | None
    at_nyquist: float | None
    largest_difference: float
    largest_difference_at: float
    scene: str


Behind = tuple[Stages, Grid, Grid, bool]
"""Stages, the sampling at their end and their beginning, and whether a scene begins there."""


def chain_behind(image: Image) -> Behind | None:
    """What `expected` needs of a picture; None where not all of its way from the source is known.

    A scene in a file may be blurred by anything: of one straight from a file nothing is expected.
    """
    try:
        transfer = transfer_of(image)
    except DataError:
        return None
    is_scene = transfer.area_means
    if not is_scene and (transfer.source.inputs or not transfer.stages):
        return None
    return transfer.part("mtf"), transfer.grid, transfer.source_grid, is_scene


def expected(work: Work, measured: Measured, *, behind: Behind, differences: bool) -> Expected:
    """The modulus of all stages along the normal that was measured.

    With `differences` as the mean of rows shows it: the derivative of samples one pixel apart
    takes sin(πf)/(πf) of a frequency f. What is folded back from beyond Nyquist does not count.
    """
    stages, grid, source_grid, is_scene = behind
    normal = math.radians(measured.angle_deg)
    # A cycle per pixel along the normal, in cycles/mrad across and along.
    xi_per_pixel = math.cos(normal) / grid.interval_x_mrad
    eta_per_pixel = math.sin(normal) / grid.interval_y_mrad

    def mtf(frequency: Vector) -> Vector:
        xi, eta = frequency * xi_per_pixel, frequency * eta_per_pixel
        total = np.ones(len(frequency))
        for stage in stages:
            work.check()
            for factor in stage.factors:
                total = total * factor_at(work, factor, xi, eta)
        if is_scene:
            total = total * sinc(xi * source_grid.interval_x_mrad)
            total = total * sinc(eta * source_grid.interval_y_mrad)
        return np.abs(total * sinc(frequency)) if differences else np.abs(total)

    end = _end(source_grid, abs(xi_per_pixel), abs(eta_per_pixel))
    frequency = measured.frequency[measured.frequency <= end]
    here = mtf(frequency)
    fine = np.linspace(0.0, end, _FINE)
    apart = np.abs(measured.mtf[: len(frequency)] - here)
    largest = int(np.argmax(apart))
    return Expected(
        frequency,
        here,
        slanted_edge.falls_to(frequency=fine, mtf=mtf(fine), level=0.5),
        float(mtf(np.array([0.5]))[0]) if end == 0.5 else None,
        float(apart[largest]),
        float(frequency[largest]),
        _AREA if is_scene else _UNKNOWN,
    )


def _end(source: Grid, xi_per_pixel: float, eta_per_pixel: float) -> float:
    """Nyquist, or where the source's samples end if these are coarser."""
    pairs = (source.nyquist_x, xi_per_pixel), (source.nyquist_y, eta_per_pixel)
    least = min(nyquist / per_pixel for nyquist, per_pixel in pairs if per_pixel > 0.0)
    return 0.5 if least >= 0.5 * (1.0 - 1e-9) else least


Axis = Literal["cyc_per_mrad", "cyc_per_pixel"]
NYQUIST = 0.5  # cycles per pixel
UNITS: dict[Axis, str] = {"cyc_per_mrad": "cyc/mrad", "cyc_per_pixel": "cyc/pixel"}


def curve_of(work: Work, measured: Measured, *expected: Expected, axis: Axis) -> CurveData:
    axis, factor = _axis(measured, axis)
    x = measured.frequency * factor
    series = [Series("measured", x, measured.mtf)]
    if measured.error.any():
        series.append(Series("+ standard error", x, measured.mtf + measured.error))
        series.append(Series("− standard error", x, np.maximum(measured.mtf - measured.error, 0.0)))
    series += [Series("expected", curve.frequency * factor, curve.mtf) for curve in expected]
    return CurveData(
        f"MTF {measured.direction}",
        f"frequency ({UNITS[axis]})",
        "MTF",
        tuple(series),
        marks=(CurveMark("Nyquist", NYQUIST * factor),),
    )


def spread_of(work: Work, measured: Measured, *, unit: str) -> CurveData:
    y_label = f"value ({unit})" if unit else "value"
    spreads = ("edge spread", measured.spread), ("line spread", measured.line_spread)
    series = tuple(Series(name, measured.away, values) for name, values in spreads)
    return CurveData(f"Spread {measured.direction}", "distance (pixels)", y_label, series)


def table_of(
    work: Work, measured: Measured, *expected: Expected, axis: Axis, unit: str
) -> TableData:
    axis, factor = _axis(measured, axis)

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * factor

    one = expected[0] if expected else None
    unit_of_axis = UNITS[axis]
    rows: list[tuple[Any, ...]] = [
        ("direction", measured.direction, "", "direction of the measurement"),
        ("edge_angle_deg", measured.angle_deg, "deg", "direction of the edge's normal"),
    ]
    for name, (value, error), meaning in (
        ("mtf50", measured.mtf50, "frequency at which the MTF falls to 0.5"),
        ("mtf10", measured.mtf10, "frequency at which the MTF falls to 0.1"),
    ):
        rows.append((name, scaled(value), unit_of_axis, meaning))
        rows.append((f"{name}_error", scaled(error), unit_of_axis, f"standard error of {name}"))
    rows += [
        ("nyquist", NYQUIST * factor, unit_of_axis, "Nyquist frequency: half a cycle per pixel"),
        ("at_nyquist", measured.nyquist[0], "", "MTF at Nyquist"),
        ("at_nyquist_error", measured.nyquist[1], "", "standard error of at_nyquist"),
        ("contrast", measured.contrast, unit, "height of the step (edge) or of the peak (line)"),
        ("noise", measured.noise, unit, "standard deviation of the noise in one sample"),
        ("expected_mtf50", one and scaled(one.mtf50), unit_of_axis,
         "frequency at which the chain's own MTF falls to 0.5"),
        ("expected_at_nyquist", one and one.at_nyquist, "", "the chain's own MTF at Nyquist"),
        ("largest_difference", one and one.largest_difference, "",
         "largest difference, measured minus expected MTF, up to Nyquist"),
        ("largest_difference_at", one and scaled(one.largest_difference_at), unit_of_axis,
         "frequency at which measured and expected MTF differ most"),
        ("scene_blur", one and one.scene, "",
         "blur of the scene itself; included in the expected MTF if known"),
    ]  # fmt: skip
    return TableData.of(*rows)


def _axis(measured: Measured, axis: Axis) -> tuple[Axis, float]:
    """Axis and cycles on it in a cycle per pixel: without an interval per pixel."""
    if axis == "cyc_per_mrad" and measured.per_mrad is not None:
        return axis, measured.per_mrad
    return "cyc_per_pixel", 1.0


def figures_of(work: Work, measured: Measured, *expected: Expected) -> TableData:
    """The table's per mrad, none where that is not known, and some per pixel too."""
    rows = table_of(work, measured, *expected, axis="cyc_per_mrad", unit="").as_dict()
    if measured.per_mrad is None:
        rows |= dict.fromkeys(("mtf50", "mtf50_error", "mtf10", "expected_mtf50"))
    for name, value in (("mtf50", measured.mtf50[0]), ("mtf10", measured.mtf10[0])):
        rows[f"{name}_per_pixel"] = value
    return TableData.of(*rows.items())


_PIXELS = (0, 1024)  # of sliders


class MeasuredOutputs(NamedTuple):
    curve: Curve
    spread: Curve
    table: Table


class MeasuredMTF(Module, key="measured_mtf", title="Measured MTF", group="Analysis"):
    """Measure the MTF from an edge or a line in a picture.

    `slanted_edge` finds the angle of the edge and sorts the samples into quarter-sample bins by
    their distance from the edge. The derivative of the bin means is windowed, Fourier transformed,
    and corrected for the responses of the bins and of the derivative. Frequencies are measured
    along the edge's normal. `row_average` averages the rows, drops the flat ends and Fourier
    transforms the derivative. The MTF of `row_average` is the modulus of the Fourier transform,
    divided by its largest value; the response of the derivative, 0.64 at Nyquist, is not corrected
    for. Standard errors are estimated by leaving out rows (jackknife).

    `expected` is the MTF of the picture's chain in the same direction, up to Nyquist. The expected
    MTF includes all stages from the source on and, for a test scene, the blur of the scene's
    samples, which are means over their area. The blur of a scene from a file is unknown and not
    included; a picture straight from a file has no expected MTF. Aliasing in `row_average` is not
    included. `imagechain measure` finds the edges in pictures of real cameras. Source: ISO
    12233:2023; Tantalo 1996, eqs. 5.67 to 5.70 and appendix B.
    """

    formulas = (
        Formula(
            r"\mathrm{MTF}(f)=\frac{1}{\mathrm{sinc}(f/4)\,\mathrm{sinc}(f/2)}\;\left|\frac{"
            r"\sum_j w_j\,\ell_j\,e^{-2\pi ifx_j}}{\sum_j w_j\,\ell_j}\right|",
            where="ℓ: line spread function, the central difference of the edge in quarter-sample "
            "steps; w: window; f: cycles per sample along the edge's normal; the sincs correct "
            "for the quarter-sample bins and the finite difference",
            when="slanted_edge",
        ),
        Formula(
            r"\mathrm{MTF}(f)=\frac{|D(f)|}{\max|D|}",
            where="D: Fourier transform of the difference between neighbouring samples of the mean "
            "row",
            when="row_average",
        ),
    )

    method: Literal["slanted_edge", "row_average"] = param(
        "slanted_edge",
        "method: ISO 12233 for a slanted edge, or the row average of Tantalo 1996 "
        "for a vertical edge",
    )
    target: slanted_edge.Target = param(
        "edge", "feature in the region: an edge, or a line (its width counts as blur)"
    )
    direction: Direction = param(
        "automatic",
        "direction of the measurement: horizontal (for a vertical edge), vertical, or "
        "automatic: the direction of the larger change",
    )
    region_x: int = param(0, "first column of the region", low=0, unit="px", slider=_PIXELS)
    region_y: int = param(0, "first row of the region", low=0, unit="px", slider=_PIXELS)
    region_width: int | None = param(
        None, "columns in the region; empty: to the picture's end", low=0, unit="px", slider=_PIXELS
    )
    region_height: int | None = param(
        None, "rows in the region; empty: to the picture's end", low=0, unit="px", slider=_PIXELS
    )
    window: slanted_edge.Window = param(
        "tukey", "window on the line spread function; tukey: flat over its middle half"
    )
    samples: int = param(129, "number of points on the curve", (2, 4096), slider=(32, 1024))
    clip_left_px: int | None = param(
        None,
        "first sample of the edge along the measurement, counted from 0 at the region's start; "
        "empty: found automatically",
        low=0,
        zero_is_empty=False,
    )
    clip_right_px: int | None = param(
        None,
        "last sample of the edge along the measurement, counted from 0 at the region's start; "
        "empty: found automatically",
        low=0,
        zero_is_empty=False,
    )
    axis: Axis = param(
        "cyc_per_mrad",
        "unit of the frequency axis; always cycles per pixel if the picture has "
        "no sampling interval",
    )

    panel = (
        Section("", "method target direction"),
        Section("Region", "region_x region_y region_width region_height"),
        Section("Slanted edge", "window samples", shown_when=("method", ("slanted_edge",))),
        Section(
            "Extent of the edge",
            "clip_left_px clip_right_px",
            shown_when=("method", ("row_average",)),
        ),
        Section("Curve", "axis"),
    )

    def run(self, image: Image, here: NodeContext) -> MeasuredOutputs:
        known = image.interval_x_mrad is not None and image.interval_y_mrad is not None
        settings: dict[str, Any] = {
            "where": self._where(image),
            "intervals": (image.interval_x_mrad, image.interval_y_mrad) if known else None,
            "direction": self.direction,
            "target": self.target,
        }
        if self.method == "slanted_edge":
            settings |= {"window": self.window, "samples": self.samples}
            measured = here.step(measured_slanted, image.recipe, **settings)
        else:
            settings |= {"clip_left": self.clip_left_px, "clip_right": self.clip_right_px}
            measured = here.step(measured_rows, image.recipe, **settings)
        shown = {"axis": self.axis}
        behind = chain_behind(image)
        both = [measured]
        if behind is not None:
            differences = self.method == "row_average" and self.target == "edge"
            both.append(here.step(expected, measured, differences=differences, behind=behind))
        return MeasuredOutputs(
            Curve(here.step(curve_of, *both, **shown)),
            Curve(here.step(spread_of, measured, unit=image.unit)),
            Table(here.step(table_of, *both, unit=image.unit, **shown)),
        )

    def _where(self, image: Image) -> Region:
        ends = []
        for first, size, start, length, whole in (
            ("region_x", "region_width", self.region_x, self.region_width, image.columns),
            ("region_y", "region_height", self.region_y, self.region_height, image.rows),
        ):
            if start >= whole:
                raise ParameterError(first, start, f"0 to {whole - 1}, within the picture")
            if length is not None and start + length > whole:
                allowed = f"at most {whole - start} to end within the picture ({first} = {start})"
                raise ParameterError(size, length, allowed)
            ends.append(whole - start if length is None else length)
        return Region(self.region_y, self.region_x, ends[1], ends[0])

    figures = TableFigures(
        ("mtf50", "cyc/mrad", "Frequency at which the MTF falls to one half."),
        ("mtf50_error", "cyc/mrad", "Standard error of mtf50; only for a slanted edge."),
        ("mtf50_per_pixel", "cyc/pixel", "Frequency at which the MTF falls to one half, in cycles "
         "per pixel."),
        ("mtf10", "cyc/mrad", "Frequency at which the MTF falls to one tenth."),
        ("mtf10_per_pixel", "cyc/pixel", "Frequency at which the MTF falls to one tenth, in cycles "
         "per pixel."),
        ("at_nyquist", "", "MTF at half a cycle per pixel."),
        ("at_nyquist_error", "", "Standard error of at_nyquist."),
        ("expected_mtf50", "cyc/mrad", "Frequency at which the chain's own MTF falls to one half."),
        ("expected_at_nyquist", "", "The chain's own MTF at half a cycle per pixel."),
        ("largest_difference", "", "Largest difference between measured and expected MTF, up to "
         "Nyquist."),
        ("edge_angle_deg", "deg", "Direction in which the MTF is measured, normal to the edge: 0 "
         "horizontal, 90 vertical."),
        table=lambda outputs: Step.of(figures_of, *outputs.table.recipe.inputs),
    )  # fmt: skip
