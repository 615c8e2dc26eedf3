"""Standard output and error as a command needs them, also where the caller has closed them."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from typing import TextIO


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
    """Drop what is left in the stream's buffer, and all that follows."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def print_error(line: str) -> None:
    """Print a line to standard error; drop it where that is full or gone."""
    try:
        print(line, file=sys.stderr, flush=True)
    except (OSError, ValueError):
        discard(sys.stderr)
