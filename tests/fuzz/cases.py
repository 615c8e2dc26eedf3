"""Numbered cases drawn from a seed, carried out in processes that may crash, hang or fill memory.

A fuzzer gives a function from a case to a verdict and calls `command`. Case N of seed S is the same
whatever is run before it: `--seed S --case N` repeats it alone, in the process itself.
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

LIMIT_S = 60.0  # of processor time: how much else the machine does changes no verdict
PROGRESS_S = 60.0
WAITING = 10  # times as long by the clock, for what waits for ever
_TICKS = os.sysconf("SC_CLK_TCK")
MEMORY = 6 * 2**30  # bytes of address space of a worker; threads' stacks are part of it
CASES_PER_WORKER = 1000  # a worker is then replaced, so that no leak adds up over a night
SIGNALS = (signal.SIGHUP, signal.SIGINT, signal.SIGTERM, signal.SIGPIPE)


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


@dataclass(frozen=True)
class Verdict:
    """What came of a case: what it counted, and the finding, empty where there is none."""

    number: int
    counts: dict[str, int]
    finding: str = ""


Try = Callable[[Case], None]


def memory_folder() -> str | None:
    """A folder in memory, where flushing a file costs nothing; None for the usual one."""
    folder = "/dev/shm"
    there = "TMPDIR" not in os.environ and os.access(folder, os.W_OK | os.X_OK)
    return folder if there and shutil.disk_usage(folder).free > MEMORY else None


def command(
    script: str,
    about: str,
    attempt: Try,
    *,
    count: int,
    limit_s: float = LIMIT_S,
    folder: str | None = None,
) -> int:
    """Carry out a fuzzer's command line; gives its exit code, 1 where there are findings.

    The cases' own folders lie in `folder`, by default where temporary files usually do.
    """
    parser = argparse.ArgumentParser(description=about)
    parser.add_argument("--count", type=int, default=count, help=f"cases (default {count})")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default 1)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
    parser.add_argument("--workers", type=int, default=1, help="processes (default 1)")
    parser.add_argument("--case", type=int, help="carry out this case alone, in this process")
    parser.add_argument("--keep", type=Path, help="with --case: keep its files in this folder")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    words = parser.parse_args()
    if words.serve:
        _serve(attempt, words.seed)
        return 0
    if words.case is not None:
        verdict = _alone(attempt, words.seed, words.case, words.keep, folder)
        print(verdict.finding or "no finding", dict(verdict.counts))
        return 1 if verdict.finding else 0
    numbers = iter(range(words.first, words.first + words.count))
    program = [sys.executable, "-X", "faulthandler", script, "--serve", "--seed", str(words.seed)]
    start = told = time.monotonic()
    verdicts = []
    for verdict in carried_out(program, numbers, words.workers, limit_s, folder):
        verdicts.append(verdict)
        if verdict.finding:
            repeat = f"{Path(script).name} --seed {words.seed} --case {verdict.number}"
            print(f"FINDING {repeat}: {verdict.finding}", flush=True)
        if time.monotonic() - told > PROGRESS_S:
            told = time.monotonic()
            print(f"… {len(verdicts)} cases", flush=True)
    _print_table(verdicts, time.monotonic() - start)
    return 1 if any(verdict.finding for verdict in verdicts) else 0


def carried_out(
    program: list[str],
    numbers: Iterator[int],
    workers: int,
    limit_s: float,
    folder: str | None = None,
) -> Iterator[Verdict]:
    """The verdicts of the cases as they come; a crash and a hang are verdicts, too."""
    pool = [_Worker(program, limit_s, folder) for _ in range(workers)]
    try:
        busy = [worker for worker in pool if worker.begin_next(numbers)]
        while busy:
            ready, _, _ = select.select([worker.output for worker in busy], [], [], 0.5)
            for worker in tuple(busy):
                verdict = worker.verdict(worker.output in ready)
                if verdict is not None:
                    yield verdict
                    if not worker.begin_next(numbers):
                        busy.remove(worker)
    finally:
        for worker in pool:
            worker.end()
            worker.clean()


class _Worker:
    """A process that takes numbers of cases and gives their verdicts, one line each."""

    def __init__(self, program: list[str], limit_s: float, folder: str | None) -> None:
        self._program = program
        self._limit_s = limit_s
        self._process: subprocess.Popen[bytes] | None = None
        self._left = 0
        self._number = -1
        # What a case that is killed has in its folder goes with the folder.
        self._folder = tempfile.TemporaryDirectory(
            prefix="fuzz-", dir=folder, ignore_cleanup_errors=True
        )
        self._said = tempfile.TemporaryFile()  # noqa: SIM115
        self._begun = self._spent = 0.0

    @property
    def output(self) -> int:
        assert self._process is not None
        assert self._process.stdout is not None
        return self._process.stdout.fileno()

    def begin_next(self, numbers: Iterator[int]) -> bool:
        number = next(numbers, None)
        if number is None:
            return False
        if self._process is None or not self._left:
            self.end()
            self._start()
        assert self._process is not None
        assert self._process.stdin is not None
        self._number = number
        self._left -= 1
        with contextlib.suppress(BrokenPipeError):  # it has ended: seen when its verdict is read
            self._process.stdin.write(f"{number}\n".encode())
            self._process.stdin.flush()
        self._begun, self._spent = time.monotonic(), self._processor_time()
        return True

    def verdict(self, ready: bool) -> Verdict | None:
        assert self._process is not None
        assert self._process.stdout is not None
        if ready:
            line = self._process.stdout.readline()
            if line.endswith(b"\n"):
                return Verdict(self._number, **json.loads(line))
            code = self._process.wait(self._limit_s)
            return self._lost(f"the process ended with {code}")
        spent = self._processor_time() - self._spent
        waited = time.monotonic() - self._begun
        if spent >= self._limit_s or waited >= WAITING * self._limit_s:
            # So that faulthandler writes where every thread stands.
            self._process.send_signal(signal.SIGABRT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(5)
            told = f"{spent:.1f} s of processor time, {waited:.1f} s by the clock"
            return self._lost(f"not done after {told}")
        return None

    def _processor_time(self) -> float:
        """Seconds that all threads of the process have computed."""
        assert self._process is not None
        with contextlib.suppress(OSError):
            stat = Path(f"/proc/{self._process.pid}/stat").read_bytes()
            user, system = stat.rpartition(b")")[2].split()[11:13]
            return (int(user) + int(system)) / _TICKS
        return 0.0

    def end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def clean(self) -> None:
        self._said.close()
        self._folder.cleanup()

    def _start(self) -> None:
        self._said.seek(0)
        self._said.truncate()
        self._process = subprocess.Popen(
            self._program,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            env={**os.environ, "TMPDIR": self._folder.name},
            start_new_session=True,
        )
        self._left = CASES_PER_WORKER

    def _lost(self, what: str) -> Verdict:
        self.end()
        self._said.seek(0)
        trace = " | ".join(self._said.read().decode(errors="replace").split("\n"))
        return Verdict(self._number, {"lost": 1}, f"{what}: {trace[:2000]}")


def _serve(attempt: Try, seed: int) -> None:
    """Carry out the cases whose numbers come on standard input."""
    default_signals()
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # Whatever a case prints goes elsewhere than the verdicts.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        verdict = _alone(attempt, seed, int(line))
        answers.write(
            json.dumps({"counts": dict(verdict.counts), "finding": verdict.finding}) + "\n"
        )
        answers.flush()


def _alone(
    attempt: Try, seed: int, number: int, keep: Path | None = None, within: str | None = None
) -> Verdict:
    """Carry out one case in a folder of its own, the present one meanwhile."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-", dir=within)) if keep is None else keep.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    case = Case(seed, number, folder)
    finding = ""
    try:
        with contextlib.chdir(folder):
            attempt(case)
    except FindingError as error:
        finding = str(error)
    except Exception as error:
        finding = f"{type(error).__name__} in the fuzzer's own process: {error} {_place(error)}"
    finally:
        if keep is None:
            shutil.rmtree(folder, ignore_errors=True)
    return Verdict(number, dict(case.counts), finding)


def _place(error: BaseException) -> str:
    """The innermost lines of the traceback."""
    import traceback

    frames = traceback.extract_tb(error.__traceback__)[-3:]
    return " < ".join(f"{Path(f.filename).name}:{f.lineno} {f.name}" for f in reversed(frames))


def default_signals() -> None:
    """Let signals end the process as usual, also where the caller ignores them, as nohup does."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _print_table(verdicts: list[Verdict], seconds: float) -> None:
    counts: Counter[str] = Counter()
    for verdict in verdicts:
        counts.update(verdict.counts)
    rows = [
        ("cases", len(verdicts)),
        *sorted(counts.items()),
        ("findings", sum(bool(verdict.finding) for verdict in verdicts)),
    ]
    width = max(len(name) for name, _ in rows)
    for name, number in rows:
        print(f"{name:<{width}}  {number:>9,}")
    print(f"{'seconds':<{width}}  {seconds:>9,.0f}")
