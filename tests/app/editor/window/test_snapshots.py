"""Snapshots in the window, by keys and mouse: kept, flipped, wiped, read, gone back to."""

import gc
import weakref

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QPalette
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QTabBar

from app.editor.snapshots.all_figures import AllFiguresQuery
from app.editor.snapshots.keep_query import KeepQuery
from app.editor.theme import THEMES
from app.editor.viewers.pixels.grey_levels import grey_levels
from colour_sight import contrast
from core.editing.fields import set_parameter
from core.editing.links import Rewire
from core.editing.nodes import Remove
from region_hands import PictureHand
from window_hands import CTRL, KEY, SHIFT, add, give_focus

PORT = "back.image"
PLAIN = Qt.KeyboardModifier.NoModifier


class Person:
    """Presses keys where the focus is, on a window with a network."""

    def __init__(self, window, idle):
        self.window = window
        self._idle = idle
        self.viewer = window.viewers.images[1]
        self.kept = window.kept

    def key(self, key, modifiers=PLAIN):
        QTest.keyClick(QApplication.focusWidget(), key, modifiers)
        self.idle()

    def idle(self):
        self._idle(self.window)

    def at_picture(self):
        give_focus(self.viewer.canvas)

    def blur(self, sigma):
        assert self.window.session.do(set_parameter("blur", "sigma_x_mrad", sigma))
        self.idle()

    def keep(self):
        self.at_picture()
        self.key(KEY.Key_K, CTRL)

    def open_list(self):
        self.key(KEY.Key_K, CTRL | SHIFT)
        return self.kept.view.list

    @property
    def status(self):
        return self.window.status.currentMessage()

    def drawn_at(self, row, column):
        """The grey of a dot of the picture as it is painted."""
        canvas = self.viewer.canvas
        image = canvas.grab().toImage()
        place = canvas.mapFromScene(canvas.view.mapViewToScene(QPointF(column, row)))
        return image.pixelColor(place * image.devicePixelRatio()).red()


@pytest.fixture
def person(window, idle):
    window.files.open_now("first_steps")
    idle(window)
    window.activateWindow()
    made = Person(window, idle)
    assert made.viewer.choices.port == PORT
    return made


def plain_spot(one, other):
    """Where both pictures are even around, and far from one another."""
    rows, columns = one.shape
    for row in range(6, rows - 6, 3):
        for column in range(6, columns - 6, 3):
            around = slice(row - 3, row + 4), slice(column - 3, column + 4)
            here, there = one[around], other[around]
            if here.min() > there.max() + 25 or there.min() > here.max() + 25:
                return row, column
    raise AssertionError("the pictures are alike everywhere")


def test_k_flips_in_place_with_the_same_levels_and_zoom(person):
    viewer = person.viewer
    before = viewer.picture.samples
    person.keep()
    assert "kept as Snapshot 1" in person.status
    person.blur(12.0)
    viewer.canvas.zoom_by(1.5)
    zoom, levels = viewer.canvas.zoom, viewer.picture.levels
    now = viewer.picture.grey
    a = grey_levels(before, *levels)
    spot = plain_spot(now, a)
    person.key(KEY.Key_K)
    assert viewer.canvas.names.left.text().startswith("A  Snapshot 1")
    assert viewer.canvas.names.left.isVisible()
    assert not viewer.canvas.names.right.isVisible()
    assert not viewer.canvas.wipe.isVisible()
    assert viewer.canvas.zoom == zoom
    assert viewer.picture.levels == levels
    assert (viewer.picture.other.grey == a).all()
    viewer.canvas.zoom_by(1 / 1.5)
    assert abs(person.drawn_at(*spot) - int(a[spot])) <= 25
    person.key(KEY.Key_K)
    assert not viewer.canvas.names.left.isVisible()
    assert abs(person.drawn_at(*spot) - int(now[spot])) <= 25


def test_the_second_flip_waits_for_nothing(person):
    person.keep()
    person.blur(12.0)
    for _ in range(2):
        person.key(KEY.Key_K)
    assert person.viewer.picture.other is None
    person.kept.snapshots.flip()  # no event is processed in between
    assert person.viewer.picture.other is not None
    assert person.viewer.canvas.second.isVisible()
    person.kept.snapshots.flip()
    assert not person.viewer.canvas.second.isVisible()
    person.idle()
    assert person.viewer.picture.other is None


def test_w_wipes_the_divider_is_dragged_and_both_sides_are_read(person):
    viewer, canvas = person.viewer, person.viewer.canvas
    before = viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.key(KEY.Key_W)
    rows, columns = before.shape
    assert canvas.wipe.isVisible()
    names = canvas.names
    assert names.left.text().startswith("A  Snapshot 1")
    assert names.right.text() == "B  now"
    hand = PictureHand(viewer)
    hand.press((columns / 2, rows / 2))
    for share in (0.45, 0.4, 0.35, 0.3, 0.25):
        QTest.qWait(25)  # pyqtgraph leaves out movements that follow in less than 10 ms
        hand.move((share * columns, rows / 2))
    QTest.qWait(25)
    hand.release((columns / 4, rows / 2))
    assert canvas.split == pytest.approx(0.25, abs=0.02)
    divider = hand.at(canvas.split * columns, 0).x()
    assert names.left.geometry().right() <= divider <= names.right.geometry().left()
    a = grey_levels(before, *viewer.picture.levels)
    b = viewer.picture.grey
    part = slice(0, rows), slice(0, int(columns * canvas.split) - 8)
    spot = plain_spot(a[part], b[part])
    assert abs(person.drawn_at(*spot) - int(a[spot])) <= 25
    # The mouse over a sample: of both sides radiance and temperature.
    row, column = 20, 30
    hand.move((column + 0.5, row + 0.5))
    text = viewer.status.more.text()
    assert f"row {row}  column {column}:  A {float(before[row, column]):.6g} W/m²/sr" in text
    assert f"B {float(viewer.picture.samples[row, column]):.6g} W/m²/sr" in text
    assert text.count(" K") == 3  # of A, of B, and of their difference
    person.key(KEY.Key_Right, CTRL)
    person.key(KEY.Key_Right, CTRL | SHIFT)
    assert canvas.split == pytest.approx(0.25 + 0.11, abs=0.02)
    person.key(KEY.Key_W)
    assert not canvas.wipe.isVisible()
    assert viewer.picture.other is None


def test_what_is_wiped_is_copied_and_written_as_it_looks(person, tmp_path):
    viewer = person.viewer
    before = viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.key(KEY.Key_W)
    viewer.copy()
    image = QApplication.clipboard().image()
    a = grey_levels(before, *viewer.picture.levels)
    row, last = a.shape[0] // 2, a.shape[1] - 1
    assert image.pixelColor(0, row).red() == a[row, 0]
    assert image.pixelColor(last, row).red() == viewer.picture.grey[row, last]
    viewer.save_as(tmp_path / "now.npy")
    assert (np.load(tmp_path / "now.npy") == viewer.picture.samples).all()
    person.key(KEY.Key_K)
    viewer.save_as(tmp_path / "kept.npy")
    assert (np.load(tmp_path / "kept.npy") == before).all()


def test_the_keys_work_on_the_canvas_and_say_what_to_do_first(person):
    give_focus(person.window.canvas.view)
    for key in (KEY.Key_K, KEY.Key_W):
        person.key(key)
        assert "nothing is kept yet: Ctrl+K" in person.status
    person.key(KEY.Key_K, CTRL)
    person.key(KEY.Key_W)
    assert person.viewer.canvas.wipe.isVisible()


def test_the_keys_work_on_a_picture_over_the_whole_screen(person):
    person.at_picture()
    person.key(KEY.Key_F11)
    page = person.window.full_screen.page
    assert page.isVisible()
    page.activateWindow()
    give_focus(person.viewer.canvas)
    person.key(KEY.Key_K, CTRL)
    assert len(person.kept.snapshots.states) == 1
    person.key(KEY.Key_W)
    assert person.viewer.canvas.wipe.isVisible()
    person.key(KEY.Key_F11)
    assert person.window.full_screen.page is None


def test_what_is_still_being_typed_is_kept(person):
    session = person.window.session
    session.select(["blur"])
    person.idle()
    field = person.window.panels.panels["blur"].findChild(QLineEdit, "value.sigma_x_mrad")
    give_focus(field)
    field.selectAll()
    QTest.keyClicks(field, "7")
    person.key(KEY.Key_K, CTRL)
    (state,) = person.kept.snapshots.states
    assert state.network.nodes["blur"].params["sigma_x_mrad"] == 7
    assert field.text() == "7"


def test_of_an_empty_network_nothing_is_kept(window, idle):
    window.files.new()
    idle(window)
    window.activateWindow()
    give_focus(window.canvas.view)
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_K, CTRL)
    assert window.status.currentMessage() == "the network is empty: there is nothing to keep"
    assert window.kept.snapshots.states == ()


def test_only_references_are_kept_and_in_a_quiet_moment(person):
    samples = person.viewer.picture.samples
    viewers = person.window.viewers
    queries = [person.viewer.queries(), viewers.plot.queries()]
    person.keep()
    (state,) = person.kept.snapshots.states
    assert state.results.pictures[PORT].samples is samples
    # A pass after an edit has to answer what it had before, and waits for nothing else.
    assert [person.viewer.queries(), viewers.plot.queries()] == queries
    assert KeepQuery.waits
    assert AllFiguresQuery.waits
    assert state.network is person.window.session.document.network


def test_of_what_was_computed_nothing_else_is_held(person):
    person.window.files.open_now("kodak_kir310")
    person.idle()
    person.keep()
    session, store = person.window.session, person.window.evaluator._runner._engine.store
    computed = [entry[0] for entry in (*store._values.values(), *store._pinned.values())]
    arrays = [weakref.ref(value) for value in computed if isinstance(value, np.ndarray)]
    del computed
    session.do(Remove(tuple(session.network.nodes)))
    person.idle()
    store.clear()
    gc.collect()
    (state,) = person.kept.snapshots.states
    kept = {id(picture.samples) for picture in state.results.pictures.values()}
    left = {id(array()) for array in arrays if array() is not None}
    assert left == kept
    assert len(left) < len(arrays)


def test_an_edit_right_after_the_key_is_not_in_the_snapshot(person):
    before = person.viewer.picture.samples
    person.at_picture()
    QTest.keyClick(person.viewer.canvas, KEY.Key_K, CTRL)
    person.window.session.do(set_parameter("blur", "sigma_x_mrad", 12.0))
    person.idle()
    (state,) = person.kept.snapshots.states
    kept = state.results.pictures[PORT].samples
    assert (kept == before).all()
    assert not (kept == person.viewer.picture.samples).all()


def test_another_wire_of_a_is_computed_when_it_is_compared(person):
    person.keep()
    person.blur(12.0)
    person.viewer.look_at("blur.mtf")
    person.idle()
    person.key(KEY.Key_W)
    person.idle()
    (state,) = person.kept.snapshots.states
    assert "blur.mtf" in state.results.pictures
    assert person.viewer.picture.other.samples is state.results.pictures["blur.mtf"].samples


def test_another_size_is_said_and_b_shown(person):
    person.keep()
    columns = person.viewer.picture.facts.columns
    person.window.session.do(set_parameter("scene", "width", columns // 2))
    person.idle()
    person.key(KEY.Key_W)
    viewer = person.viewer
    assert viewer.status.title.text().startswith(f"not compared: A has {columns} × ")
    assert viewer.picture.facts.columns == columns // 2
    assert not viewer.canvas.wipe.isVisible()
    assert not viewer.canvas.names.left.isVisible()


def test_the_list_has_name_time_and_what_changed_since(person):
    person.keep()
    sigma = person.window.session.network.nodes["blur"].params["sigma_x_mrad"]
    person.blur(12.0)
    rows = person.open_list()
    item = rows.topLevelItem(0)
    (state,) = person.kept.snapshots.states
    assert item.text(0) == "A  Snapshot 1"
    assert item.text(1) == f"{state.taken:%H:%M:%S}"
    assert item.text(2) == f"blur σ x {sigma:g} → 12 mrad"
    person.window.session.undo()
    person.idle()
    assert rows.topLevelItem(0).text(2) == "as now"
    assert person.kept.snapshots.states == (state,)  # undo leaves snapshots alone


def test_the_empty_list_says_what_to_do_first(person):
    person.at_picture()
    person.open_list()
    assert person.kept.view.title.text() == "nothing is kept yet: Ctrl+K keeps the present state"
    assert not person.kept.view.flip.isEnabled()
    names = [bar.accessibleName() for bar in person.window.findChildren(QTabBar)]
    assert names
    assert all(names)
    person.open_list()
    assert not person.kept.view.isVisible()


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
    assert [state.name for state in person.kept.snapshots.states] == ["kw wide"]
    assert rows.topLevelItem(0).text(0) == "A  kw wide"
    assert person.kept.snapshots.way is None


def test_the_current_row_is_a_and_del_removes_it(person):
    first = person.viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.keep()
    rows = person.open_list()
    assert [rows.topLevelItem(row).text(0) for row in (0, 1)] == ["A  Snapshot 2", "Snapshot 1"]
    person.key(KEY.Key_Down)
    assert person.kept.snapshots.chosen.name == "Snapshot 1"
    person.key(KEY.Key_K)
    assert (person.viewer.picture.other.samples == first).all()
    person.key(KEY.Key_Delete)
    assert [state.name for state in person.kept.snapshots.states] == ["Snapshot 2"]
    assert person.kept.snapshots.chosen.name == "Snapshot 2"
    person.key(KEY.Key_Delete)
    assert person.kept.snapshots.way is None
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
    assert "back at Snapshot 1" in person.status
    assert session.document.history.undo_text == "Go back to Snapshot 1"
    session.undo()
    assert session.document.text() == changed
    session.redo()
    person.idle()
    person.window.actions_by_name["go_back"].trigger()
    assert "as in Snapshot 1 already" in person.status


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
    rows = person.open_list()
    assert rows.topLevelItem(0).text(2) == "lens/blur σ x 12 → 3 mrad"
    assert "lens" in rows.topLevelItem(1).toolTip(2)
    person.kept.snapshots.go_back(1)
    person.idle()
    assert session.document.text() == kept
    session.undo()
    session.undo()
    session.undo()
    assert session.document.text() == grouped
    person.kept.snapshots.go_back(1)
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
    assert len(person.kept.snapshots.states[0].results.curves) == 2


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


@pytest.mark.parametrize("look", ["dark", "light"])
def test_figures_stand_side_by_side_with_differences_in_colour_and_sign(person, look):
    window = person.window
    window.files.open_now("kodak_kir310")
    person.idle()
    window.set_theme(THEMES[look])
    person.keep()
    window.session.do(set_parameter("init", "f_number", 4.0))
    person.idle()
    person.open_list()
    person.idle()
    table, strip = person.kept.view.table, window.figures
    rows = {}
    for row in range(table.rowCount()):
        if table.item(row, 4) is not None:
            rows[table.item(row, 0).text().strip()] = row
    row = rows["G#"]
    a, b = (float(table.item(row, column).text()) for column in (1, 2))
    assert f"{b:g} 1/sr" in strip.text("g_number")
    # G# = (1 + 4 F#²) / (π τ): from F/2 to F/4 it grows as 65 to 17.
    assert b / a == pytest.approx(65 / 17, rel=1e-3)
    assert table.item(row, 3).text() == "1/sr"
    assert table.item(row, 4).text() == "▲ +282 %"
    assert table.item(rows["Bandwidth"], 4).text() == "="
    assert table.item(rows["SNR"], 4).text().startswith("▼ −")
    inks = {}
    ground = table.palette().color(QPalette.ColorRole.Base).name()
    for name in ("G#", "Bandwidth", "SNR"):
        inks[name] = table.item(rows[name], 4).foreground().color().name()
        assert contrast(inks[name], ground) >= 4.5
    assert len(set(inks.values())) == 3
    differing = sum(table.item(n, 4).text() != "=" for n in rows.values())
    assert person.kept.view.title.text().startswith(f"A Snapshot 1, B now: {differing} of ")
    seen = len(rows)
    QTest.mouseClick(person.kept.view.every, Qt.MouseButton.LeftButton)
    assert table.rowCount() > seen


def test_pictures_beyond_the_bound_are_dropped_said_and_computed_again(person):
    snapshots = person.kept.snapshots
    samples = person.viewer.picture.samples
    snapshots.capacity_bytes = 2**20  # less than two states of this network
    person.keep()
    held = sum(picture.samples.nbytes for picture in snapshots.states[0].results.pictures.values())
    snapshots.capacity_bytes = held
    person.blur(12.0)
    person.keep()
    assert "some of Snapshot 1 are dropped" in person.status
    assert not snapshots.states[0].results.pictures
    assert snapshots.states[0].results.figures is not None
    snapshots.choose(1)
    person.key(KEY.Key_K)
    person.idle()
    assert (person.viewer.picture.other.samples == samples).all()


def test_snapshots_go_with_their_network_and_that_is_said(person):
    person.keep()
    person.key(KEY.Key_W)
    person.window.files.open_now("pupils")
    person.idle()
    assert person.kept.snapshots.states == ()
    assert person.kept.snapshots.way is None
    assert "the snapshot of the last network went with it" in person.status
    assert person.viewer.kept_side is None
    person.keep()
    assert person.kept.snapshots.states[0].name == "Snapshot 1"


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
