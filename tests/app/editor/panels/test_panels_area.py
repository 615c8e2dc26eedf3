"""Which panels are open, what stands on them beside the parameters, and that they go away."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QContextMenuEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QToolButton

from app.editor.evaluation.queries import Badge
from app.editor.theme import ERROR
from core.editing.operations import remove_nodes, set_node_field, set_parameter
from panel_hands import LEFT, drop, field_of, panel_area, type_in, undo_to


def test_panels_follow_the_document_without_editing_it(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "gaussian_mtf")
    position = session.document.position
    x, y = (field_of(area, session, f"sigma_{axis}_mrad") for axis in "xy")
    QTest.mouseClick(y.edit, LEFT)
    QTest.keyClicks(y.edit, "7")  # being typed
    session.do(set_parameter("node", "sigma_x_mrad", 2.5))
    assert x.edit.text() == "2.5"
    assert x.slider.value() == x.slider.maximum() / 2  # of 0 … 5
    assert x.changed
    assert "7" in y.edit.text()
    assert y.edit.isModified()
    assert session.document.position == position + 1
    session.undo()
    assert x.edit.text() == "0"
    assert x.slider.value() == 0
    assert not x.changed
    assert session.document.position == position
    # Esc restores, and leaving takes what was typed.
    QTest.keyClick(y.edit, Qt.Key.Key_Escape)
    before = session.document.text()
    type_in(x.edit, "3", key=Qt.Key.Key_Escape)
    assert x.edit.text() == "0"
    assert session.document.text() == before
    type_in(x.edit, "3", key=Qt.Key.Key_Tab)
    assert session.network.nodes["node"].params["sigma_x_mrad"] == 3.0
    type_in(x.edit, "4", key=None)
    area.finish_typing()
    assert session.network.nodes["node"].params["sigma_x_mrad"] == 4.0
    type_in(y.edit, "5", key=None)
    session.select([])
    assert session.network.nodes["node"].params["sigma_y_mrad"] == 5.0


# What the offscreen platform says of menus.
@pytest.mark.qt_log_ignore("This plugin does not support (raise|grabbing)")
def test_a_value_set_by_hand_to_the_default_is_stored_and_reset_by_the_menu_key(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "jitter_mtf")
    field = field_of(area, session, "sigma_mrad")
    before, position = session.document.text(), session.document.position
    type_in(field.edit, "0.02")
    assert session.network.nodes["node"].params["sigma_mrad"] == 0.02
    assert not field.changed
    reset_by_menu_key(qtbot, field, field.edit)
    assert session.document.text() == before
    type_in(field.edit, "0.5")
    assert field.changed
    reset_by_menu_key(qtbot, field, field.slider)
    assert session.document.text() == before
    assert not field.changed
    assert field.edit.text() == "0.02"
    undo_to(session, position)
    assert session.document.text() == before


def reset_by_menu_key(qtbot, field, widget):
    widget.setFocus()
    event = QContextMenuEvent(
        QContextMenuEvent.Reason.Keyboard, widget.rect().center(), widget.mapToGlobal(widget.pos())
    )
    QApplication.sendEvent(widget, event)
    qtbot.waitUntil(lambda: QApplication.activePopupWidget() is not None)
    menu = QApplication.activePopupWidget()
    assert "Reset to default (0.02 mrad)" in [action.text() for action in menu.actions()]
    for _ in menu.actions():
        QTest.keyClick(menu, Qt.Key.Key_Up)
        if menu.activeAction().objectName() == "reset":
            break
    QTest.keyClick(menu, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: QApplication.activePopupWidget() is None)


def test_a_name_is_edited_in_place_and_refusals_are_said(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "jitter_mtf", "other")
    drop(session, "jitter_mtf", "shake")
    area.edit_name()
    name = area.panels["shake"].head.name
    assert name.hasFocus()
    for bad, why in (("a.b", "must not"), ("other", "already"), ("", "must not")):
        type_in(name, bad)
        assert "shake" in session.network.nodes
        assert why in area.panels["shake"].head.name_problem.text()
        assert area.panels["shake"].head.name_problem.isVisible()
    QTest.keyClick(name, Qt.Key.Key_Escape)
    assert name.text() == "shake"
    type_in(name, "wobble")
    assert list(session.network.nodes) == ["other", "wobble"]
    assert list(area.panels) == ["wobble"]
    assert session.selection == ("wobble",)
    assert area.panels["wobble"].head.name.hasFocus()
    session.undo()
    assert list(area.panels) == ["shake"]
    assert session.selection == ("shake",)


def test_toggles_and_problems_stand_in_the_head(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "jitter_mtf")
    head = area.panels["node"].head
    before = session.document.text()
    assert head.auto.isChecked()  # nobody has said
    assert session.network.nodes["node"].auto is None
    QTest.mouseClick(head.auto, LEFT)
    assert session.network.nodes["node"].auto is False
    QTest.mouseClick(head.auto, LEFT)
    assert session.network.nodes["node"].auto is True
    QTest.mouseClick(head.disable, LEFT)
    assert session.network.nodes["node"].disabled
    undo_to(session, 1)
    assert session.document.text() == before
    assert head.auto.isChecked()
    assert not head.disable.isChecked()
    # What is wrong with the node stands on its panel.
    problem = head.problem
    assert not problem.isVisible()
    area.set_badges({"node": Badge("incomplete", "not connected: context needs a context")})
    assert problem.isVisible()
    assert "context needs a context" in problem.text()
    area.set_badges({"node": Badge("running", "computing")})
    assert "context needs a context" in problem.text()  # does not flicker
    area.set_badges({})
    assert not problem.isVisible()
    with qtbot.waitSignal(area.requests.generate):
        QTest.mouseClick(head.generate, LEFT)
    assert not head.text.isVisible()
    QTest.mouseClick(head.help, LEFT)
    assert head.text.isVisible()
    assert head.text.text().startswith("Blur by random line-of-sight motion")


def test_a_long_problem_is_broken_into_lines_and_moves_nothing_under_a_button(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "detector_mtf")
    panel = area.panels["node"]
    head, field = panel.head, panel.body.sections.field("apply")

    def show(words):
        area.set_badges({"node": Badge("error", " ".join(["number"] * words))})
        qtbot.wait(40)
        line = head.fontMetrics().lineSpacing()
        return round(head.problem.height() / line), field.mapTo(area, QPoint(0, 0)).y()

    nothing, (one, at) = show(0), show(2)
    assert nothing == (one, at)
    assert one == 1
    QTest.mousePress(head.auto, LEFT)
    assert show(12) == (1, at)
    QTest.mouseRelease(head.auto, LEFT)
    qtbot.waitUntil(lambda: field.mapTo(area, QPoint(0, 0)).y() > at)
    lines, lower = show(12)
    assert 1 < lines < 4
    assert head.problem.text().count("number") == 12
    assert show(2)[1] == show(0)[1] == lower  # what was to be clicked stays
    assert show(400)[0] == 7
    assert head.problem.toolTip().count("number") == 400


def test_help_leaves_the_buttons_of_the_head_in_place(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "gaussian_mtf")
    panel = area.panels["node"]
    area.resize(area.width(), panel.sizeHint().height() + 20)
    parts = [panel.head.name, *panel.head.bar.findChildren(QToolButton)]
    places = [one.geometry() for one in parts]
    assert not area.verticalScrollBar().maximum()
    QTest.mouseClick(panel.head.help, LEFT)
    qtbot.waitUntil(lambda: area.verticalScrollBar().maximum() > 0)
    assert [one.geometry() for one in parts] == places


def test_parameters_that_an_error_is_about_are_marked(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "detector_mtf")
    marked = ("detector_x_um", "focal_length_mm")
    for parameters in (marked, ()):
        area.set_badges({"node": Badge("error", "empty", parameters)})
        for field in area.panels["node"].body.sections.fields:
            role = field.marked_label().foregroundRole()
            assert (role == ERROR) == (field.parameter.name in parameters)


def test_pinned_panels_stay_open_below_and_are_closed(qtbot, session):
    area = panel_area(qtbot, session)
    for name in ("one", "two", "three"):
        drop(session, "jitter_mtf", name)
    session.select(["one"])
    QApplication.processEvents()
    QTest.mouseClick(area.panels["one"].head.pin, LEFT)
    assert session.network.nodes["one"].extra["pinned"] is True
    kept = area.panels["one"]
    session.select(["three"])
    assert order(area) == ["three", "one"]
    assert area.panels["one"] is kept
    session.select(["one"])
    assert order(area) == ["one"]
    session.select([])
    assert order(area) == ["one"]
    assert area.network_panel.isVisible()
    QTest.mouseClick(kept.head.bar.fold, LEFT)
    assert not kept.body.isVisible()
    QTest.mouseClick(kept.head.bar.fold, LEFT)
    QTest.mouseClick(kept.head.close_button, LEFT)
    assert "pinned" not in session.network.nodes["one"].extra
    assert order(area) == []
    session.undo()
    assert order(area) == ["one"]
    session.do(set_node_field("two", "pinned", True))
    session.do(remove_nodes(("one",)))
    assert order(area) == ["two"]
    session.select(["three"])
    QApplication.processEvents()
    QTest.mouseClick(area.panels["three"].head.close_button, LEFT)
    assert session.selection == ()
    assert order(area) == ["two"]


def order(area):
    """The panels from top to bottom."""
    QApplication.processEvents()
    return sorted(area.panels, key=lambda name: area.panels[name].y())


def test_a_section_is_shown_only_while_its_parameters_count(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "exit_pupil")
    sections = area.panels["node"].body.sections
    conditional = [section for section in sections.sections if section.shown_when]
    assert conditional
    for section in conditional:
        name, values = section.shown_when
        for choice in sections.field(name).choices:
            session.do(set_parameter("node", name, choice))
            QApplication.processEvents()
            for inside in section.parameters:
                assert sections.field(inside).isVisible() == (choice in values)


LONG = "/data/campaigns/2024-spring/flights/17/calibrated/radiance/runway_after_rain.exr"


def test_the_end_of_a_path_is_seen(qtbot, session):
    area = panel_area(qtbot, session, width=360)
    drop(session, "read_image")
    session.do(set_parameter("node", "path", LONG))
    line = field_of(area, session, "path").edit
    area.setFocus()
    line.grab()
    assert line.text() == LONG
    assert line.fontMetrics().horizontalAdvance(LONG) > line.width()
    assert line.cursorPositionAt(QPoint(line.width() - 3, line.height() // 2)) == len(LONG)


def offered(field):
    QApplication.processEvents()
    return [c for c, b in zip(field.choices, field.buttons, strict=True) if b.isVisible()]


def press(field, choice):
    button = field.buttons[field.choices.index(choice)]
    QTest.mouseClick(button, LEFT, pos=QPoint(8, button.height() // 2))


def test_a_region_offers_its_materials_as_buttons(qtbot, session):
    area = panel_area(qtbot, session)
    drop(session, "electronics_noise")
    sections = area.panels["node"].body.sections
    region, material = sections.field("region"), sections.field("material")
    for name, materials in (
        ("MWIR", {"InSb", "PtSi", "HgCdTe", "manual"}),
        ("VIS", {"Si", "manual", "HgCdTe"}),  # the last one is chosen, and stays
        ("LWIR", {"HgCdTe", "Si:Ga", "Si:As", "manual"}),  # figs. 4.35 and 4.42
    ):
        press(region, name)
        assert set(offered(material)) == materials
    press(material, "Si:As")
    assert session.network.nodes["node"].params["material"] == "Si:As"
