"""Closing the editor by every way in every state: it ends, or it asks; no work is lost."""

import json
import signal
import subprocess
import time
from dataclasses import dataclass

from app.run.shipped import shipped_networks
from editor_process import EditorProcess

WAYS = ("keys", "menu", "window manager", "SIGTERM", "SIGTERM twice")
STATES = ("unmodified", "modified", "computing", "dialog")
# Keys that open something, and whether it is a question that itself asks for unsaved work.
DIALOGS = {
    "open": "ctrl+o",
    "save as": "ctrl+shift+s",
    "replace": "ctrl+shift+s",
    "export": "ctrl+e",
    "shortcuts": "question",
    "module search": "Tab",
    "new": "ctrl+n",
    "menu": "alt+e",
}
LARGE = 2048
AGAIN_S = 0.3


@dataclass(frozen=True)
class Trial:
    """One closing: way, state, which dialog is open, whether there is unsaved work, the answer."""

    way: str
    state: str
    dialog: str = ""
    modified: bool = False
    answer: str = "Discard"

    @property
    def is_told(self):
        """Whether a signal tells it to end, so that it asks nothing."""
        return self.way.startswith("SIGTERM")


def trials(count, first=0):
    """`count` closings by each way; every dialog and every answer in turn."""
    answers, dialogs = ("Discard", "Save", "Cancel"), tuple(DIALOGS)
    for number in range(first, first + count):
        state = STATES[number % len(STATES)]
        turn = number // len(STATES)
        for way in WAYS:
            modified = state == "modified" or (state != "unmodified" and turn % 2 == 1)
            dialog = dialogs[turn % len(dialogs)] if state == "dialog" else ""
            yield Trial(way, state, dialog, modified or dialog == "new", answers[turn % 3])


def network(trial):
    """What is opened; large where it is to be computing when it is closed."""
    text = shipped_networks()["first_steps"].read_text()
    found = json.loads(text)
    if trial.state == "computing":
        found["nodes"]["scene"]["params"] |= {"width": LARGE, "height": LARGE}
    return found


def close(trial, folder, screen):
    """Carry a closing out; what happened, or an AssertionError that says what is wrong."""
    with EditorProcess(folder, screen, network(trial)) as editor:
        before = json.loads(editor.file.read_text())
        if trial.modified:
            editor.edit()
        if trial.state == "computing":
            editor.keys("ctrl+Return")
        elif trial.dialog:
            plain = editor.windows()
            editor.keys(DIALOGS[trial.dialog])
            if trial.dialog == "menu":
                editor.wait(lambda: editor.windows() - plain, "the Edit menu")
            if trial.dialog == "replace":
                editor.wait(lambda: editor.window("^Save the network"), "the dialog")
                editor.focus(editor.window("^Save the network"))
                editor.keys("Return")  # the network's own file, which is there
                editor.wait(lambda: editor.window("^Replace file"), "the question to replace it")
            if trial.dialog == "new":
                editor.wait(lambda: editor.asks, "the question of a new network")
        go(trial, editor)
        outcome = editor.outcome()
        if trial.is_told and outcome == "asked":  # of New: told to end, it ends
            editor.wait(lambda: editor.gone, "the end")
            outcome = "ended"
        assert outcome in ("ended", "asked"), f"{outcome}; it said {editor.said!r}"
        if outcome == "asked":
            assert trial.modified, "it asks, though there is no unsaved work"
            answered(trial, editor, before)
        else:
            assert not trial.modified or trial.is_told, "it ended without a question"
            ended(editor)
            assert json.loads(editor.file.read_text()) == before, "it wrote the file unasked"
            assert len(editor.kept()) == trial.modified, "kept against a crash"
            if trial.modified:
                assert len(json.loads(editor.kept()[0])["nodes"]) == 2 * len(before["nodes"])
        return outcome


def go(trial, editor):
    """Close by the trial's way."""
    way = trial.way
    if way == "keys":
        editor.keys("ctrl+q")
    elif way == "menu":
        open_file_menu(trial, editor)
        editor.keys("q")
    elif way == "window manager":
        editor.press_close_button()
    else:
        editor.process.send_signal(signal.SIGTERM)
        if way == "SIGTERM twice":
            # As somebody who sees nothing happen: before it has ended, or while it does.
            time.sleep(AGAIN_S)
            editor.process.send_signal(signal.SIGTERM)


def open_file_menu(trial, editor):
    """By a click; where another menu is open, by the pointer alone, as a click would close it."""
    before = editor.windows()
    if trial.dialog == "menu":
        editor.move(18, 10)
    else:
        editor.click(18, 10)
    if trial.dialog != "new":  # its question is modal: the menus stay shut
        editor.wait(lambda: editor.windows() - before, "the File menu")


def answered(trial, editor, before):
    """Answer the question, and look at what becomes of the work."""
    if trial.dialog == "new":  # that question is another's: give it up, and close anew
        answer(editor, "Escape")
        assert not editor.gone
        editor.focus(editor.main)
        editor.press_close_button()
        assert editor.outcome() == "asked"
    if trial.answer == "Cancel":
        answer(editor, "Escape")
        assert not editor.gone
        lives(trial, editor, before)
        editor.press_close_button()
        assert editor.outcome() == "asked"
    answer(editor, "alt+s" if trial.answer == "Save" else "alt+d")
    ended(editor)
    assert not editor.kept(), "work that was saved or given up is not kept"
    saved = len(json.loads(editor.file.read_text())["nodes"])
    assert saved == len(before["nodes"]) * (2 if trial.answer == "Save" else 1)


def answer(editor, key):
    editor.focus(editor.window("^Save changes"))
    editor.keys(key)
    editor.wait(lambda: editor.gone or not editor.asks, "the end" if key != "Escape" else "it goes")


def lives(trial, editor, before):
    """What is edited after Cancel is kept against a crash."""
    editor.focus(editor.main)
    if trial.dialog == "module search":  # it is open as before, and takes the keys
        editor.keys("Escape")
    editor.keys("ctrl+a", "ctrl+d")
    count = 4 * len(before["nodes"])
    editor.wait(
        lambda: any(len(json.loads(text)["nodes"]) == count for text in editor.kept()),
        "the work done after Cancel to be kept",
    )


def ended(editor):
    """It has ended, or does so now: by itself, without a word."""
    try:
        code = editor.process.wait(120)
    except subprocess.TimeoutExpired:
        raise AssertionError("the window is gone, the process is not") from None
    assert code == 0, f"exit code {code}: {editor.said!r}"
    assert editor.said == "", editor.said
