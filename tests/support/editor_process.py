"""The editor as a process of its own on a virtual screen, worked by real keys and mouse."""

import contextlib
import ctypes
import ctypes.util
import json
import os
import subprocess
import sys
import time
from pathlib import Path


class _Message(ctypes.Structure):
    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 5),
        ("rest", ctypes.c_long * 24),  # Xlib's events all have the size of the largest
    )


_CLIENT_MESSAGE = 33


def press_close_button(display, window):
    """Send WM_DELETE_WINDOW to a window, as the button in its title bar does."""
    name = ctypes.util.find_library("X11")
    assert name, "these tests need libX11, which xdotool brings along"
    x11 = ctypes.CDLL(name)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XInternAtom.restype = ctypes.c_ulong
    x11.XInternAtom.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int)
    x11.XSendEvent.argtypes = (
        *(ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long),
        ctypes.POINTER(_Message),
    )
    x11.XCloseDisplay.argtypes = (ctypes.c_void_p,)
    connection = x11.XOpenDisplay(display.encode())
    assert connection, f"{display} does not answer"
    try:
        protocols = x11.XInternAtom(connection, b"WM_PROTOCOLS", 0)
        delete = x11.XInternAtom(connection, b"WM_DELETE_WINDOW", 0)
        message = _Message(type=_CLIENT_MESSAGE, window=window, message_type=protocols, format=32)
        message.data[0] = delete
        assert x11.XSendEvent(connection, window, 0, 0, ctypes.byref(message))
    finally:
        x11.XCloseDisplay(connection)  # sends what is still held


ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 300.0  # a loaded machine is slow; none of the waits is for a thing that never comes
# A child of a background job ignores SIGINT, one of nohup SIGHUP: neither is what is tried.
START = """
import signal, sys
for name in ("SIGHUP", "SIGINT", "SIGTERM"):
    signal.signal(getattr(signal, name), signal.SIG_DFL)
from app.command.cli import main
sys.exit(main())  # as the command itself, which ends with it
"""


class EditorProcess:
    """A running editor with a network of its own in a folder of its own.

    Its settings and recovery files lie in that folder too.
    """

    def __init__(self, folder, screen, network, *, size=(1000, 700)):
        self.folder = Path(folder)
        self.file = self.folder / "mine.json"
        self.file.write_text(json.dumps(network))
        self.recovery = self.folder / "imagechain" / "recovery"
        homes = {"XDG_CONFIG_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
        self.environment = {**screen, **homes, "PYTHONPATH": str(ROOT)}
        words = ["edit", str(self.file), "--size", f"{size[0]}x{size[1]}"]
        self._errors = (self.folder / "stderr").open("w+")
        self.process = subprocess.Popen(
            [sys.executable, "-c", START, *words],
            cwd=folder,
            env=self.environment,
            stdout=self._errors,
            stderr=self._errors,
        )

    def __enter__(self):
        try:
            self.wait(lambda: self.window("mine.json") is not None, "a window")
        except BaseException:
            self.__exit__()
            raise
        self.main = self.window("mine.json")
        self.focus(self.main)
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(30)
        self._errors.close()

    # --- seeing ------------------------------------------------------------------------------

    @property
    def gone(self):
        return self.process.poll() is not None

    @property
    def said(self):
        return (self.folder / "stderr").read_text()

    def window(self, name):
        """The id of a window in sight whose title contains that."""
        its_own = ("--all", "--pid", self.process.pid)
        told = self._xdotool("search", "--onlyvisible", *its_own, "--name", name)
        numbers = told.split()
        return int(numbers[-1]) if numbers else None

    def title(self):
        return self._xdotool("getwindowname", self.main).strip()

    @property
    def modified(self):
        return "*" in self.title()

    @property
    def asks(self):
        return self.window("^Save changes") is not None

    def kept(self):
        """The texts of the networks kept against a crash."""
        found = []
        for path in self.recovery.glob("[!.]*.recovery"):  # hidden is what is still being written
            with contextlib.suppress(FileNotFoundError):
                found.append(json.loads(path.read_text())["network"])
        return found

    # --- doing -------------------------------------------------------------------------------

    def keys(self, *names):
        self._xdotool("key", "--delay", "20", *names)

    def focus(self, window):
        """What a window manager does with a new window, and on a click."""
        self._xdotool("windowfocus", window)

    def wait(self, condition, what):
        end = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < end, f"waited in vain for {what}; it said {self.said!r}"
            assert not self.gone or what == "the end", f"it ended, without {what}: {self.said!r}"
            time.sleep(0.05)

    def edit(self):
        """Duplicate every node: by one key each, as a person would."""
        before = self.window("mine.json")
        self.focus(before)
        self.keys("ctrl+a", "ctrl+d")
        self.wait(lambda: self.modified, "the mark of unsaved work")

    def press_close_button(self):
        press_close_button(self.environment["DISPLAY"], self.main)

    def outcome(self):
        """Wait until it has ended or asks; gives which."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if self.gone:
                return "ended"
            if self.asks:
                return "asked"
            time.sleep(0.05)
        return f"neither within {PATIENCE_S:g} s"

    def _xdotool(self, *words):
        done = subprocess.run(
            ["xdotool", *map(str, words)],
            env={**os.environ, "DISPLAY": self.environment["DISPLAY"]},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        return done.stdout
