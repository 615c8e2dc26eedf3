"""The list of snapshots: named, removed, gone back to, with curves and figures of both sides."""

import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QTabBar

from core.editing.operations import Remove, Rewire, set_parameter
from snapshot_hands import PORT
from window_hands import CTRL, KEY, add, give_focus


def test_the_list_has_name_and_time(person):
    person.keep()
    person.blur(12.0)
    rows = person.open_list()
    item = rows.topLevelItem(0)
    (state,) = person.snapshots.states
    assert item.text(0) == "A  Snapshot 1"
    assert item.text(1) == f"{state.taken:%H:%M:%S}"
    person.window.session.undo()
    person.idle()
    assert person.snapshots.states == [state]  # undo leaves snapshots alone


def test_the_empty_list_says_what_to_do_first(person):
    person.at_picture()
    person.open_list()
    assert (
        person.window.snapshots_view.title.text()
        == "there are no snapshots yet: Ctrl+K keeps the current state"
    )
    assert not person.window.snapshots_view.flip.isEnabled()
    names = [bar.accessibleName() for bar in person.window.findChildren(QTabBar)]
    assert names
    assert all(names)
    person.open_list()
    assert not person.window.snapshots_view.isVisible()


def test_a_picture_that_fails_stays_faint_while_keys_are_pressed(person):
    person.keep()
    link = next(link for link in person.window.session.network.links if link.target == "back")
    person.window.session.do(Rewire((), (link,)))
    person.idle()
    why = person.viewer.status.title.text()
    for key in (KEY.Key_K, KEY.Key_K, KEY.Key_W):
        person.key(key)
        assert person.viewer.canvas.first.opacity() < 0.5
        assert person.viewer.status.title.text() == why


def test_a_name_is_typed_without_flipping(person):
    person.keep()
    rows = person.open_list()
    assert rows.hasFocus()
    person.key(KEY.Key_F2)
    assert isinstance(QApplication.focusWidget(), QLineEdit)
    QTest.keyClicks(QApplication.focusWidget(), "kw wide")
    person.key(KEY.Key_Return)
    assert [state.name for state in person.snapshots.states] == ["kw wide"]
    assert rows.topLevelItem(0).text(0) == "A  kw wide"
    assert person.snapshots.way is None


def test_the_current_row_is_a_and_del_removes_it(person):
    first = person.viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.keep()
    rows = person.open_list()
    assert [rows.topLevelItem(row).text(0) for row in (0, 1)] == ["A  Snapshot 2", "Snapshot 1"]
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
    session.do(Remove(("back",)))
    person.idle()
    changed = session.document.text()
    person.open_list()
    person.key(KEY.Key_Return)
    assert session.document.text() == kept
    assert "restored Snapshot 1" in person.status
    assert session.document.history.undo_text == "Go back to Snapshot 1"
    session.undo()
    assert session.document.text() == changed
    session.redo()
    person.idle()
    person.window.actions_by_name["go_back"].trigger()
    assert "already as in Snapshot 1" in person.status


def test_a_macro_is_grouped_compared_and_gone_back_from(person):
    session, viewer = person.window.session, person.viewer
    kept = session.document.text()
    before = viewer.picture.samples
    person.keep()
    session.select(["init", "blur", "back"])
    give_focus(person.window.canvas.view)
    person.key(KEY.Key_G, CTRL)
    QTest.keyClicks(QApplication.focusWidget(), "lens")
    person.key(KEY.Key_Return)
    grouped = session.document.text()
    assert session.do(set_parameter("lens/blur", "sigma_x_mrad", 12.0))
    person.idle()
    person.keep()
    person.window.viewers.look_at(1, "lens/back.image")
    person.idle()
    assert session.do(set_parameter("lens/blur", "sigma_x_mrad", 3.0))
    person.idle()
    person.at_picture()
    person.key(KEY.Key_W)
    person.idle()
    assert viewer.canvas.wipe.isVisible()  # the wire inside was computed for A
    person.snapshots.go_back(person.snapshots.states[0])
    person.idle()
    assert session.document.text() == kept
    session.undo()
    session.undo()
    session.undo()
    assert session.document.text() == grouped
    person.snapshots.go_back(person.snapshots.states[0])
    viewer.look_at(PORT)
    person.idle()
    assert (viewer.picture.samples == before).all()


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
    assert len(person.snapshots.states[0].curves) == 2


def test_what_a_has_not_is_looked_for_once(person, qtbot):
    window = person.window
    person.keep()
    curve = add(window, "mtf_slices")
    window.viewers.plot.look_at(f"{curve}.curve")
    window.viewers.look_at(1, f"{add(window, 'test_scene')}.image")
    person.at_picture()
    person.key(KEY.Key_W)
    person.idle()
    assert "Snapshot 1 has no" in person.viewer.status.title.text()
    generation = window.evaluator.generation
    qtbot.wait(400)
    assert window.evaluator.generation == generation


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


def test_pictures_beyond_the_bound_are_dropped_said_and_computed_again(person):
    snapshots = person.snapshots
    samples = person.viewer.picture.samples
    snapshots.capacity_bytes = 2**20  # less than two states of this network
    person.keep()
    held = sum(picture.samples.nbytes for picture in snapshots.states[0].pictures.values())
    snapshots.capacity_bytes = held
    person.blur(12.0)
    person.keep()
    assert "those of Snapshot 1 were dropped" in person.status
    assert not snapshots.states[0].pictures
    assert snapshots.states[0].figures is not None
    snapshots.choose(snapshots.states[0])
    person.key(KEY.Key_K)
    person.idle()
    assert (person.viewer.picture.other.samples == samples).all()


def test_snapshots_go_with_their_network_and_that_is_said(person):
    person.keep()
    person.key(KEY.Key_W)
    person.window.files.open_now("pupils")
    person.idle()
    assert person.snapshots.states == []
    assert person.snapshots.way is None
    assert "the snapshot was removed with the previous network" in person.status
    assert person.viewer.kept_side is None
    person.keep()
    assert person.snapshots.states[0].name == "Snapshot 1"


def test_the_actions_stand_in_menus_with_their_keys(person):
    menu = person.window.menus["&Compare"]
    keys = {action.text(): action.shortcut().toString() for action in menu.actions()}
    assert keys["&Keep Snapshot"] == "Ctrl+K"
    assert keys["&Flip A and B"] == "K"
    assert keys["&Wipe A and B"] == "W"
    assert keys["&Snapshots"] == "Ctrl+Shift+K"
    person.window.viewers.look_at(2, PORT)
    for viewer in person.window.viewers.images.values():
        offered = [action.text() for action in viewer.bar.compare.menu.actions()]
        assert offered[-3:] == ["&Keep Snapshot", "&Flip A and B", "&Wipe A and B"]
        sections = [a.text() for a in viewer.bar.compare.menu.actions() if a.isSeparator()]
        assert sections.count("With a snapshot") == 1
