"""Fields for numbers, with a slider, and for names of files."""

import math
import re
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from PySide6.QtCore import QEvent, QSignalBlocker, QStringListModel, Qt, QTimer, Signal
from PySide6.QtGui import QFocusEvent, QHideEvent, QKeyEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QCompleter, QFileDialog, QMenu, QSlider, QWidget

from app.editor import messages, theme, widgets
from app.editor.declared_text import about, placeholder_of, shown_number, tip, typed_number
from app.editor.panels.fields.field import TextField
from app.editor.panels.fields.type_in import STEPS, discard_typing, step_factor
from core.editing.operations import set_parameter
from core.errors import ParameterError, thaw
from core.modules.parameters import Parameter
from core.modules.preview import round_step
from core.network.linked_values import expression
from core.records import dataclass

WHEEL_REST_MS = 400
_HOW_TO_DRAG = "Drag the name sideways to change the value (Shift: finer, Ctrl: coarser)"
_UNLINK = "To unlink, type a value, or right-click and choose Unlink"
_HOW_TO_TYPE = (
    "Type a number, arithmetic (2*0.3), a value in another unit, or = and an "
    "expression with other parameters. Arrow keys and the wheel change the value in steps "
    "(Shift: finer, Ctrl: coarser)"
)


class NumberField(TextField):
    """A number, with a slider that rounds nothing typed; a linked one has its expression there."""

    lines_up = True

    def build(self) -> None:
        self.scale = scale_of(self.parameter)
        edit = self.build_edit(steps=True)
        self._least_edit = edit.minimumWidth()
        if self.parameter.empty:
            edit.setPlaceholderText(placeholder_of(self.parameter))
        edit.textEdited.connect(self._offer_names)
        edit.stepped.connect(self._step_freely)
        edit.step_ended.connect(self._end)
        edit.turned.connect(self._turn)
        self.slider = Slider(self.scale.positions, self)
        self.named(self.slider, ", slider", "slider")
        self.slider.setToolTip(tip(about(self.parameter)))
        self.slider.moved.connect(
            lambda at: self._offer_moved(self.scale.value_at(at / self.scale.positions))
        )
        self.slider.stepped.connect(self._step)
        self.slider.finished.connect(self._end)
        self.slider.given_up.connect(self._give_up_drag)
        self.slider.typed.connect(self._begin_typing)
        self.linked_value = widgets.plain_label(
            f"linked_value.{self.parameter.name}", self, role=theme.CHANGED
        )
        self.linked_value.setAccessibleName(f"value of {self.title}")
        self.linked_value.setWordWrap(False)
        beside = (self.unit, self.linked_value)
        widgets.filled(self.row, self.label, (self.slider, 1), (edit, 1), *beside)
        self.label.setToolTip(tip(f"{self.title}: {about(self.parameter)}\n{_HOW_TO_DRAG}"))
        self.label.dragged.connect(self._drag)
        self.label.finished.connect(self._end)
        self.label.given_up.connect(self._give_up_drag)
        self._part = 0.0
        self._gesture: object | None = None
        self._show_link()

    def line_up(self, label: int, unit: int, room: int) -> None:
        """Show all of what an empty field means, where that leaves room for the slider."""
        super().line_up(label, unit, room)
        metrics = self.fontMetrics()
        meant = metrics.horizontalAdvance(self.edit.placeholderText()) + metrics.height()
        most = room - self.slider.minimumWidth()
        self.edit.setMinimumWidth(max(self._least_edit, min(meant, most)))

    def show_value(self, value: Any) -> None:
        """Show a number, all of it; or the expression it follows, and its value beside."""
        if self.link is not None or not self.linked_value.isHidden():
            self._show_link()
        if self.link is not None:
            self.edit.show_text(f"= {self.link.text}")
        else:
            self.edit.show_text("" if value is None else shown_number(value))
        self.slider.show_position(self.scale.position_of(value))

    def take(self, text: str) -> None:
        text = text.strip()
        if text.startswith("="):
            self._offer_link(text[1:].strip())
            return
        try:
            number = typed_number(text, self.parameter)
        except ParameterError as error:
            self.refuse_typed(error)
            return
        self.offer(number)

    def add_link_actions(self, menu: QMenu) -> None:
        if self.link is None:
            about = "Type an expression after ="
            widgets.offer(
                menu,
                "link",
                "Link to other parameters…",
                partial(self._begin_typing, "= "),
                about=about,
            )
            return
        value = "" if self.link.problem else f", keep {self.shown_value}"
        unlinking = widgets.offer(menu, "unlink", f"Unlink{value}", self._unlink)
        unlinking.setEnabled(not self.link.problem)

    def _show_link(self) -> None:
        link = self.link
        self.label.set_drags(link is None)
        self.slider.setVisible(link is None)
        self.unit.setVisible(link is None)
        self.linked_value.setVisible(link is not None)
        how = _HOW_TO_TYPE
        if link is not None:
            value = "no value" if link.problem else self.shown_value
            self.linked_value.setText(value if link.problem else f"= {value}")
            how = f"Linked: = {link.text}\nValue: {value}\n{_UNLINK}"
        self.edit.setToolTip(tip(f"{about(self.parameter)}\n{how}"))

    def _turn(self, event: Any) -> None:
        """Take the wheel over the typed number."""
        if self.link is None:
            self.edit.commit()
            self.slider.turn(event, self.edit)

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        self._end()

    def _begin_typing(self, text: str) -> None:
        self.edit.setFocus(Qt.FocusReason.OtherFocusReason)
        self.edit.setText(text)
        self.edit.setModified(True)

    def _unlink(self) -> None:
        discard_typing(self)
        node, name = self.node, self.parameter.name
        if node.is_there:
            value = thaw(node.session.valued(node.name).params[name])
            node.do(set_parameter(node.name, name, value, f"Unlink {node.name}.{name}"))

    def _offer_names(self, text: str) -> None:
        """List the names that have the last word of an expression in them, unless it is one."""
        word = _last_word(text)
        names = self.node.names_beside() if word else []
        if word and self.edit.names is None:
            completer = self.edit.names = QCompleter(self)
            completer.setFilterMode(Qt.MatchFlag.MatchContains)
            completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
            completer.setWidget(self.edit)
            completer.activated.connect(self._take_name)
        if (shown := self.edit.names) is not None:
            shown.setModel(QStringListModel([] if word in names else names, shown))
            shown.setCompletionPrefix(word)
            shown.complete()  # which hides the list where there is nothing in it

    def _take_name(self, name: str) -> None:
        text = self.edit.text()
        self.edit.setText(text.removesuffix(_last_word(text)) + name)
        self.edit.setModified(True)

    def _offer_link(self, text: str) -> None:
        raw = expression(text)
        fault = self.node.session.link_fault(self.node.name, self.parameter.name, raw)
        if fault is not None:
            self.refuse_typed(fault)
        else:
            self.put(raw)

    def _step(self, steps: float) -> None:
        stepped = self.scale.stepped(self.value, steps)
        self._offer_moved(self.scale.within(stepped, self.value))

    def _step_freely(self, steps: float) -> None:
        if self.link is not None:
            self._show_problem(f"{self.title} follows {self.link.text}: {_UNLINK}")
        elif not self.edit.marked:
            self._offer_moved(self.scale.stepped(self.value, steps))

    def _drag(self, steps: float) -> None:
        """By the name; of whole numbers, parts of a step are gathered."""
        if self.scale.whole:
            self._part += steps
            steps = int(self._part)
            self._part -= steps
        if steps:
            self._offer_moved(self.scale.stepped(self.value, steps))

    def _offer_moved(self, number: float) -> None:
        """A step beyond what is allowed ends at the last number that is."""
        param = self.parameter.param
        if param.low is not None and number < param.low:
            number = param.low
        if param.high is not None and number > param.high:
            number = param.high
        try:
            self.parameter.coerce(number)
        except ParameterError:
            return
        self._gesture = self._gesture or object()
        self.offer(number, self._gesture)

    def _give_up_drag(self) -> None:
        if self._gesture is not None:
            self.node.session.give_up(self._gesture)
        self._end()

    def _end(self) -> None:
        if self._gesture is not None:
            self._gesture = None
            self.node.session.end_gesture()
            self.show_value(self.value)


def _last_word(text: str) -> str:
    """Of an expression, which begins with =; none of a number."""
    found = re.search(r"[^\W\d][\w.]*$", text)
    return found.group() if found and text.lstrip().startswith("=") else ""


_BEGINS = "0123456789.-="
_STEPS = {**STEPS, Qt.Key.Key_Right: 1, Qt.Key.Key_Left: -1}


class Slider(QSlider):
    moved = Signal(int)  # position: dragged, clicked, or sent to an end
    # steps: by keys or the wheel: small steps from the value, whatever the position shows of it
    stepped = Signal(float)
    finished = Signal()  # the mouse or the key is up, or the wheel rests
    given_up = Signal()  # Esc while it is held
    typed = Signal(str)  # what a number begins with: Tab leads from a field to the next slider
    _held = False

    def __init__(self, positions: int, parent: QWidget) -> None:
        super().__init__(Qt.Orientation.Horizontal, parent)
        self.setRange(0, positions)
        self.setPageStep(max(1, positions // 10))
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)
        self.setMinimumWidth(self.fontMetrics().height() * 3)
        self.valueChanged.connect(self.moved)
        self._rest = QTimer(self, singleShot=True, interval=WHEEL_REST_MS)
        self._rest.timeout.connect(self.finished)

    def show_position(self, position: int) -> None:
        if not self.isSliderDown():
            with QSignalBlocker(self):
                self.setValue(position)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in _STEPS:
            self.stepped.emit(_STEPS[Qt.Key(event.key())] * step_factor(event.modifiers()))
        elif event.text() and event.text() in _BEGINS:
            self.typed.emit(event.text())
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        super().keyReleaseEvent(event)
        if not event.isAutoRepeat():
            self.finished.emit()

    def event(self, event: QEvent) -> bool:
        """End a press by Esc, and by a dialog: the release behind that never arrives."""
        given_up = widgets.is_escape(event)
        if self._held and (given_up or event.type() == QEvent.Type.WindowBlocked):
            self._held = False
            self.setSliderDown(False)
            self.setRepeatAction(QSlider.SliderAction.SliderNoAction)  # of a press beside it
            (self.given_up if given_up else self.finished).emit()
            event.setAccepted(given_up)
        return bool(super().event(event))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        self._held = True
        super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self.isSliderDown():  # else it was given up
            super().mouseMoveEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        super().mouseReleaseEvent(event)
        self._held = False
        self.finished.emit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if not self.isSliderDown():
            self._rest.stop()
            self.finished.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        self.turn(event, self)

    def turn(self, event: QWheelEvent, control: QWidget) -> None:
        """Take a turn of the wheel over a control, unless it is to scroll."""
        turned = event.angleDelta().y()
        if not turned or not widgets.takes_wheel(control):
            event.ignore()
            return
        self.stepped.emit(math.copysign(step_factor(event.modifiers()), turned))
        self._rest.start()
        event.accept()


# Which numbers a slider covers, and where on it each of them lies.

POSITIONS = 1000
PER_DECADE = 100
LOGARITHMIC_FROM = 1000.0
LARGEST_WHOLE_RANGE = 1e6

# Usual ranges, by unit, where the declaration leaves the range open.
_USUAL: Mapping[str, tuple[float, float]] = {
    "µm": (0.4, 20.0),
    "mm": (1.0, 500.0),
    "cm": (1.0, 100.0),
    "m": (10.0, 10000.0),
    "km": (0.1, 10.0),
    "s": (1e-6, 1.0),
    "Hz": (1.0, 1e6),
    "K": (200.0, 400.0),
    "%": (0.0, 100.0),
    "mrad": (0.0, 5.0),
    "mrad/s": (0.0, 1e5),
    "m/s": (0.0, 300.0),
    "cyc/mrad": (1e-4, 10.0),
    "cm √Hz/W": (1e8, 1e14),
    "m^(-2/3)": (1e-18, 1e-12),
    "1/km": (0.0, 1.0),
    "W/m²/sr": (0.0, 100.0),
}
_PLAIN = (0.0, 100.0)


@dataclass(frozen=True)
class Scale:
    """From one number to a greater one, in equal steps or factors; `zero`: these begin at 0."""

    low: float
    high: float
    log: bool = False
    whole: bool = False
    zero: bool = False

    @property
    def positions(self) -> int:
        """Of a slider."""
        if self.log:
            return math.ceil(PER_DECADE * math.log10(self.high / self.low))
        span = self.high - self.low
        return int(span) if self.whole and span <= 2 * POSITIONS else POSITIONS

    @property
    def rest(self) -> float:
        return min(max(0.0, self.low), self.high)

    def share(self, value: float) -> float:
        """Where a number lies: 0 at the low end, 1 at the high one."""
        if self.log:
            return math.log(max(value, 1e-300) / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def value_at(self, share: float) -> float | int:
        """The number at a place, with no more digits than it can be placed by."""
        share = min(max(share, 0.0), 1.0)
        if self.log:
            if self.zero and share == 0:
                return 0 if self.whole else 0.0
            value = float(f"{self.low * (self.high / self.low) ** share:.3g}")
        else:
            decimals = max(0, math.ceil(-math.log10((self.high - self.low) / POSITIONS)))
            value = round(self.low + share * (self.high - self.low), decimals)
        value = min(max(value, self.low), self.high)
        return round(value) if self.whole else value

    def position_of(self, value: float | None) -> int:
        share = self.share(self.rest if value is None else value)
        return round(min(max(share, 0.0), 1.0) * self.positions)

    def stepped(self, value: float | None, steps: float) -> float | int:
        """So many small steps from a number, which keeps its own digits."""
        start = self.rest if value is None else value
        if self.whole:
            steps = math.copysign(max(1.0, abs(steps)), steps)
        result = start + steps * self._step(start, down=steps < 0)
        if self.log and start > 0:
            result = max(result, start / 10)
        return round(result) if self.whole else float(f"{result:.10g}")

    def within(self, value: float, start: float | None) -> float | int:
        """Kept on the scale, or not farther off it than the number one started from."""
        start = self.rest if start is None else start
        floor = 0.0 if self.log and self.zero else self.low
        clamped = min(max(value, min(floor, start)), max(self.high, start))
        return round(clamped) if self.whole else clamped

    def _step(self, value: float, *, down: bool) -> float:
        if not self.log:
            step = round_step((self.high - self.low) / 100)
        elif value < self.low:
            step = self.low
        else:
            decade = math.floor(math.log10(value) + 1e-9)
            at_decade = down and math.isclose(value, 10.0**decade)
            step = 10.0 ** (decade - (2 if at_decade else 1))
        return max(1.0, float(round(step))) if self.whole else step


def scale_of(parameter: Parameter) -> Scale:
    """The slider for a number: its declared part, its range, or what is usual in its unit."""
    param = parameter.param
    whole = parameter.kind == "integer"
    low, high = param.slider or _range(parameter, whole)
    if param.low is not None:
        low = max(low, param.low)
    if param.high is not None:
        high = min(high, param.high)
    margin = (high - low) / POSITIONS
    if param.above and low == param.low:
        low += 1 if whole else margin
    if param.below and high == param.high:
        high -= 1 if whole else margin
    zero_allowed = param.low is None or param.low < 0 or (param.low == 0 and not param.above)
    log = low > 0 and high / low >= LOGARITHMIC_FROM
    return Scale(low, high, log, whole, zero=zero_allowed)


def _range(parameter: Parameter, whole: bool) -> tuple[float, float]:
    param, default = parameter.param, parameter.default
    bounded = param.low is not None and param.high is not None
    if bounded and not (whole and param.high - param.low > LARGEST_WHOLE_RANGE):  # type: ignore[operator]
        return float(param.low), float(param.high)  # type: ignore[arg-type]
    given = abs(default) if isinstance(default, int | float) else 0.0
    low, high = _USUAL.get(param.unit, (0.0, 10 * given) if given else _PLAIN)
    if given > high:
        high = 10 * given
    return (low, high) if param.low is not None else (-high, high)


class PathField(TextField):
    """A line, and a button that opens a dialog; the line's tooltip is the whole name."""

    def build(self) -> None:
        declared = self.node.session.declared(self.node.name)
        self._writes = declared is not None and declared.sink
        edit = self.build_edit()
        edit.setPlaceholderText("no file")
        self.browse = widgets.tool_button("", "Browse…", "", self)
        self.named(self.browse, ": browse", "browse")
        self.browse.clicked.connect(self.open_dialog)
        widgets.filled(self.row, self.label, (edit, 1), self.browse)
        self.unit.hide()

    def show_value(self, value: Any) -> None:
        self.edit.show_text("" if value is None else Path(value).as_posix())
        self.edit.end(False)  # the file's own name is seen, however long its folder
        whole = "" if value is None else (self.node.session.folder.absolute() / value).as_posix()
        self.edit.setToolTip(tip(f"{whole}\n{about(self.parameter)}") if whole else "")

    def open_dialog(self) -> None:
        title = f"{'Write' if self._writes else 'Open'} file: {self.node.name} · {self.title}"
        dialog = widgets.labelled(messages.FileDialog(self, title), "field.dialog")
        dialog.setOption(QFileDialog.Option.DontConfirmOverwrite)  # nothing is written by choosing
        if self._writes:
            dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
        else:
            dialog.setFileMode(QFileDialog.FileMode.ExistingFile)
        folder = self.node.session.folder.absolute()
        if self.value is not None:
            folder = (folder / self.value).parent
        dialog.setDirectory(str(folder))
        dialog.fileSelected.connect(self._chosen)
        messages.show_beside(self, dialog)

    def _chosen(self, name: str) -> None:
        if name:
            if self._writes:
                self.node.session.choose_output(Path(name))
            self.offer(self.relative(Path(name)))

    def relative(self, path: Path) -> str:
        """The name from the network's folder where the file lies below it, else all of it."""
        if self.node.session.document.path is not None:
            folder = self.node.session.folder.resolve()
            if path.resolve().is_relative_to(folder):
                return path.resolve().relative_to(folder).as_posix()
        return path.as_posix()
