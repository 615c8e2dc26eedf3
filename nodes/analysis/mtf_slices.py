"""MTF Slices: every stage's transfer function and their product, along lines."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from core.chain import wires
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param, readout
from core.transfer.factors import Grid, Part
from nodes.analysis import lineage

Lines = tuple[lineage.Line, ...]
Seen = wires.Transfer | wires.Magnitude
SAMPLES, PIXELS = "Nyquist of the samples", "Nyquist of the pixels"
_ALIKE = 0.999  # of one another, where one mark is enough


class CurveOutput(NamedTuple):
    curve: wires.Curve


class MtfSlices(Module, key="mtf_slices", title="MTF Slices", group="Analysis"):
    """Plot the MTF of each stage and of the total along a line, from zero to Nyquist.

    Stages are evaluated only on the plotted line, so the plot is fast. For a magnitude, the MTFs
    are plotted, not the picture's spectrum; for a PTF, the phases and their sum. The plot ends at
    the Nyquist frequency of the image's samples. The pixels' Nyquist frequency, half a cycle per
    pitch, is marked if Init & Trans or Camera has a pitch. Source: Tantalo 1996, figs. 5.26 and
    5.53.
    """

    formulas = (
        Formula(
            r"M(f)=\prod_k M_k(f\cos\alpha,\,f\sin\alpha)",
            where="M_k: MTF of a stage; α: direction in the frequency plane",
        ),
    )

    direction: Literal["horizontal", "vertical", "angle", "both"] = param(
        "horizontal", "direction of the slice; both: horizontal and vertical"
    )
    angle_deg: float = param(45.0, "angle of the slice: 0 horizontal, 90 vertical", (-360, 360))
    samples: int = param(257, "number of points on each curve", (2, 65536), slider=(32, 1024))
    stages: bool = param(True, "show every stage, not only the total")

    panel = (
        Section("Direction in the frequency plane", "direction"),
        Section("", "angle_deg", shown_when=("direction", ("angle",))),
        Section("Curves", "stages samples"),
    )

    def run(self, transfer: Seen, here: NodeContext) -> CurveOutput:
        part: Part = transfer.part if isinstance(transfer, wires.Transfer) else "mtf"
        shown: Any = {"lines": self._lines(), "part": part, "samples": self.samples}
        shown["marks"] = self._marks(transfer)
        if isinstance(transfer, wires.Transfer) and transfer.own is not None:
            recipe = here.step(own_slices, transfer.own, label=transfer.label, **shown)
        else:
            shown |= {"stages": lineage.stages_of(transfer.factors), "grid": transfer.grid}
            recipe = here.step(slices, stagewise=self.stages, **shown)
        return CurveOutput(wires.Curve(recipe))

    def _lines(self) -> Lines:
        if self.direction == "angle":
            return (lineage.Line.at(self.angle_deg),)
        if self.direction == "both":
            return lineage.HORIZONTAL, lineage.VERTICAL
        return (lineage.HORIZONTAL if self.direction == "horizontal" else lineage.VERTICAL,)

    def _marks(self, transfer: Seen) -> tuple[wires.CurveMark, ...]:
        """Where the image's samples end along the lines, and where the pixels would."""
        marks = []
        for line in self._lines():
            nyquist, pixels = _ends(transfer, line)
            within = pixels is not None and pixels <= nyquist * (1.0 + 1e-9)
            if pixels is not None and within:
                marks.append(wires.CurveMark(_named(PIXELS, line, self._lines()), pixels))
            if pixels is None or not within or pixels < _ALIKE * nyquist:
                marks.append(wires.CurveMark(_named(SAMPLES, line, self._lines()), nyquist))
        return tuple(marks)

    @readout()
    def at_nyquist_x(self, axis: str, transfer: Seen) -> Recipe | None:
        """Total MTF (or PTF, rad) at the horizontal Nyquist frequency of the image's samples."""
        return _at(transfer, axis, 0)

    @readout()
    def at_pixel_nyquist_x(self, axis: str, transfer: Seen) -> Recipe | None:
        """Total MTF (or PTF, rad) at the pixels' horizontal Nyquist frequency, 0.5 cycles/pitch."""
        return _at(transfer, axis, 1)


def _ends(transfer: Seen, line: lineage.Line) -> tuple[float, float | None]:
    """Where the line leaves the band of the samples, and that of the pixels, if it is known."""
    grid = transfer.grid
    x, y = (0.5 / pixel if pixel else math.inf for pixel in transfer.pixel_mrad)
    pixels = line.end(x, y)
    return line.end(grid.nyquist_x, grid.nyquist_y), pixels if math.isfinite(pixels) else None


def _at(transfer: Seen, axis: str, which: int) -> Recipe | None:
    """At the Nyquist frequency of the samples, 0, or of the pixels, 1."""
    line = lineage.HORIZONTAL if axis == "x" else lineage.VERTICAL
    frequency = _ends(transfer, line)[which]
    if frequency is None or (isinstance(transfer, wires.Transfer) and transfer.own is not None):
        return None
    part: Part = transfer.part if isinstance(transfer, wires.Transfer) else "mtf"
    whole = lineage.Stage("", transfer.factors)
    return Step.of(value_at, stage=whole, part=part, line=line, frequency=frequency)


def value_at(
    work: Work, *, stage: lineage.Stage, part: Part, line: lineage.Line, frequency: float
) -> float:
    return float(lineage.stage_along(work, stage, part, line, np.array([frequency]))[0])


def slices(
    work: Work, *, stages: lineage.Stages, grid: Grid, samples: int, stagewise: bool, **shown: Any
) -> wires.CurveData:
    lines, part = shown["lines"], shown["part"]
    series = []
    for line in lines:
        frequency = line.frequencies(grid, samples)
        total = np.ones(samples) if part == "mtf" else np.zeros(samples)
        for stage in stages:
            work.check()
            value = lineage.stage_along(work, stage, part, line, frequency)
            total = total * value if part == "mtf" else total + value
            if stagewise:
                series.append(wires.Series(_named(stage.label, line, lines), frequency, value))
        series.append(wires.Series(_named(f"Total {part.upper()}", line, lines), frequency, total))
    return _curves(series, **shown)


def own_slices(
    work: Work, sampled: wires.SampledTransfer, *, label: str, samples: int, **shown: Any
) -> wires.CurveData:
    lines, part = shown["lines"], shown["part"]
    series = []
    for line in lines:
        frequency, value = lineage.samples_along(sampled, part, line, samples)
        series.append(wires.Series(_named(label or part.upper(), line, lines), frequency, value))
    return _curves(series, **shown)


def _named(label: str, line: lineage.Line, lines: Lines) -> str:
    return label if len(lines) == 1 else f"{label} {line.name}"


def _curves(
    series: list[wires.Series], *, part: Part, lines: Lines, marks: tuple[wires.CurveMark, ...]
) -> wires.CurveData:
    where = " and ".join(line.name for line in lines)
    y_label = "MTF" if part == "mtf" else "PTF (rad)"
    title = f"{part.upper()} {where}"
    return wires.CurveData(title, "frequency (cyc/mrad)", y_label, tuple(series), marks=marks)
