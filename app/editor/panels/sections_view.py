"""The parameters of a panel: sections of fields, on pages where there are many."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.editor.panels.fields.choice import (
    MOST_BUTTONS,
    ButtonsField,
    ListField,
    NumbersField,
    SwitchField,
    TextField,
    choices_of,
)
from app.editor.panels.fields.field import Field, FieldLink
from app.editor.panels.fields.number import NumberField
from app.editor.panels.fields.panel_node import PanelNode
from app.editor.panels.fields.path import PathField
from app.editor.theme import FAINT
from app.editor.widgets import PageTabs, filled, plain_label
from core.editing.operations import ABSENT
from core.modules.declaration import Declaration
from core.modules.panel_sections import Section
from core.modules.parameters import Parameter
from core.network.linked_values import LinkError, expression_text
from core.network.network import Node

_LABEL_SHARE = 0.4  # of the width, at most, for the names
_AT_FIRST = 340  # dots that a panel is wide, until it is laid out


class SectionsView(QWidget):
    """Fields for all parameters of a module."""

    def __init__(
        self, declaration: Declaration, node: PanelNode, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("sections")
        self._declaration = declaration
        self._panel_node = node
        self.sections = declaration.panel
        self._boxes: list[QWidget] = []
        self.fields: list[Field] = []
        self.pages = tuple(dict.fromkeys(s.page for s in self.sections if s.page))
        self.tabs = PageTabs(self.pages, self)
        column = filled(QVBoxLayout(self), spacing=4)
        self._fill(column)
        self._line_up(_AT_FIRST)
        self._node: Node | None = None

    def field(self, name: str) -> Field:
        """The first field of a parameter."""
        return next(field for field in self.fields if field.parameter.name == name)

    def page_of(self, name: str) -> str:
        """The page a parameter stands on first; empty if it stands on none."""
        return next((s.page for s in self.sections if name in s.parameters), "")

    def show_page(self, page: str) -> None:
        self.tabs.turn_to(page)

    def follow(
        self, node: Node, values: Mapping[str, Any], faults: Mapping[str, LinkError]
    ) -> None:
        """Show a node as the document has it; fields whose value is as before are left alone.

        `values` are what its expressions come to, `faults` why they have no value, by parameter.
        """
        before, self._node = self._node, node
        for field in self.fields:
            name = field.parameter.name
            raw = node.params.get(name, ABSENT)
            if name in node.linked:
                fault = faults.get(name)
                problem = fault.message if fault is not None else ""
                link = FieldLink(expression_text(raw), values.get(name), problem, fault)
                if field.link != link:
                    field.follow_link(link)
            elif before is None or _differs(before.params, name, raw):
                field.follow(raw)
        self._show_sections()

    def _fill(self, column: QVBoxLayout) -> None:
        self.tabs.setVisible(bool(self.pages))
        self.tabs.turned.connect(self._show_sections)
        placed = False
        for section in self.sections:
            if section.page and not placed:
                column.addWidget(self.tabs)
                placed = True
            box = self._box(section)
            self._boxes.append(box)
            column.addWidget(box)

    def _box(self, section: Section) -> QWidget:
        box = QWidget(self)
        inside = filled(QVBoxLayout(box), spacing=2)
        if section.title:
            title = plain_label("", box, section.title, role=FAINT, bold=True)
            title.setContentsMargins(0, 4, 0, 0)
            inside.addWidget(title)
        for name in section.parameters:
            parameter = self._declaration.parameter(name)
            if parameter is None:
                continue
            offered = section.offer is not None and section.offer.parameter == name
            field = self._field_for(parameter, box, as_buttons=offered)
            self.fields.append(field)
            inside.addWidget(field)
        return box

    def _field_for(self, parameter: Parameter, box: QWidget, *, as_buttons: bool) -> Field:
        """The field of the parameter's kind; a few choices are buttons in any case."""
        node = self._panel_node
        match parameter.kind:
            case "number" | "integer":
                return NumberField(parameter, node, box)
            case "switch":
                return SwitchField(parameter, node, box)
            case "choice" if as_buttons or len(choices_of(parameter)) <= MOST_BUTTONS:
                return ButtonsField(parameter, node, box)
            case "choice":
                return ListField(parameter, node, box)
            case "path":
                return PathField(parameter, node, box, writes=self._declaration.sink)
            case "numbers":
                return NumbersField(parameter, node, box)
            case "text":
                return TextField(parameter, node, box)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Have names, values and units of all fields stand in columns."""
        super().resizeEvent(event)
        self._line_up(self.width())

    def _line_up(self, width: int) -> None:
        metrics = self.fontMetrics()
        units = {field.parameter.param.unit for field in self.fields if field.lines_up}
        unit = max((metrics.horizontalAdvance(unit) for unit in units), default=0)
        widest = max((field.label_width for field in self.fields), default=0)
        label = min(widest, int(_LABEL_SHARE * width))
        for field in self.fields:
            field.line_up(label, unit)

    def _show_sections(self) -> None:
        values = {field.parameter.name: field.value for field in self.fields}
        self._narrow(values)
        met = [
            section.shown_when is None or values.get(section.shown_when[0]) in section.shown_when[1]
            for section in self.sections
        ]
        used = {s.page for m, s in zip(met, self.sections, strict=True) if m}
        self.tabs.offer(used)
        page = self.tabs.page
        for box, section, shown in zip(self._boxes, self.sections, met, strict=True):
            box.setVisible(shown and section.page in ("", page))

    def _narrow(self, values: Mapping[str, Any]) -> None:
        """Offer the choices that are valid with the other choices."""
        for offer in filter(None, (section.offer for section in self.sections)):
            field = self.field(offer.parameter)
            if isinstance(field, ButtonsField):
                field.narrow(offer.of(values[offer.by], field.choices))


def _differs(params: Mapping[str, Any], name: str, raw: Any) -> bool:
    had = params.get(name, ABSENT)
    return had is not raw and (type(had) is not type(raw) or had != raw)
