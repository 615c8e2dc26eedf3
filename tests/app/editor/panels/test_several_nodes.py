"""Nodes of one module that are selected together: a change of a value is for all, one undo step."""

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from core.editing.operations import add_nodes
from core.network.network import Node
from panel_hands import LEFT, drag, handle_of, panel_area, type_in

SIGMAS = {"one": 0.1, "two": 0.2, "three": 0.3}


@pytest.fixture
def area(qtbot, session):
    nodes = [Node(name, "gaussian_mtf", {"sigma_x_mrad": sigma}) for name, sigma in SIGMAS.items()]
    nodes.append(Node("other", "jitter_mtf"))
    session.do(add_nodes(tuple((node, (0.0, 0.0)) for node in nodes)))
    return panel_area(qtbot, session)


def sigmas(session):
    return {name: session.network.nodes[name].params.get("sigma_x_mrad") for name in SIGMAS}


def field(area, name):
    return area.panels[name].body.sections.field("sigma_x_mrad")


def test_what_is_typed_is_for_all_of_them_and_one_step(area, session):
    session.select(["one", "three"])
    steps = session.document.position
    type_in(field(area, "three").edit, "0.7", key=Qt.Key.Key_Return)
    assert sigmas(session) == {"one": 0.7, "two": 0.2, "three": 0.7}
    assert session.document.position == steps + 1
    session.undo()
    assert sigmas(session) == SIGMAS


def test_a_drag_is_one_step_and_esc_gives_each_its_own_value_back(area, session):
    session.select(["one", "two", "three"])
    QApplication.processEvents()
    steps = session.document.position
    slider = field(area, "three").slider
    start = handle_of(slider)
    QTest.mousePress(slider, LEFT, pos=start)
    QTest.mouseMove(slider, start + QPoint(20, 0))
    moved = sigmas(session)
    assert moved["one"] == moved["two"] == moved["three"] != 0.3
    QTest.keyClick(slider, Qt.Key.Key_Escape)
    assert sigmas(session) == SIGMAS
    QTest.mouseMove(slider, start + QPoint(30, 0))
    QTest.mouseRelease(slider, LEFT, pos=start + QPoint(30, 0))
    assert sigmas(session) == SIGMAS
    drag(slider, 0.4)
    assert session.document.position == steps + 1
    session.undo()
    assert sigmas(session) == SIGMAS
