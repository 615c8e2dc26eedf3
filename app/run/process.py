"""The process of a command: an orderly end on a signal to stop, and streams that may be closed."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any, TextIO

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP


class Stopped(KeyboardInterrupt):
    """Raised by a signal to stop.

    After a plain KeyboardInterrupt inside ``exec`` the interpreter would end by the signal.
    """


class Stop(threading.Event):
    """Set on a signal to stop, and the handler of these signals.

    `Stopped` is raised only inside `during`, whose caller catches it: anywhere else, such as in
    the caller's own ``except``, it would end the process with a traceback.
    """

    def __init__(self) -> None:
        super().__init__()
        self.is_late = False
        self._noted = False

    def during(self, function: Callable[..., object], *words: object) -> None:
        function(*words)

    def too_late(self) -> None:
        """From now on a stop is only noted: the files are being put in place."""
        self.is_late = True

    def __call__(self, _number: int, frame: FrameType | None) -> None:
        """Note the signal; raise where it can be caught, and nothing is being cleared away."""
        if not self._noted:
            # A signal within `set` would wait for its lock for ever.
            self._noted = True
            self.set()
        if self.is_late or isinstance(sys.exception(), Stopped):
            return
        while frame is not None and frame.f_code is not Stop.during.__code__:
            frame = frame.f_back
        if frame is not None:
            raise Stopped


def too_late(cancel: threading.Event | None) -> None:
    """From now on a stop that is tied to signals comes too late."""
    if isinstance(cancel, Stop):
        cancel.too_late()


@contextlib.contextmanager
def stoppable(*, to_the_end: bool = False) -> Iterator[Stop]:
    """Make Ctrl-C and the signals to end raise `Stopped`, and set the event.

    Code that swallows every exception may hide it from the caller. If the process ends after it
    (`to_the_end`), Ctrl-C ends the rest without a traceback, and a second signal changes nothing.
    """
    stop = Stop()
    previous: dict[signal.Signals, Any] = {}
    hook = sys.unraisablehook

    def report(unraisable: Any) -> None:
        # One that is raised while an object is being deleted goes no further; Python prints it.
        if not isinstance(unraisable.exc_value, Stopped):
            hook(unraisable)

    sys.unraisablehook = report
    with contextlib.suppress(ValueError):  # not the main thread
        for name in _SIGNALS:
            number = getattr(signal, name, None)
            # Ignored, as by nohup: to stay so.
            if number is not None and signal.getsignal(number) != signal.SIG_IGN:
                previous[number] = signal.signal(number, stop)
    try:
        yield stop
    finally:
        for number, handler in previous.items():
            again = stop.is_set() and number != signal.SIGINT
            at_end = signal.SIG_IGN if again else signal.SIG_DFL
            signal.signal(number, at_end if to_the_end else handler)
        if not to_the_end:
            sys.unraisablehook = hook


@contextlib.contextmanager
def usable_streams() -> Iterator[None]:
    """Make names of any alphabet printable, and replace closed streams by the null device.

    Without it `print` writes to standard output what was meant for a closed standard error, and
    the next file that is opened takes the number of the closed stream.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
        stream = getattr(sys, name)
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        # The interpreter flushes at its end: what fails then changes the exit code.
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except (OSError, ValueError):
                discard(stream)


def discard(stream: TextIO) -> None:
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def print_error(line: str) -> None:
    """Print a line to standard error; drop it where that is full or gone."""
    try:
        print(line, file=sys.stderr, flush=True)
    except (OSError, ValueError):
        discard(sys.stderr)


def version() -> str:
    """The version that is installed; read only when needed, as it takes 20 ms."""
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"


def versions() -> dict[str, str]:
    """Of the program, and of what its numbers depend on."""
    import numpy as np
    import scipy

    python = ".".join(map(str, sys.version_info[:3]))
    numbers = {"numpy": np.__version__, "scipy": scipy.__version__}
    return {"imagechain": version(), "python": python, **numbers}
