"""A polite end when the process is told to stop."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from typing import Any

_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP


class Stopped(KeyboardInterrupt):
    """Told to stop.

    A class of its own: after a plain KeyboardInterrupt inside ``exec`` (as dataclasses use it) the
    interpreter ends by the signal, however well it was caught.
    """


@contextlib.contextmanager
def stoppable() -> Iterator[threading.Event]:
    """Make Ctrl-C and the signals to end raise `Stopped`.

    Yields an event that is set then: code that swallows every exception (a module being imported,
    a callback) may hide the exception from the caller.
    """
    told = threading.Event()

    def stop(_number: int, _frame: object) -> None:
        told.set()
        raise Stopped

    previous: dict[signal.Signals, Any] = {}
    with contextlib.suppress(ValueError):  # not the main thread
        for name in _SIGNALS:
            number = getattr(signal, name, None)
            # Ignored, as by nohup: to stay so.
            if number is not None and signal.getsignal(number) != signal.SIG_IGN:
                previous[number] = signal.signal(number, stop)
    try:
        yield told
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)
