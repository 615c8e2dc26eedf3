"""MTF or PTF of a node along both axes, and the preview of it."""

from collections.abc import Callable, Hashable, Iterator
from functools import partial
from typing import Any, ClassVar

import numpy as np

from app.editor.evaluation.queries import Passing, Query
from app.run.transfer_chain import Axis as Direction
from app.run.transfer_chain import response
from core.arrays import Vector
from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Transfer
from core.errors import DataError
from core.evaluation.recipes import Recipe
from core.evaluation.work import Work
from core.modules import preview
from core.records import dataclass
from core.transfer.factors import Part

SAMPLES = 257
LOWEST_SHARE = 1e-3  # of the highest frequency, on a logarithmic axis
_FLOORS = (0.999, 0.99, 0.9, 0.5)  # an MTF that stays above one of these is shown from there on
_HEADROOM = 0.22  # above the curves, for what is written there
_NOTHING = 1e-12
_SHARPENINGS = 2  # each to 1/256 of the step before


@dataclass(frozen=True, eq=False)
class TransferLine:
    # frequency, values: shape (points,): cycles/mrad from 0 on; signed MTF, or PTF in radians
    frequency: Vector
    values: Vector
    nyquist: float  # of the image, cycles/mrad
    at_nyquist: float  # the value there; NaN where the curve does not reach it
    # where the modulus of an MTF first falls to one half, cycles/mrad; None: nowhere here
    half: float | None
    # from where on an aperture passes nothing, cycles/mrad, where there is one
    cutoff: float | None


@dataclass(frozen=True)
class TransferPreviewQuery(Query):
    """The node's own MTF, or PTF, up to the image's Nyquist frequency or, further, a cutoff."""

    urgency: ClassVar[int] = 1

    node: str
    part: Part = "mtf"

    def key(self, plan: Plan) -> Hashable:
        transfer: Transfer = plan.output(f"{self.node}.{self.part}")
        return transfer.key, plan.node(self.node).node.disabled

    def answer(self, passing: Passing) -> preview.Preview | None:
        if passing.plan.node(self.node).node.disabled:
            return None
        x, y = transfer_lines(passing, self.node, self.part)
        return _preview(self.part, x, y, _turn(passing.plan.node(self.node)))


def transfer_lines(passing: Passing, node: str, part: Part) -> tuple[TransferLine, TransferLine]:
    planned, work = passing.plan.node(node), passing.work
    transfer: Transfer = passing.plan.output(f"{node}.{part}")
    own = work.value(transfer.own) if transfer.own is not None else None
    turn, grid = _turn(planned), transfer.grid

    def line(axis: Direction, nyquist: float) -> TransferLine:
        cutoff = _cutoff(planned, axis, work)
        end = max(nyquist, cutoff or 0.0)
        if own is None:

            def values_at(frequencies: Vector) -> Vector:
                sampled = response(work, transfer.factors, frequencies, axis)
                return sampled.mtf if part == "mtf" else sampled.ptf_rad

            places = np.linspace(0.0, end, SAMPLES)
            if turn is not None:
                places = np.append(0.0, np.geomspace(_lowest(end, turn), end, SAMPLES - 1))
            return _line(places, values_at, nyquist, cutoff, part)
        # The first row or column of a function with frequencies of its own, in FFT order.
        row = own.values[0] if axis == "x" else own.values[:, 0]
        row = np.asarray(row[: (len(row) + 1) // 2], np.float64)
        interval = own.interval_x if axis == "x" else own.interval_y
        frequency: Vector = np.arange(len(row), dtype=np.float64) * interval
        between: Any = partial(np.interp, xp=frequency, fp=row, right=np.nan)
        return _line(frequency[frequency <= end + interval], between, nyquist, cutoff, part)

    return line("x", grid.nyquist_x), line("y", grid.nyquist_y)


def _lowest(end: float, turn: float) -> float:
    """Where a logarithmic axis begins."""
    return float(min(turn, end) * LOWEST_SHARE**0.5)


def _line(
    frequency: Vector,
    values_at: Callable[[Vector], Vector],
    nyquist: float,
    cutoff: float | None,
    part: Part,
) -> TransferLine:
    *values, at = values_at(np.append(frequency, nyquist))
    shown = np.array(values)
    if not np.all(np.isfinite(shown)):
        raise DataError("the transfer function has values that are not finite")
    half = _half_contrast(frequency, shown, values_at) if part == "mtf" else None
    return TransferLine(frequency, shown, nyquist, float(at), half, cutoff)


def _half_contrast(
    frequency: Vector, values: Vector, values_at: Callable[[Vector], Vector]
) -> float | None:
    """Where the modulus first falls to one half, on a straight line between two points.

    It is looked for twice more between these: a curve that falls within the plot's first steps is
    not straight between two of them.
    """
    half = None
    for step in range(1 + _SHARPENINGS):
        modulus = np.abs(values_at(frequency) if step else values)
        below = np.flatnonzero(modulus <= 0.5)
        if not below.size or below[0] == 0:
            break
        last = int(below[0])
        high, low = modulus[last - 1], modulus[last]
        share = (high - 0.5) / (high - low)
        half = float(frequency[last - 1] + share * (frequency[last] - frequency[last - 1]))
        frequency = np.linspace(frequency[last - 1], frequency[last], SAMPLES)
    return half


def _cutoff(planned: PlannedNode, axis: str, work: Work) -> float | None:
    module: Any = planned.module
    cutoff_of = getattr(module, "cutoff_x", None)  # which gives both axes
    if cutoff_of is None:
        return None
    cutoff = cutoff_of(axis, planned.inputs["context"], planned.inputs["pupil"])
    return float(work.value(cutoff) if isinstance(cutoff, Recipe) else cutoff)


def _turn(planned: PlannedNode) -> float | None:
    """The frequency from which on light is scattered aside, far below all others."""
    module: Any = planned.module
    if getattr(module, "turbidity", "none") == "none":
        return None
    return float(module.turbidity_cutoff_cyc_per_mrad)


def _preview(part: Part, x: TransferLine, y: TransferLine, turn: float | None) -> preview.Preview:
    alike = (
        x.values.shape == y.values.shape
        and np.allclose(x.frequency, y.frequency, rtol=1e-6, atol=0)
        and np.allclose(x.values, y.values, rtol=0, atol=1e-6)
    )
    named = [(x, "x = y", 0)] if alike else [(x, "x", 0), (y, "y", 1)]
    curves: list[preview.Curve] = []
    marks: list[preview.Mark] = []
    for line, name, number in named:
        style: preview.Style = "dashed" if number else "solid"
        curves.append(preview.Curve(line.frequency, line.values, number, style, name))
        if part == "mtf" and line.values.min() < 0:
            modulus = np.where(line.values < 0, -line.values, np.nan)
            curves.append(preview.Curve(line.frequency, modulus, number, "dotted", width=1.2))
        if line.half is not None:
            which = "" if alike else f" ({name})"
            marks.append(
                preview.Mark(
                    line.half, 0.5, f"½ at {preview.brief(line.half)}{which}", number, number
                )
            )
    chart = preview.Plot(
        _across(x, y, turn),
        _up(part, np.concatenate([x.values, y.values])),
        curves=tuple(curves),
        marks=tuple(marks),
        uprights=tuple(_uprights(x, y)),
        levels=(0.5,) if part == "mtf" else (),
    )
    return preview.Preview(_in_words(part, x, y), (chart,))


def _uprights(x: TransferLine, y: TransferLine) -> Iterator[tuple[float, str, int]]:
    """Nyquist frequencies and cutoffs, once where both axes have the same."""
    lines = {0: x, 1: y}
    for name, down, values in (
        ("Nyquist", 0, {n: line.nyquist for n, line in lines.items()}),
        ("cutoff", 2, {n: line.cutoff for n, line in lines.items() if line.cutoff is not None}),
    ):
        one = len({preview.brief(value) for value in values.values()}) == 1
        for number, value in list(values.items())[: 1 if one else 2]:
            which = "" if one else f" {'xy'[number]}"
            yield value, f"{name}{which} {preview.brief(value)}", down + number


def _in_words(part: Part, x: TransferLine, y: TransferLine) -> str:
    unit = "" if part == "mtf" else " rad"
    text = (
        f"{part.upper()} at the Nyquist frequency {preview.pair(x.nyquist, y.nyquist)} cyc/mrad: "
    )
    text += _both(x.at_nyquist, y.at_nyquist, unit)
    if x.half is not None or y.half is not None:
        text += f"; MTF50 {_both(x.half, y.half, ' cyc/mrad')}"
    if x.cutoff is not None and y.cutoff is not None:
        text += f"; cutoff {_both(x.cutoff, y.cutoff, ' cyc/mrad')}"
    return text


def _both(x: float | None, y: float | None, unit: str) -> str:
    # What rounding leaves of 0 is 0.
    across, along = (
        "none" if v is None else preview.brief(v if abs(v) >= _NOTHING else 0.0) + unit
        for v in (x, y)
    )
    return across if across == along else f"{across} (x), {along} (y)"


def _across(x: TransferLine, y: TransferLine, turn: float | None) -> preview.Axis:
    title = "spatial frequency (cyc/mrad)"
    end = max(x.frequency[-1], y.frequency[-1], x.nyquist, y.nyquist)
    if turn is None:
        return preview.Axis(0.0, end * 1.03, title)
    return preview.Axis(_lowest(end, turn), end * 1.2, title, log=True)


def _up(part: Part, values: Vector) -> preview.Axis:
    least, most = float(values.min()), float(values.max())
    if part == "ptf":
        size = max(abs(least), abs(most))
        step = preview.round_step(size / 2) if size > 0 else 0.5
        low = -2 * step if least < 0 else 0.0
        high = 2 * step if most > 0 or least == 0 else 0.0
        return preview.Axis(low, high + _HEADROOM * (high - low), "PTF (rad)", reach=high)
    low = next((floor for floor in _FLOORS if least >= floor and least < 1), 0.0)
    if least < 0:
        low = -0.25 if least > -0.25 else -1.0
    high = max(1.0, most)
    return preview.Axis(low, high + _HEADROOM * (high - low), "MTF", reach=high)
