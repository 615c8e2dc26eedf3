"""Names of temporary files that carry their process, and clearing away those of dead processes."""

import contextlib
import functools
import hashlib
import os
import re
import secrets
import shutil
import stat
import time
from pathlib import Path

from core.file_lock import is_held

FOLDER_PREFIX = ".imagechain-"
LOCK = "lock"
"""A file in a temporary folder that its process holds locked."""
ABANDONED_S = 30 * 24 * 3600.0
"""A folder untouched for so long is abandoned, also where its process cannot be known."""

_UNKNOWN = "0" * 8
_MARK = r"([0-9a-f]{8})-([0-9]{1,10})-([0-9a-f]{8})-[0-9a-f]{8}"
_FOLDER = re.compile(re.escape(FOLDER_PREFIX) + _MARK)
_FILE = re.compile(r"\..*\." + _MARK + r"(\.[^.]*)?", re.DOTALL)
_UNMARKED = re.compile(re.escape(FOLDER_PREFIX) + r"[0-9a-f]{12}")  # before folders were marked


def new_mark() -> str:
    """A part of a name that no other process makes: machine, process, and a random number."""
    return f"{_host()}-{os.getpid()}-{_digest(own_token())}-{secrets.token_hex(4)}"


def sweep(folder: Path) -> None:
    """Remove what dead processes of this user have left in a folder.

    Only real files and folders whose names are marked are touched. What a process of another
    machine made is left until it has not been touched for 30 days: whether that one runs is not
    known here. What cannot be removed stays.
    """
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if entry.name.startswith("."):
                with contextlib.suppress(OSError):
                    _sweep_one(entry)


def _sweep_one(entry: os.DirEntry[str]) -> None:
    marked = _FOLDER.fullmatch(entry.name) or _FILE.fullmatch(entry.name)
    if marked is None and _UNMARKED.fullmatch(entry.name) is None:
        return
    status = entry.stat(follow_symlinks=False)
    if hasattr(os, "geteuid") and status.st_uid != os.geteuid():
        return
    is_folder = entry.name.startswith(FOLDER_PREFIX)
    if not (stat.S_ISDIR if is_folder else stat.S_ISREG)(status.st_mode):
        return  # a link, above all
    if marked is None or marked[1] != _host():
        dead = None
    else:
        dead = _is_dead(int(marked[2]), marked[3], Path(entry.path) if is_folder else None)
    if dead is None:
        dead = time.time() - status.st_mtime > ABANDONED_S
    if dead and is_folder:
        shutil.rmtree(entry.path, ignore_errors=True)
    elif dead:
        Path(entry.path).unlink()


def _is_dead(pid: int, start: str, folder: Path | None) -> bool | None:
    """Whether a process of this machine has ended; None where that cannot be known."""
    # The lock too: machines that are copies of each other may share a drive.
    if folder is not None and (held := is_held(folder / LOCK)) is not None:
        return not held and (start == _UNKNOWN or _digest(start_token(pid)) != start)
    return None if start == _UNKNOWN else _digest(start_token(pid)) != start


@functools.cache
def _host() -> str:
    """The machine, and where it divides its process numbers, as containers do, which part."""
    facts = [os.uname().nodename if hasattr(os, "uname") else os.environ.get("COMPUTERNAME", "")]
    with contextlib.suppress(OSError):
        facts.append(Path("/etc/machine-id").read_bytes().decode("utf-8", "replace").strip())
    with contextlib.suppress(OSError):
        facts.append(str(Path("/proc/self/ns/pid").readlink()))
    return _digest("\n".join(facts))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:8] if text else _UNKNOWN


# Telling whether a process still runs, though its number may have been given to another since.

_PROC = Path("/proc")


def start_token(pid: int) -> str:
    """What distinguishes a process from a later one of the same number; empty where unknown."""
    try:
        # The program's name, in parentheses, may hold spaces and parentheses itself.
        fields = (_PROC / str(pid) / "stat").read_bytes().rpartition(b")")[2].split()
        boot = (_PROC / "sys/kernel/random/boot_id").read_bytes().decode("ascii").strip()
        return f"{boot}:{fields[19].decode('ascii')}"
    except (OSError, IndexError, ValueError):
        return ""


def own_token() -> str:
    """The token of this process."""
    return start_token(os.getpid())


def runs(pid: int, token: str) -> bool:
    """Whether the process of that number and token runs; False where that is unknown."""
    return bool(token) and start_token(pid) == token
