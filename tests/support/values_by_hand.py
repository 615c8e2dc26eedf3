"""Typing and choosing values on control panels of a real window, as a person does."""

from PySide6.QtCore import QPoint
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLineEdit, QWidget

from core.modules.declaration import declaration
from hands import centre, wait_still, wait_until


class ValuesByHand:
    """What a builder does on the panels; it brings window, hands, library and what is wanted."""

    def set_values(self):
        for node in self.wanted.nodes.values():
            if node.params:
                self.select(node.id)
                for name, value in node.params.items():
                    self.set_value(node, name, value)
        self.select("electronics")
        self.settle()
        self.screenshot("4_values")

    def set_value(self, node, name, value):
        # Badges that change while all is computed anew may move what stands below them.
        wait_until(lambda: self.window.evaluator.idle, "all is computed")
        field = self.find(QWidget, f"field.{name}", self.window.panels)
        self.turn_to_page_of(field)
        self.bring_into_view(field)
        wait_still(field)
        kind = declaration(self.library[node.module]).parameter(name).kind
        if kind == "choice":
            self.choose(field, name, value)
        elif kind == "switch":
            if self.network.nodes[node.id].params.get(name, False) != value:
                box = self.find(QAbstractButton, f"value.{name}", field)
                self.hands.click(box.mapToGlobal(QPoint(8, box.height() // 2)))
        else:
            self.hands.click(centre(self.find(QLineEdit, f"value.{name}", field)))
            self.hands.keys("ctrl+a")
            self.hands.type(repr(value))
            self.hands.keys("Return")
        wait_until(
            lambda: (
                self.network.nodes[node.id].params.get(name, _default(self, node, name)) == value
            ),
            f"{node.id}.{name} = {value}",
        )

    def turn_to_page_of(self, field):
        """Press the buttons of the panel's pages until the field is there."""
        pages = self.window.panels.findChild(QWidget, "pages")
        for button in pages.findChildren(QAbstractButton) if pages is not None else ():
            if field.isVisible():
                return
            if button.isVisible():
                self.bring_into_view(button)
                self.hands.click(centre(button))
        assert field.isVisible(), f"{field.objectName()} is on no page"

    def choose(self, field, name, value):
        buttons = [b for b in field.findChildren(QAbstractButton) if b.text() == str(value)]
        if buttons:
            self.bring_into_view(buttons[0])
            self.hands.click(buttons[0].mapToGlobal(QPoint(8, buttons[0].height() // 2)))
            return
        box = self.find(QComboBox, f"value.{name}", field)
        self.hands.click(centre(box))
        self.hands.type(str(value))
        self.hands.keys("Return")

    def bring_into_view(self, widget):
        """Turn the wheel until the widget can be seen."""
        wait_still(widget)
        area = self.window.panels
        for _ in range(60):
            top = widget.mapTo(area.viewport(), QPoint(0, 0)).y()
            if top < 0:
                clicks = 1
            elif top + widget.height() > area.viewport().height():
                clicks = -1
            else:
                return
            # At the right edge, where no slider or list takes the wheel.
            edge = area.viewport().mapToGlobal(
                QPoint(area.viewport().width() - 3, area.viewport().height() // 2)
            )
            self.hands.wheel(edge, clicks)
        raise AssertionError(f"{widget.objectName()} cannot be scrolled into view")

    def set_seed(self):
        self.deselect()
        for name, value in (("name", self.wanted.name), ("seed", str(self.wanted.seed))):
            edit = self.find(QLineEdit, f"network_{name}", self.window.panels)
            self.hands.click(centre(edit))
            self.hands.keys("ctrl+a")
            self.hands.type(value)
            self.hands.keys("Return")
        wait_until(lambda: self.network.seed == self.wanted.seed, "the seed is set")


def _default(builder, node, name):
    return declaration(builder.library[node.module]).parameter(name).default
