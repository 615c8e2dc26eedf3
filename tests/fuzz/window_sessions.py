"""Random sessions of real key and mouse events in a window: nothing fails, nothing is lost.

    python tests/fuzz/window_sessions.py --count 60 --actions 200

Each session begins from a shipped network or an empty one; it adds, wires, deletes, undoes,
disables, drags, types, lays out, saves and reopens, and does what `window_actions` has: macros,
presets, expressions, dots, snapshots, jumps in the history. After each action the canvas draws the
network; after all of them: no exception, no warning of Qt, the saved file is the document, undoing
all gives the start, and doing it again the end. It draws offscreen unless
QT_QPA_PLATFORM says otherwise. A session that failed is printed with its seed and its last actions.
"""

import argparse
import os
import random
import sys
import tempfile
import time
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "support")]
SCREEN = ROOT / "tests" / "support" / "screen.json"
os.environ.setdefault("QT_QPA_PLATFORM", f"offscreen:configfile={SCREEN}")

from PySide6.QtCore import QPoint, Qt, qInstallMessageHandler  # noqa: E402
from PySide6.QtTest import QTest  # noqa: E402
from PySide6.QtWidgets import QApplication  # noqa: E402
from window_actions import NewerActions  # noqa: E402

from app.editor.window.main_window import MainWindow  # noqa: E402
from app.editor.window.recent_files import Settings  # noqa: E402
from app.editor.window.start import application  # noqa: E402
from core.network.file import format_network, read_network  # noqa: E402
from nodes.library import standard_library  # noqa: E402
from window_hands import CTRL, KEY, SHIFT, WindowHands  # noqa: E402

ALT = Qt.KeyboardModifier.AltModifier
QUIET = ("propagateSizeHints", "does not support raise", "grabbing the keyboard")
STARTS = ("", "first_steps", "kodak_kir310", "spatial_blur", "camera_and_sensor", "pupils")
PLAIN = Qt.KeyboardModifier.NoModifier
KEYED = {  # keys of the canvas, what is held with them, how often they are pressed at most
    "delete": ([KEY.Key_Delete, KEY.Key_Backspace],),
    "cut": ([KEY.Key_X], CTRL),
    "undo": ([KEY.Key_Z], CTRL, 6),
    "redo": ([KEY.Key_Z], CTRL | SHIFT, 6),
    "letter": ([KEY.Key_D, KEY.Key_L, KEY.Key_F, KEY.Key_T, KEY.Key_M],),
    "output": ([KEY.Key_O],),
    "align": ([KEY.Key_Left, KEY.Key_Right, KEY.Key_Up, KEY.Key_Down], ALT),
    "nudge": ([KEY.Key_Left, KEY.Key_Down],),
    "select_all": ([KEY.Key_A], CTRL),
    "view": ([KEY.Key_1, KEY.Key_2],),
    "compare": ([KEY.Key_K, KEY.Key_W],),
}
TYPED = ("0.3", "1e-3", "-1", "", "abc", "600", "2*0.3", "1e400")


class WindowSession(NewerActions):
    """One session; `log` has what was done."""

    def __init__(self, seed, folder):
        self.random = random.Random(seed)
        self.folder = Path(folder)
        self.log = []
        self.complaints = []
        self.library = standard_library()
        self.window = MainWindow(
            library=self.library,
            settings=Settings(self.folder / "editor.ini"),
            recovery=self.folder / "recovery",
            remembered=False,
        )
        self.window.resize(1400, 860)
        self.window.show()
        start = self.random.choice(STARTS)
        if start:
            self.window.files.open_now(start)
        else:
            self.window.files.new()
        self.hands = WindowHands(self.window)
        self.hands.focus()
        self.session = self.window.session
        self.start = self.text()

    def text(self):
        return format_network(self.session.document.network, library=self.library)

    def run(self, actions):
        names = [*(name for name in dir(self) if name.startswith("do_")), *KEYED]
        for _ in range(actions):
            name = self.random.choice(names)
            self.log.append(name)
            if name in KEYED:
                self.press(*KEYED[name])
            else:
                getattr(self, name)()
            QApplication.processEvents()
            self.put_dialogs_away()
            self.check_drawn()
        self.settle()

    def press(self, keys, modifiers=PLAIN, most=1):
        self.hands.focus()
        for _ in range(self.random.randint(1, most)):
            self.hands.key(self.random.choice(keys), modifiers)

    def settle(self):
        end = time.monotonic() + 600
        while not self.window.evaluator.idle:
            assert time.monotonic() < end, "the window does not come to rest"
            QTest.qWait(10)

    def put_dialogs_away(self):
        """Esc for what asks something, as a person who has thought better of it."""
        for widget in QApplication.topLevelWidgets():
            if widget.isVisible() and widget is not self.window and widget.isWindow():
                QTest.keyClick(widget, KEY.Key_Escape)
                widget.close()
        if self.window.canvas.popup.is_open:
            self.hands.key(KEY.Key_Escape)

    def node(self):
        """One of the nodes that the canvas shows."""
        names = list(self.window.level.network.nodes)
        return self.random.choice(names) if names else None

    def visible(self, pos):
        return self.hands.port_of_view.rect().contains(pos)

    def anywhere(self):
        """A pixel of the canvas."""
        rect = self.hands.port_of_view.rect()
        return QPoint(self.random.randrange(rect.width()), self.random.randrange(rect.height()))

    # --- what is done ---------------------------------------------------------------------------

    def do_add(self):
        self.hands.focus()
        title = self.library[self.random.choice(list(self.library))].title
        if self.random.random() < 0.5:
            self.session.select([])
        self.hands.key(KEY.Key_Tab)
        self.hands.type("".join(c for c in title if c.isascii()))
        self.hands.key(KEY.Key_Return)

    def do_click(self):
        name = self.node()
        if name is not None and self.visible(pos := self.hands.head(name)):
            keys = self.random.choice([PLAIN, CTRL, SHIFT])
            self.hands.click(pos, keys)

    def do_band(self):
        self.hands.drag(self.anywhere(), self.anywhere())

    def do_drag(self):
        name = self.node()
        if name is not None and self.visible(pos := self.hands.head(name)):
            by = QPoint(self.random.randint(-200, 200), self.random.randint(-80, 80))
            self.hands.drag(pos, pos + by)

    def do_wire(self):
        names = [self.node(), self.node()]
        if None in names:
            return
        ends = []
        for name, side in zip(names, ("output", "input"), strict=True):
            ports = [p for s, p in self.window.canvas.content.nodes[name].ports if s == side]
            if not ports:
                return
            ends.append(self.hands.port(name, self.random.choice(ports), side))
        self.hands.drag(*ends)

    def do_copy_paste(self):
        self.hands.focus()
        if len(self.session.network.nodes) < 60:
            self.hands.key(KEY.Key_C, CTRL)
            self.hands.key(KEY.Key_V, CTRL)

    def do_duplicate(self):
        self.hands.focus()
        if len(self.session.network.nodes) < 60:
            self.hands.key(KEY.Key_D, CTRL)

    def do_backdrop(self):
        self.hands.focus()
        self.hands.key(KEY.Key_B)
        self.hands.type(self.random.choice(["Stage", "d l f", ""]))
        self.hands.key(self.random.choice([KEY.Key_Return, KEY.Key_Escape]))

    def do_find(self):
        self.hands.focus()
        self.hands.key(KEY.Key_F, CTRL)
        name = self.node()
        if name is not None and name.isascii():
            self.hands.type(name)
            self.hands.key(KEY.Key_Return)

    def do_type(self):
        """Type a value into a field of the panel."""
        edits = [edit for edit in self.fields() if edit.isEnabled()]
        if edits:
            edit = self.random.choice(edits)
            edit.setFocus()
            edit.selectAll()
            QTest.keyClicks(edit, self.random.choice(TYPED))
            QTest.keyClick(edit, self.random.choice([KEY.Key_Return, KEY.Key_Tab, KEY.Key_Escape]))

    def do_wheel(self):
        middle = self.hands.port_of_view.rect().center()
        self.hands.wheel(middle, self.random.choice([-240, 120, 240]))

    def do_layout(self):
        names = ("picture_below", "picture_beside", "canvas_first", "reset_layout")
        self.window.actions_by_name[self.random.choice(names)].trigger()

    def do_wait(self):
        QTest.qWait(self.random.choice([5, 30, 120]))

    def do_save(self):
        self.check_saved()

    def do_reopen(self):
        """Save and open: the same document; undo does not go back beyond that, so the start is."""
        path = self.check_saved()
        before = self.text()
        self.window.files.open_now(str(path))
        assert self.text() == before, "the reopened network differs"
        self.start = before

    def check_saved(self):
        path = self.folder / "session.json"
        assert self.session.save(path, over=True), self.window.status.said("error")
        loaded = read_network(path, library=self.library)
        assert format_network(loaded, library=self.library) == self.text(), "the file differs"
        assert not self.session.document.modified
        return path

    def check_drawn(self):
        """The canvas has the nodes and the wires of the network that it shows."""
        shown, content = self.window.level.network, self.window.canvas.content
        assert set(content.nodes) == set(shown.nodes), "the canvas draws other nodes"
        assert set(content.wires) == set(shown.links), "the canvas draws other wires"

    def check_undone(self):
        history = self.session.document
        self.session.document.go_to(history.last)
        end = self.text()
        for _ in range(100_000):
            if not history.undo_text:
                break
            self.session.undo()
        assert self.text() == self.start, "undo to the start is not the start"
        for _ in range(100_000):
            if not history.redo_text:
                break
            self.session.redo()
        assert self.text() == end, "redo to the end is not the end"


def run_session(seed, actions):
    """What went wrong; empty where nothing did."""
    complaints = []

    def note(_kind, _context, text):
        if not any(word in text for word in QUIET):
            complaints.append(f"Qt: {text}")

    def hook(kind, value, trace):
        complaints.append("".join(traceback.format_exception(kind, value, trace)[-4:]))

    before = qInstallMessageHandler(note)
    sys.excepthook = hook
    with tempfile.TemporaryDirectory() as folder:
        session = WindowSession(seed, folder)
        try:
            session.run(actions)
            session.check_saved()
            session.check_undone()
        except Exception:
            complaints.append(traceback.format_exc(limit=-6))
        finally:
            session.window.close_for_good()
            session.window.deleteLater()
            QApplication.processEvents()
    sys.excepthook = sys.__excepthook__
    qInstallMessageHandler(before)
    return [f"{text}\n  last: {' '.join(session.log[-8:])}" for text in complaints]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=60, help="sessions")
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--actions", type=int, default=200, help="actions of each")
    options = parser.parse_args()
    app = application()
    wrong = 0
    for seed in range(options.first, options.first + options.count):
        complaints = run_session(seed, options.actions)
        wrong += bool(complaints)
        print(f"{seed}: {'WRONG' if complaints else 'right'}", *complaints[:3], flush=True)
    print(f"{options.count} sessions of {options.actions} actions, {wrong} wrong")
    assert app is not None
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
