"""The figures of the sensor in one row: noise, temperature resolution, and the run time."""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping, Sequence
from typing import Any, ClassVar

from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.editor import declared_text, theme, widgets
from app.editor.evaluation.evaluator import Evaluator, Freshness
from app.editor.evaluation.queries import Answer, PassDone, Passing, Query
from app.editor.session import Session
from app.editor.viewers.viewer import Viewer
from app.run.evaluation import ELECTRONICS_FIGURES, SENSOR_FIGURES, sensor_node
from app.run.transfer_chain import HOW_TO_MARK, find_output, sound_part
from core.chain.engine import Plan
from core.errors import ImagechainError
from core.modules.preview import signed
from core.records import dataclass

RUN_TIME = "run_time"
OUTPUT = "output"


class FiguresStrip(Viewer):
    """Read-outs of the sensor before the final picture, and the time since the last change."""

    def __init__(self, session: Session, evaluator: Evaluator) -> None:
        super().__init__(session, evaluator, "figures_strip")
        self.setAccessibleName("Sensor figures")
        self._slots: list[tuple[widgets.ElidedLabel, widgets.ElidedLabel]] = []
        self._names: tuple[str, ...] = ()
        self._layout = widgets.FlowLayout(self, across=10, down=2)  # no figure is ever cut short
        self._layout.setContentsMargins(8, 2, 8, 3)
        for _ in (OUTPUT, *ELECTRONICS_FIGURES, RUN_TIME):
            self._add_slot()
        self._name_slots(ELECTRONICS_FIGURES)
        session.selection_changed.connect(self.ask)
        evaluator.pass_done.connect(self._pass_done)
        self._freshness = Freshness(session, evaluator, self)
        self._freshness.changed.connect(self._mark)
        self.follow_opening()

    def event(self, event: QEvent) -> bool:
        """No line of figures is cut off where they take several."""
        if event.type() in (QEvent.Type.Resize, QEvent.Type.LayoutRequest):
            self.setMinimumHeight(self._layout.heightForWidth(self.width()))
        return super().event(event)

    def text(self, name: str) -> str:
        """The text shown for a read-out, such as ``snr``, for ``output`` or ``run_time``."""
        return self.label(name).text()

    def label(self, name: str) -> widgets.ElidedLabel:
        return self._slots[(OUTPUT, *self._names, RUN_TIME).index(name)][1]

    def _mark(self, _old: bool = False) -> None:
        # In words the status bar says it: captions that grow would move the figures.
        role = theme.FAINT if self._freshness.is_old else theme.TEXT
        for name in self._names:
            self.label(name).setForegroundRole(role)

    def queries(self) -> tuple[Query, ...]:
        """The figures of the node selected, if it has such figures, else of the last one."""
        for name in reversed(self.session.selection):
            declared = self.session.declared(name)
            if declared is not None and declared.key in SENSOR_FIGURES:
                return (FiguresQuery(name),)
        return (FiguresQuery(),)

    def take(self, answer: Answer) -> None:
        self._show(answer.value, "" if answer.error is None else str(answer.error))
        self._freshness.catch_up(answer.generation)

    def follow_opening(self) -> None:
        self._show(None)
        self.label(RUN_TIME).show_text(NONE)

    def _add_slot(self) -> None:
        both = QWidget(self)
        head, value = widgets.ElidedLabel("", "", both), widgets.ElidedLabel("", "", both)
        widgets.filled(QVBoxLayout(both), head, value, spacing=0)
        self._layout.addWidget(both)
        head.setForegroundRole(theme.FAINT)
        self._slots.append((head, value))

    def _name_slots(self, shown: Sequence[tuple[str, str]]) -> None:
        names = tuple(name for name, _ in shown)
        if names == self._names:
            return
        self._names = names
        captions = ((OUTPUT, "Output"), *shown, (RUN_TIME, "Run time"))
        for (head, value), (name, caption) in zip(self._slots, captions, strict=True):
            widgets.labelled(head, f"{self.owner}.{name}.caption", f"What {caption} means")
            head.show_text(caption)
            widgets.labelled(value, f"{self.owner}.{name}", caption)

    def _show(self, answer: Figures | None, why: str = "") -> None:
        port, missing, choices = answer.output if answer is not None else (None, why, ())
        several = f"{len(choices)} pictures" if choices else NONE
        about = "The network's output picture" if port else missing
        self.label(OUTPUT).show_text(port or several, about)
        if answer is not None and (answer.figures or answer.node is None):
            captions = SENSOR_FIGURES[answer.module] if answer.figures else ELECTRONICS_FIGURES
            self._name_slots(captions)  # not those of a sensor that is gone
        none = NONE, why or missing or _NO_SENSOR
        for name in self._names:
            self.label(name).show_text(*(answer.figures.get(name, none) if answer else none))

    def _pass_done(self, done: Any) -> None:
        if isinstance(done, PassDone) and done.after_edit and not done.cancelled:
            kind = f"a preview at 1:{done.reduced}" if done.reduced > 1 else "everything shown"
            about = f"Computing {kind} took {done.seconds:.4f} s after the last change"
            self.label(RUN_TIME).show_text(figure_text(done.seconds, "s"), about)


_NO_SENSOR = "no Focal Plane or Electronics & Noise module in the network computes this figure"
# port of the picture that the network delivers, why there is none, and ports that could be meant
_Output = tuple[str | None, str, tuple[str, ...]]


@dataclass(frozen=True)
class Figures:
    # the electronics; None where there is none, or it is not clear which leads to the output
    node: str | None
    module: str
    figures: Mapping[str, tuple[str, str]]  # text and meaning of its read-outs, by name
    output: _Output


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
        plan, engine, work = passing.plan, passing.engine, passing.work
        output = _output_of(plan)
        name = sensor_node(plan, self.preferred)
        if name is None:
            return Figures(None, "", {}, output)
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        values = {} if planned.node.disabled else engine.readouts(plan, name, work)
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        figures = {}
        for readout, _ in SENSOR_FIGURES[planned.node.module]:
            value, unit = values.get(readout), declared[readout].unit
            about = "" if value is None else f" {value!r} {unit}".rstrip()
            if value is None and values:
                reason = engine.why_none(plan, name, work, readout)
                about = f" None: {reason}." if reason else ""
            figures[readout] = (
                figure_text(value, unit), f"{declared[readout].meaning}{about} ({name})"
            )  # fmt: skip
        return Figures(name, planned.node.module, figures, output)


def _output_of(plan: Plan) -> _Output:
    try:
        output = find_output(sound_part(plan))
    except ImagechainError as error:
        return None, declared_text.error_text(error), ()
    missing = f"{output.missing}; {HOW_TO_MARK}" if output.choices else output.missing
    return output.port, missing, output.choices


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
    return signed(f"{value / factor:.4g} {shown_unit}".strip())


def prefixed(value: float, unit: str) -> tuple[float, str]:
    """What a figure is divided by to be read well, and its unit with the prefix for that."""
    if unit in _PREFIXED and value and math.isfinite(value):
        power = min(9, max(-9, 3 * math.floor(math.log10(abs(float(f"{value:.4g}"))) / 3)))
        return 10.0**power, f"{_PREFIXES[power]}{unit}"
    return 1.0, unit
