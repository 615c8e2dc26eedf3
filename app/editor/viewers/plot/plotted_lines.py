"""What is plotted of a chain or a port: the queries, and their answers as lines to be drawn."""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from typing import Any, ClassVar, Literal

import numpy as np

from app.editor.declared_text import error_text
from app.editor.evaluation.queries import Passing, Query
from app.run import transfer_chain
from core.arrays import Vector
from core.chain.engine import Plan
from core.chain.wires import Curve, CurveData, CurveMark, Table, TableData
from core.errors import NetworkError
from core.network.macro import SEPARATOR
from core.records import dataclass, replace
from core.transfer.factors import Grid, Planar
from nodes.analysis.lineage import Line as Direction

Parts = Literal["mtf", "ptf", "both"]
_AXES = {0.0: "ξ", 90.0: "η"}
_DECADES = 8  # below the greatest value that a logarithmic ordinate shows at most
_SAME = 0.005  # of the ordinates' range: curves nearer to one another look like one
_MOST = 0.9  # of its points
_MANY, _FEW = 200, 24  # stages: of more than so many, so many are drawn
_BOUNDS = ("+ ", "\N{MINUS SIGN} ")  # how the labels of limits around a curve begin


@dataclass(frozen=True)
class Entry:
    name: str  # unique in the drawing
    title: str  # for people
    total: bool = False  # whether it is a product of the others
    shown: bool = True  # whether it is shown until the person chooses otherwise
    bound: bool = False  # whether it is a limit around the entry before it
    over: int = 0  # on how many of the entries before it it lies: these are to be seen through it
    # the entry of the present state, where it is the same curve of a kept one; else empty
    of: str = ""
    strong: bool = False  # whether it is the one that is looked at


@dataclass(frozen=True, eq=False)
class Line:
    name: str
    x: Vector
    y: Vector


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes; `least` is the range that the ordinate shows at least, unless `log`."""

    y_label: str
    lines: tuple[Line, ...]
    least: tuple[float, float] | None = None
    log: bool = False

    def drawn(self, y: Vector) -> Vector:
        """Ordinates as they are drawn: NaN, a gap, where there is nothing to draw."""
        y = np.asarray(y, np.float64)
        if self.log:
            y = _logarithm(y)
        return y if np.isfinite(y).all() else np.where(np.isfinite(y), y, np.nan)


@dataclass(frozen=True, eq=False)
class Drawing:
    """All that is plotted; with `bars`, their names, each line is a height for each of them.

    With `log_x` abscissae are drawn by their logarithm. `note` stands in the legend: what is
    missing there, and why, a line each.
    """

    x_label: str
    entries: tuple[Entry, ...] = ()
    panels: tuple[Panel, ...] = ()
    marks: tuple[CurveMark, ...] = ()
    bars: tuple[str, ...] = ()
    log_x: bool = False
    note: str = ""

    @property
    def x_range(self) -> tuple[float, float] | None:
        drawn = [self.drawn_x(line.x) for panel in self.panels for line in panel.lines]
        there = _finite(drawn)
        return (float(there.min()), float(there.max())) if len(there) else None

    def drawn_x(self, x: Vector) -> Vector:
        """Abscissae as they are drawn: NaN where a logarithm has none."""
        return _logarithm(x) if self.log_x else x

    def x_at(self, drawn: float) -> float:
        return float(10.0**drawn) if self.log_x else drawn


def transfer_drawing(
    curves: TransferCurves, parts: Parts, *, log: bool = False, strong: str = ""
) -> Drawing:
    """MTF, PTF or both of a chain; a PTF that is 0 everywhere is not drawn.

    `strong` is the node whose curve is looked at, or a macro with several.
    With `log` the modulus of the MTF, which is signed, by its logarithm. Of very many stages only
    those that do most are drawn, with all products.
    """
    drawn = _drawn_of(curves.curves)
    entries = tuple(
        Entry(
            curve.name,
            curve.title if kind == "total" else curve.name + " (beside)" * (kind == "beside"),
            kind == "total",
            kind == "total" or (curve.acts and kind == "stage"),
            strong=f"{curve.name}{SEPARATOR}".startswith(f"{strong}{SEPARATOR}"),
        )
        for kind, curve in drawn
    )
    panels = []
    if parts in ("mtf", "both"):
        lines = (
            Line(curve.name, curves.frequency, np.abs(curve.x.mtf) if log else curve.x.mtf)
            for _, curve in drawn
        )
        panels.append(Panel("|MTF|" if log else "MTF", tuple(lines), (0.0, 1.0), log))
    if parts in ("ptf", "both"):
        shifting = [curve for _, curve in drawn if curve.x.ptf_rad.any()]
        lines = (Line(curve.name, curves.frequency, curve.x.ptf_rad) for curve in shifting)
        panels.append(Panel("PTF (rad)", tuple(lines), None if shifting else (-1.0, 1.0)))
    along = _AXES.get(curves.angle_deg % 180.0)
    label = along or f"frequency along {curves.angle_deg:g}°"
    notes = [f"no Total: {curves.missing}"] if curves.missing and entries else []
    if len(drawn) < len(curves.curves):
        stages = sum(kind != "total" for kind, _ in curves.curves)
        notes += [
            f"Strongest {_FEW} of {stages:,} stages",
            "Save the plot as CSV to get all stages",
        ]
    return Drawing(
        f"{label} (cyc/mrad)", entries, tuple(panels), curves.marks, note="\n".join(notes)
    )


def _drawn_of(curves: Curves) -> Curves:
    """All curves, or of very many stages those that change most along the line."""
    stages = [curve for kind, curve in curves if kind != "total"]
    if len(stages) <= _MANY:
        return curves

    def change(stage: transfer_chain.StageResponse) -> float:
        return float(max(np.abs(stage.x.mtf - 1).max(), np.abs(stage.x.ptf_rad).max()))

    few = {stage.name for stage in sorted(stages, key=change, reverse=True)[:_FEW]}
    return tuple(one for one in curves if one[0] == "total" or one[1].name in few)


def curve_drawing(data: CurveData, *, log: bool = False) -> Drawing:
    """Curves or bars of a port, by their logarithm with `log`."""
    lines = tuple(
        Line(str(number), series.x, series.y) for number, series in enumerate(data.series)
    )
    least = (0.0, 1.0) if data.y_label == "MTF" else None
    panel = Panel(data.y_label, lines, least, log)
    overs = _overlaps(panel) if not data.bars else (0,) * len(lines)
    entries = tuple(
        Entry(
            line.name,
            series.label or f"curve {line.name}",
            series.label.startswith("Total"),
            bound=series.label.startswith(_BOUNDS),
            over=over,
        )
        for line, series, over in zip(lines, data.series, overs, strict=True)
    )
    return Drawing(data.x_label, entries, (panel,), data.marks, data.bars, data.log_x)


def _overlaps(panel: Panel) -> tuple[int, ...]:
    """On how many lines before it each line lies, as far as one can see."""
    low, high = y_range(panel, [line.name for line in panel.lines])
    near = _SAME * (high - low)
    return tuple(
        sum(_lies_on(line, other, panel, near) for other in panel.lines[:number])
        for number, line in enumerate(panel.lines)
    )


def _lies_on(line: Line, other: Line, panel: Panel, near: float) -> bool:
    if min(len(line.x), len(other.x)) < 2 or not (np.diff(other.x) > 0).all():
        return False
    beneath = np.interp(line.x, other.x, panel.drawn(other.y), left=np.nan, right=np.nan)
    with np.errstate(invalid="ignore"):
        same = np.abs(panel.drawn(line.y) - beneath) <= near
    return bool(same.mean() > _MOST)


def _logarithm(values: Vector) -> Vector:
    values = np.asarray(values, np.float64)
    return np.log10(values, out=np.full(values.shape, np.nan), where=values > 0)


def _finite(arrays: Sequence[Vector]) -> Vector:
    """All numbers of several arrays."""
    values = np.concatenate(arrays or [np.zeros(0)])
    return values[np.isfinite(values)]


def y_range(panel: Panel, shown: Iterable[str]) -> tuple[float, float]:
    """What the ordinate has to show for these entries as drawn, with a little room around."""
    names = set(shown)
    drawn = [panel.drawn(line.y) for line in panel.lines if line.name in names]
    least = (panel.least if not panel.log else None) or ()
    there = _finite([*drawn, np.array(least)])
    if not len(there):
        return -1.0, 1.0
    low, high = float(there.min()), float(there.max())
    if panel.log:
        low = max(low, high - _DECADES)
    room = 0.04 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def same_points(one: tuple[Vector | None, Vector | None], other: tuple[Vector, Vector]) -> bool:
    """Whether abscissae and ordinates are the same; a gap equals a gap."""
    pairs = zip(one, other, strict=True)
    return all(a is not None and np.array_equal(a, b, equal_nan=True) for a, b in pairs)


def value_at(line: Line, x: float) -> float | None:
    """Ordinate at an abscissa, linear between points; None outside and in gaps."""
    if not len(line.x) or not line.x[0] <= x <= line.x[-1]:
        return None
    with np.errstate(invalid="ignore"):
        value = float(np.interp(x, line.x, line.y))
    return value if np.isfinite(value) else None


# The curves of a kept state, A, drawn beside those of the present one, B.

MARK = "A "
"""What the names of kept curves begin with."""


def with_kept(drawing: Drawing, kept: Drawing, name: str) -> Drawing:
    """The drawing with the kept curves that differ from the present ones of the same title.

    They stand behind the present ones in the legend, and are drawn dashed in their colours. Where
    the two have other axes, or bars, only a note says so, with the kept state's name.
    """
    if not kept.panels or not drawing.panels:
        return drawing
    if drawing.bars or _axes(kept) != _axes(drawing):
        note = f"A ({name}) is not drawn: its axes differ from B's, or the plot has bars"
        return replace(drawing, note="\n".join(filter(None, (drawing.note, note))))
    names = {entry.title: entry.name for entry in kept.entries}
    panels, differing = [], set()
    for panel, before in zip(drawing.panels, kept.panels, strict=True):
        now = {line.name: line for line in panel.lines}
        then = {line.name: line for line in before.lines}
        lines = list(panel.lines)
        for entry in drawing.entries:
            old, new = then.get(names.get(entry.title, "")), now.get(entry.name)
            if old and not (new and same_points((old.x, old.y), (new.x, new.y))):
                differing.add(entry.name)
                lines.append(Line(MARK + entry.name, old.x, old.y))
        panels.append(replace(panel, lines=tuple(lines)))
    entries = tuple(
        Entry(MARK + entry.name, f"A: {entry.title}", entry.total, entry.shown, of=entry.name)
        for entry in drawing.entries
        if entry.name in differing
    )
    return replace(drawing, entries=(*drawing.entries, *entries), panels=tuple(panels))


def _axes(drawing: Drawing) -> Hashable:
    labels = tuple(panel.y_label for panel in drawing.panels)
    return drawing.x_label, drawing.log_x, drawing.bars, labels


Kind = Literal["stage", "beside", "total"]
FINEST = 1025  # points of a curve


Curves = tuple[tuple[Kind, transfer_chain.StageResponse], ...]
"""Along a line; whether each leads to the final picture, stands beside, or is a product."""


@dataclass(frozen=True, eq=False)
class TransferCurves:
    angle_deg: float  # direction of the line
    frequency: Vector  # cycles/mrad along the line
    curves: Curves  # the stages and products
    # frequencies along the line: the cutoff of the optics and Nyquist, which is that of the
    # spectrum's samples, called so where the pixels', of a coarser pitch or once samples are
    # combined, is marked beside it
    marks: tuple[CurveMark, ...]
    # what cannot be planned or computed, and why, in one line; empty where all can
    trouble: str = ""
    missing: str = ""  # why there is no total, in one line; empty where there is one


@dataclass(frozen=True)
class CurvesQuery(Query):
    """MTF and PTF of every stage that leads to the final picture, and of their product.

    Of a network with errors, what can be planned.
    """

    urgency: ClassVar[int] = 1

    angle_deg: float = 0.0  # direction of the line: 0 across, 90 along

    def key(self, plan: Plan) -> Hashable:
        sound = transfer_chain.sound_part(plan)
        chain = transfer_chain.find_chain(sound)
        stages = tuple(
            (stage.node, stage.title, tuple((f.key, f.node) for f in stage.factors))
            for stage in (*chain.stages, *chain.later, *chain.beside)
        )
        parts = len(chain.stages), len(chain.later), chain.missing
        return self, chain.grid, chain.combined, parts, stages, _trouble(plan, ())

    def answer(self, passing: Passing) -> TransferCurves:
        chain = transfer_chain.find_chain(transfer_chain.sound_part(passing.plan))
        grid = chain.grid
        if grid is None:
            trouble = _trouble(passing.plan, ())
            missing = _missing(chain)
            return TransferCurves(self.angle_deg, np.zeros(0), (), (), trouble, missing)
        samples = min(FINEST, max(grid.rows, grid.columns) // 2 + 1)
        responses = transfer_chain.responses_along(chain, passing.work, self.angle_deg, samples)
        kinds: tuple[tuple[Kind, tuple[transfer_chain.StageResponse, ...]], ...] = (
            ("stage", responses.stages), ("beside", responses.beside), ("total", responses.products)
        )  # fmt: skip
        curves = tuple((kind, stage) for kind, stages in kinds for stage in stages)
        marks = _marks(chain, grid, Direction.at(self.angle_deg))
        trouble = _trouble(passing.plan, tuple(error_text(error) for error in responses.failed))
        return TransferCurves(self.angle_deg, responses.xi, curves, marks, trouble, _missing(chain))


@dataclass(frozen=True)
class PortDataQuery(Query):
    urgency: ClassVar[int] = 1

    port: str  # ``NODE.PORT``

    def key(self, plan: Plan) -> Hashable:
        return self, self._value(plan).key

    def answer(self, passing: Passing) -> CurveData | TableData:
        self._value(passing.plan)
        data: CurveData | TableData = passing.engine.value(passing.plan, self.port, passing.work)
        return data

    def _value(self, plan: Plan) -> Curve | Table:
        value: Any = plan.output(self.port)
        if not isinstance(value, Curve | Table):
            kind = getattr(value, "port_type", type(value).__name__)
            raise NetworkError(
                f"{self.port} is of type {kind}: only curves and tables can be plotted"
            )
        return value


_ALIKE = 0.99  # of one another, where one mark is enough


def _marks(chain: transfer_chain.Chain, grid: Grid, line: Direction) -> tuple[CurveMark, ...]:
    nyquist = line.end(grid.nyquist_x, grid.nyquist_y)
    pixels = line.end(*(math.inf if end is None else end for end in chain.pixel_nyquist))
    marks = [CurveMark("Nyquist", nyquist)]
    if pixels < _ALIKE * nyquist:
        marks = [CurveMark("samples' Nyquist", nyquist), CurveMark("pixels' Nyquist", pixels)]
    planar = (f for stage in chain.stages for f in stage.factors if isinstance(f, Planar))
    cutoffs = [cutoff for cutoff in map(_cutoff_along(line), planar) if cutoff]
    if cutoffs:
        marks.append(CurveMark("optics cutoff", min(cutoffs)))
    return tuple(marks)


def _cutoff_along(line: Direction) -> Any:
    def cutoff(factor: Planar) -> float | None:
        if factor.cutoff is None:
            return None
        x, y = factor.cutoff
        if line.along == 0.0 or line.across == 0.0:
            return x if line.along == 0.0 else y
        # The OTF of a disc ends on an ellipse; where other shapes' do, their extents do not show.
        return 1.0 / math.hypot(line.across / x, line.along / y) if factor.radial else None

    return cutoff


def _missing(chain: transfer_chain.Chain) -> str:
    return f"{chain.missing}; {transfer_chain.HOW_TO_MARK}" if chain.choices else chain.missing


def _trouble(plan: Plan, further: tuple[str, ...]) -> str:
    texts = [error_text(error) for error in plan.errors()]
    texts += [text for text in further if text not in texts]
    if len(texts) > 1:
        return f"{texts[0]} (and {len(texts) - 1} more)"
    return texts[0] if texts else ""
