"""Kills `imagechain study` at random moments, starts it again, and looks at its rows.

    python tests/fuzz/study_kills.py --count 20 --seed 1 --jobs 2

A study of some hundred points over the Kodak KIR-310's optics and noise is begun, ended by SIGKILL
at a random moment, and begun again with the same words, until it has been killed so often and at
last comes to its end. Wrong is: an output that differs from an undisturbed study's in more than its
seconds, a row that had been kept and was computed again, a traceback, or a
file that is left over.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OUTPUT, JOURNAL = "rows.csv", "rows.csv.journal"
WORDS = [
    *("study", "kodak_kir310", "--set", "scene.width=64", "--set", "scene.height=64"),
    *("--set", "frame_grabber.width=32", "--set", "frame_grabber.height=32"),
    *("--vary", "aberration.sigma_x_mrad=0.05:0.5:30"),
    *("--vary", "electronics.amplifier_snr=20:200:20"),
    *("--figure", "electronics.snr", "--figure", "electronics.netd_system_K"),
    *("--save", "pixels.image=pictures/{point}.npy"),
]
LONGEST_S = 600.0


def kills(count: int, seed: int, jobs: int) -> list[str]:
    """Kill a study so many times; what is wrong."""
    moments = random.Random(seed)
    wrong: list[str] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "whole").mkdir()
        (folder / "killed").mkdir()
        begun = time.monotonic()
        _finish(folder / "whole", jobs)
        longest = time.monotonic() - begun
        whole = _rows(folder / "whole" / OUTPUT)
        place, killed, kept = folder / "killed", 0, {}
        while killed < count:
            # Most moments of a go are short after its start, so that it is killed that often.
            after = moments.uniform(0.0, longest * 0.3)
            code, line = _killed(place, jobs, after)
            wrong += [f"kill {killed + 1}, {after:.2f} s: {line}"] if line else []
            killed += code != 0
            if (place / OUTPUT).exists():  # the end, even if it was killed right behind it
                wrong += _differences(whole, _rows(place / OUTPUT), kept)
                for file in place.iterdir():
                    if file.is_file():
                        file.unlink()
                kept = {}
                continue
            now = _journal(place / JOURNAL)
            lost = [row for row, took in kept.items() if now.get(row) != took]
            wrong += [f"kill {killed}: {len(lost)} rows are lost or computed again"] if lost else []
            kept = now
            print(f"kill {killed} after {after:.2f} s: {len(kept)} rows", flush=True)
        _finish(place, jobs)
        wrong += _differences(whole, _rows(place / OUTPUT), kept)
        pictures = [sorted((folder / f / "pictures").iterdir()) for f in ("whole", "killed")]
        if [p.name for p in pictures[0]] != [p.name for p in pictures[1]]:
            wrong.append("other pictures are there")
        elif any(a.read_bytes() != b.read_bytes() for a, b in zip(*pictures, strict=True)):
            wrong.append("pictures differ")
        left = sorted(file.name for file in place.iterdir())
        wrong += [] if left == ["pictures", OUTPUT] else [f"left over: {left}"]
    return wrong


def _command(jobs: int) -> list[str]:
    return [sys.executable, "-m", "app.command.cli", *WORDS, "--output", OUTPUT, f"--jobs={jobs}"]


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def _finish(folder: Path, jobs: int) -> None:
    done = subprocess.run(
        _command(jobs), cwd=folder, env=_environment(), capture_output=True, text=True,
        timeout=LONGEST_S, check=False,
    )  # fmt: skip
    if done.returncode or done.stderr:
        raise RuntimeError(f"a study that nobody disturbs: {done.returncode}, {done.stderr}")


def _killed(folder: Path, jobs: int, after: float) -> tuple[int, str]:
    """Exit code, and what it printed, of a study that is killed some time after its first row."""
    process = subprocess.Popen(
        _command(jobs), cwd=folder, env=_environment(), stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    end = time.monotonic() + LONGEST_S
    journal = folder / JOURNAL
    before = journal.stat().st_size if journal.exists() else 0
    while process.poll() is None and time.monotonic() < end:
        if journal.exists() and journal.stat().st_size > max(before, 200):
            break
        time.sleep(0.002)
    moment = time.monotonic() + after
    while process.poll() is None and time.monotonic() < moment:
        time.sleep(0.001)
    if process.poll() is None:
        process.send_signal(signal.SIGKILL)
    _, line = process.communicate(timeout=LONGEST_S)
    return process.returncode, line


def _rows(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))


def _journal(path: Path) -> dict[int, float]:
    """The seconds of each row that is whole."""
    rows = {}
    for line in path.read_bytes().splitlines(keepends=True)[1:]:
        if line.endswith(b"\n"):
            entry = json.loads(line.partition(b" ")[2])
            rows[entry[0] + 1] = entry[3]
    return rows


def _differences(
    whole: list[list[str]], rows: list[list[str]], kept: dict[int, float]
) -> list[str]:
    place = whole[0].index("seconds (s)")
    wrong = []
    if len(rows) != len(whole):
        wrong.append(f"{len(rows)} rows for {len(whole)}")
    for one, other in zip(whole, rows, strict=False):
        if one[:place] + one[place + 1 :] != other[:place] + other[place + 1 :]:
            wrong.append(f"{other} in the place of {one}")
    again = [p for p, took in kept.items() if float(rows[p][place]) != took]
    return [*wrong, *([f"rows {again} were computed again"] if again else [])]


def command() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--count", type=int, default=20, help="kills (default: 20)")
    parser.add_argument("--seed", type=int, default=1, help="of the random moments (default: 1)")
    parser.add_argument("--jobs", type=int, default=1, help="processes (default: 1)")
    words = parser.parse_args()
    wrong = kills(words.count, words.seed, words.jobs)
    print("\n".join(wrong) or "no faults")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(command())
