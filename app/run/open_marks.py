"""Lock files of windows: a second window on a network says that it is open already."""

from __future__ import annotations

import contextlib
import hashlib
import os
import secrets
import time
from pathlib import Path

from app.user_folders import state_folder
from core.file_lock import FileLock, is_held, take

_SUFFIX = ".lock"
_LEFT_BEHIND_S = 60.0  # a mark that is not held is just being made, or left by a crash


class OpenMark:
    """One window's mark; without one where the folder cannot be written."""

    def __init__(self, network: Path) -> None:
        name = hashlib.sha256(os.fsencode(os.path.realpath(network))).hexdigest()[:32]
        self.folder = state_folder() / "open" / name
        self._file = self.folder / f"{secrets.token_hex(8)}{_SUFFIX}"
        self._lock: FileLock | None = None
        with contextlib.suppress(OSError):
            self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            self._lock = take(self._file)

    @property
    def is_shared(self) -> bool:
        shared = False
        with contextlib.suppress(OSError):
            for other in self.folder.glob(f"*{_SUFFIX}"):
                if other == self._file:
                    continue
                if is_held(other):
                    shared = True
                elif time.time() - other.stat().st_mtime > _LEFT_BEHIND_S:
                    other.unlink()
        return shared

    def let_go(self) -> None:
        if self._lock is not None:
            self._lock.let_go()
        self._lock = None
        with contextlib.suppress(OSError):  # another window's mark is in it
            self.folder.rmdir()
