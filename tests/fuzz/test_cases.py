"""The frame of the fuzzers: a finding is told with its number, and the rest goes on."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import os, signal, sys, time
sys.path.insert(0, {fuzz!r})
from cases import command

def attempt(case):
    assert not list(case.folder.iterdir())
    {does}

sys.exit(command("about", attempt, count=3, limit_s=1.0))
"""


def fuzz(does, *words):
    script = SCRIPT.format(fuzz=str(Path(__file__).parent), does=does)
    return subprocess.run(
        [sys.executable, "-c", script, *words], capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    ("does", "told"),
    [
        ("case.expect(case.number != 1, 'it is one')", "it is one"),
        ("case.number == 1 and bytearray(10**13)", "MemoryError"),
    ],
)
def test_a_finding_is_told_with_its_number_and_the_rest_goes_on(does, told):
    done = fuzz(does, "--seed", "4")
    assert done.returncode == 1
    (line,) = [line for line in done.stdout.splitlines() if line.startswith("FINDING")]
    assert line.startswith("FINDING --seed 4 --first 1: ")
    assert told in line
    assert "cases 3 findings 1" in " ".join(done.stdout.split())


def test_a_case_that_hangs_is_ended():
    done = fuzz("time.sleep(3600)")
    assert done.returncode == 1
    assert "in attempt" in done.stderr  # where it stood


def test_a_case_is_the_same_alone_and_among_others():
    does = "case.expect(False, str(case.random.random()))"
    among = [line for line in fuzz(does).stdout.splitlines() if "FINDING" in line]
    assert len({line.split()[-1] for line in among}) == 3
    assert fuzz(does, "--first", "2", "--count", "1").stdout.startswith(among[2])
