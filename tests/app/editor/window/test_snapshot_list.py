"""The list of snapshots: named, removed, gone back to, with curves and figures of both sides."""

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit

from core.editing.operations import remove_nodes, set_parameter
from window_hands import KEY, give_focus, show_small


def test_snapshots_are_named_chosen_and_removed_in_their_list(person):
    first = person.viewer.picture.samples
    snapshots = person.snapshots
    person.keep()
    kept = snapshots.chosen
    person.blur(12.0)
    person.keep()
    # Of another state it is computed once it is A.
    snapshots.choose(kept)
    assert not snapshots.results
    person.key(KEY.Key_K)
    person.idle()
    assert (person.viewer.picture.other.samples == first).all()
    assert snapshots.figures
    person.key(KEY.Key_K)
    rows = person.open_list()
    assert rows.hasFocus()
    assert [rows.topLevelItem(row).text(0) for row in (0, 1)] == ["Snapshot 2", "Snapshot 1"]
    rows.setCurrentItem(rows.topLevelItem(0))
    person.key(KEY.Key_Down)
    assert snapshots.chosen.name == "Snapshot 1"
    person.key(KEY.Key_F2)  # a name is typed without flipping
    assert isinstance(QApplication.focusWidget(), QLineEdit)
    QTest.keyClicks(QApplication.focusWidget(), "kw wide")
    person.key(KEY.Key_Return)
    assert [state.name for state in snapshots.states] == ["kw wide", "Snapshot 2"]
    assert rows.topLevelItem(1).text(0) == "kw wide"
    assert snapshots.way is None
    give_focus(rows)
    person.key(KEY.Key_K)
    assert (person.viewer.picture.other.samples == first).all()
    person.key(KEY.Key_Delete)
    assert [state.name for state in snapshots.states] == ["Snapshot 2"]
    assert snapshots.chosen.name == "Snapshot 2"
    person.key(KEY.Key_Delete)
    assert snapshots.way is None
    assert person.viewer.picture.other is None


def test_going_back_is_a_step_that_undo_takes_back(person):
    session, plot = person.window.session, person.window.viewers.plot
    before = {curve.name: curve.x.mtf for _, curve in plot.data.curves}
    kept = session.document.text()
    person.keep()
    person.blur(12.0)
    # Curves of A stand dashed beside those of B.
    titles = [entry.title for entry in plot.canvas.drawing.entries]
    assert "A: blur" in titles
    line = next(line for line in plot.canvas.drawing.panels[0].lines if line.name == "A blur")
    assert (line.y == before["blur"]).all()
    plot.set_angle(90.0)  # A's along another line is computed, too
    person.idle()
    person.idle()
    titles = [entry.title for entry in plot.canvas.drawing.entries]
    assert "A: Total" not in titles  # along η nothing has changed
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


def test_the_figures_that_differ_are_listed_and_go_with_their_network(person):
    window = person.window
    person.keep()
    person.at_picture()
    person.key(KEY.Key_W)
    show_small(window, "kodak_kir310")
    person.idle()
    assert person.snapshots.states == []
    assert person.snapshots.way is None
    assert "the snapshots of the previous network were removed" in person.status
    assert person.viewer.kept_side is None
    person.keep()
    assert person.snapshots.states[0].name == "Snapshot 1"
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
        f"A: Snapshot 1, B: now; {len(lines)} of "
    )
