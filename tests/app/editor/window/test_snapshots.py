"""Snapshots in the window, by keys and mouse: kept, flipped, wiped and read."""

import gc
import re
import weakref

import numpy as np
import pytest
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.viewers.pixels.grey_levels import grey_levels
from app.editor.viewers.pixels.picture_query import KeptPicture
from core.editing.operations import set_parameter
from region_hands import PictureHand
from window_hands import CTRL, KEY, SHIFT


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
    assert viewer.canvas.names[0].toPlainText().startswith("A  Snapshot 1")
    assert viewer.canvas.names[0].isVisible()
    assert not viewer.canvas.names[1].isVisible()
    assert not viewer.canvas.wipe.isVisible()
    assert viewer.canvas.zoom == zoom
    assert viewer.picture.levels == levels
    assert (viewer.picture.other.grey == a).all()
    viewer.canvas.zoom_by(1 / 1.5)
    assert abs(person.drawn_at(*spot) - int(a[spot])) <= 25
    person.key(KEY.Key_K)
    assert not viewer.canvas.names[0].isVisible()
    assert abs(person.drawn_at(*spot) - int(now[spot])) <= 25


def test_w_wipes_the_divider_is_dragged_and_both_sides_are_read(person):
    viewer, canvas = person.viewer, person.viewer.canvas
    before = viewer.picture.samples
    person.keep()
    person.blur(12.0)
    person.key(KEY.Key_W)
    rows, columns = before.shape
    assert canvas.wipe.isVisible()
    names = canvas.names
    assert names[0].toPlainText().startswith("A  Snapshot 1")
    assert names[1].toPlainText() == "B  now"
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
    a = grey_levels(before, *viewer.picture.levels)
    b = viewer.picture.grey
    part = slice(0, rows), slice(0, int(columns * canvas.split) - 8)
    spot = plain_spot(a[part], b[part])
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


def test_of_what_was_computed_nothing_else_is_held(person):
    person.window.files.open_now("kodak_kir310")
    person.idle()
    person.keep()
    session, store = person.window.session, person.window.evaluator._runner._engine.store
    computed = [entry[0] for entry in (*store._values.values(), *store._pinned.values())]
    arrays = [weakref.ref(value) for value in computed if isinstance(value, np.ndarray)]
    del computed
    session.do(set_parameter("scene", "width", 512))  # all is computed anew
    person.idle()
    store.clear()
    gc.collect()
    pictures = person.snapshots.results.values()
    kept = {id(one.samples) for one in pictures if isinstance(one, KeptPicture)}
    left = {id(array()) for array in arrays if array() is not None}
    assert left == kept
    assert len(left) < len(arrays)


def test_another_wire_of_a_is_computed_when_it_is_compared(person):
    person.keep()
    person.blur(12.0)
    person.viewer.look_at("blur.mtf")
    person.idle()
    person.key(KEY.Key_W)
    person.idle()
    assert person.viewer.picture.other.samples is person.snapshots.results["blur.mtf"].samples
