"""A display of its own for a test: a real X server that draws to memory."""

import contextlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from child_process import PATIENCE_S, ROOT

SCREENSHOTS = Path(__file__).resolve().parents[2] / "build" / "screenshots"


@contextlib.contextmanager
def virtual_screen(width=1600, height=1000):
    """Start Xvfb on a free display; gives the environment for programs that are to draw there."""
    program = shutil.which("Xvfb")
    assert program, "these tests need Xvfb and xdotool (Debian: xvfb xauth xdotool)"
    read, write = os.pipe()
    server = subprocess.Popen(
        [
            program,
            "-displayfd",
            str(write),
            "-screen",
            "0",
            f"{width}x{height}x24",
            "-nolisten",
            "tcp",
            # Else it starts anew when its last program ends, and refuses the next one meanwhile.
            "-noreset",
        ],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    try:
        with os.fdopen(read) as stream:
            number = stream.readline().strip()
        assert number, "Xvfb did not start"
        yield {
            **{name: value for name, value in os.environ.items() if name != "WAYLAND_DISPLAY"},
            "DISPLAY": f":{number}",
            "QT_QPA_PLATFORM": "xcb",
        }
    finally:
        server.terminate()
        server.wait(PATIENCE_S)


def seen_by(name, folder, environment, *words):
    """What the script of that name in `tests/support` writes of a window in a process of its own.

    It is called with the words and the folder, in which it leaves its findings as `seen.json`.
    """
    script = ROOT / "tests" / "support" / name
    path = os.pathsep.join([str(ROOT), str(script.parent)])
    done = subprocess.run(
        [sys.executable, str(script), *words, str(folder)],
        env={**environment, "PYTHONPATH": path, "XDG_CONFIG_HOME": str(folder)},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "seen.json").read_text())


@contextlib.contextmanager
def managed_screen(width, height):
    """A virtual screen with a window manager, as people have one; skips where there is none."""
    program = shutil.which("openbox")
    if program is None:
        pytest.skip("these tests need a window manager (Debian: openbox)")
    with virtual_screen(width, height) as environment:
        manager = subprocess.Popen(
            [program, "--sm-disable"],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            yield environment
        finally:
            manager.terminate()
            manager.wait(PATIENCE_S)


def screenshot_folder():
    """Where the tests leave their screenshots: beside the code, not in it."""
    SCREENSHOTS.mkdir(parents=True, exist_ok=True)
    return SCREENSHOTS
