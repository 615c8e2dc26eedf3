"""The viewer of curves shows what the node that is selected has, and says where it has nothing."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

NETWORK = "mwir_camera"

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def select(bench, plot_viewer):
    def by_name(name):
        bench.session.select([name])
        bench.settle()
        return plot_viewer

    return by_name


def strong(viewer):
    return [entry.name for entry in viewer.canvas.drawing.entries if entry.strong]


def test_the_curve_of_the_selected_node_is_shown_unless_another_is_pinned(select):
    viewer = select("merit")
    assert viewer.port == "merit.mrtd"
    assert viewer.canvas.drawing.panels[0].y_label == "MRTD (K)"
    # A node without curves is told, and keeps no others.
    select("back")
    assert viewer.hint.isVisible()
    assert viewer.hint.text().startswith("back has no curves")
    assert viewer.queries() == ()
    assert not viewer.canvas.isVisible()
    assert viewer.bar.ports.currentText() == ""
    select("merit")
    assert viewer.canvas.isVisible()
    assert not viewer.hint.isVisible()
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("optics").port == "merit.mrtd"
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("budget").port == "budget.noise"
    assert viewer.canvas.bars is not None
    # Of a stage the chain is shown, with its curve thick.
    select("optics")
    assert viewer.port is None
    assert strong(viewer) == ["optics"]
    pens = viewer.canvas.pens
    assert pens["optics"].widthF() == 3 * pens["jitter"].widthF()
    assert strong(select("jitter")) == ["jitter"]
    assert viewer.canvas.pens["optics"].widthF() == 1
