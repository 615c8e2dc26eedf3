"""Ends `imagechain run` at random moments, and looks at what is left.

    python tests/fuzz/kills.py --count 200 --seed 1

Each trial starts a run of the Kodak KIR-310 over the files of another run of it, sends SIGKILL,
SIGTERM or SIGINT, and then lets a run come to its end. Of ten trials three count the moment from
the start, four from the first file that is written, three from the first that is put in its place;
in the run's own processor time, so that the moments are spread over it however busy the machine is.
A trial fails if a file is neither the whole old one nor the whole new one, if what the exit code
and stderr say is not true, if a traceback is printed, or if the last run leaves anything hidden.
"""

import argparse
import collections
import contextlib
import io
import json
import math
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# A script beside this one is named like the package of the shipped networks: the root comes first.
sys.path.insert(0, str(ROOT))

from app.command.cli import main  # noqa: E402

CANCELLED = "imagechain: cancelled; nothing was written\n"
SIZE = ("scene.width=128", "scene.height=128", "frame_grabber.width=80", "frame_grabber.height=80")
VARIANTS = ("aberration.sigma_x_mrad=0.1", "aberration.sigma_x_mrad=0.3")
SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
FILES = ("out/final.png", "out/mtf.csv", "out/readouts.json", "saved.npy")
REPORTS = ("report.json", "report.html")
LONGEST_S = 600.0
# After which moment, in how many of ten trials, and how long at most: a run's processor time from
# there to its end, measured; None for the whole of it.
MOMENTS: dict[str, tuple[int, float | None]] = {
    "of the start": (3, None),
    "of writing": (4, 0.15),
    "of putting in place": (3, 0.01),
}


class Kills:
    """Trials in an empty folder; every so many (`pages`) of them write an .html report too."""

    def __init__(self, folder: Path, seed: int, pages: int) -> None:
        self.folder = folder
        self.random = random.Random(seed)
        self.pages = pages
        self.found: collections.Counter[str] = collections.Counter()
        self.whole: list[dict[str, bytes]] = []
        for variant in range(len(VARIANTS)):
            self._finish(variant)
            self.whole.append(self._files())
        self.seconds = self._measured()
        assert all(self.whole[0][name] != self.whole[1][name] for name in FILES)

    def trial(self, number: int) -> list[str]:
        """Carry out one trial; what is wrong afterwards."""
        page = self.pages > 0 and number % self.pages == 0
        variant = 1 - self.last
        (moment,) = self.random.choices(list(MOMENTS), [share for share, _ in MOMENTS.values()])
        ending = self.random.choice(SIGNALS)
        longest = MOMENTS[moment][1] or self.seconds * (2 if page else 1)
        after = self.random.uniform(0, longest)
        before = self._reports()
        process = self._started(self._words(variant, page=page))
        self._wait(process, moment, after)
        started = _has_begun(process.pid)
        process.send_signal(ending)
        _, line = process.communicate(timeout=LONGEST_S)
        reported = self._reports() != before
        wrong = self._outcome(variant, ending, process.returncode, line, started, reported)
        self._finish(variant)
        hidden = [path.name for path in self.folder.rglob(".*")]
        if hidden:
            wrong.append(f"the next run leaves {hidden}")
        if self._files() != self.whole[variant]:
            wrong.append("the next run does not write what it should")
        with_page = ", with a page" if page else ""
        told = f"trial {number}: {ending.name} {after:.4f} s {moment}{with_page}"
        return [f"{told}: {each}" for each in wrong]

    def _words(self, variant: int, *, page: bool = False) -> list[str]:
        sets = [word for text in (*SIZE, VARIANTS[variant]) for word in ("--set", text)]
        reports = REPORTS if page else REPORTS[:1]
        more = [word for name in reports for word in ("--report", name)]
        save = ["--save", "electronics.image=saved.npy", "--output-dir", "out"]
        return ["run", "kodak_kir310", *sets, *save, *more]

    def _started(self, words: list[str]) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "app.command.cli", *words]
        quiet, told = subprocess.DEVNULL, subprocess.PIPE
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        return subprocess.Popen(
            command, cwd=self.folder, env=environment, stdout=quiet, stderr=told, text=True
        )

    def _wait(self, process: subprocess.Popen[str], moment: str, after: float) -> None:
        """Until the moment, and so much of the run's own processor time after it."""
        last, before = time.monotonic() + LONGEST_S, self._inodes()
        reached = {
            "of the start": lambda: True,
            "of writing": self._writes,
            "of putting in place": lambda: self._inodes() != before,
        }[moment]
        while process.poll() is None and not reached() and time.monotonic() < last:
            time.sleep(0.0002)
        begun = 0.0 if moment == "of the start" else _processor_s(process.pid)
        while process.poll() is None and _processor_s(process.pid) < begun + after:
            time.sleep(0.0002)

    def _measured(self) -> float:
        """How much processor time a run takes in a process of its own."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        process = self._started(self._words(self.last))
        _, told = process.communicate(timeout=LONGEST_S)
        assert process.returncode == 0, told
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def _outcome(
        self, variant: int, ending: signal.Signals, code: int, line: str, started: bool,
        reported: bool,
    ) -> list[str]:  # fmt: skip
        """What is not as it should be of a run that was disturbed."""
        files, old, new = self._files(), self.whole[1 - variant], self.whole[variant]
        wrong = [f"{name} is torn" for name in FILES if files[name] not in (old[name], new[name])]
        wrong += self._torn_reports()
        if code == 0:
            self.found["done"] += 1
            if line or files != new or not reported:
                wrong.append(f"it says that it is done, and {line!r}")
        elif code == 1 and line == CANCELLED:
            self.found["cancelled"] += 1
            if files != old or reported:
                wrong.append("it says that nothing was written")
        elif code == -ending and not line:
            self.found[f"ended by {ending.name}"] += 1
        elif ending == signal.SIGINT and not started:
            self.found["ended by Python's own start"] += 1  # before any line of ours
        else:
            wrong.append(f"exit code {code}, {line!r}")
        if files not in (old, new):
            self.found["of these, with old and new files"] += 1
            if ending != signal.SIGKILL:
                wrong.append("some files are old, some new")
        return wrong

    def _torn_reports(self) -> list[str]:
        wrong = []
        try:
            json.loads((self.folder / REPORTS[0]).read_bytes())
        except ValueError:
            wrong.append("the report is torn")
        page = self.folder / REPORTS[1]
        if page.exists() and not page.read_bytes().rstrip().endswith(b"</html>"):
            wrong.append("the page is torn")
        return wrong

    def _finish(self, variant: int) -> None:
        """A run that nobody disturbs, in this process: that is quicker."""
        told = io.StringIO()
        with (
            contextlib.chdir(self.folder),
            contextlib.redirect_stdout(told),
            contextlib.redirect_stderr(told),
        ):
            code = main(self._words(variant))
        if code:
            raise RuntimeError(f"a run that nobody disturbs fails: {told.getvalue()}")
        self.last = variant

    def _files(self) -> dict[str, bytes]:
        return {name: (self.folder / name).read_bytes() for name in FILES}

    def _reports(self) -> tuple[int, ...]:
        """What tells the present reports from those written later."""
        paths = [self.folder / name for name in REPORTS]
        return tuple(path.stat().st_ino for path in paths if path.exists())

    def _inodes(self) -> list[int]:
        """Which files are there, 0 for none: one put in the place of another is another."""
        found = []
        for name in FILES:
            try:
                found.append((self.folder / name).stat().st_ino)
            except FileNotFoundError:
                found.append(0)
        return found

    def _writes(self) -> bool:
        places = (self.folder, self.folder / "out")
        found = (path.name for place in places for path in place.iterdir())
        return any(name.startswith(".imagechain-") for name in found)


def _processor_s(pid: int) -> float:
    """Seconds that all threads of a process have computed; endless when it has ended."""
    with contextlib.suppress(OSError):
        return time.clock_gettime(~pid << 3 | 2)  # clock_getcpuclockid(3), which Python lacks
    return math.inf


def _has_begun(pid: int) -> bool:
    """Whether a process catches SIGTERM, as the command does from its first line on."""
    with contextlib.suppress(OSError):
        for text in Path(f"/proc/{pid}/status").read_text().splitlines():
            if text.startswith("SigCgt:"):
                return bool(int(text.split()[1], 16) >> (signal.SIGTERM - 1) & 1)
    return True


def command() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--count", type=int, default=200, help="trials (default: 200)")
    parser.add_argument("--seed", type=int, default=1, help="of the random moments (default: 1)")
    parser.add_argument("--pages", type=int, default=10,
                        help="every so many write a page too (default: 10; 0: none)")  # fmt: skip
    words = parser.parse_args()
    wrong: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        trials = Kills(Path(name), words.seed, words.pages)
        for number in range(1, words.count + 1):
            wrong += trials.trial(number)
            if number % 20 == 0 or number == words.count:
                told = ", ".join(f"{what} {n}" for what, n in sorted(trials.found.items()))
                print(f"{number} trials: {told}; faults {len(wrong)}", flush=True)
    print("\n".join(wrong) or "no faults")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(command())
