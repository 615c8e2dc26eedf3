"""Notes on the canvas, and colours of nodes: typed, chosen, saved, undone, readable."""

import json

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from app.editor.canvas.canvas_style import TINTS, CanvasStyle
from app.editor.theme import DARK, LIGHT
from core.editing.backdrops import backdrops_of, nodes_on


def press(key):
    QTest.keyClick(QApplication.focusWidget(), key)


def luminance(colour):
    """WCAG 2's, of an sRGB colour."""
    parts = (colour.redF(), colour.greenF(), colour.blueF())
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
@pytest.mark.parametrize("name", TINTS)
def test_text_is_read_on_every_colour(qapp, theme, name):
    style = CanvasStyle(theme, qapp.font())
    lights = sorted(luminance(colour) for colour in (style.tint(name), style.text))
    assert (lights[1] + 0.05) / (lights[0] + 0.05) >= 4.5


def test_a_note_is_typed_moved_and_saved(kodak, tmp_path):
    session = kodak.session
    session.select([])
    nodes = dict(session.network.nodes)
    press(Qt.Key.Key_N)
    QTest.keyClicks(QApplication.focusWidget(), "Look at D and L")
    press(Qt.Key.Key_Return)
    note = backdrops_of(session.network)[-1]
    assert (note.title, note.note) == ("Look at D and L", True)
    assert dict(session.network.nodes) == nodes
    assert nodes_on(session.network, len(backdrops_of(session.network)) - 1, {}) == ()
    session.save(tmp_path / "n.json")
    stored = json.loads((tmp_path / "n.json").read_text())["backdrops"]
    assert stored[-1]["kind"] == "note"
    assert all("kind" not in entry for entry in stored[:-1])
    kodak.files.open_now(str(tmp_path / "n.json"))
    assert backdrops_of(session.network)[-1] == note
    item = kodak.canvas.content.backdrops[-1]
    middle = kodak.canvas.view.pixel(item.frame().center())
    port = kodak.canvas.view.viewport()
    left, plain = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    if kodak.canvas.view.viewport().rect().contains(middle):
        QTest.mousePress(port, left, plain, middle)
        QTest.mouseMove(port, middle.__class__(middle.x() + 30, middle.y() + 10))
        QTest.mouseRelease(port, left, plain, middle.__class__(middle.x() + 30, middle.y() + 10))
        moved = backdrops_of(session.network)[-1]
        assert moved.x > note.x
        assert moved.note


def test_nodes_and_backdrops_are_coloured_by_their_menu(kodak, tmp_path):
    session, menus = kodak.session, kodak.canvas.menus
    actions = {action.text(): action for action in menus._colours.actions()}
    session.select(["detector", "charge"])
    actions["Red"].trigger()
    assert {session.network.nodes[n].extra["colour"] for n in ("detector", "charge")} == {"red"}
    item = kodak.canvas.content.nodes["detector"]
    picture = kodak.canvas.view.grab().toImage()
    inside = kodak.canvas.view.pixel(item.frame().topLeft())
    wanted = item.style.tint("red")
    found = [
        QColor(picture.pixel(inside.x() + dx, inside.y() + dy))
        for dx in range(2, 12)
        for dy in range(2, 12)
    ]
    assert any(colour.name() == wanted.name() for colour in found)
    session.save(tmp_path / "n.json")
    kodak.files.open_now(str(tmp_path / "n.json"))
    assert kodak.canvas.content.nodes["charge"].face.colour == "red"
    session.select(["detector", "charge"])
    actions["&As its group"].trigger()
    assert "colour" not in session.network.nodes["detector"].extra
    session.undo()
    assert session.network.nodes["detector"].extra["colour"] == "red"
    session.select([])
    kodak.canvas.marks.choose(None, kodak.canvas.content.backdrops[0])
    actions["Blue"].trigger()
    first = backdrops_of(session.network)[0]
    assert (first.colour, first.note) == ("blue", False)
