"""Locks on files that the system lets go of when their process ends, however it ends."""

import contextlib
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    def _try(descriptor: int) -> None:
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _try(descriptor: int) -> None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


_PLAIN = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)


class FileLock:
    """A lock that is held until it is let go, or the process ends."""

    def __init__(self, path: Path, descriptor: int) -> None:
        self._path = path
        self._descriptor = descriptor

    def let_go(self) -> None:
        """Let go of it, and remove its file."""
        with contextlib.suppress(OSError):
            self._path.unlink()
        with contextlib.suppress(OSError):
            os.close(self._descriptor)
        with contextlib.suppress(OSError):  # where an open file cannot be removed
            self._path.unlink(missing_ok=True)


def take(path: Path) -> FileLock | None:
    """Make a lock file of this process; None where the file system has no locks."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        _try(descriptor)
    except OSError:
        os.close(descriptor)
        return None
    return FileLock(path, descriptor)


@contextlib.contextmanager
def in_turn(path: Path, wait_s: float = 10.0) -> Iterator[None]:
    """Hold a lock that others wait for; its file stays.

    Where it cannot be had, as on file systems without locks, the block runs without it.
    """
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | _PLAIN, 0o600)
    except OSError:
        yield
        return
    try:
        end = time.monotonic() + wait_s
        while time.monotonic() < end:
            try:
                _try(descriptor)
                break
            except (BlockingIOError, PermissionError):
                time.sleep(0.01)
            except OSError:
                break
        yield
    finally:
        os.close(descriptor)


def is_held(path: Path) -> bool | None:
    """Whether a living process holds a lock; None where there is no such file."""
    try:
        # No link and no pipe: such a name would open another file.
        descriptor = os.open(path, os.O_RDWR | _PLAIN)
    except OSError:
        return None
    try:
        _try(descriptor)
    except BlockingIOError:
        return True
    except OSError as error:
        return isinstance(error, PermissionError) or None  # PermissionError: held, on Windows
    finally:
        os.close(descriptor)
    return False
