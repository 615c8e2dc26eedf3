"""MTF or PTF of a node along both axes, and the preview of it."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.run.responses import Axis as Direction
from app.run.responses import response
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Transfer
from core.errors import DataError
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules.preview import (
    Axis,
    Curve,
    Mark,
    Plot,
    Preview,
    Style,
    Upright,
    brief,
    pair,
    round_step,
)
from core.transfer.factors import Part

Vector = NDArray[np.float64]
SAMPLES = 257
LOWEST_SHARE = 1e-3  # of the highest frequency, on a logarithmic axis
_FLOORS = (0.999, 0.99, 0.9, 0.5)  # an MTF that stays above one of these is shown from there on
_HEADROOM = 0.22  # above the curves, for what is written there
_NOTHING = 1e-12


@dataclass(frozen=True, eq=False)
class TransferLine:
    """A transfer function along one axis."""

    # frequency, values: shape (points,): cycles/mrad from 0 on; signed MTF, or PTF in radians
    frequency: Vector
    values: Vector
    nyquist: float  # of the image, cycles/mrad
    at_nyquist: float  # the value there; NaN where the curve does not reach it
    # where the modulus of an MTF first falls to one half, cycles/mrad; None: nowhere here
    half: float | None
    # from where on an aperture passes nothing, cycles/mrad, where there is one
    cutoff: float | None


@dataclass(frozen=True, eq=False)
class TransferLines:
    """A transfer function across (x) and along (y).

    `turn` is a frequency, cycles/mrad, that a logarithmic axis is needed to see.
    """

    part: Part
    x: TransferLine
    y: TransferLine
    turn: float | None = None

    @cached_property
    def alike(self) -> bool:
        """Whether both axes have the same curve."""
        return (
            self.x.values.shape == self.y.values.shape
            and np.allclose(self.x.frequency, self.y.frequency, rtol=1e-6, atol=0)
            and np.allclose(self.x.values, self.y.values, rtol=0, atol=1e-6)
        )


@dataclass(frozen=True)
class TransferQuery(Query):
    """The node's own MTF, or PTF, from 0 to the image's Nyquist frequency or a cutoff."""

    urgency: ClassVar[int] = 1

    node: str
    part: Part = "mtf"

    def key(self, plan: Plan) -> Hashable:
        transfer: Transfer = plan.output(f"{self.node}.{self.part}")
        return transfer.key, plan.node(self.node).node.disabled

    def answer(self, passing: Passing) -> TransferLines | None:
        planned, work = passing.plan.node(self.node), passing.work
        transfer: Transfer = passing.plan.output(f"{self.node}.{self.part}")
        if planned.node.disabled:
            return None
        cutoffs = tuple(_cutoff(planned, axis, work) for axis in ("x", "y"))
        if transfer.own is not None:
            return _sampled(transfer, cutoffs, work)
        turn = _turn(planned)
        grid = transfer.grid
        lines = []
        places: tuple[tuple[Direction, float], ...] = (("x", grid.nyquist_x), ("y", grid.nyquist_y))
        for (axis, nyquist), cutoff in zip(places, cutoffs, strict=True):
            frequency = _frequencies(max(nyquist, cutoff or 0.0), turn)
            asked = np.append(frequency, nyquist)
            sampled = response(work, transfer.factors, asked, axis)
            values = sampled.mtf if self.part == "mtf" else sampled.ptf
            lines.append(_line(frequency, values[:-1], nyquist, values[-1], cutoff, self.part))
        return TransferLines(self.part, lines[0], lines[1], turn)


def _frequencies(end: float, turn: float | None) -> Vector:
    if turn is None:
        return np.linspace(0.0, end, SAMPLES)
    low = min(turn, end) * LOWEST_SHARE**0.5
    return np.concatenate(([0.0], np.geomspace(low, end, SAMPLES - 1)))


def _line(
    frequency: Vector, values: Vector, nyquist: float, at: float, cutoff: float | None, part: Part
) -> TransferLine:
    if not np.all(np.isfinite(values)):
        raise DataError("the transfer function has values that are not finite")
    half = half_contrast(frequency, values) if part == "mtf" else None
    return TransferLine(frequency, values, nyquist, float(at), half, cutoff)


def half_contrast(frequency: Vector, values: Vector) -> float | None:
    """Where the modulus first falls to one half, between two points on a straight line."""
    modulus = np.abs(values)
    below = np.flatnonzero(modulus <= 0.5)
    if not below.size or below[0] == 0:
        return None
    last = int(below[0])
    high, low = modulus[last - 1], modulus[last]
    share = (high - 0.5) / (high - low)
    return float(frequency[last - 1] + share * (frequency[last] - frequency[last - 1]))


def _sampled(transfer: Transfer, cutoffs: tuple[float | None, ...], work: Work) -> TransferLines:
    """Of a function with frequencies of its own: its first row and column, in FFT order."""
    assert transfer.own is not None
    own = work.value(transfer.own)
    rows, columns = own.values.shape
    grid = transfer.grid
    sides = (
        (own.values[0, : (columns + 1) // 2], own.interval_x, grid.nyquist_x, cutoffs[0]),
        (own.values[: (rows + 1) // 2, 0], own.interval_y, grid.nyquist_y, cutoffs[1]),
    )
    lines = []
    for values, interval, nyquist, cutoff in sides:
        frequency = np.arange(len(values)) * interval
        reach = frequency <= max(nyquist, cutoff or 0.0) + interval
        frequency, shown = frequency[reach], np.asarray(values[reach], np.float64)
        at = float(np.interp(nyquist, frequency, shown, right=np.nan))
        lines.append(_line(frequency, shown, nyquist, at, cutoff, transfer.part))
    return TransferLines(transfer.part, lines[0], lines[1])


def _cutoff(planned: PlannedNode, axis: str, work: Work) -> float | None:
    """The cutoff that the node's module declares, as an exit pupil's does."""
    module: Any = planned.module
    cutoff_of = getattr(module, f"cutoff_{axis}", None)
    if cutoff_of is None:
        return None
    cutoff = cutoff_of(planned.inputs["context"], planned.inputs["pupil"])
    return float(work.value(cutoff) if isinstance(cutoff, Recipe) else cutoff)


def _turn(planned: PlannedNode) -> float | None:
    """The frequency from which on light is scattered aside, far below all others."""
    module: Any = planned.module
    if getattr(module, "turbidity", "none") == "none":
        return None
    return float(module.turbidity_cutoff_cyc_per_mrad)


@dataclass(frozen=True)
class TransferPreviewQuery(TransferQuery):
    """The curves up to the image's Nyquist frequency, or further, to where an aperture ends."""

    def answer(self, passing: Passing) -> Any:
        lines = super().answer(passing)
        return None if lines is None else _preview(lines)


def _preview(lines: TransferLines) -> Preview:
    named = [(lines.x, "x = y", 0)] if lines.alike else [(lines.x, "x", 0), (lines.y, "y", 1)]
    curves: list[Curve] = []
    marks: list[Mark] = []
    for line, name, number in named:
        style: Style = "dashed" if number else "solid"
        curves.append(Curve(line.frequency, line.values, number, style, name))
        if lines.part == "mtf" and line.values.min() < 0:
            modulus = np.where(line.values < 0, -line.values, np.nan)
            curves.append(Curve(line.frequency, modulus, number, "dotted", width=1.2))
        if line.half is not None:
            which = "" if lines.alike else f" ({name})"
            marks.append(Mark(line.half, 0.5, f"½ at {brief(line.half)}{which}", number, number))
    return Preview(
        _in_words(lines),
        (
            Plot(
                _across(lines),
                _up(lines),
                curves=tuple(curves),
                marks=tuple(marks),
                uprights=tuple(_uprights(lines)),
                levels=(0.5,) if lines.part == "mtf" else (),
            ),
        ),
    )


def _uprights(lines: TransferLines) -> Iterator[Upright]:
    x, y = lines.x, lines.y
    if brief(x.nyquist) == brief(y.nyquist):
        yield Upright(x.nyquist, f"Nyquist {brief(x.nyquist)}")
    else:
        yield Upright(x.nyquist, f"Nyquist x {brief(x.nyquist)}")
        yield Upright(y.nyquist, f"Nyquist y {brief(y.nyquist)}", 1)
    for number, line in enumerate((x, y)):
        if line.cutoff is None or (number and brief(line.cutoff) == brief(x.cutoff or 0.0)):
            continue
        which = "" if brief(x.cutoff or 0.0) == brief(y.cutoff or 0.0) else f" {'xy'[number]}"
        yield Upright(line.cutoff, f"cutoff{which} {brief(line.cutoff)}", 2 + number)


def _in_words(lines: TransferLines) -> str:
    """The essential numbers."""
    x, y = lines.x, lines.y
    unit = "" if lines.part == "mtf" else " rad"
    text = f"{lines.part.upper()} at the Nyquist frequency {pair(x.nyquist, y.nyquist)} cyc/mrad: "
    text += _both(x.at_nyquist, y.at_nyquist, unit)
    if x.half is not None or y.half is not None:
        text += f"; half contrast at {_both(x.half, y.half, ' cyc/mrad')}"
    if x.cutoff is not None and y.cutoff is not None:
        text += f"; cutoff {_both(x.cutoff, y.cutoff, ' cyc/mrad')}"
    return text


def _both(x: float | None, y: float | None, unit: str) -> str:
    across, along = ("none" if v is None else brief(_clean(v)) + unit for v in (x, y))
    return across if across == along else f"{across} across, {along} along"


def _clean(value: float) -> float:
    """Without what rounding leaves of 0."""
    return 0.0 if abs(value) < _NOTHING else value


def _across(lines: TransferLines) -> Axis:
    title = "spatial frequency (cyc/mrad)"
    end = max(line.frequency[-1] for line in (lines.x, lines.y))
    end = max(end, lines.x.nyquist, lines.y.nyquist)
    if lines.turn is None:
        return Axis(0.0, end * 1.03, title)
    return Axis(min(lines.turn, end) * LOWEST_SHARE**0.5, end * 1.2, title, log=True)


def _up(lines: TransferLines) -> Axis:
    values = np.concatenate([lines.x.values, lines.y.values])
    least, most = float(values.min()), float(values.max())
    if lines.part == "ptf":
        size = max(abs(least), abs(most))
        step = round_step(size / 2) if size > 0 else 0.5
        low = -2 * step if least < 0 else 0.0
        high = 2 * step if most > 0 or least == 0 else 0.0
        return Axis(low, high + _HEADROOM * (high - low), "PTF (rad)", reach=high)
    low = next((floor for floor in _FLOORS if least >= floor and least < 1), 0.0)
    if least < 0:
        low = -0.25 if least > -0.25 else -1.0
    high = max(1.0, most)
    return Axis(low, high + _HEADROOM * (high - low), "MTF", reach=high)
