"""The end of a real editor while a run goes on: no process of it is left, and no half of a file."""

import json
from pathlib import Path

import pytest

from app.run.shipped import shipped_networks
from editor_process import EditorProcess
from virtual_screen import virtual_screen

SMALL = 256


@pytest.fixture
def editor(tmp_path):
    """An editor that computes frames in the background."""
    network = json.loads(shipped_networks()["first_steps"].read_text())
    network["nodes"]["scene"]["params"] |= {"width": SMALL, "height": SMALL}
    with virtual_screen(1100, 800) as screen, EditorProcess(tmp_path, screen, network) as started:
        started.keys("ctrl+shift+t", "space")
        started.wait(lambda: started.window("^Add a run"), "the dialog")
        started.focus(started.window("^Add a run"))
        started.keys("Down", "alt+n", "ctrl+a", *"100000", "Return")
        started.wait(lambda: not started.window("^Add a run"), "the run to be queued")
        started.focus(started.main)
        started.wait(lambda: hidden(tmp_path), "files that are being prepared")
        yield started


def children(pid):
    """The processes that a process has started."""
    return [int(text) for text in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def hidden(folder):
    return [path.name for path in folder.glob(".imagechain-*")]


def is_running(pid):
    """Not one that has ended and is not waited for yet."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return "State:\tZ" not in status


def test_a_killed_editor_takes_its_run_along(editor):
    """It can do nothing itself: its run's input ends with it."""
    (run,) = children(editor.process.pid)
    editor.process.kill()
    editor.process.wait(120)
    editor.wait(lambda: not is_running(run), "the end")
    editor.wait(lambda: not hidden(editor.folder), "the end")
    assert not list(editor.folder.glob("mine-*"))
