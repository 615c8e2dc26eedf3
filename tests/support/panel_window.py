"""The control panel in a whole window, by real mouse; what was seen is left in FOLDER/seen.json.

python panel_window.py FOLDER
"""

import json
import subprocess
import sys
from pathlib import Path

from PySide6.QtCore import QPoint

from app.editor.panels.preview_view import PreviewView
from hands import centre, process_events, wait_still, wait_until
from managed_window import Managed
from panel_hands import handle_of
from screen_places import place_of_head

SHUT = "shut.json"


def visible(made, panel):
    """Parameters whose fields are all in sight without scrolling."""
    view = made.window.panels.viewport()
    seen = []
    for field in panel.body.sections.fields:
        top = field.mapTo(view, QPoint(0, 0)).y()
        if field.isVisible() and top >= 0 and top + field.height() <= view.height():
            seen.append(field.parameter.name)
    return seen


def heights(panel):
    """Where all fields that are shown lie, by parameter."""
    return {
        field.parameter.name: field.mapToGlobal(QPoint(0, 0)).y()
        for field in panel.body.sections.fields
        if field.isVisible()
    }


def choose(made, node):
    """Click on a node; its panel, once all is computed."""
    process_events(0.2)  # a second click would be a double-click
    made.hands.click(made.at(place_of_head(made.window.canvas, node)))
    wait_until(lambda: made.window.session.selection == (node,), f"{node} is selected")
    process_events(0.1)
    wait_until(lambda: made.window.evaluator.idle, "all is computed")
    panel = made.window.panels.panels[node]
    wait_still(panel.body)
    return panel


def dragged(made, panel, name, pixels):
    """Where the fields lie before a slider is dragged, at each step, and after."""
    slider = panel.body.sections.field(name).slider
    x, y = made.at(slider.mapToGlobal(handle_of(slider)))
    found, badges = [heights(panel)], []
    steps = [("mousemove", x, y, "mousedown", 1)]
    steps += [("mousemove", x + pixels * step // 2, y) for step in (1, 2)]
    for step in (*steps, ("mouseup", 1)):
        subprocess.run(["xdotool", *map(str, step)], check=True)
        process_events(0.15)
        wait_until(lambda: made.window.evaluator.idle, "all is computed")
        found.append(heights(panel))
        badges.append(panel.head.problem.text())
    return {"heights": found, "badges": badges}


def main(folder):
    made = Managed(folder)
    made.window.files.open_now("mwir_camera")
    made.settle()
    panel = choose(made, "focal_plane")
    seen = {
        "visible": visible(made, panel),
        "panel": made.window.panels.viewport().height(),
        "illustration": panel.findChild(PreviewView).height(),
    }
    seen["exposure"] = dragged(made, panel, "integration_time_s", 30)
    seen["jitter"] = dragged(made, choose(made, "jitter"), "sigma_mrad", -200)

    def shows():
        panel = choose(made, "focal_plane")
        return panel.findChild(PreviewView).isVisible(), len(visible(made, panel))

    seen["before"] = shows()
    panel = made.window.panels.panels["focal_plane"]
    made.hands.click(made.at(centre(panel.head.fold_picture)))
    wait_until(lambda: not panel.findChild(PreviewView).isVisible(), "the illustration is folded")
    seen["other kind"] = choose(made, "init").findChild(PreviewView).isVisible()
    seen["after"] = shows()
    panel = choose(made, "jitter")
    made.hands.click(made.at(centre(panel.head.fold_picture)))
    wait_until(panel.findChild(PreviewView).isVisible, "the curve of the stage is unfolded")
    made.close(folder / SHUT)
    made = Managed(folder)
    made.window.files.open_now("mwir_camera")
    made.settle()
    seen["next start"] = {
        name: choose(made, name).findChild(PreviewView).isVisible()
        for name in ("focal_plane", "init", "jitter", "optics")
    }
    made.window.close_for_good()
    (folder / "seen.json").write_text(json.dumps(seen))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
