"""What stands on the panel of a module: parameters, read-outs, ports."""

import json
from collections.abc import Hashable, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any, ClassVar

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QPalette, QResizeEvent
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QLabel,
    QLineEdit,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from app.editor import widgets
from app.editor.declared_text import label_of, shown_figure, tip
from app.editor.evaluation.evaluator import Freshness
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.fields.field import (
    MOST_BUTTONS,
    ButtonsField,
    Field,
    FieldLink,
    ListField,
    NumbersField,
    PanelNode,
    SwitchField,
    TextField,
    choices_of,
)
from app.editor.panels.fields.number import NumberField, PathField
from app.editor.theme import CHANGED, FAINT, TEXT, set_ink, theme_of
from app.editor.viewers.viewer import PLOT_TYPES, VIEWER_NUMBERS, Viewer
from core.chain.engine import Plan
from core.editing.operations import ABSENT
from core.errors import shown, thaw
from core.modules.declaration import Declaration, Port
from core.modules.parameters import Parameter, Section
from core.network.linked_values import LinkError, expression_text
from core.network.network import Network, Node
from core.records import dataclass


class ModuleBody(QWidget):
    def __init__(self, declaration: Declaration, node: PanelNode, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._session = node.session
        self._node = node.name
        self._valued: Node | None = None
        self.sections = SectionsView(declaration, node, self)
        node.session.free_changed.connect(self._mark_free)
        self._mark_free()
        self._column = widgets.filled(
            QVBoxLayout(self), self.sections, margins=(8, 4, 8, 8), spacing=4
        )
        self.readouts = ReadoutsView(declaration, node, self)
        if declaration.readouts:
            self._titled(self.readouts.title, self.readouts)
        else:
            self.readouts.hide()
            self.readouts.title.hide()
        self.ports = PortsView(declaration, node, self)
        self._titled(QLabel("Ports", self), self.ports)

    def follow(self, before: Network | None, after: Network) -> None:
        node, valued = after.nodes[self._node], self._session.valued(self._node)
        faults = self._session.resolved.faults_of(node)
        changed = before is None or before.nodes.get(self._node) is not node
        if changed or valued is not self._valued or faults:
            self.sections.follow(node, valued.params, faults)
        self._valued = valued
        if before is None or before.links != after.links:
            self.ports.follow(after)

    def _titled(self, title: QLabel, widget: QWidget) -> None:
        line = QFrame(self, frameShape=QFrame.Shape.HLine, frameShadow=QFrame.Shadow.Sunken)
        widgets.make_bold(title)
        title.setForegroundRole(FAINT)
        for part in (line, title, widget):
            self._column.addWidget(part)

    def _mark_free(self) -> None:
        free = [one.place for one in self._session.free]
        for field in self.sections.fields:
            field.show_free((self._node, field.parameter.name) in free)
        self.sections.line_up()  # names are longer then


class PortsView(QWidget):
    """The ports of a node, each with a button that shows it."""

    def __init__(self, declaration: Declaration, node: PanelNode, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("ports")
        self._node = node
        self._sources: dict[tuple[str, str], tuple[str, str]] = {}
        self._dots: list[tuple[QLabel, str]] = []
        self._inputs: dict[str, QLabel] = {}
        self._buttons: dict[tuple[str, str], QToolButton] = {}
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 2, 0, 2)
        self._grid.setVerticalSpacing(2)
        self._grid.setColumnStretch(1, 1)
        for port in declaration.inputs:
            self._inputs[port.name] = self._add("input", port)
        for port in declaration.outputs:
            self._sources["output", port.name] = node.name, port.name
            self._add("output", port)
        self._colour()

    def _add(self, side: str, port: Port) -> QLabel:
        dot, label = QLabel("●", self), widgets.plain_label("", self, port.name)
        self._dots.append((dot, port.types[0]))
        need = "" if port.required else ", may be left unconnected"
        label.setToolTip(tip(f"{side} {port.name}: {' or '.join(port.types)}{need}"))
        place = side, port.name
        about = f"view {side} {port.name}"
        view = partial(self._view, place, 1)
        button = widgets.tool_button(f"view.{side}.{port.name}", "View", about, self, view)
        if set(port.types) <= set(PLOT_TYPES):
            button.setToolTip(tip("Show this port in Curves"))
        else:
            button.setToolTip(
                tip("Show this port in viewer 1; the arrow (or Down key) lists the other viewers")
            )
            button.setPopupMode(QToolButton.ToolButtonPopupMode.MenuButtonPopup)
            menu = widgets.Menu(button)
            for number in VIEWER_NUMBERS:
                widgets.offer(menu, "", f"Viewer {number}", partial(self._view, place, number))
            button.setMenu(menu)
        self._buttons[place] = button
        row = self._grid.rowCount()
        for column, widget in enumerate((dot, label, button)):
            self._grid.addWidget(widget, row, column)
        return label

    def follow(self, network: Network) -> None:
        links = {link.input: link for link in network.links_into(self._node.name)}
        for name, label in self._inputs.items():
            place, link = ("input", name), links.get(name)
            self._sources.pop(place, None)
            if link is not None:
                self._sources[place] = link.source, link.output
            source = f"{link.source}.{link.output}" if link is not None else "not connected"
            label.setText(f"{name} ← {source}")
            self._buttons[place].setEnabled(link is not None)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._colour()

    def _colour(self) -> None:
        theme = theme_of(self)
        for dot, kind in self._dots:
            set_ink(dot, theme.ports.get(kind, theme.faint_text))

    def _view(self, place: tuple[str, str], number: int) -> None:
        if place in self._sources:
            self._node.view_wanted.emit(*self._sources[place], number)


class UnknownBody(QWidget):
    """Of a module that is not in the library: the parameters as the file has them, and why."""

    def __init__(self, module: str, node: str, why: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._node = node
        self.note = widgets.plain_label(
            "unknown_module",
            self,
            f"There is no module {shown(module)} in this library{why and f': {why}'}. The node "
            "is kept and saved with these parameters, but computes nothing.",
            role=CHANGED,
        )
        self.raw = widgets.plain_label("raw", self)
        self.raw.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        widgets.filled(QVBoxLayout(self), self.note, self.raw, margins=(8, 4, 8, 8))

    def follow(self, _before: Network | None, after: Network) -> None:
        rows = []
        for name, value in sorted(after.nodes[self._node].params.items()):
            text = value if isinstance(value, str) else json.dumps(thaw(value), ensure_ascii=False)
            rows.append(f"{name}: {text}")
        self.raw.setText("\n".join(rows))


_LABEL_SHARE = 0.4  # of the width, for long names, however little is left
_LEAST_LINES = 10  # heights of a line that a slider, a field and their gaps are wide at least
_AT_FIRST = 340  # dots that a panel is wide, until it is laid out
_FIELDS = MappingProxyType(
    {
        "number": NumberField,
        "integer": NumberField,
        "switch": SwitchField,
        "path": PathField,
        "numbers": NumbersField,
        "text": TextField,
    }
)


class SectionsView(QWidget):
    def __init__(self, declaration: Declaration, node: PanelNode, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("sections")
        self._declaration = declaration
        self._panel_node = node
        self.sections = declaration.panel
        self.fields: list[Field] = []
        pages = tuple(dict.fromkeys(s.page for s in self.sections if s.page))
        self.tabs = widgets.PageTabs(pages, self)
        self.tabs.setVisible(bool(pages))
        self.tabs.turned.connect(self._show_sections)
        self._boxes = [self._box(section) for section in self.sections]
        parts: list[QWidget] = [*self._boxes]
        parts.insert(next((n for n, s in enumerate(self.sections) if s.page), 0), self.tabs)
        widgets.filled(QVBoxLayout(self), *parts, spacing=4)
        self._line_up(_AT_FIRST)
        self._node: Node | None = None

    def field(self, name: str) -> Field:
        return next(field for field in self.fields if field.parameter.name == name)

    def follow(
        self, node: Node, values: Mapping[str, Any], faults: Mapping[str, LinkError]
    ) -> None:
        """Show a node where it differs; `values` and `faults` are of its expressions."""
        before, self._node = self._node, node
        for field in self.fields:
            name = field.parameter.name
            raw = node.params.get(name, ABSENT)
            if name in node.linked:
                problem = faults[name].message if name in faults else ""
                link = FieldLink(expression_text(raw), values.get(name), problem)
                if field.link != link:
                    field.follow_link(link)
            elif before is None or _differs(before.params, name, raw):
                field.follow(raw)
        self._show_sections()

    def _box(self, section: Section) -> QWidget:
        box = QWidget(self)
        inside = widgets.filled(QVBoxLayout(box), spacing=2)
        if section.title:
            title = widgets.plain_label("", box, section.title, role=FAINT, bold=True)
            title.setContentsMargins(0, 4, 0, 0)
            inside.addWidget(title)
        for name in section.parameters:
            parameter = self._declaration.parameter(name)
            if parameter is not None:
                offered = section.offer is not None and section.offer.parameter == name
                self.fields.append(self._field_for(parameter, box, as_buttons=offered))
                inside.addWidget(self.fields[-1])
        return box

    def _field_for(self, parameter: Parameter, box: QWidget, *, as_buttons: bool) -> Field:
        kind: type[Field] = _FIELDS.get(parameter.kind, ListField)
        few = as_buttons or len(choices_of(parameter)) <= MOST_BUTTONS
        if parameter.kind == "choice" and few:
            kind = ButtonsField
        return kind(parameter, self._panel_node, box)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Have names, values and units of all fields stand in columns."""
        super().resizeEvent(event)
        self._line_up(self.width())

    def line_up(self) -> None:
        self._line_up(self.width() if self.isVisible() else _AT_FIRST)

    def _line_up(self, width: int) -> None:
        """Give names what they need where that leaves room for the fields of this page."""
        metrics = self.fontMetrics()
        fields = [field for field in self.fields if field.isVisibleTo(self)]
        units = {field.parameter.param.unit for field in fields if field.lines_up}
        unit = max((metrics.horizontalAdvance(unit) for unit in units), default=0)
        widest = max((field.label_width for field in fields), default=0)
        most = width - unit - _LEAST_LINES * metrics.height()
        label = min(widest, max(most, int(_LABEL_SHARE * width)))
        room = width - label - unit - 3 * metrics.height()
        for field in fields:
            field.line_up(label, unit, room)

    def _show_sections(self) -> None:
        values = {field.parameter.name: field.value for field in self.fields}
        for offered in filter(None, (section.offer for section in self.sections)):
            field = self.field(offered.parameter)
            if isinstance(field, ButtonsField):
                field.narrow(offered.of(values[offered.by], field.choices))
        met = [
            section.shown_when is None or values.get(section.shown_when[0]) in section.shown_when[1]
            for section in self.sections
        ]
        used = {s.page for m, s in zip(met, self.sections, strict=True) if m}
        self.tabs.offer(used)
        page, hidden = self.tabs.page, [box.isHidden() for box in self._boxes]
        for box, section, fits in zip(self._boxes, self.sections, met, strict=True):
            box.setVisible(fits and section.page in ("", page))
        if hidden != [box.isHidden() for box in self._boxes]:
            self.line_up()


def _differs(params: Mapping[str, Any], name: str, raw: Any) -> bool:
    had = params.get(name, ABSENT)
    return had is not raw and (type(had) is not type(raw) or had != raw)


NONE = "—"
TITLE = "Read-outs"
OLDER, HELD_BACK = "computed before the last edit", "as last generated"
_DIGITS = 13  # letters that a value is wide


@dataclass(frozen=True)
class ReadoutsQuery(Query):
    """What are the read-outs of that node? Answered in order, with why one has no value."""

    node: str
    urgency: ClassVar[int] = 1

    def key(self, plan: Plan) -> Hashable:
        planned = plan.node(self.node)
        if planned.error is not None:
            return (type(planned.error), str(planned.error))
        wires = (planned.inputs, planned.outputs)
        keys = tuple(
            (name, getattr(value, "key", None), getattr(value, "unit", ""))
            for wire in wires
            for name, value in wire.items()
        )
        return keys, repr(planned.module), planned.node.disabled

    def answer(self, passing: Passing) -> tuple[tuple[str, str, str, str], ...]:
        engine, plan, work = passing.engine, passing.plan, passing.work
        readouts = engine.readouts(plan, self.node, work)
        units = plan.node(self.node).units
        return tuple(
            (
                name,
                shown_figure(value),
                units[name],
                engine.why_none(plan, self.node, work, name) if value is None else "",
            )
            for name, value in readouts.items()
        )


def _value_line(name: str, parent: QWidget) -> QLineEdit:
    """Can be selected and copied; a `QLabel` would have the window laid out for each text."""
    line = QLineEdit(NONE, parent, readOnly=True, frame=False, alignment=widgets.RIGHT)
    line.setTextMargins(0, 0, 0, 0)
    line.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
    line.setFixedHeight(line.fontMetrics().height())
    line.setMaximumWidth(line.fontMetrics().averageCharWidth() * _DIGITS)
    palette = line.palette()
    palette.setColor(QPalette.ColorRole.Base, Qt.GlobalColor.transparent)
    line.setPalette(palette)
    return widgets.labelled(line, f"readout.{name}")


class ReadoutsView(Viewer):
    """One row for each read-out, faint where it is of the network before the last edit."""

    _is_held_back = False

    def __init__(self, declaration: Declaration, node: PanelNode, parent: QWidget | None) -> None:
        super().__init__(node.session, node.evaluator, f"panel.readouts.{id(self):x}", parent)
        self.setObjectName("readouts")
        self.query = ReadoutsQuery(node.name)
        self.values: dict[str, QLineEdit] = {}
        self.units: dict[str, QLabel] = {}
        self._meanings: dict[str, str] = {}
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 2)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(0, 1)
        for row, readout in enumerate(declaration.readouts):
            name = widgets.plain_label("", self, label_of(readout.name), role=FAINT)
            value = _value_line(readout.name, self)
            unit = widgets.plain_label("", self, readout.unit, role=FAINT)
            unit.setWordWrap(False)
            self._meanings[readout.name] = readout.meaning
            for column, widget in enumerate((name, value, unit)):
                widget.setToolTip(tip(readout.meaning))
                grid.addWidget(widget, row, column)
            self.values[readout.name] = value
            self.units[readout.name] = unit
            value.setAccessibleName(_spoken(readout.name, readout.unit))
        self.title = QLabel(TITLE, self)
        self.title.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self._freshness = Freshness(node.session, node.evaluator, self)
        self._freshness.changed.connect(self._mark)

    @property
    def is_old(self) -> bool:
        return self._freshness.is_old or self._is_held_back

    def queries(self) -> tuple[Query, ...]:
        return (self.query,)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "title"):
            self._mark()

    def set_held_back(self, on: bool) -> None:
        self._is_held_back = on
        self._mark()

    def _mark(self, _old: bool = False) -> None:
        ink = self.palette().color(FAINT if self.is_old else TEXT).name()
        for value in self.values.values():
            set_ink(value, ink)
        words = HELD_BACK if self._is_held_back else OLDER
        text = f"{TITLE}: {words}" if self.is_old else TITLE
        if text != self.title.text():
            self.title.setText(text)

    def take(self, answer: Answer) -> None:
        rows = {name: row for name, *row in answer.value} if answer.error is None else {}
        for name, value in self.values.items():
            label, meaning = self.units[name], self._meanings[name]
            nothing = (NONE, label.text(), str(answer.error or ""))
            text, unit, reason = rows.get(name, nothing)
            if text != value.text():
                value.setText(text)
                value.setCursorPosition(0)
            value.setToolTip(tip(f"{reason}\n{meaning}" if reason else meaning))
            value.setAccessibleDescription(reason)
            if unit != label.text():  # that of the picture that comes in
                label.setText(unit)
                value.setAccessibleName(_spoken(name, unit))
        self._freshness.catch_up(answer.generation)


def _spoken(name: str, unit: str) -> str:
    """A read-out's name for who does not see it."""
    return f"{label_of(name)} in {unit}" if unit else label_of(name)
