"""The figures of the sensor in one row: noise, temperature resolution, and the run time."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from typing import Any, ClassVar

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.editor.declared_text import error_text
from app.editor.evaluation.evaluator import Evaluator, Freshness
from app.editor.evaluation.queries import Answer, PassDone, Passing, Query
from app.editor.session import Session
from app.editor.theme import FAINT, TEXT
from app.editor.viewers.viewer import Viewer
from app.editor.widgets import ElidedLabel, FlowLayout, filled, labelled
from app.run.figures import ELECTRONICS_FIGURES, SENSOR_FIGURES, sensor_node
from app.run.transfer_chain import HOW_TO_MARK, find_output, sound_part
from core.chain.engine import Plan
from core.errors import ImagechainError
from core.records import dataclass

RUN_TIME = "run_time"
OUTPUT = "output"


class FiguresStrip(Viewer):
    """Read-outs of the sensor before the final picture, and the time since the last change."""

    def __init__(
        self, session: Session, evaluator: Evaluator | None, parent: QWidget | None = None
    ) -> None:
        super().__init__(session, evaluator, "figures_strip", parent)
        self.setAccessibleName("Sensor figures")
        self._slots: list[tuple[ElidedLabel, ElidedLabel]] = []
        self._names: tuple[str, ...] = ()
        self._layout = FlowLayout(self, across=10, down=2)  # no figure is ever cut short
        self._layout.setContentsMargins(8, 2, 8, 3)
        for name, caption in ((OUTPUT, "Output"), *ELECTRONICS_FIGURES, (RUN_TIME, "Run time")):
            self._add(name, caption)
        self._name_slots(ELECTRONICS_FIGURES)
        session.selection_changed.connect(self.ask)
        self._freshness: Freshness | None = None
        if evaluator is not None:
            evaluator.pass_done.connect(self._pass_done)
            self._freshness = Freshness(session, evaluator, self)
            self._freshness.changed.connect(self._mark)
        self._show(None)
        self.label(RUN_TIME).show_text(NONE)

    def event(self, event: QEvent) -> bool:
        """No line of figures is cut off where they take several."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest):
            self.setMinimumHeight(self._layout.heightForWidth(self.width()))
        return super().event(event)

    def text(self, name: str) -> str:
        """The text shown for a read-out, such as ``snr``, for ``output`` or ``run_time``."""
        return self.label(name).text()

    def label(self, name: str) -> ElidedLabel:
        return self._slots[(OUTPUT, *self._names, RUN_TIME).index(name)][1]

    def _mark(self, _old: bool = False) -> None:
        # In words the status bar says it: captions that grow would move the figures.
        old = self._freshness is not None and self._freshness.is_old
        for name in self._names:
            self.label(name).setForegroundRole(FAINT if old else TEXT)

    def queries(self) -> tuple[Query, ...]:
        """The figures of the node selected, if it has such figures, else of the last one."""
        return (FiguresQuery(self._preferred()),)

    def take(self, answer: Answer) -> None:
        figures = answer.value if isinstance(answer.value, Figures) else None
        self._show(figures, "" if answer.error is None else str(answer.error))
        if self._freshness is not None:
            self._freshness.catch_up(answer.generation)

    def follow_opening(self) -> None:
        self._show(None)
        self.label(RUN_TIME).show_text(NONE)

    def _add(self, name: str, caption: str) -> None:
        both = QWidget(self)
        head = ElidedLabel(f"{self.owner}.{name}.caption", f"What {caption} means", both)
        head.show_text(caption)
        value = ElidedLabel(f"{self.owner}.{name}", caption, both)
        filled(QVBoxLayout(both), head, value, spacing=0)
        self._layout.addWidget(both)
        head.setForegroundRole(FAINT)
        self._slots.append((head, value))

    def _name_slots(self, shown: Sequence[tuple[str, str]]) -> None:
        names = tuple(name for name, _ in shown)
        if names == self._names:
            return
        self._names = names
        for (head, value), (name, caption) in zip(self._slots[1:-1], shown, strict=True):
            labelled(head, f"{self.owner}.{name}.caption", f"What {caption} means")
            head.show_text(caption)
            labelled(value, f"{self.owner}.{name}", caption)

    def _show(self, answer: Figures | None, why: str = "") -> None:
        figures = {} if answer is None else {figure.name: figure for figure in answer.figures}
        missing = self._show_output(answer, why)
        none = (
            why
            or missing
            or ("no Focal Plane or Electronics & Noise module in the network computes this figure")
        )
        if figures:
            self._name_slots([(figure.name, figure.caption) for figure in figures.values()])
        elif answer is not None and answer.node is None:
            self._name_slots(ELECTRONICS_FIGURES)  # not those of a sensor that is gone
        for name in self._names:
            label = self.label(name)
            figure: Figure | None = figures.get(name)
            if figure is None:
                label.show_text(NONE, none)
            else:
                node = answer.node if answer is not None else ""
                exact = "" if figure.value is None else f" {figure.value!r} {figure.unit}".rstrip()
                text = figure_text(figure.value, figure.unit)
                about = f" None: {figure.reason}." if figure.reason else exact
                label.show_text(text, f"{figure.meaning}{about} ({node})")

    def _show_output(self, answer: Figures | None, why: str) -> str:
        """Show which picture is the output; returns why none is."""
        label = self.label(OUTPUT)
        if answer is None:
            label.show_text(NONE, why)
        elif answer.output is not None:
            label.show_text(answer.output, "The network's output picture")
        else:
            label.show_text(
                f"{len(answer.choices)} pictures" if answer.choices else NONE, answer.missing
            )
        return "" if answer is None else answer.missing

    def _preferred(self) -> str | None:
        for name in reversed(self.session.selection):
            declared = self.session.declared(name)
            if declared is not None and declared.key in SENSOR_FIGURES:
                return name
        return None

    def _pass_done(self, done: Any) -> None:
        if isinstance(done, PassDone) and done.after_edit and not done.cancelled:
            kind = f"a preview at 1:{done.reduced}" if done.reduced > 1 else "everything shown"
            about = f"Computing {kind} took {done.seconds:.4f} s after the last change"
            self.label(RUN_TIME).show_text(figure_text(done.seconds, "s"), about)


# The query of the figures strip: the sensor's figures among the electronics' read-outs.


@dataclass(frozen=True)
class Figure:
    """One read-out; `value` None where there is none, `reason` why, where that is known."""

    name: str
    caption: str
    value: Any
    unit: str
    meaning: str
    reason: str = ""


@dataclass(frozen=True)
class Figures:
    # the electronics; None where there is none, or it is not clear which leads to the output
    node: str | None
    figures: tuple[Figure, ...] = ()  # its read-outs
    output: str | None = None  # port of the picture that the network delivers
    missing: str = ""  # why there is none, in one line
    choices: tuple[str, ...] = ()  # ports of the pictures that could be meant, where none is marked


@dataclass(frozen=True)
class FiguresQuery(Query):
    urgency: ClassVar[int] = 1

    preferred: str | None = None  # the node to show if there are several; else it is the last one

    def key(self, plan: Plan) -> Hashable:
        output = _output_of(plan)
        name = sensor_node(plan, self.preferred)
        if name is None:
            return self, output
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return self, output, name, planned.node.disabled, getattr(table, "key", None)

    def answer(self, passing: Passing) -> Figures:
        plan = passing.plan
        output = _output_of(plan)
        name = sensor_node(plan, self.preferred)
        if name is None:
            return Figures(None, (), *output)
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        engine, values, reasons = passing.engine, dict[str, Any](), dict[str, str]()
        if not planned.node.disabled:
            values = engine.readouts(plan, name, passing.work)
            reasons = {
                readout: engine.why_none(plan, name, passing.work, readout)
                for readout, _ in SENSOR_FIGURES[planned.node.module]
                if values.get(readout) is None
            }
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        return Figures(
            name,
            tuple(
                Figure(
                    readout,
                    caption,
                    values.get(readout),
                    declared[readout].unit,
                    declared[readout].meaning,
                    reasons.get(readout, ""),
                )
                for readout, caption in SENSOR_FIGURES[planned.node.module]
            ),
            *output,
        )


def _output_of(plan: Plan) -> tuple[str | None, str, tuple[str, ...]]:
    """The picture that the network delivers, or why there is none, and the candidates for it."""
    try:
        output = find_output(sound_part(plan))
    except ImagechainError as error:
        return None, error_text(error), ()
    missing = f"{output.missing}; {HOW_TO_MARK}" if output.choices else output.missing
    return output.port, missing, output.choices


# Figures as text: four digits, and a unit with the prefix that reads well.

NONE = "—"
_PREFIXED = ("Hz", "K", "s", "W/m²/sr", "e-")
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def figure_text(value: Any, unit: str) -> str:
    """A figure in four digits with its unit, which may get a prefix; a dash for none."""
    if value is None:
        return NONE
    if not isinstance(value, int | float):
        return str(value)
    factor, shown_unit = prefixed(value, unit)
    text = f"{value / factor:.4g} {shown_unit}"
    return text.strip().replace("-", "\N{MINUS SIGN}")


def prefixed(value: float, unit: str) -> tuple[float, str]:
    """What a figure is divided by to be read well, and its unit with the prefix for that."""
    if unit in _PREFIXED and value and math.isfinite(value):
        power = min(9, max(-9, 3 * math.floor(math.log10(abs(float(f"{value:.4g}"))) / 3)))
        return 10.0**power, f"{_PREFIXES[power]}{unit}"
    return 1.0, unit
