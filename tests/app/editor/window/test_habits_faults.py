"""Faults of the hand that were mended: by real mouse, keys and drops."""

import itertools

import numpy as np
from PySide6.QtCore import QRectF, Qt
from PySide6.QtTest import QTest

from window_hands import CTRL, KEY, SHIFT, WindowHands, show_small, turn

PLAIN = Qt.KeyboardModifier.NoModifier


def test_a_number_goes_by_fine_and_coarse_steps(window, idle):
    window.files.open_now("first_steps")
    idle(window)
    WindowHands(window).select("blur")
    idle(window)
    panels = window.panels
    field = panels.panels["blur"].body.sections.field("sigma_x_mrad")
    panels.ensureWidgetVisible(field)
    QTest.qWait(300)  # else the area counts as scrolling

    def step(act):
        before = field.value
        act()
        return round(field.value - before, 9)

    keys = (PLAIN, SHIFT, CTRL)
    QTest.mouseClick(field.edit, Qt.MouseButton.LeftButton)
    up = [step(lambda k=k: QTest.keyClick(field.edit, KEY.Key_Up, k)) for k in keys]
    turned = [step(lambda k=k: turn(field.edit, keys=k)) for k in keys]
    one = up[0]
    assert one > 0
    assert up == turned == [one, round(one / 10, 9), round(one * 10, 9)]


def test_a_picture_dropped_beside_the_canvas_replaces_nothing(window, hand, tmp_path):
    np.save(tmp_path / "one.npy", np.ones((4, 6)))
    np.save(tmp_path / "two.npy", np.ones((4, 6)))
    hand.drop_files(window.canvas.view.viewport(), hand.at(0, 0), [tmp_path / "one.npy"])
    (name,) = window.session.network.nodes
    hand.select(name)  # the mouse rests on it
    view = window.library_view
    hand.drop_files(view, view.rect().center(), [tmp_path / "two.npy"])
    nodes = window.session.network.nodes
    assert [node.module for node in nodes.values()] == ["read_image"] * 2
    assert nodes[name].params["path"].endswith("one.npy")


def test_files_dropped_together_spread_out(window, hand, idle, tmp_path):
    for number in range(3):
        np.save(tmp_path / f"{number}.npy", np.full((40, 60), number))
    files = sorted(tmp_path.glob("*.npy"))
    hand.drop_files(window.canvas.view.viewport(), hand.at(0, 0), files)
    idle(window)
    canvas, layout = window.canvas, window.session.network.layout
    assert window.session.selection == tuple(layout)
    frames = [QRectF(*layout[n], *size) for n, size in canvas.sizes_with_thumbnails().items()]
    assert len(frames) == 3
    assert all(
        frame.height() > canvas.content.sizes()[n][1]
        for n, frame in zip(layout, frames, strict=True)
    )
    assert not any(one.intersects(two) for one, two in itertools.combinations(frames, 2))


def test_new_leaves_no_empty_panel_and_no_names_of_the_last_sensor(window, idle):
    strip = window.figures
    first = strip._slots[1][0].text()
    show_small(window, "mwir_camera")
    idle(window)
    assert strip._slots[1][0].text() != first
    window.actions_by_name["picture_beside"].trigger()
    QTest.qWait(100)
    hand = WindowHands(window)
    hand.focus()
    hand.key(KEY.Key_N, CTRL)
    idle(window)
    assert not window.session.network.nodes
    assert not window.panel_dock.isVisible()
    assert window.canvas.height() > 0.8 * window.workbench.height()
    hand.key(KEY.Key_Tab)
    hand.type("test scene")
    hand.key(KEY.Key_Return)
    idle(window)
    assert window.panel_dock.isVisible()
    assert strip._slots[1][0].text() == first
