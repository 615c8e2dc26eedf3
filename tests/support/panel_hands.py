"""Working on control panels with mouse and keys, as a person would."""

import gc

from PySide6.QtCore import QCoreApplication, QEvent, QObject, QPoint, Qt, Signal
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QStyle, QStyleOptionSlider

from app.editor.panels.panel_area import PanelArea
from core.editing.operations import add_nodes, set_parameter
from core.errors import ParameterError
from core.modules.declaration import declaration
from core.modules.parameters import plain
from core.network.network import Node
from nodes.library import standard_library

LIBRARY = standard_library()
PARAMETERS = [
    (key, parameter.name)
    for key, module in LIBRARY.items()
    for parameter in declaration(module).parameters
]
NUMBERS = [
    (key, name)
    for key, name in PARAMETERS
    if declaration(LIBRARY[key]).parameter(name).kind in ("number", "integer")
]
LEFT = Qt.MouseButton.LeftButton


class NoEvaluator(QObject):
    """Computes nothing."""

    answered, pass_done = Signal(object), Signal(object)
    generation, plan = 0, None

    def ask(self, owner, queries):
        pass

    def forget(self, owner):
        pass


def panel_area(qtbot, session, evaluator=None, width=360):
    """A panel area on the screen."""
    area = PanelArea(session, evaluator or NoEvaluator(session))
    qtbot.addWidget(area)
    area.resize(width, 700)
    area.show()
    area.activateWindow()
    qtbot.waitUntil(area.isActiveWindow)
    return area


def drop(session, key, name="node"):
    """Put a module into the network and select it: opening a panel edits nothing."""
    session.do(add_nodes(((Node(name, key), (0.0, 0.0)),)))
    dropped = session.network
    session.select([name])
    QApplication.processEvents()
    assert session.network is dropped


def field_of(area, session, name, node="node"):
    """The field of a parameter, brought to light: its page turned to, its condition met."""
    sections = area.panels[node].body.sections
    page = next((each.page for each in sections.sections if name in each.parameters), "")
    for button in sections.tabs.buttons:
        if button.text() == page:
            button.click()
    field = sections.field(name)
    for section in sections.sections:
        if name in section.parameters and section.shown_when and not field.isVisible():
            other, values = section.shown_when
            session.do(set_parameter(node, other, values[0]))
    QApplication.processEvents()
    area.ensureWidgetVisible(field)
    assert field.isVisible(), name
    return field


def type_in(edit, text, key=Qt.Key.Key_Return):
    """Click into a line, type over what is there, and press a key."""
    QTest.mouseClick(edit, LEFT)
    edit.selectAll()
    QTest.keyClicks(edit, text) if text else QTest.keyClick(edit, Qt.Key.Key_Delete)
    if key is not None:
        QTest.keyClick(edit, key)


def other_value(parameter, now):
    """A value that the parameter may have and has not."""
    wanted = {
        "number": (0.25, 1.5, 42.0, 3.0, 0.1, -2.0, 0.9999),
        "integer": (3, 5, 7),
        "switch": (True, False),
        "choice": parameter.choices,
        "path": ("folder/file.tif", "other.tif"),
        "text": ("counts", "K"),
        "numbers": ([0.0, 0.25], [0.125]),
    }[parameter.kind]
    for value in wanted:
        try:
            coerced = parameter.coerce(value)
        except ParameterError:
            continue
        if coerced != now:
            return plain(coerced)
    raise AssertionError(parameter.name)


def change(field):
    """Change a parameter by its own widget; what was set."""
    value = other_value(field.parameter, field.value)
    kind = field.parameter.kind
    if kind == "switch":
        QTest.mouseClick(field.box, LEFT, pos=QPoint(8, field.box.height() // 2))
    elif kind == "choice" and isinstance(getattr(field, "box", None), QComboBox):
        value = choose_below(field)
    elif kind == "choice":
        offered = zip(field.choices, field.buttons, strict=True)
        shown = ((c, b) for c, b in offered if b.isVisible() and c != field.value)
        value, button = next(shown)
        QTest.mouseClick(button, LEFT, pos=QPoint(8, button.height() // 2))
    elif kind == "numbers":
        type_in(field.edit, ", ".join(str(number) for number in value))
    else:
        type_in(field.edit, str(value))
    return value


def choose_below(field):
    """Choose the next one of a list with the arrow key, from the last one the one before."""
    at = field.choices.index(field.value)
    down = at + 1 < len(field.choices)
    field.box.setFocus()
    QTest.keyClick(field.box, Qt.Key.Key_Down if down else Qt.Key.Key_Up)
    return field.choices[at + 1 if down else at - 1]


def handle_of(slider):
    """The middle of a slider's handle."""
    option = QStyleOptionSlider()
    slider.initStyleOption(option)
    handle = slider.style().subControlRect(
        QStyle.ComplexControl.CC_Slider, option, QStyle.SubControl.SC_SliderHandle, slider
    )
    return handle.center()


def drag(slider, share):
    """Take the handle and pull it by a share of the slider's width, in four movements."""
    start = handle_of(slider)
    QTest.mousePress(slider, LEFT, pos=start)
    for step in range(1, 5):
        QTest.mouseMove(slider, start + QPoint(round(share * slider.width() * step / 4), 0))
        QApplication.processEvents()
    QTest.mouseRelease(slider, LEFT, pos=start + QPoint(round(share * slider.width()), 0))


def undo_to(session, position):
    """Undo until so many steps are left, each time one: to follow is not to edit."""
    history = session.document
    while (before := history.position) > position:
        session.undo()
        assert history.position == before - 1


def let_go():
    """Carry out what was put off: deletions too."""
    QApplication.processEvents()
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    QApplication.processEvents()
    gc.collect()
