"""The frame of the fuzzers: what a case may do, and the verdict that comes of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parent
SCRIPT = """
import os, signal, sys, time
sys.path.insert(0, {fuzz!r})
from cases import command

def attempt(case):
    case.counts["tried"] += 1
    {does}

sys.exit(command(__file__, "about", attempt, count=3, limit_s={limit_s}))
"""


@pytest.fixture
def fuzz(tmp_path):
    """Run a fuzzer whose cases do this; gives its exit code and what it prints."""

    def run(does, *words, limit_s=60.0):
        script = tmp_path / "fuzzer.py"
        script.write_text(SCRIPT.format(fuzz=str(FUZZ), does=does, limit_s=limit_s))
        done = subprocess.run(
            [sys.executable, script, *words],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.stderr == ""
        return done.returncode, done.stdout

    return run


def figures(out):
    """The table at the end."""
    rows = (line.rsplit(maxsplit=1) for line in out.splitlines() if "FINDING" not in line)
    return {row[0]: int(row[1].replace(",", "")) for row in rows if len(row) == 2}


def test_good_cases_are_counted(fuzz):
    code, out = fuzz("print('to nobody')", "--count", "5", "--workers", "2")
    assert code == 0
    table = figures(out)
    assert (table["cases"], table["tried"], table["findings"]) == (5, 5, 0)


@pytest.mark.parametrize(
    ("does", "told"),
    [
        ("case.expect(case.number != 1, 'it is one')", "it is one"),
        ("assert case.number != 1, 'one'", "AssertionError"),
        ("case.number == 1 and sys.exit(3)", "ended with 3"),
        ("case.number == 1 and os.kill(os.getpid(), signal.SIGSEGV)", "ended with -11"),
        ("case.number == 1 and bytearray(10**13)", "MemoryError"),
    ],
)
def test_a_finding_is_told_with_its_number_and_the_rest_goes_on(fuzz, does, told):
    code, out = fuzz(does, "--seed", "4")
    assert code == 1
    (line,) = [line for line in out.splitlines() if line.startswith("FINDING")]
    assert line.startswith("FINDING fuzzer.py --seed 4 --case 1: ")
    assert told in line
    table = figures(out)
    assert (table["cases"], table["findings"]) == (3, 1)


@pytest.mark.parametrize("does", ["time.sleep(3600)", "exec('while True: pass')"])
def test_a_case_that_hangs_is_ended(fuzz, does):
    code, out = fuzz(does, "--count", "1", limit_s=0.3)
    assert code == 1
    assert "not done after" in out
    assert "Fatal Python error: Aborted" in out  # where every thread stood


def test_a_case_is_the_same_alone_and_among_others(fuzz):
    does = "case.expect(False, str(case.random.random()))"
    _, out = fuzz(does)
    among = [line.rsplit(": ", 1)[1] for line in out.splitlines() if "FINDING" in line]
    assert len(set(among)) == 3
    for number, drawn in enumerate(among):
        code, alone = fuzz(does, "--case", str(number))
        assert code == 1
        assert alone.startswith(drawn)


def test_a_case_has_an_empty_folder_that_does_not_stay(fuzz, tmp_path):
    does = f"open('{tmp_path}/log', 'a').write(os.getcwd() + str(os.listdir()) + chr(10))"
    code, _ = fuzz(does)
    assert code == 0
    for line in (tmp_path / "log").read_text().splitlines():
        folder, _, held = line.partition("[")
        assert held == "]"
        assert not Path(folder).exists()


def test_its_files_can_be_kept(fuzz, tmp_path):
    code, _ = fuzz("open('a', 'w').write('b')", "--case", "0", "--keep", str(tmp_path / "kept"))
    assert code == 0
    assert (tmp_path / "kept" / "a").read_text() == "b"
