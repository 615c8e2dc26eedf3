"""What a window shows of a network that has just been opened."""

import json

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton, QWidget

from app.run.shipped import shipped_networks
from core.editing.operations import set_parameter, together
from window_hands import CTRL, SHIFT, give_focus

SHOWN = {
    "line_by_line": ("lines", "lines.curve", ("lines.image", "lines.difference"), 2),
    "first_steps": (None, None, ("back.image", "scene.image"), 1),
}


def test_a_network_shows_what_it_is_there_for(window, idle, tmp_path):
    """An analysis its panel, its curve and a telling picture."""
    for network, (node, curve, pictures, front) in SHOWN.items():
        window.show_welcome()
        QTest.mouseClick(window.findChild(QWidget, f"welcome.{network}"), Qt.MouseButton.LeftButton)
        idle(window)
        assert window.session.selection == (() if node is None else (node,))
        panels = window.panels
        assert panels.network_panel.isVisible() == (node is None)
        assert list(panels.panels) == ([] if node is None else [node])
        plot = window.viewers.plot
        assert plot.port == curve
        assert plot.data is not None
        viewers = window.viewers.images
        assert tuple(viewers[number].choices.port for number in (1, 2)) == pictures
        behind = [viewers[number].visibleRegion().isEmpty() for number in (1, 2)]
        assert behind == [front != 1, front != 2]
        assert viewers[front].picture is not None
        assert not window.session.document.modified
    # An analysis that cannot be planned does not count: nothing is connected to it.
    document = json.loads(shipped_networks()["noise_budget"].read_text())
    links = [link for link in document["links"] if link[1] != "budget.image"]
    assert len(links) == len(document["links"]) - 1
    path = tmp_path / "unwired.json"
    path.write_text(json.dumps({**document, "links": links}))
    window.files.open_now(str(path))
    idle(window)
    assert window.session.selection == ("components",)
    assert window.viewers.plot.port == "components.curve"
    # "View" of a curve opens the curves that were closed.
    window.files.open_now("measured_mtf")
    idle(window)
    window.viewers.plot_dock.close()
    view = window.panels.panels["measured"].findChild(QToolButton, "view.output.spread")
    assert view.menu() is None  # there is but one place for it
    QTest.mouseClick(view, Qt.MouseButton.LeftButton)
    idle(window)
    assert window.viewers.plot.isVisible()
    assert window.viewers.plot.port == "measured.spread"


def test_the_first_viewer_follows_the_end_of_a_chain_that_is_built(window, hand, idle):
    viewer = window.viewers.images[1]

    def add(typed):
        hand.key(Qt.Key.Key_Tab)
        hand.type(typed)
        hand.key(Qt.Key.Key_Return)
        idle(window)
        return viewer.choices.port

    # A spectrum is no picture, and behind a node with an error there is none.
    words = ("gauss", "test scene", "init", "detector mtf", "back")
    scene = "test_scene.image"
    assert [add(word) for word in words] == ["", *[scene] * 4]
    given = {"detector_x_um": 20.0, "detector_y_um": 20.0, "focal_length_mm": 100.0}
    window.session.do(together([set_parameter("init_trans", *one) for one in given.items()]))
    idle(window)
    assert viewer.choices.port == "back_transform.image"
    assert add("compare images") == "back_transform.image"  # that only compares
    for _ in range(3):
        hand.key(Qt.Key.Key_Z, CTRL)
    idle(window)
    assert viewer.choices.port == scene
    for _ in range(2):
        hand.key(Qt.Key.Key_Z, CTRL | SHIFT)
    idle(window)
    assert viewer.choices.port == "back_transform.image"
    hand.select("test_scene")
    hand.key(Qt.Key.Key_1)
    hand.select("back_transform")
    assert add("combine") == scene  # as it was chosen


def test_home_fits_the_picture_of_a_viewer_with_the_keyboard(window, idle):
    window.files.open_now("first_steps")
    idle(window)
    canvas = window.viewers.images[1].canvas
    fitted, place = canvas.zoom, window.canvas.view.visible_rect()
    for keys in (Qt.KeyboardModifier.NoModifier, CTRL):
        give_focus(canvas)
        QTest.keyClick(canvas, Qt.Key.Key_Plus)
        assert canvas.zoom != fitted
        QTest.keyClick(canvas, Qt.Key.Key_Home, keys)
        assert canvas.zoom == fitted
    assert window.canvas.view.visible_rect() == place
