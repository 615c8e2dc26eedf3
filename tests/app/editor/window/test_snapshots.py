"""Snapshots in the window, by keys and mouse: kept, flipped, wiped and read."""

import gc
import re
import weakref

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.theme import theme_of
from app.editor.viewers.picture.picture_facts import grey_levels
from app.editor.viewers.picture.picture_query import KeptPicture
from core.editing.operations import set_parameter
from region_hands import PictureHand
from window_hands import CTRL, KEY, SHIFT, give_focus, show_small

LEFT = Qt.MouseButton.LeftButton


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


def wiped(person, a, now, folder):
    """By W: what is wiped is copied and written as it looks."""
    viewer, canvas, names = person.viewer, person.viewer.canvas, person.viewer.canvas.names
    before, (rows, columns) = np.load(folder / "kept.npy"), a.shape
    person.key(KEY.Key_W)
    assert canvas.wipe.isVisible()
    assert names[0].toPlainText().startswith("A  Snapshot 1")
    assert names[1].toPlainText() == "B  now"
    viewer.copy()
    image = QApplication.clipboard().image()
    assert image.pixelColor(0, rows // 2).red() == a[rows // 2, 0]
    assert image.pixelColor(columns - 1, rows // 2).red() == now[rows // 2, -1]
    middle = [image.pixelColor(columns // 2 + k, rows // 2) for k in (-1, 0)]
    assert theme_of(canvas).accent in middle  # the file says that it has two sides
    viewer.export(folder / "now.npy")
    assert (np.load(folder / "now.npy") == viewer.picture.samples).all()
    # The divider is dragged, and both sides are read.
    hand = PictureHand(viewer)
    hand.press((columns / 2, rows / 2))
    for share in (0.45, 0.4, 0.35, 0.3, 0.25):
        QTest.qWait(25)  # pyqtgraph leaves out movements that follow in less than 10 ms
        hand.move((share * columns, rows / 2))
    QTest.qWait(25)
    hand.release((columns / 4, rows / 2))
    assert canvas.split == pytest.approx(0.25, abs=0.02)
    divider = canvas.split * columns
    assert names[0].pos().x() <= divider <= names[1].pos().x()
    part = slice(0, rows), slice(0, int(columns * canvas.split) - 8)
    spot = plain_spot(a[part], now[part])
    assert abs(person.drawn_at(*spot) - int(a[spot])) <= 25
    # The mouse over a sample: of both sides radiance and temperature.
    hand.move((30.5, 20.5))
    text = viewer.status.more.text()
    row, column = map(int, re.match(r"row (\d+)  column (\d+):", text).groups())
    assert max(abs(row - 20), abs(column - 30)) <= 2  # a dot of the screen is two samples
    assert f"row {row}  column {column}:  A {float(before[row, column]):.6g} W/m²/sr" in text
    assert f"B {float(viewer.picture.samples[row, column]):.6g} W/m²/sr" in text
    assert text.count(" K") == 3  # of A, of B, and of their difference
    person.key(KEY.Key_Right, CTRL)
    person.key(KEY.Key_Right, CTRL | SHIFT)
    assert canvas.split == pytest.approx(0.25 + 0.11, abs=0.02)
    person.key(KEY.Key_W)
    assert not canvas.wipe.isVisible()
    assert viewer.picture.other is None


def test_k_flips_and_w_wipes_a_snapshot_and_the_picture_of_now(person, tmp_path):
    viewer, canvas, names = person.viewer, person.viewer.canvas, person.viewer.canvas.names
    before = viewer.picture.samples
    person.keep()
    assert "kept as Snapshot 1" in person.status
    person.blur(12.0)
    canvas.zoom_by(1.5)
    zoom, levels = canvas.zoom, viewer.picture.levels
    now = viewer.picture.grey
    a = grey_levels(before, *levels)
    spot = plain_spot(now, a)
    person.key(KEY.Key_K)
    assert names[0].toPlainText().startswith("A  Snapshot 1")
    assert names[0].isVisible()
    assert not names[1].isVisible()
    assert not canvas.wipe.isVisible()
    assert canvas.zoom == zoom
    assert viewer.picture.levels == levels
    assert (viewer.picture.other.grey == a).all()
    canvas.zoom_by(1 / 1.5)
    assert abs(person.drawn_at(*spot) - int(a[spot])) <= 25
    viewer.export(tmp_path / "kept.npy")
    assert (np.load(tmp_path / "kept.npy") == before).all()
    person.key(KEY.Key_K)
    assert not names[0].isVisible()
    assert abs(person.drawn_at(*spot) - int(now[spot])) <= 25
    wiped(person, a, now, tmp_path)
    # Another wire of A is computed when it is compared.
    viewer.look_at("blur.mtf")
    person.idle()
    person.key(KEY.Key_W)
    person.idle()
    assert viewer.picture.other.samples is person.snapshots.results["blur.mtf"].samples


def test_keys_of_pictures_work_in_a_panel_but_not_where_one_types(person):
    window, names = person.window, person.viewer.canvas.names
    window.session.select(["blur"])
    person.keep()
    panel = window.panels.panels["blur"]
    number = panel.body.sections.field("sigma_x_mrad")
    for part in (panel.head.below, number.slider, panel.head.auto, panel.head.disable):
        if part is number.slider or part is panel.head.below:
            QTest.mouseClick(part, LEFT, pos=part.rect().bottomLeft() + QPoint(3, -3))
        else:
            part.setFocus()
        assert window.panels.isAncestorOf(QApplication.focusWidget()) or window.panels.hasFocus()
        for wiped, key in ((False, KEY.Key_K), (True, KEY.Key_W)):
            person.key(key)
            assert names[0].isVisible()
            assert person.viewer.canvas.wipe.isVisible() == wiped
        person.key(KEY.Key_W)
        assert not names[0].isVisible()
    for edit in (panel.head.name, number.edit):
        give_focus(edit)
        edit.selectAll()
        QTest.keyClicks(edit, "kwfmt")
        assert edit.text() == "kwfmt"
        assert not names[0].isVisible()
        QTest.keyClick(edit, KEY.Key_Escape)


def test_of_what_was_computed_nothing_else_is_held(person):
    show_small(person.window, "kodak_kir310")
    person.idle()
    person.keep()
    session, store = person.window.session, person.window.evaluator._runner._engine.store
    computed = [entry[0] for entry in (*store._values.values(), *store._pinned.values())]
    arrays = [weakref.ref(value) for value in computed if isinstance(value, np.ndarray)]
    del computed
    session.do(set_parameter("scene", "width", 96))  # all is computed anew
    person.idle()
    store.clear()
    gc.collect()
    pictures = person.snapshots.results.values()
    kept = {id(one.samples) for one in pictures if isinstance(one, KeptPicture)}
    left = {id(array()) for array in arrays if array() is not None}
    assert left == kept
    assert len(left) < len(arrays)
