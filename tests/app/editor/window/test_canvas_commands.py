"""Commands of the canvas by keys and menus, from finding a node to the colour of a note."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor, QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.canvas.canvas_style import TINTS, CanvasStyle
from app.editor.theme import DARK, LIGHT
from colour_sight import contrast
from core.editing.backdrops import backdrops_of, nodes_on
from window_hands import CTRL, KEY, SHIFT, WindowHands

ALT, NONE = Qt.KeyboardModifier.AltModifier, Qt.KeyboardModifier.NoModifier


def press(window, key, keys=NONE):
    QTest.keyClick(QApplication.focusWidget() or window, key, keys)


def type_in(window, text):
    QTest.keyClicks(QApplication.focusWidget() or window, text)


def links_of(window):
    return {str(link) for link in window.session.network.links}


def test_keys_find_align_lay_out_and_heal(kodak):
    session, canvas = kodak.session, kodak.canvas
    canvas.zoom_by(8.0)
    for typed, name in (("electr", "electronics"), ("charge eff phase", "charge_phase")):
        press(kodak, KEY.Key_F, CTRL)
        assert canvas.popup.is_open
        type_in(kodak, typed)
        press(kodak, KEY.Key_Return)
        assert session.selection == (name,)
        assert canvas.view.visible_rect().contains(canvas.content.nodes[name].frame())
        assert canvas.view.hasFocus()
    names = ["scene", "optics", "electronics"]
    session.select(names)
    for key, edge in (("Left", "left"), ("Right", "right"), ("Up", "top"), ("Down", "bottom")):
        press(kodak, getattr(Qt.Key, f"Key_{key}"), ALT)
        frames = [canvas.content.nodes[name].frame() for name in names]
        assert len({getattr(frame, edge)() for frame in frames}) == 1, key
        session.undo()
        frames = [canvas.content.nodes[name].frame() for name in names]
        assert len({frame.left() for frame in frames}) > 1, key
    # Del and Ctrl+X in mid-chain lead the wire past what is taken out.
    before = links_of(kodak)
    for key, keys in ((KEY.Key_Delete, NONE), (KEY.Key_X, CTRL)):
        session.select(["detector"])
        press(kodak, key, keys)
        assert "detector" not in session.network.nodes
        assert "aberration.magnitude → charge.magnitude" in links_of(kodak)
        session.undo()
        assert links_of(kodak) == before
    assert '"detector"' in QGuiApplication.clipboard().text()
    # Ctrl+Shift+X keeps it, with no wire of its own.
    hand = WindowHands(kodak)
    hand.select("detector")
    press(kodak, KEY.Key_X, CTRL | SHIFT)
    assert "detector" in session.network.nodes
    assert not any("detector." in link for link in links_of(kodak))
    assert "aberration.magnitude → charge.magnitude" in links_of(kodak)
    press(kodak, KEY.Key_Z, CTRL)
    assert links_of(kodak) == before
    # L lays out to the shape of the canvas.
    session.select([])
    kodak.actions_by_name["picture_beside"].trigger()
    QTest.qWait(100)
    canvas.frame_all()
    zoom = canvas.view.zoom
    canvas.setFocus()
    press(kodak, KEY.Key_L)
    assert canvas.view.zoom > 1.3 * zoom
    assert len(canvas.content.backdrops) == 4
    assert canvas.view.visible_rect().contains(canvas.content.bounds())


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_text_is_read_on_every_colour(qapp, theme):
    style = CanvasStyle(theme, qapp.font())
    for name in TINTS:
        assert contrast(style.tint(name).name(), style.text.name()) >= 4.5, name


def titled_at_once(kodak):
    """A note, made after a backdrop.

    Letters typed right after a backdrop were commands: "Tested" disabled four nodes.
    """
    session, canvas = kodak.session, kodak.canvas
    session.select(["detector", "charge"])
    nodes = dict(session.network.nodes)
    count = len(backdrops_of(session.network))
    press(kodak, KEY.Key_B)
    type_in(kodak, "Tested")
    press(kodak, KEY.Key_Return)
    made = backdrops_of(session.network)
    assert len(made) == count + 1
    assert made[-1].title == "Tested"
    assert dict(session.network.nodes) == nodes
    assert canvas.view.hasFocus()
    press(kodak, KEY.Key_D)  # letters are commands again
    assert session.network.nodes["detector"].disabled
    session.undo()
    session.undo()
    session.select([])
    press(kodak, KEY.Key_N)
    type_in(kodak, "Look at D and L")
    press(kodak, KEY.Key_Return)
    note = backdrops_of(session.network)[-1]
    assert (note.title, note.note) == ("Look at D and L", True)
    assert dict(session.network.nodes) == nodes
    assert nodes_on(session.network, len(backdrops_of(session.network)) - 1, {}) == ()
    return note


def test_backdrops_and_notes_are_titled_at_once_and_all_is_coloured_by_menu(kodak, tmp_path):
    session, canvas = kodak.session, kodak.canvas
    note = titled_at_once(kodak)
    actions = {action.text(): action for action in canvas.menus._colours.actions()}
    session.select(["detector", "charge"])
    actions["Red"].trigger()
    assert {session.network.nodes[n].extra["colour"] for n in ("detector", "charge")} == {"red"}
    item = canvas.content.nodes["detector"]
    picture = canvas.view.grab().toImage()
    inside = canvas.view.pixel(item.frame().topLeft())
    around = [(inside.x() + dx, inside.y() + dy) for dx in range(2, 12) for dy in range(2, 12)]
    painted = {QColor(picture.pixel(x, y)).name() for x, y in around}
    assert item.style.tint("red").name() in painted
    session.save(tmp_path / "n.json")
    stored = json.loads((tmp_path / "n.json").read_text())["backdrops"]
    assert stored[-1]["kind"] == "note"
    assert all("kind" not in entry for entry in stored[:-1])
    kodak.files.open_now(str(tmp_path / "n.json"))
    assert backdrops_of(session.network)[-1] == note
    assert canvas.content.nodes["charge"].face.colour == "red"
    session.select(["detector", "charge"])
    actions["&As its group"].trigger()
    assert "colour" not in session.network.nodes["detector"].extra
    session.undo()
    assert session.network.nodes["detector"].extra["colour"] == "red"
    session.select([])
    canvas.marks.choose(None, canvas.content.backdrops[0])
    actions["Blue"].trigger()
    first = backdrops_of(session.network)[0]
    assert (first.colour, first.note) == ("blue", False)
    # A note is moved by the mouse.
    canvas.frame_all()
    middle = canvas.view.pixel(canvas.content.backdrops[-1].frame().center())
    port, left, away = canvas.view.viewport(), Qt.MouseButton.LeftButton, QPoint(30, 10)
    QTest.mousePress(port, left, NONE, middle)
    QTest.mouseMove(port, middle + away)
    QTest.mouseRelease(port, left, NONE, middle + away)
    moved = backdrops_of(session.network)[-1]
    assert moved.x > note.x
    assert moved.note
