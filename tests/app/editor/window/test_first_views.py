"""What a window shows of a network that has just been opened."""

import json

from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QToolButton, QWidget

from app.run.shipped import shipped_networks

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
