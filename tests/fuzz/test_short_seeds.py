"""A short seed of each fuzzer, by the command that carries out a long one."""

import sys

import pytest

from child_process import ROOT, finished

SEEDS = {
    "networks": ("--count 10 --seed 2", "cases 10 "),
    "kills": ("--count 4 --seed 7 --pages 0", "; faults 0 no faults"),
    "window_sessions": ("--count 1 --first 3 --actions 60", "1 sessions of 60 actions, 0 wrong"),
    "pictures": ("--count 120 --seed 7", " refused "),
    "shrinking_files": ("--count 80 --seed 3", ": refused "),  # one at least was cut in time
}


@pytest.mark.parametrize("name", SEEDS)
def test_nothing_is_found(name, tmp_path):
    words, told = SEEDS[name]
    script = str(ROOT / "tests" / "fuzz" / f"{name}.py")
    done = finished([sys.executable, script, *words.split()], folder=tmp_path)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert told in " ".join(done.stdout.split())
    numbers = [f"--seed 2 --first {number}" for number in range(10)]
    if name != "window_sessions":
        assert done.stderr.splitlines() == (numbers if name == "networks" else [])
