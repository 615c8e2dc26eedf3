"""Closing the editor with unsaved work, in many states: it ends, or it asks; no work is lost."""

import json
import signal
import subprocess
import time
from dataclasses import dataclass

from app.run.shipped import shipped_networks
from editor_process import EditorProcess

LARGE = 2048
AGAIN_S = 0.3


@dataclass(frozen=True)
class Trial:
    """One closing of modified work: the way, what goes on, and the answer to the question."""

    way: str
    state: str
    answer: str = "Discard"

    @property
    def is_told(self):
        """Whether a signal tells it to end, so that it asks nothing."""
        return self.way.startswith("SIGTERM")


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
        editor.edit()
        if trial.state == "computing":
            editor.keys("ctrl+Return")
        else:
            editor.keys("ctrl+shift+s")
        if trial.state == "replace":
            editor.wait(lambda: editor.window("^Save the network"), "the dialog")
            editor.focus(editor.window("^Save the network"))
            editor.keys("Return")  # the network's own file, which is there
            editor.wait(lambda: editor.window("^Replace file"), "the question to replace it")
        go(trial, editor)
        outcome = editor.outcome()
        assert outcome in ("ended", "asked"), f"{outcome}; it said {editor.said!r}"
        if outcome == "asked":
            answered(trial, editor, before)
        else:
            assert trial.is_told, "it ended without a question"
            ended(editor)
            assert json.loads(editor.file.read_text()) == before, "it wrote the file unasked"
            (kept,) = editor.kept()
            assert len(json.loads(kept)["nodes"]) == 2 * len(before["nodes"])
        return outcome


def go(trial, editor):
    """Close by the trial's way."""
    if not trial.is_told:
        editor.press_close_button()
        return
    editor.process.send_signal(signal.SIGTERM)
    if trial.way == "SIGTERM twice":
        # As somebody who sees nothing happen: before it has ended, or while it does.
        time.sleep(AGAIN_S)
        editor.process.send_signal(signal.SIGTERM)


def answered(trial, editor, before):
    """Answer the question, and look at what becomes of the work."""
    if trial.answer == "Cancel":
        answer(editor, "Escape")
        assert not editor.gone
        lives(editor, before)
        editor.press_close_button()
        assert editor.outcome() == "asked"
    answer(editor, "alt+d")
    ended(editor)
    assert not editor.kept(), "work that was given up is not kept"
    assert json.loads(editor.file.read_text()) == before


def answer(editor, key):
    editor.focus(editor.window("^Save changes"))
    editor.keys(key)
    editor.wait(lambda: editor.gone or not editor.asks, "the end" if key != "Escape" else "it goes")


def lives(editor, before):
    """What is edited after Cancel is kept against a crash."""
    editor.focus(editor.main)
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
