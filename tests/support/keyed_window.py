"""The editor's window worked by real keys; what was seen is left in FOLDER/seen.json.

python keyed_window.py FOLDER
"""

import json
import sys
from pathlib import Path

from PySide6.QtCore import QRect, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QDockWidget, QFileDialog, QTabBar

from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.viewer_docks import in_sight
from hands import centre, process_events, wait_until
from managed_window import Managed
from nodes.library import standard_library

TABS = 50  # more than there are widgets to visit
SOON_S = 2.0
IN_PROC = ("/proc/self/mine.json", "/proc/mine.json")


def stray_tabs(folder):
    """Tab bars of a single tab that Qt leaves in a window that opens with a network."""
    window = MainWindow(
        library=standard_library(),
        settings=Settings(folder / "other.ini"),
        recovery=folder / "recovery",
    )
    window.open_first("first_steps")
    window.show()
    wait_until(window.isActiveWindow, "the window has the focus")
    process_events(0.5)
    bench, direct = window.workbench, Qt.FindChildOption.FindDirectChildrenOnly
    bars = bench.findChildren(QTabBar, options=direct)
    found = [bar.geometry().getRect() for bar in bars if bar.count() < 2]
    seen = [place for place in found if QRect(*place).intersects(bench.rect())]
    window.close_for_good()
    process_events(0.2)
    return {"found": len(found), "seen": seen}


def saved_as(place, window, hands, to_canvas):
    """What is said of a name typed letter by letter, which Qt completes from what is there."""
    to_canvas()
    hands.keys("ctrl+shift+s")
    wait_until(lambda: window.findChild(QFileDialog, "file_dialog"), "Save As is open")
    process_events(0.3)
    hands.type(place)
    hands.keys("Return")
    wait_until(lambda: window.findChild(QFileDialog) is None, "it is closed", SOON_S)
    return window.status.said("error")


def main(folder):
    made = Managed(folder)
    window, hands, seen = made.window, made.hands, {"tabs": stray_tabs(folder)}
    window.activateWindow()
    window.files.open_now("mwir_camera")
    made.settle()

    def to_canvas():
        process_events(0.2)  # a second click would be a double-click, which bends a wire
        hands.click(made.at(centre(window.canvas)))
        wait_until(lambda: window.canvas.isAncestorOf(QApplication.focusWidget()), "canvas")

    def open_menu():
        hands.keys("alt+v")
        wait_until(QApplication.activePopupWidget, "a menu is open")

    # B and R are keys of the canvas, and mnemonics of View.
    to_canvas()
    open_menu()
    for letter, action in (("b", "picture_below"), ("r", "reset_layout")):
        if QApplication.activePopupWidget() is None:
            open_menu()
        came = []
        window.actions_by_name[action].triggered.connect(lambda *_, to=came: to.append(1))
        hands.keys(letter)
        wait_until(lambda: QApplication.activePopupWidget() is None, f"{letter} closes the menu")
        seen[f"menu {letter}"] = len(came)
        to_canvas()
    seen["changed by menus"] = window.isWindowModified()

    seen["proc"] = [saved_as(place, window, hands, to_canvas) for place in IN_PROC]
    for name in ("trade_off", "measure", "fit"):
        window.actions_by_name[name].trigger()
    made.settle()
    window.viewers.docks[1].raise_()
    to_canvas()
    ring, parts = window.focus_ring, []
    for _ in range(6):
        before = QApplication.focusWidget()
        hands.keys("F6")
        wait_until(lambda was=before: QApplication.focusWidget() is not was, "another part")
        process_events(0.05)
        part = next(p for p in window.parts() if p.isAncestorOf(QApplication.focusWidget())
                    or p is QApplication.focusWidget())  # fmt: skip
        place = part.mapTo(window, part.rect().topLeft()).toTuple() + part.size().toTuple()
        parts.append((part.objectName(), in_sight(part), ring.geometry().getRect() == place))
    seen["parts"] = parts

    to_canvas()
    hidden = []
    for _ in range(TABS):
        QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
        focus = QApplication.focusWidget()
        docks = [dock for dock in window.findChildren(QDockWidget) if dock.isAncestorOf(focus)]
        hidden += [focus.objectName() for dock in docks if not in_sight(dock)]
    seen["hidden"] = hidden
    (folder / "seen.json").write_text(json.dumps(seen))
    window.close_for_good()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
