"""The first tour builds `first_steps` on the real window, by the user's hands or by Next."""

import json

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLabel, QMessageBox, QPushButton, QSlider, QWidget

from app.editor.theme import DARK, LIGHT
from app.editor.window.documents.remembered_settings import Settings
from app.run.shipped import shipped_networks
from colour_sight import contrast
from core.network.network import Link
from screen_places import place_of_module
from window_hands import CTRL, KEY, WindowHands, add, answer, give_focus

MODEL = json.loads(shipped_networks()["first_steps"].read_text())


@pytest.fixture
def hand(window):
    made = WindowHands(window)
    window.actions_by_name["first_tour"].trigger()
    give_focus(window.canvas.view)
    return made


def card(window):
    return window.findChild(QWidget, "tour")


def place(window):
    return window.findChild(QLabel, "tour.place").text()


def press(window, name):
    QTest.mouseClick(window.findChild(QPushButton, f"tour.{name}"), Qt.MouseButton.LeftButton)
    QTest.qWait(20)


def add_by_keys(hand, words):
    """Add a module as its search on the canvas does; it is wired only to what is selected."""
    hand.window.session.select([])
    give_focus(hand.canvas.view)
    hand.key(KEY.Key_Tab)
    hand.type(words)
    hand.key(KEY.Key_Return)
    QTest.qWait(20)


def wire(hand, source, output, target, entry):
    hand.window.canvas.frame_all()
    hand.drag(hand.port(source, output, "output"), hand.port(target, entry, "input"))
    QTest.qWait(20)
    assert Link(source, output, target, entry) in hand.window.session.network.links


def test_it_goes_on_as_the_user_does_each_step(window, hand, idle, qtbot):
    assert place(window) == "Step 1 of 6"
    tree = window.library_view.tree
    at = tree.viewport().mapFromGlobal(place_of_module(window.library_view, "test_scene"))
    QTest.mouseClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=at)
    QTest.mouseDClick(tree.viewport(), Qt.MouseButton.LeftButton, pos=at)
    QTest.qWait(20)
    assert place(window) == "Step 2 of 6"
    add_by_keys(hand, "init")
    assert place(window) == "Step 2 of 6"  # its wire is missing
    window.actions_by_name["arrange"].trigger()
    wire(hand, "test_scene", "image", "init_trans", "image")
    assert place(window) == "Step 3 of 6"
    add_by_keys(hand, "gaussian")
    window.actions_by_name["arrange"].trigger()
    wire(hand, "init_trans", "context", "gaussian_mtf", "context")
    assert place(window) == "Step 3 of 6"
    wire(hand, "init_trans", "magnitude", "gaussian_mtf", "magnitude")
    assert place(window) == "Step 4 of 6"
    add_by_keys(hand, "back transform")
    window.actions_by_name["arrange"].trigger()
    wire(hand, "gaussian_mtf", "magnitude", "back_transform", "magnitude")
    wire(hand, "init_trans", "phase", "back_transform", "phase")
    assert place(window) == "Step 5 of 6"
    add_by_keys(hand, "examine image")
    window.actions_by_name["arrange"].trigger()
    wire(hand, "back_transform", "image", "examine_image", "image")
    assert place(window) == "Step 6 of 6"
    idle(window)
    assert window.session.selection == ("gaussian_mtf",)
    assert window.viewers.images[1].choices.port == "back_transform.image"
    before = window.viewers.images[1].picture.samples.copy()
    slider = window.panels.panels["gaussian_mtf"].findChildren(QSlider)[0]
    slider.setFocus()
    QTest.keyClick(slider, Qt.Key.Key_PageUp)
    QTest.qWait(20)
    assert place(window) == "Done"
    idle(window)
    assert (window.viewers.images[1].picture.samples != before).any()  # it is blurred
    press(window, "leave")
    assert not card(window).isVisible()
    modules = {node.module for node in window.session.network.nodes.values()}
    assert modules == {node["module"] for node in MODEL["nodes"].values()}
    assert len(window.session.network.links) == len(MODEL["links"])


def test_what_is_wired_at_once_is_done_at_once(window, hand):
    add_by_keys(hand, "test scene")
    assert place(window) == "Step 2 of 6"
    window.session.select(["test_scene"])
    give_focus(window.canvas.view)
    hand.key(KEY.Key_Tab)
    hand.type("init")
    hand.key(KEY.Key_Return)
    QTest.qWait(20)
    assert place(window) == "Step 3 of 6"


def test_next_does_each_step_as_one_edit_that_is_undone(window, hand):
    networks = [window.session.network]
    for number in range(6):
        assert place(window) == f"Step {number + 1} of 6"
        press(window, "next")
        networks.append(window.session.network)
    assert place(window) == "Done"
    assert window.session.document.history.position == 6
    built = json.loads(window.session.document.text())
    assert built["nodes"] == MODEL["nodes"]
    assert sorted(built["links"]) == sorted(MODEL["links"])
    assert built["layout"] == MODEL["layout"]
    give_focus(window.canvas.view)
    for network in networks[-2::-1]:
        hand.key(KEY.Key_Z, CTRL)
        assert window.session.network == network


def test_next_after_an_undo_does_what_is_missing_before_too(window, hand):
    for _ in range(3):
        press(window, "next")
    give_focus(window.canvas.view)
    hand.key(KEY.Key_Z, CTRL)
    hand.key(KEY.Key_Z, CTRL)
    assert len(window.session.network.nodes) == 1
    assert place(window) == "Step 4 of 6"
    press(window, "next")
    assert set(window.session.network.nodes) == {"scene", "init", "blur", "back"}
    assert place(window) == "Step 5 of 6"


def test_back_shows_the_step_before_and_leaves_the_work(window, hand):
    press(window, "next")
    press(window, "next")
    network = window.session.network
    press(window, "back")
    assert place(window) == "Step 2 of 6"
    assert window.session.network is network
    press(window, "next")  # nothing is missing
    assert window.session.network is network
    assert place(window) == "Step 3 of 6"


@pytest.mark.parametrize("focus", ["canvas", "button", "library"])
def test_esc_leaves_it_wherever_the_focus_is(window, hand, focus):
    press(window, "next")
    widget = {
        "canvas": window.canvas.view,
        "button": window.findChild(QPushButton, "tour.next"),
        "library": window.library_view.tree,
    }[focus]
    give_focus(widget)
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Escape)
    assert not card(window).isVisible()
    assert not window.findChild(QWidget, "tour.frame").isVisible()
    assert len(window.session.network.nodes) == 1  # what was built stays
    assert window.canvas.isVisible()


def test_left_at_once_the_first_page_is_there(window, hand):
    press(window, "leave")
    assert window.welcome.isVisible()
    add(window, "test_scene")  # and goes on no more
    QTest.qWait(20)
    assert not card(window).isVisible()


def test_it_takes_no_focus_and_keys_reach_its_buttons(window, hand, qtbot):
    assert window.canvas.view.hasFocus()
    press(window, "next")
    give_focus(window.canvas.view)
    seen = set()
    for _ in range(12):
        QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_F6)
        seen.add(QApplication.focusWidget().objectName())
    assert any(name.startswith("tour.") for name in seen)
    button = window.findChild(QPushButton, "tour.next")
    button.setFocus()
    QTest.keyClick(button, Qt.Key.Key_Space)
    QTest.qWait(20)
    assert place(window) == "Step 3 of 6"
    assert "Step 3 of 6: " in card(window).accessibleDescription()
    for button in card(window).findChildren(QPushButton):
        assert button.text()
        assert button.toolTip()


@pytest.mark.thorough(always=("size0-dark", "size2-light"))
@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
@pytest.mark.parametrize("size", [(1000, 700), (1366, 768), (2560, 1440)])
def test_card_and_frame_at_any_size(window, hand, idle, size, theme):
    window.set_theme(theme)
    window.resize(*size)
    idle(window)
    parts = []
    for _ in range(6):
        shown = card(window)
        assert window.rect().contains(shown.geometry())
        text = window.findChild(QLabel, "tour.text")
        assert text.height() >= text.heightForWidth(text.width())
        frame = window.findChild(QWidget, "tour.frame")
        assert frame.isVisible()
        part = window.tour.frame.part
        parts.append(part)
        assert frame.geometry().topLeft() == part.mapTo(window, QPoint())
        assert frame.size() == part.size()
        dot = window.grab().toImage().pixelColor(frame.geometry().center().x(), frame.y() + 1)
        assert dot.name() == theme.accent
        middle = frame.geometry().center()
        assert window.childAt(middle) is not frame  # the mouse reaches the part
        assert contrast(theme.text, theme.raised) >= 4.5
        assert not shown.geometry().intersects(window.library_dock.geometry())
        press(window, "next")
        idle(window)
    assert parts == [window.library_dock, *[window.canvas] * 4, window.panel_dock]


def test_it_asks_before_work_is_lost(window, qtbot):
    add(window, "test_scene")
    window.actions_by_name["first_tour"].trigger()
    answer(qtbot, window, QMessageBox.StandardButton.Cancel)
    qtbot.wait(20)
    assert not card(window).isVisible()
    assert window.session.network.nodes
    window.actions_by_name["first_tour"].trigger()
    answer(qtbot, window, QMessageBox.StandardButton.Discard)
    qtbot.waitUntil(card(window).isVisible)
    assert not window.session.network.nodes


def test_another_network_ends_it(window, hand):
    press(window, "next")
    window.files.open_now("kodak_kir310")
    assert not card(window).isVisible()


def test_only_a_first_start_has_it(tmp_path):
    path = tmp_path / "editor.ini"
    assert Settings(path).first
    first = Settings(path)
    first.toured = True
    again = Settings(path)
    assert not again.first
    assert again.toured
    older = tmp_path / "older.ini"
    older.write_text("[General]\nlook=light\n")
    assert not Settings(older).first
    assert not Settings(older).toured
