"""The session that the README's clip shows, by real mouse and key events, on a display of its own.

    python readme_session.py FILE.gif [FRAMES_PER_S]

A module is dragged onto a wire, its slider turned while picture and curves follow, three modules
become one, and all is undone: the last frame is the first one again.
"""

import sys
import tempfile
from pathlib import Path

from PySide6.QtCore import QEvent, QObject, QPoint, Qt
from PySide6.QtWidgets import QSlider

from app.editor.window.files import open_named
from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.start import application, settle
from clip_frames import Clip, gif
from core.editing.document import Document
from core.editing.operations import set_parameter
from core.network.network import Link
from nodes.library import standard_library
from screen_places import place_of_head, place_of_module, place_of_wire
from slider_drag import handle_of

NETWORK = "first_steps"
FRAMES_PER_S = 10
WIRE = Link("blur", "magnitude", "back", "magnitude")
MODULE, PARAMETER = "jitter_mtf", "sigma_mrad"
BLUR_MRAD = 0.15
STRONG = 0.97  # part of the slider's length
MACRO = "camera"
CANVAS_HEIGHT, ZOOM = 190, 0.84


def session(clip):
    """Play it; every step has to have had its effect."""
    window = clip.window
    start = clip.ask(lambda: window.session.network)
    clip.caption = "A sensor is a chain of modules: scene, optics, picture"
    clip.rest(1.6)
    name = insert(clip, start)
    slide(clip, name)
    group(clip, name)
    clip.caption = "Ctrl+Z takes every step back"
    clip.rest(0.6)
    history = window.session.document
    while clip.ask(lambda: history.position):
        clip.keys("ctrl+z")
        clip.rest(0.5)
    assert clip.ask(lambda: window.session.network) == start
    clip.rest(0.6)


def insert(clip, start):
    """Drag the module from the library onto the wire; gives the node's name."""
    window = clip.window
    clip.caption = "Drag a module from the library onto a wire"
    clip.ask(window.library_dock.raise_)
    clip.glide(clip.ask(lambda: place_of_module(window.library_view, MODULE)), 1.2)
    clip.rest(0.2)
    clip.press()
    clip.glide(clip.ask(lambda: place_of_wire(window.canvas, WIRE)), 1.5, least=8)
    clip.rest(0.3)
    clip.release()
    clip.until(lambda: set(window.session.network.nodes) - set(start.nodes), "a node is added")
    (name,) = clip.ask(lambda: set(window.session.network.nodes) - set(start.nodes))
    links = clip.ask(lambda: window.session.network.links)
    assert Link(name, "magnitude", "back", "magnitude") in links, "it is in the wire"
    assert WIRE not in links
    clip.caption = "It is wired in, and its control panel opens"
    clip.rest(0.9)
    return name


def slide(clip, name):
    """Move the slider up and somewhat back."""
    window = clip.window

    def value():
        return window.session.network.nodes[name].params.get(PARAMETER)

    clip.caption = "Move its slider: the picture and the MTF follow"
    slider = clip.ask(lambda: window.panels.panels[name].findChild(QSlider, f"slider.{PARAMETER}"))

    def place(part):
        y = handle_of(slider).y()
        return slider.mapToGlobal(QPoint(round(part * slider.width()), y))

    clip.glide(clip.ask(lambda: slider.mapToGlobal(handle_of(slider))), 1.0)
    clip.press()
    clip.glide(clip.ask(lambda: place(STRONG)), 2.0, least=2)
    most = clip.ask(value)
    clip.rest(0.5)
    clip.glide(clip.ask(lambda: place(STRONG / 2)), 1.0, least=2)
    clip.release()
    assert 0 < clip.ask(value) < most, "the slider moves the value"
    clip.rest(0.6)


def group(clip, name):
    """Make one node of the blurs, and look inside."""
    window = clip.window
    clip.caption = "Select modules with Ctrl held …"
    for number, node in enumerate(("init", "blur", name, "back")):
        clip.glide(clip.ask(lambda node=node: place_of_head(window.canvas, node)), 0.4)
        clip.click(held_key="ctrl" if number else None)
    clip.caption = "… and Ctrl+G makes them one: a macro"
    clip.keys("ctrl+g")
    clip.until(lambda: any(n.macro for n in window.session.network.nodes.values()), "a macro")
    clip.rest(0.4)
    clip.type(MACRO)
    clip.keys("Return")
    clip.until(lambda: MACRO in window.session.network.nodes, "the macro has its name")
    clip.rest(0.8)
    clip.caption = "A double-click shows its inside"
    clip.glide(clip.ask(lambda: place_of_head(window.canvas, MACRO)), 0.5)
    clip.click(times=2)
    clip.until(lambda: window.level.path == (MACRO,), "the inside is shown")
    clip.rest(1.2)
    clip.caption = "Alt+PgUp leads out again"
    clip.keys("alt+Prior")
    clip.until(lambda: window.level.path == (), "the whole is shown")
    clip.rest(0.6)


def sharper(library):
    """The network with less blur of its own, so that what the slider does is seen."""
    network = open_named(NETWORK, library=library)[0].network
    for name in ("sigma_x_mrad", "sigma_y_mrad"):
        network = set_parameter("blur", name, BLUR_MRAD).apply(network)
    return Document(network, library=library)


def make_room(window):
    """A canvas high enough for the thumbnails, with room for one more node beside the others."""
    viewer = window.viewers.docks[1]
    taken = CANVAS_HEIGHT - window.canvas.height()
    window.resizeDocks([viewer], [viewer.height() - taken], Qt.Orientation.Vertical)
    settle(window)
    window.canvas.frame_all()
    window.canvas.zoom_by(ZOOM)


class NoTips(QObject):
    """Keeps tool tips away: they come after a time of the machine's, not of the clip's."""

    def eventFilter(self, _watched, event):  # noqa: N802 - Qt's name
        return event.type() == QEvent.Type.ToolTip


def record(frames_per_s):
    """The frames of the session."""
    app = application()
    app.setCursorFlashTime(0)
    no_tips = NoTips()
    app.installEventFilter(no_tips)
    library = standard_library()
    with tempfile.TemporaryDirectory() as folder:
        window = MainWindow(
            library=library,
            settings=Settings(Path(folder) / "settings.ini"),
            recovery=Path(folder),
            remembered=False,
        )
        try:
            window.resize(app.primaryScreen().size())
            window.move(0, 0)
            window.show()
            window.activateWindow()
            settle(window)
            window.files.show(sharper(library))
            make_room(window)
            settle(window)
            clip = Clip(window, frames_per_s)
            clip.play(session)
        finally:
            window.close_for_good()
    return clip.frames


def main():
    """Write the clip."""
    file, *rates = sys.argv[1:]
    frames_per_s = float(rates[0]) if rates else FRAMES_PER_S
    frames = record(frames_per_s)
    Path(file).write_bytes(gif(frames, frames_per_s=FRAMES_PER_S))
    print(f"{file}: {len(frames)} frames")


if __name__ == "__main__":
    main()
