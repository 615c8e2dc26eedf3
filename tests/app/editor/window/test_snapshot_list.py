"""The list of snapshots: named, removed, gone back to, with curves and figures of both sides."""

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit

from core.editing.operations import remove_nodes, set_parameter
from window_hands import KEY


def test_a_name_is_typed_without_flipping(person):
    person.keep()
    rows = person.open_list()
    assert rows.hasFocus()
    person.key(KEY.Key_F2)
    assert isinstance(QApplication.focusWidget(), QLineEdit)
    QTest.keyClicks(QApplication.focusWidget(), "kw wide")
    person.key(KEY.Key_Return)
    assert [state.name for state in person.snapshots.states] == ["kw wide"]
    assert rows.topLevelItem(0).text(0) == "kw wide"
    assert person.snapshots.way is None


def test_the_current_row_is_a_and_del_removes_it(person):
    first = person.viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.keep()
    rows = person.open_list()
    assert [rows.topLevelItem(row).text(0) for row in (0, 1)] == ["Snapshot 2", "Snapshot 1"]
    person.key(KEY.Key_Down)
    assert person.snapshots.chosen.name == "Snapshot 1"
    person.key(KEY.Key_K)
    assert (person.viewer.picture.other.samples == first).all()
    person.key(KEY.Key_Delete)
    assert [state.name for state in person.snapshots.states] == ["Snapshot 2"]
    assert person.snapshots.chosen.name == "Snapshot 2"
    person.key(KEY.Key_Delete)
    assert person.snapshots.way is None
    assert person.viewer.picture.other is None


def test_going_back_is_a_step_that_undo_takes_back(person):
    session = person.window.session
    kept = session.document.text()
    person.keep()
    person.blur(12.0)
    session.do(remove_nodes(("back",)))
    person.idle()
    changed = session.document.text()
    person.open_list()
    person.key(KEY.Key_Return)
    assert session.document.text() == kept
    assert "restored Snapshot 1" in person.status
    assert session.document.undo_text == "Go back to Snapshot 1"
    session.undo()
    assert session.document.text() == changed
    session.redo()
    person.idle()
    person.window.actions_by_name["go_back"].trigger()
    assert "already matches Snapshot 1" in person.status


def test_curves_of_a_stand_dashed_beside_those_of_b(person):
    plot = person.window.viewers.plot
    before = {curve.name: curve.mtf for curve in plot.data.curves}
    person.keep()
    person.blur(12.0)
    titles = [entry.title for entry in plot.canvas.drawing.entries]
    assert "A: blur" in titles
    line = next(line for line in plot.canvas.drawing.panels[0].lines if line.name == "A blur")
    assert (line.y == before["blur"]).all()
    plot.set_angle(90.0)  # A's along another line is computed, too
    person.idle()
    person.idle()
    titles = [entry.title for entry in plot.canvas.drawing.entries]
    assert "A: Total" not in titles  # along η nothing has changed


def test_the_figures_that_differ_are_listed(person):
    window = person.window
    window.files.open_now("kodak_kir310")
    person.idle()
    person.keep()
    window.session.do(set_parameter("init", "f_number", 4.0))
    person.idle()
    person.open_list()
    person.idle()
    figures = person.window.snapshots_view.figures
    lines = [figures.item(row).text() for row in range(figures.count())]
    (line,) = (line for line in lines if " G#: " in line)
    a, b = (float(side.split()[0]) for side in line.partition(": ")[2].split(" → "))
    assert f"{b:g} 1/sr" in window.figures.text("g_number")
    # G# = (1 + 4 F#²) / (π τ): from F/2 to F/4 it grows as 65 to 17.
    assert b / a == pytest.approx(65 / 17, rel=1e-3)
    assert not any("Bandwidth" in line for line in lines)
    assert person.window.snapshots_view.title.text().startswith(
        f"A Snapshot 1, B now: {len(lines)} of "
    )


def test_of_another_state_it_is_computed_once_it_is_a(person):
    snapshots = person.snapshots
    samples = person.viewer.picture.samples
    person.keep()
    first = snapshots.chosen
    person.blur(12.0)
    person.keep()
    snapshots.choose(first)
    assert not snapshots.results
    person.key(KEY.Key_K)
    person.idle()
    assert (person.viewer.picture.other.samples == samples).all()
    assert snapshots.figures


def test_snapshots_go_with_their_network_and_that_is_said(person):
    person.keep()
    person.key(KEY.Key_W)
    person.window.files.open_now("pupils")
    person.idle()
    assert person.snapshots.states == []
    assert person.snapshots.way is None
    assert "the snapshots of the previous network were removed" in person.status
    assert person.viewer.kept_side is None
    person.keep()
    assert person.snapshots.states[0].name == "Snapshot 1"
