"""What a window shows of a network that has just been opened."""

import json

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton, QWidget

from app.editor.window.help import ModuleText
from app.editor.window.start import _select_node_with_figures
from app.run.shipped import shipped_networks
from window_hands import give_focus

ELECTRONICS = "electronics.image"
SHOWN = {
    "figures_of_merit": ("merit", "merit.mrtd", (ELECTRONICS, "scene.image"), 1),
    "noise_budget": ("budget", "budget.noise", (ELECTRONICS, "scene.image"), 1),
    "measured_mtf": ("measured", "measured.curve", (ELECTRONICS, "scene.image"), 1),
    "camera_and_sensor": ("camera", "camera.curve", (ELECTRONICS, "scene.image"), 1),
    "spatial_blur": ("space", "space.curve", ("back.image", "scene.image"), 1),
    "line_by_line": ("lines", "lines.curve", ("lines.image", "lines.difference"), 2),
    "first_steps": (None, None, ("back.image", "scene.image"), 1),
    "kodak_kir310": (None, None, ("frame_grabber.image", "scene.image"), 1),
    "inframetrics": (None, None, ("frame_grabber.image", "scene.image"), 1),
}


@pytest.mark.thorough(but=3, always=("line_by_line", "first_steps"))
@pytest.mark.parametrize("network", SHOWN)
def test_an_analysis_shows_its_panel_its_curve_and_a_telling_picture(window, idle, network):
    node, curve, pictures, front = SHOWN[network]
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


def test_what_was_selected_meanwhile_stays(window, idle):
    window.files.open_now("measured_mtf")
    window.session.select(["blur"])
    idle(window)
    assert window.session.selection == ("blur",)


def test_an_analysis_that_cannot_be_planned_is_not_what_a_network_is_there_for(
    window, idle, tmp_path
):
    """Its first node of analysis has nothing connected; the next one counts."""
    document = json.loads(shipped_networks()["noise_budget"].read_text())
    links = [link for link in document["links"] if link[1] != "budget.image"]
    assert len(links) == len(document["links"]) - 1
    path = tmp_path / "unwired.json"
    path.write_text(json.dumps({**document, "links": links}))
    window.files.open_now(str(path))
    idle(window)
    assert window.session.selection == ("components",)
    assert window.viewers.plot.port == "components.curve"


@pytest.mark.parametrize(
    ("network", "node"), [("kodak_kir310", "electronics"), ("figures_of_merit", "merit")]
)
def test_a_screenshot_has_the_sensors_panel_where_nothing_is_analysed(window, idle, network, node):
    window.files.open_now(network)
    idle(window)
    _select_node_with_figures(window)
    assert window.session.selection == (node,)


def test_view_of_a_curve_opens_the_curves_that_were_closed(window, idle):
    window.files.open_now("measured_mtf")
    idle(window)
    window.viewers.plot_dock.close()
    view = window.panels.panels["measured"].findChild(QToolButton, "view.output.spread")
    assert view.menu() is None  # there is but one place for it
    QTest.mouseClick(view, Qt.MouseButton.LeftButton)
    idle(window)
    assert window.viewers.plot.isVisible()
    assert window.viewers.plot.port == "measured.spread"


def test_f1_tells_what_the_module_does_in_a_window_that_fits(window, idle, qtbot):
    window.resize(1366, 768)
    window.files.open_now("figures_of_merit")
    idle(window)
    give_focus(window.canvas.view)
    QTest.keyClick(window.canvas.view, Qt.Key.Key_F1)
    told = window.findChild(ModuleText)
    assert told.isVisible()
    assert told.height() < 700
    assert told.windowTitle() == "Figures of Merit"
    assert "MRTD" in told.text.toPlainText().partition("\n")[0]
    qtbot.waitUntil(told.isActiveWindow)
    QTest.keyClick(told, Qt.Key.Key_Escape)
    qtbot.waitUntil(lambda: window.findChild(ModuleText) is None)
