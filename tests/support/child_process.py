"""Programs run by a Python of their own, from the root of the repository."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PATIENCE_S = 900.0
"""When a wait is given up: far beyond what a busy machine takes, so that no verdict hangs on it."""

PEAK = (
    "lines = open('/proc/self/status').read().splitlines()\n"
    "print(next(line.split()[1] for line in lines if line.startswith('VmHWM')))"
)
"""Lines of Python that print the peak memory of their process, kB: its own, where `ru_maxrss` of a
child begins with that of its parent."""

_TO_STOP = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")


def let_children_be_stopped() -> None:
    """Start children with the signals' default effects, also where they are ignored here.

    As by ``nohup`` or for the background job of a script. A handler that does nothing goes on
    ignoring the signal in this process; a new program begins with the default in its place.
    """
    for name in _TO_STOP:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == signal.SIG_IGN:
            signal.signal(number, lambda *_: None)


def wait_for(
    condition: Callable[[], object],
    what: str,
    *,
    child: subprocess.Popen[str] | subprocess.Popen[bytes] | None = None,
    seconds: float = PATIENCE_S,
) -> None:
    """Wait until something is so; a child that ends meanwhile ends the wait."""
    end = time.monotonic() + seconds
    while not condition():
        if child is not None and child.poll() is not None:
            raise AssertionError(f"the process ended before {what}: {child.communicate()}")
        assert time.monotonic() < end, f"waited {seconds:g} s in vain: {what}"
        time.sleep(0.02)


def catches(pid: int, number: int) -> bool:
    """Whether a process has a handler of its own for a signal."""
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
    return bool(int(caught.split()[1], 16) >> (number - 1) & 1)


def finished(
    command: Sequence[str], *, folder: Path = ROOT, env: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """How a command ended, and what it printed."""
    return subprocess.run(
        command,
        cwd=folder,
        env=env,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )


def run_program(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """What it printed; it must not fail."""
    done = finished([sys.executable, "-c", program, *arguments])
    assert done.returncode == 0, done.stderr
    return done


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
        assert child.wait(PATIENCE_S) == -signal.SIGKILL
