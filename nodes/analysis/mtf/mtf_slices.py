"""MTF Slices: every stage's transfer function and their product, along lines."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

import numpy as np

from core.chain.results import CurveData, SampledTransfer, Series
from core.chain.wires import Curve, Magnitude, Transfer
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.transfer.factors import Part
from core.transfer.grid import Grid
from nodes.analysis.lineage.line_transfer import (
    Line,
    Stage,
    samples_along,
    stage_along,
    stages_of,
)

HORIZONTAL = Line("horizontal", 1.0, 0.0)
VERTICAL = Line("vertical", 0.0, 1.0)


class CurveOutput(NamedTuple):
    """Curves."""

    curve: Curve


class MtfSlices(Module, key="mtf_slices", title="MTF Slices", group="Analysis"):
    """Plot the MTF of each stage and the total along a line, from zero to the band's end.

    Stages are evaluated on the line itself, so that slices of a chain cost next to nothing. Of a
    magnitude its MTFs are shown, not the picture's spectrum; of a PTF the phases and their sum.
    Source: Tantalo 1996, figs. 5.26 and 5.53.
    """

    direction: Annotated[
        Literal["horizontal", "vertical", "angle", "both"],
        Param("line of frequencies; both: horizontal and vertical"),
    ] = "horizontal"
    angle_deg: Annotated[
        float,
        Param("direction of the line: 0 horizontal, 90 vertical", unit="deg", low=-360, high=360),
    ] = 45.0
    samples: Annotated[int, Param("points of each curve", low=2, high=65536, slider=(32, 1024))] = (
        257
    )
    stages: Annotated[bool, Param("each stage too, not the total alone")] = True

    panel = (
        Section("Line of frequencies", ("direction",)),
        Section("", ("angle_deg",), shown_when=("direction", ("angle",))),
        Section("Curves", ("stages", "samples")),
    )

    def run(self, transfer: Transfer | Magnitude, here: NodeContext) -> CurveOutput:
        """Plan the curves."""
        part: Part = transfer.part if isinstance(transfer, Transfer) else "mtf"
        if isinstance(transfer, Transfer) and transfer.own is not None:
            recipe = Step.of(
                own_slices,
                transfer.own,
                node=here.node,
                lines=self._lines(),
                part=part,
                samples=self.samples,
                label=transfer.label,
            )
        else:
            recipe = Step.of(
                slices,
                node=here.node,
                lines=self._lines(),
                stages=stages_of(transfer.factors),
                part=part,
                grid=transfer.grid,
                samples=self.samples,
                stagewise=self.stages,
            )
        return CurveOutput(Curve(recipe))

    def _lines(self) -> tuple[Line, ...]:
        if self.direction == "angle":
            return (Line.at(self.angle_deg),)
        if self.direction == "both":
            return HORIZONTAL, VERTICAL
        return (HORIZONTAL if self.direction == "horizontal" else VERTICAL,)

    @readout()
    def at_nyquist_x(self, transfer: Transfer | Magnitude) -> Recipe | None:
        """Total at the Nyquist frequency across (a PTF in radians)."""
        return _end(transfer, HORIZONTAL)

    @readout()
    def at_nyquist_y(self, transfer: Transfer | Magnitude) -> Recipe | None:
        """Total at the Nyquist frequency along (a PTF in radians)."""
        return _end(transfer, VERTICAL)


def _end(transfer: Transfer | Magnitude, line: Line) -> Recipe | None:
    if isinstance(transfer, Transfer) and transfer.own is not None:
        return None
    part: Part = transfer.part if isinstance(transfer, Transfer) else "mtf"
    whole = Stage("", transfer.factors)
    return Step.of(value_at_end, stage=whole, part=part, grid=transfer.grid, line=line)


@ends_lineage
def value_at_end(work: Work, *, stage: Stage, part: Part, grid: Grid, line: Line) -> float:
    """Value where the line leaves the band."""
    end = np.array([line.end(grid.nyquist_x, grid.nyquist_y)])
    return float(stage_along(work, stage, part, line, end)[0])


@ends_lineage
def slices(
    work: Work,
    *,
    lines: tuple[Line, ...],
    stages: tuple[Stage, ...],
    part: Part,
    grid: Grid,
    samples: int,
    stagewise: bool,
) -> CurveData:
    """Curves of the stages, if `stagewise`, and of the total."""
    series = []
    for line in lines:
        frequency = line.frequencies(grid, samples)
        total = np.ones(samples) if part == "mtf" else np.zeros(samples)
        for stage in stages:
            work.check()
            value = stage_along(work, stage, part, line, frequency)
            total = total * value if part == "mtf" else total + value
            if stagewise:
                series.append(Series(_named(stage.label, line, lines), frequency, value))
        series.append(Series(_named(f"Total {part.upper()}", line, lines), frequency, total))
    return _curves(series, part, lines)


@ends_lineage
def own_slices(
    work: Work,
    sampled: SampledTransfer,
    *,
    lines: tuple[Line, ...],
    part: Part,
    samples: int,
    label: str,
) -> CurveData:
    """Curves of a function with frequency intervals of its own."""
    series = []
    for line in lines:
        frequency, value = samples_along(sampled, part, line, samples)
        series.append(Series(_named(label or part.upper(), line, lines), frequency, value))
    return _curves(series, part, lines)


def _named(label: str, line: Line, lines: tuple[Line, ...]) -> str:
    return label if len(lines) == 1 else f"{label} {line.name}"


def _curves(series: list[Series], part: Part, lines: tuple[Line, ...]) -> CurveData:
    where = " and ".join(line.name for line in lines)
    y_label = "MTF" if part == "mtf" else "PTF (rad)"
    return CurveData(f"{part.upper()} {where}", "frequency (cyc/mrad)", y_label, tuple(series))
