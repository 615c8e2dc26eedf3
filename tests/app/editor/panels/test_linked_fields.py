"""Number fields take arithmetic and units, and follow other parameters: with mouse and keys."""

import html

import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu

from app.editor.evaluation.queries import Badge
from core.editing.operations import add_nodes, rename_node, set_parameter
from core.network.network import Node
from panel_hands import LEFT, field_of, panel_area, type_in


@pytest.fixture
def area(qtbot, session):
    """A panel of a Gaussian MTF beside a node init at F/2."""
    init = Node("init", "init_trans", {"f_number": 2.0})
    blur = Node("blur", "gaussian_mtf", {"sigma_x_mrad": 0.3})
    session.do(add_nodes(((init, (0.0, 0.0)), (blur, (200.0, 0.0)))))
    made = panel_area(qtbot, session)
    session.select(["blur"])
    return made


@pytest.fixture
def sigma(area, session):
    return field_of(area, session, "sigma_x_mrad", "blur")


def stored(session, name="sigma_x_mrad", node="blur"):
    return session.network.nodes[node].params.get(name)


def open_menu(field):
    field.open_menu(field.mapToGlobal(QPoint(5, 5)))
    QApplication.processEvents()
    menu = field.findChildren(QMenu, "field.menu")[-1]
    return menu, {action.objectName(): action for action in menu.actions() if action.objectName()}


def wheel(widget, notches=1):
    """A turn of the wheel over the middle of a widget, passed on as Qt does."""
    middle = QPointF(widget.rect().center())
    event = QWheelEvent(
        middle, QPointF(widget.mapToGlobal(middle)), QPoint(), QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(widget, event)
    QApplication.processEvents()


def test_arithmetic_and_units_are_taken_or_refused_with_why_and_what_counts(sigma, session):
    for text, value in (
        ("3*0.1", 0.3),
        ("600 µrad", 0.6),
        ("600,5 urad", 0.6005),
        ("(1/60) deg", 0.29088820866572),
    ):
        session.do(set_parameter("blur", "sigma_x_mrad", 0.125))
        position = session.document.position
        type_in(sigma.edit, text)
        assert stored(session) == pytest.approx(value, rel=1e-13)
        assert not sigma.message.isVisible()
        assert not sigma.edit.marked
        assert session.document.position == position + 1
    session.do(set_parameter("blur", "sigma_x_mrad", 0.3))
    before = session.network
    for text, part in (
        ("3 K", "K is a unit of temperature, but this value is in mrad"),
        ("1/0", "1 / 0 divides by zero"),
        ("-1", "a number of at least 0"),
        ("1,000", "write 1000 or 1.000"),
        ("init.f_number", "begin with = to link to it"),
        (
            "= 1 - init.f_number",
            "the expression gives -1 mrad. The result must be a number of at least 0",
        ),
        ("= blur.sigma_x_mrad", "follows itself"),
    ):
        type_in(sigma.edit, text)
        assert session.network is before
        assert sigma.edit.marked
        assert part in sigma.message.text()
        assert sigma.message.text().endswith("(still 0.3 mrad)")
        QTest.keyClick(sigma.edit, Qt.Key.Key_Escape)
        assert not sigma.message.text()
        assert sigma.edit.text() == "0.3"


def test_a_name_is_completed_behind_the_equals_sign(sigma, session, qtbot):
    sigma.edit.setFocus()
    sigma.edit.selectAll()
    QTest.keyClicks(sigma.edit, "2")
    assert sigma.edit.names is None  # a number, no name
    sigma.edit.selectAll()
    QTest.keyClicks(sigma.edit, "= 0.2 * F_nu")
    popup = sigma.edit.names.popup()
    assert popup.isVisible()
    offered = [popup.model().index(row, 0).data() for row in range(popup.model().rowCount())]
    assert offered == ["init.f_number"]
    QTest.keyClick(popup, Qt.Key.Key_Down)
    QTest.keyClick(popup, Qt.Key.Key_Return)
    assert not popup.isVisible()
    assert sigma.edit.text() == "= 0.2 * init.f_number"
    QTest.keyClicks(sigma.edit, " * 2")
    QTest.keyClick(sigma.edit, Qt.Key.Key_Return)
    assert stored(session) == {"expression": "0.2 * init.f_number * 2"}


def test_a_link_is_typed_shown_followed_and_undone(sigma, session):
    position = session.document.position
    type_in(sigma.edit, "= init.f_number * 0.2")
    assert stored(session) == {"expression": "init.f_number * 0.2"}
    assert session.document.position == position + 1
    assert session.document.undo_text == "Link blur.sigma_x_mrad"
    assert sigma.edit.text() == "= init.f_number * 0.2"
    assert sigma.linked_value.isVisible()
    assert sigma.linked_value.text() == "= 0.4 mrad"
    assert not sigma.slider.isVisible()
    assert "= init.f_number * 0.2" in html.unescape(sigma.edit.toolTip())
    assert "Value: 0.4 mrad" in html.unescape(sigma.edit.toolTip())
    session.do(set_parameter("init", "f_number", 3.0))
    assert sigma.linked_value.text() == "= 0.6 mrad"
    assert sigma.value == pytest.approx(0.6)
    session.do(rename_node("init", "Lens 2"))
    assert sigma.edit.text() == "= 'Lens 2'.f_number * 0.2"
    for _ in range(3):
        session.undo()
    assert stored(session) == 0.3
    assert sigma.edit.text() == "0.3"
    assert not sigma.linked_value.isVisible()
    assert sigma.slider.isVisible()
    session.redo()
    assert sigma.linked_value.text() == "= 0.4 mrad"


def test_a_link_is_edited_and_taken_away_by_typing_and_by_the_menu(sigma, session):
    type_in(sigma.edit, "= init.f_number * 0.2")
    type_in(sigma.edit, "= init.f_number * 0.1")
    assert stored(session) == {"expression": "init.f_number * 0.1"}
    type_in(sigma.edit, "= init.f_number * nonsense")
    assert stored(session) == {"expression": "init.f_number * 0.1"}
    assert sigma.message.text().endswith("(still = init.f_number * 0.1)")
    QTest.keyClick(sigma.edit, Qt.Key.Key_Escape)
    assert sigma.edit.text() == "= init.f_number * 0.1"
    position = session.document.position
    menu, actions = open_menu(sigma)
    assert actions["unlink"].text() == "Unlink, keep 0.2 mrad"
    actions["unlink"].trigger()
    menu.close()
    assert stored(session) == 0.2
    assert session.document.position == position + 1
    assert session.document.undo_text == "Unlink blur.sigma_x_mrad"
    session.undo()
    assert stored(session) == {"expression": "init.f_number * 0.1"}
    type_in(sigma.edit, "0.7")
    assert stored(session) == 0.7
    assert sigma.slider.isVisible()


def pull(label, way, modifier=Qt.KeyboardModifier.NoModifier, steps=10):
    """Press on a label, move sideways in steps, and let go."""
    start = QPoint(10, label.height() // 2)
    QTest.mousePress(label, LEFT, modifier, start)
    for step in range(1, steps + 1):
        at = start + QPoint(round(way * step / steps), 0)
        _moved(label, at, modifier)
        QApplication.processEvents()
    QTest.mouseRelease(label, LEFT, modifier, start + QPoint(way, 0))


def _moved(widget, at, modifier):
    """`QTest.mouseMove` knows no modifiers."""
    place = QPointF(at)
    event = QMouseEvent(
        QEvent.Type.MouseMove, place, QPointF(widget.mapToGlobal(place)),
        Qt.MouseButton.NoButton, LEFT, modifier,
    )  # fmt: skip
    QApplication.sendEvent(widget, event)


def test_a_label_is_dragged_sideways(sigma, session):
    """A step is four pixels; one of this slider, from 0 to 5 mrad, is 0.05."""
    assert sigma.label.cursor().shape() == Qt.CursorShape.SizeHorCursor
    assert (sigma.scale.low, sigma.scale.high) == (0.0, 5.0)
    for modifier, way, value in (
        (Qt.KeyboardModifier.NoModifier, 40, 0.3 + 10 * 0.05),
        (Qt.KeyboardModifier.ShiftModifier, 40, 0.3 + 10 * 0.005),
        (Qt.KeyboardModifier.NoModifier, -400, 0.0),
    ):
        position = session.document.position
        pull(sigma.label, way, modifier)
        assert stored(session) == pytest.approx(value, abs=1e-9)
        assert session.document.position == position + 1
        session.undo()
        assert stored(session) == 0.3
        assert sigma.edit.text() == "0.3"
    # Esc puts the value back until the button is up.
    QTest.mousePress(sigma.label, LEFT, pos=QPoint(10, 4))
    _moved(sigma.label, QPoint(40, 4), Qt.KeyboardModifier.NoModifier)
    assert stored(session) > 0.3
    QTest.keyClick(QApplication.focusWidget() or sigma.label, Qt.Key.Key_Escape)
    _moved(sigma.label, QPoint(60, 4), Qt.KeyboardModifier.NoModifier)
    QTest.mouseRelease(sigma.label, LEFT, pos=QPoint(60, 4))
    assert stored(session) == 0.3


def test_the_wheel_changes_only_what_has_the_focus(sigma, session, area):
    before = session.network
    area.setFocus()
    for control in (sigma.edit, sigma.slider):
        wheel(control)
    assert session.network is before
    sigma.slider.setFocus()
    area._scrolled_at = float("-inf")
    wheel(sigma.slider)
    assert stored(session) == pytest.approx(0.35)
    position = session.document.position
    wheel(sigma.slider)
    assert session.document.position == position  # one turn, one step


def top(widget):
    QApplication.processEvents()
    return widget.mapToGlobal(QPoint(0, 0)).y()


WARNING = {"blur": Badge("warning", "a line that comes while the mouse is down\nand another")}


@pytest.mark.parametrize(("control", "folded"), [("slider", False), ("label", True)])
def test_nothing_moves_under_the_mouse_while_a_warning_comes(control, folded, sigma, area):
    if not folded:
        QTest.mouseClick(area.panels["blur"].head.fold_picture, LEFT)
        QTest.qWait(50)
    held = getattr(sigma, control)
    at = top(held)
    start = QPoint(held.width() // 2, held.height() // 2)
    QTest.mousePress(held, LEFT, pos=start)
    area.set_badges(WARNING)
    assert top(held) == at
    _moved(held, start + QPoint(12, 0), Qt.KeyboardModifier.NoModifier)
    area.set_badges(WARNING)
    assert top(held) == at
    assert area.panels["blur"].head.problem.isVisible()
    QTest.mouseRelease(held, LEFT, pos=start + QPoint(12, 0))
    assert top(held) == at
    area.set_badges({})
    assert top(held) == at
    assert not area.panels["blur"].head.problem.isVisible()
