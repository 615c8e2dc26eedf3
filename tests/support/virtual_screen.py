"""A display of its own for a test: a real X server that draws to memory."""

import contextlib
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from child_process import PATIENCE_S

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
