"""The viewer of curves shows what the node that is selected has, and says where it has nothing."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QWidget

from app.editor.evaluation.queries import Answer
from core.editing.operations import Remove, Rename
from core.errors import DataError

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


def test_the_curve_of_the_selected_node_is_shown(select):
    viewer = select("merit")
    assert viewer.port == "merit.mrtd"
    assert viewer.canvas.drawing.panels[0].y_label == "MRTD (K)"
    assert select("budget").port == "budget.noise"
    assert viewer.bars.isVisible()


def test_of_a_stage_the_chain_is_shown_with_its_curve_thick(select):
    viewer = select("optics")
    assert viewer.port is None
    assert strong(viewer) == ["optics"]
    pens = viewer.canvas.pens
    assert pens["optics"].widthF() == 3 * pens["jitter"].widthF()
    assert strong(select("jitter")) == ["jitter"]
    assert viewer.canvas.pens["optics"].widthF() == 1


def test_of_a_node_with_a_table_alone_it_is_the_table(select):
    viewer = select("focal_plane")
    assert viewer.port == "focal_plane.table"
    assert viewer.table.isVisible()


def test_a_node_without_curves_is_told_and_keeps_no_others(select, bench):
    viewer = select("merit")
    select("back")
    assert viewer.hint.isVisible()
    assert viewer.hint.text().startswith("back has no curves")
    assert viewer.queries() == ()
    assert not viewer.canvas.isVisible()
    assert viewer.bar.ports.currentText() == ""
    select("merit")
    assert viewer.canvas.isVisible()
    assert not viewer.hint.isVisible()


def test_once_the_node_without_curves_is_gone_the_chain_is_shown(select, bench):
    viewer = select("back")
    bench.do(Rename("back", "inverse"))
    assert viewer.hint.text().startswith("inverse has no curves")
    bench.do(Remove(("inverse",)))
    assert not viewer.hint.isVisible()


def test_with_nothing_selected_it_stays(select, bench):
    viewer = select("merit")
    bench.session.select([])
    assert viewer.port == "merit.mrtd"


def test_curves_that_cannot_be_computed_leave_no_others_in_sight(select):
    viewer = select("merit")
    viewer.look_at("budget.noise")
    (query,) = viewer.queries()
    viewer.take(Answer(1, viewer.owner, query, error=DataError("no noise")))
    assert viewer.status.title.text() == "no noise"
    assert viewer.canvas.drawing.panels == ()
    assert viewer.list.count() == 0


def test_what_fails_after_an_edit_stays_in_sight(select):
    viewer = select("merit")
    (query,) = viewer.queries()
    viewer.take(Answer(1, viewer.owner, query, error=DataError("no noise")))
    assert len(viewer.canvas.drawing.panels) == 1


def test_pinned_it_keeps_its_curves(select):
    viewer = select("merit")
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("optics").port == "merit.mrtd"
    QTest.mouseClick(viewer.bar.pin, LEFT)
    assert select("budget").port == "budget.noise"


def test_its_bar_never_holds_the_dock_wide(select, bench):
    for name in ("merit", "back", "optics"):
        viewer = select(name)
        room = 60 * viewer.fontMetrics().averageCharWidth()
        assert viewer.minimumSizeHint().width() < room, name
    viewer.resize(380, 300)
    bench.settle()
    shown = [part for part in viewer.bar.findChildren(QWidget) if part.isVisibleTo(viewer.bar)]
    direct = [part for part in shown if part.parentWidget() is viewer.bar]
    assert len(direct) > 6
    assert all(viewer.bar.rect().contains(part.geometry()) for part in direct)


def test_the_meaning_of_figures_is_a_tooltip_where_there_is_no_room(select, bench):
    viewer = select("focal_plane")
    viewer.resize(1000, 300)
    bench.settle()
    assert not viewer.table.isColumnHidden(3)
    viewer.resize(380, 300)
    bench.settle()
    assert viewer.table.isColumnHidden(3)
    assert "electrons from the scene" in viewer.table.item(0, 0).toolTip()
