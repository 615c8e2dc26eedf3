"""Numbered cases drawn from a seed, each in a folder of its own.

A fuzzer gives a function from a case to a verdict and calls `command`. Case N of seed S is the same
whatever is run before it: `--seed S --first N --count 1` repeats it alone. A case that hangs, fills
memory or crashes ends the command; it has said its number, and says where every thread stood.
"""

import argparse
import contextlib
import faulthandler
import os
import resource
import shutil
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

LIMIT_S = 600.0
MEMORY = 6 * 2**30  # bytes of address space; threads' stacks are part of it


class FindingError(AssertionError):
    """Something that must not happen; the message says what."""


@dataclass
class Case:
    """One case: its own random numbers, an empty folder, and what it counts for the table."""

    seed: int
    number: int
    folder: Path
    counts: Counter[str] = field(default_factory=Counter)

    @property
    def random(self) -> Random:
        """The case's random numbers, from their beginning."""
        return Random(f"{self.seed}/{self.number}")

    def expect(self, good: bool, message: str) -> None:
        """Raise a finding unless it is good."""
        if not good:
            raise FindingError(message)


Try = Callable[[Case], None]


def memory_folder() -> str | None:
    """A folder in memory, where flushing a file costs nothing; None for the usual one."""
    folder = "/dev/shm"
    there = "TMPDIR" not in os.environ and os.access(folder, os.W_OK | os.X_OK)
    return folder if there and shutil.disk_usage(folder).free > MEMORY else None


def command(
    about: str, attempt: Try, *, count: int, limit_s: float = LIMIT_S, folder: str | None = None
) -> int:
    """Carry out a fuzzer's command line; gives its exit code, 1 where there are findings.

    The cases' own folders lie in `folder`, by default where temporary files usually do.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--count", type=int, default=count, help=f"cases (default {count})")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default 1)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
    words = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    start, counts = time.monotonic(), Counter[str]()
    for number in range(words.first, words.first + words.count):
        print(f"--seed {words.seed} --first {number}", end="\r", file=sys.stderr, flush=True)
        faulthandler.dump_traceback_later(limit_s, exit=True)
        finding = _finding(attempt, words.seed, number, folder, counts)
        if finding:
            counts["findings"] += 1
            print(f"FINDING --seed {words.seed} --first {number}: {finding}", flush=True)
    faulthandler.cancel_dump_traceback_later()
    figures = {"cases": words.count, **dict(sorted(counts.items())), "findings": counts["findings"]}
    for name, value in {**figures, "seconds": round(time.monotonic() - start)}.items():
        print(f"{name:<40}  {value:>9,}")
    return 1 if counts["findings"] else 0


def _finding(
    attempt: Try, seed: int, number: int, within: str | None, counts: Counter[str]
) -> str | None:
    """Carry out one case in a folder of its own, the present one meanwhile; what it found."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-", dir=within))
    case = Case(seed, number, folder, counts)
    try:
        with contextlib.chdir(folder):
            attempt(case)
    except FindingError as error:
        return str(error)
    except Exception as error:
        place = traceback.extract_tb(sys.exc_info()[2])[-1]
        return f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    return None
