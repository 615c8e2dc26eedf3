"""Programs run by a Python of their own, from the root of the repository."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def run_program(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """What it printed; it must not fail."""
    return subprocess.run(
        [sys.executable, "-c", program, *arguments],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
        timeout=60,
    )


def kill_program(program: str, *arguments: str, says: str, after_s: float = 0.0) -> None:
    """Kill it without a warning, some time after its first line."""
    command = [sys.executable, "-c", program, *arguments]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        try:
            assert child.stdout.readline() == f"{says}\n"
            time.sleep(after_s)
        finally:
            child.kill()
        assert child.wait(10) == -signal.SIGKILL
