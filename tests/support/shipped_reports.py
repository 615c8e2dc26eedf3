"""Both reports of a shipped network, made once for all tests of a run."""

import contextlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from command_line import run_here

try:
    import fcntl
except ImportError:  # not on this system: each process of the tests makes its own
    fcntl = None  # type: ignore[assignment]


@dataclass(frozen=True)
class Reports:
    """What ``imagechain run NETWORK --report r.json --report r.html`` wrote."""

    facts: dict[str, Any]
    page: str


def reports_of(network: str, folder: Path) -> Reports:
    """Run the network as it is shipped, if none of the processes of these tests has yet."""
    with _alone(folder / f"{network}.lock"):
        files = [folder / f"{network}.json", folder / f"{network}.html"]
        if not all(file.exists() for file in files):
            words = [f"--report={file}" for file in files]
            out = folder / f"{network}.out"
            done = run_here("run", network, f"--output-dir={out}", *words, folder=folder)
            assert (done.returncode, done.stderr) == (0, "")
        facts, page = (file.read_text(encoding="utf-8") for file in files)
    return Reports(json.loads(facts), page)


@contextlib.contextmanager
def _alone(file: Path) -> Iterator[None]:
    with file.open("w") as lock:
        if fcntl is not None:
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield
