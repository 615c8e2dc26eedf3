"""The status bar shows nothing that no longer holds, and the empty canvas what to do first."""

from PySide6.QtWidgets import QLabel

from window_hands import CTRL, KEY, add


def test_that_it_was_saved_is_gone_with_the_next_edit(window, hand, tmp_path):
    add(window, "test_scene")
    assert window.session.save(tmp_path / "mine.json")
    window.files.save()
    assert "saved" in window.status.note
    hand.click(hand.middle("test_scene"))
    assert "saved" in window.status.note  # it still is
    hand.key(KEY.Key_D)
    assert window.status.note == ""


# --- an empty canvas -----------------------------------------------------------------------------


def hint_of(window):
    return window.findChild(QLabel, "canvas.empty_hint")


def test_an_empty_canvas_says_what_to_do_until_there_is_a_node(window, hand):
    hint = hint_of(window)
    assert hint.isVisible()
    for words in ("Tab", "double-click", "library", "file"):
        assert words in hint.text()
    add(window, "test_scene")
    assert not hint.isVisible()
    hand.key(KEY.Key_Z, CTRL)
    assert hint.isVisible()
    window.files.open_now("first_steps")
    assert not hint.isVisible()
