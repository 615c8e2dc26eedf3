"""What a person's hands expect of the canvas, in the window as it is: real keys and mouse."""

from PySide6.QtCore import QPoint

from canvas_networks import chain_and_free_blur
from core.network.network import Link
from window_hands import CTRL, KEY, SHIFT

# --- adding ------------------------------------------------------------------------------------


def test_letters_typed_into_the_search_are_no_shortcuts(window, hand):
    """F, L, D, 1 and ? are shortcuts of the canvas and the window."""
    hand.key(KEY.Key_Tab)
    hand.type("fld1?")
    assert window.canvas.popup.field.text() == "fld1?"
    hand.key(KEY.Key_Z, CTRL)
    assert not window.session.network.nodes


def test_escape_closes_the_search_before_it_cancels_anything(window, hand):
    cancelled = []
    window.actions_by_name["cancel"].triggered.connect(lambda: cancelled.append(1))
    hand.key(KEY.Key_Tab)
    assert window.canvas.popup.is_open
    hand.key(KEY.Key_Escape)
    assert not window.canvas.popup.is_open
    assert not cancelled
    hand.key(KEY.Key_Escape)
    assert len(cancelled) == 1


# --- deleting, copying, undoing ----------------------------------------------------------------


def test_copy_and_paste_bring_nodes_with_the_wires_among_them(hand, chain):
    hand.select("init", "back")
    hand.key(KEY.Key_C, CTRL)
    hand.click(hand.at(300, 400))
    hand.key(KEY.Key_V, CTRL)
    assert {"init_2", "back_2"} <= set(chain.network.nodes)
    assert Link("init_2", "magnitude", "back_2", "magnitude") in chain.network.links
    assert set(chain.selection) == {"init_2", "back_2"}
    hand.key(KEY.Key_Z, CTRL)
    assert chain.network == chain_and_free_blur()
    hand.key(KEY.Key_Z, CTRL | SHIFT)
    assert "init_2" in chain.network.nodes


def test_duplicate_is_fed_by_the_same_wires(hand, chain):
    hand.select("init")
    hand.key(KEY.Key_D, CTRL)
    assert Link("scene", "image", "init_2", "image") in chain.network.links
    assert chain.selection == ("init_2",)


def test_undo_and_redo_go_across_a_rename(hand, chain):
    hand.select("blur")
    hand.key(KEY.Key_F2)
    hand.key(KEY.Key_A, CTRL)
    hand.type("shake")
    hand.key(KEY.Key_Return)
    assert "shake" in chain.network.nodes
    assert chain.selection == ("shake",)
    hand.focus()
    hand.key(KEY.Key_D, CTRL)
    assert "shake_2" in chain.network.nodes
    for _ in range(2):
        hand.key(KEY.Key_Z, CTRL)
    assert chain.network == chain_and_free_blur()
    for _ in range(2):
        hand.key(KEY.Key_Y, CTRL)
    assert {"shake", "shake_2"} <= set(chain.network.nodes)


# --- looking around ----------------------------------------------------------------------------


def visible(window):
    return window.canvas.view.visible_rect()


def test_f_shows_all_and_with_a_selection_that(window, hand, chain):
    window.canvas.view.pan(QPoint(5000, 3000))
    hand.key(KEY.Key_F)
    assert visible(window).contains(window.canvas.content.bounds())
    hand.select("blur")
    window.canvas.view.pan(QPoint(5000, 3000))
    hand.key(KEY.Key_F)
    assert visible(window).contains(window.canvas.content.nodes["blur"].frame())


def test_home_shows_all_and_a_click_with_ctrl_and_shift_a_nodes_picture(window, hand, chain):
    hand.select("blur")
    window.canvas.view.pan(QPoint(5000, 3000))
    hand.key(KEY.Key_Home)
    assert visible(window).contains(window.canvas.content.bounds())
    hand.click(hand.head("scene"), CTRL | SHIFT)
    assert window.viewers.images[1].choices.port == "scene.image"


def test_d_lets_nodes_pass_their_input_through_and_again_not(hand, chain):
    hand.select("init", "back")
    hand.key(KEY.Key_D)
    assert [chain.network.nodes[name].disabled for name in ("init", "back")] == [True, True]
    hand.key(KEY.Key_D)
    assert not chain.network.nodes["init"].disabled
    assert not chain.network.nodes["blur"].disabled


def test_the_keyboard_alone_builds_a_chain(window, hand):
    """Two nodes and the wire between them, taken away and drawn again, without the mouse."""
    for typed in ("test scene", "init trans"):
        hand.key(KEY.Key_Tab)
        hand.type(typed)
        hand.key(KEY.Key_Return)
    link = Link("test_scene", "image", "init_trans", "image")
    for typed, there in (("disconnect", False), ("test_scene image init_trans", True)):
        assert (link in window.session.network.links) != there
        hand.key(KEY.Key_C)
        assert window.canvas.popup.is_open
        hand.type(typed)
        hand.key(KEY.Key_Return)
        assert (link in window.session.network.links) == there
