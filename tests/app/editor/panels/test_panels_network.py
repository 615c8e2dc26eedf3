"""The panel of the network itself, and of modules that the library does not have."""

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from core.editing.operations import ABSENT, add_nodes, set_parameter
from core.network.network import LARGEST_INTEGER, SEEDS, Node
from panel_hands import LEFT, drop, let_go, panel_area, type_in, undo_to


def test_the_networks_own_panel(qtbot, session):
    area = panel_area(qtbot, session)
    panel = area.network_panel
    assert panel.isVisible()
    assert panel.count.text() == "0 nodes, 0 wires"
    before = session.document.text()
    type_in(panel.name, "Sensor")
    type_in(panel.seed, "1996")
    QTest.mouseClick(panel.description.viewport(), LEFT)
    QTest.keyClicks(panel.description, "Two lines")
    QTest.keyClick(panel.description, Qt.Key.Key_Return)
    QTest.keyClicks(panel.description, "of words")
    panel.name.setFocus()
    network = session.network
    assert (network.name, network.seed) == ("Sensor", 1996)
    assert network.description == "Two lines\nof words"
    for bad in ("-1", "1.5", str(LARGEST_INTEGER + 1), "x", ""):
        type_in(panel.seed, bad)
        assert session.network is network
        assert SEEDS in panel.seed_problem.text()
        assert panel.seed_problem.isVisible()
    QTest.keyClick(panel.seed, Qt.Key.Key_Escape)
    assert panel.seed.text() == "1996"
    assert not panel.seed_problem.isVisible()
    type_in(panel.seed, str(LARGEST_INTEGER))
    assert session.network.seed == LARGEST_INTEGER
    undo_to(session, 0)
    assert session.document.text() == before
    assert panel.name.text() == panel.description.toPlainText() == ""
    drop(session, "jitter_mtf")
    assert not panel.isVisible()
    session.select([])
    assert panel.count.text() == "1 node, 0 wires"


def test_a_module_the_library_does_not_have_is_shown_and_kept(qtbot, session):
    params = {"gain": 2.5, "mode": "odd", "list": [1, 2]}
    area = panel_area(qtbot, session)
    session.do(add_nodes(((Node("what", "from_the_future", params), None),)))
    session.select(["what"])
    QApplication.processEvents()
    body = area.panels["what"].body
    assert "no module from_the_future" in body.note.text()
    shown = {name: body.findChild(QWidget, f"raw.{name}").text() for name in params}
    assert shown == {"gain": "2.5", "mode": "odd", "list": "[1, 2]"}
    session.do(set_parameter("what", "gain", ABSENT))
    let_go()
    assert body.findChild(QWidget, "raw.gain") is None
