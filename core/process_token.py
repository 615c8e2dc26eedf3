"""Telling whether a process still runs, though its number may have been given to another since."""

from __future__ import annotations

import os
from pathlib import Path

_PROC = Path("/proc")


def start_token(pid: int) -> str:
    """What distinguishes a process from a later one of the same number; empty where unknown.

    On Linux, the boot and the time within it at which the process began.
    """
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
