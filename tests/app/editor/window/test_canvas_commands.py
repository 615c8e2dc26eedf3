"""Commands of the canvas by their keys: find, map, align, backdrops with a title typed at once."""

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from core.editing.backdrops import backdrops_of

ALT, CTRL, NONE = (
    Qt.KeyboardModifier.AltModifier,
    Qt.KeyboardModifier.ControlModifier,
    Qt.KeyboardModifier.NoModifier,
)


def press(window, key, keys=NONE):
    QTest.keyClick(QApplication.focusWidget() or window, key, keys)


def type_in(window, text):
    QTest.keyClicks(QApplication.focusWidget() or window, text)


def test_a_node_is_found_by_its_name_or_its_module(kodak):
    kodak.canvas.zoom_by(8.0)
    for typed, name in (("electr", "electronics"), ("charge eff phase", "charge_phase")):
        press(kodak, Qt.Key.Key_F, CTRL)
        assert kodak.canvas.popup.is_open
        type_in(kodak, typed)
        press(kodak, Qt.Key.Key_Return)
        assert kodak.session.selection == (name,)
        frame = kodak.canvas.content.nodes[name].frame()
        assert kodak.canvas.view.visible_rect().contains(frame)
        assert kodak.canvas.view.hasFocus()


def test_a_new_backdrop_takes_what_is_typed_as_its_title(kodak):
    """Letters typed right after it were commands: "Tested" disabled four nodes."""
    kodak.session.select(["detector", "charge"])
    nodes = dict(kodak.session.network.nodes)
    count = len(backdrops_of(kodak.session.network))
    press(kodak, Qt.Key.Key_B)
    type_in(kodak, "Tested")
    press(kodak, Qt.Key.Key_Return)
    made = backdrops_of(kodak.session.network)
    assert len(made) == count + 1
    assert made[-1].title == "Tested"
    assert dict(kodak.session.network.nodes) == nodes
    assert kodak.canvas.view.hasFocus()
    press(kodak, Qt.Key.Key_D)  # letters are commands again
    assert kodak.session.network.nodes["detector"].disabled


def test_alt_and_an_arrow_align(kodak):
    names = ["scene", "optics", "electronics"]
    kodak.session.select(names)
    for key, edge in (("Left", "left"), ("Right", "right"), ("Up", "top"), ("Down", "bottom")):
        press(kodak, getattr(Qt.Key, f"Key_{key}"), ALT)
        frames = [kodak.canvas.content.nodes[name].frame() for name in names]
        assert len({getattr(frame, edge)() for frame in frames}) == 1, key
        kodak.session.undo()
        frames = [kodak.canvas.content.nodes[name].frame() for name in names]
        assert len({frame.left() for frame in frames}) > 1, key


def test_l_lays_out_to_the_shape_of_the_canvas(kodak):
    kodak.session.select([])
    kodak.actions_by_name["picture_beside"].trigger()
    QTest.qWait(100)
    before = kodak.canvas.view.zoom
    kodak.canvas.setFocus()
    press(kodak, Qt.Key.Key_L)
    assert kodak.canvas.view.zoom > 1.3 * before
    held = kodak.canvas.content.backdrops
    assert len(held) == 4
    assert kodak.canvas.view.visible_rect().contains(kodak.canvas.content.bounds())
