"""Silence for libraries written in C that print to stderr what they also report as errors."""

from __future__ import annotations

import contextlib
import os
import sys
import threading
from collections.abc import Iterator

# The descriptor belongs to the whole process: two threads that redirect it at once could
# restore it in the wrong order and lose it for good.
_DESCRIPTOR_LOCK = threading.Lock()
_STDERR = 2


@contextlib.contextmanager
def quiet_stderr() -> Iterator[None]:
    """Send file descriptor 2 to nowhere for the length of the block, one thread at a time."""
    with _DESCRIPTOR_LOCK, contextlib.ExitStack() as stack:
        try:
            saved = os.dup(_STDERR)
        except OSError:  # a windowed process has no stderr, so there is nothing to silence
            saved = -1
        if saved >= 0:
            stack.callback(os.close, saved)
            null = os.open(os.devnull, os.O_WRONLY)
            stack.callback(os.close, null)
            if sys.stderr is not None:
                sys.stderr.flush()
            os.dup2(null, _STDERR)
            stack.callback(os.dup2, saved, _STDERR)
        yield
