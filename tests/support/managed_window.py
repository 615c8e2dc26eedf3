"""The editor's window under a window manager, worked by real keys and mouse.

    python managed_window.py first FOLDER
    python managed_window.py again FOLDER

`first` opens a window for the first time, maximises it, shows its picture over the whole screen
and back, and closes it maximised; `again` is the next start. What was measured is left in
FOLDER/seen.json.
"""

import json
import sys
from pathlib import Path

from PySide6.QtCore import QPoint

from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.start import application
from hands import Hands, centre, process_events, wait_until
from nodes.library import standard_library
from window_hands import show_small


class Managed:
    """A window with its settings in a folder, and what is measured of it."""

    def __init__(self, folder):
        self.hands = Hands()
        self.app = application()
        self.app.setDoubleClickInterval(150)  # single clicks follow as soon
        self.screen = self.app.primaryScreen()
        self.window = MainWindow(
            library=standard_library(),
            settings=Settings(folder / "settings.ini"),
            recovery=folder / "recovery",
        )
        self.window.show()
        wait_until(self.window.isActiveWindow, "the window has the focus")
        self.settle()
        self.measured = {"screen": self.screen.availableGeometry().getRect()}

    def settle(self):
        """Wait until nothing is computed, and the window manager has placed the window."""
        before = None
        while before != (before := (self.window.frameGeometry().getRect(), self.share())):
            process_events(0.3)
            wait_until(lambda: self.window.evaluator.idle, "all is computed")

    def share(self):
        """What the picture with its axes has of the window."""
        shown = self.window.viewers.images[1].canvas
        return shown.width() * shown.height() / (self.window.width() * self.window.height())

    def note(self, what):
        """Leave the window's frame, size and state, and the picture's share."""
        window = self.window
        self.measured[what] = {
            "frame": window.frameGeometry().getRect(),
            "inside": window.geometry().getRect(),
            "maximised": window.isMaximized(),
            "share": self.share(),
            "picture": self.window.viewers.images[1].canvas.size().toTuple(),
        }

    def at(self, point):
        """A point of the screen in its own dots, which xdotool counts."""
        ratio = self.screen.devicePixelRatio()
        return round(point.x() * ratio), round(point.y() * ratio)

    def double_click_on_title(self):
        """What maximises a window, and makes it as large as before."""
        frame, inside = self.window.frameGeometry(), self.window.geometry()
        assert inside.top() > frame.top(), "the window has no title bar"
        title = QPoint(frame.center().x(), (frame.top() + inside.top()) // 2)
        was = self.window.isMaximized()
        self.hands.double_click(self.at(title))
        wait_until(lambda: self.window.isMaximized() != was, "the window is maximised or not")
        self.settle()

    def whole_screen_and_back(self):
        """F11 with the picture in use, and again."""
        picture = self.window.viewers.images[1].canvas
        self.hands.click(self.at(centre(picture)))
        wait_until(picture.hasFocus, "the picture has the focus")
        self.hands.keys("F11")
        wait_until(lambda: self.window.full_screen.page is not None, "F11 shows a page")
        page = self.window.full_screen.page
        wait_until(page.isActiveWindow, "the page has the focus")
        whole = self.screen.geometry()
        # Without its frame, whose extents Qt may still have from before: then the window manager
        # has taken it off without another word.
        wait_until(lambda: page.geometry() == whole, "the page has the bare screen")
        process_events(0.3)
        self.measured["page"] = {
            "frame": page.geometry().getRect(),
            "whole": self.screen.geometry().getRect(),
            "picture": picture.size().toTuple(),
        }
        self.hands.keys("F11")
        wait_until(lambda: picture.window() is self.window, "F11 puts the picture back")
        wait_until(self.window.isActiveWindow, "the window has the focus again")
        self.settle()

    def close(self, file):
        """Close by the window's own action."""
        self.window.close()
        process_events(0.2)
        file.write_text(json.dumps(self.measured))


def first(folder):
    """The first start."""
    made = Managed(folder)
    made.note("welcome")
    show_small(made.window, "kodak_kir310")
    made.settle()
    made.note("first")
    made.double_click_on_title()
    made.note("maximised")
    made.whole_screen_and_back()
    made.note("after page")
    made.double_click_on_title()
    made.note("again small")
    made.whole_screen_and_back()
    made.note("small after page")
    made.double_click_on_title()
    made.note("left")
    made.close(folder / "seen.json")


def again(folder):
    """The next start."""
    made = Managed(folder)
    show_small(made.window, "kodak_kir310")
    made.settle()
    made.note("begun")
    made.double_click_on_title()
    made.note("small")
    made.close(folder / "seen.json")


if __name__ == "__main__":
    {"first": first, "again": again}[sys.argv[1]](Path(sys.argv[2]))
