"""Of many variations of one check some run each time, and all with `--thorough`."""

import sys

import pytest

from child_process import finished

LEFT_OUT = "5 variations left out: --thorough runs them too"


@pytest.mark.thorough(but=3, always=("sample6", "mple2"))
@pytest.mark.parametrize("number", range(9), ids="sample{}".format)
def test_one_of_nine(number):
    """For the runs below."""


@pytest.mark.thorough
def test_only_when_wanted():
    """For the runs below."""


@pytest.mark.parametrize("workers", ["0", "1"])
def test_a_run_counts_what_it_leaves_out(workers):
    lines = of_those(__file__, "-vv", "-n", workers)
    assert LEFT_OUT in lines
    passed = [line for line in lines if "PASSED" in line]
    samples = [number for number in range(9) if f"sample{number}]" in "".join(passed)]
    assert samples == [0, 2, 4, 6, 8]
    assert len(passed) == 5


def test_nothing_is_left_out_where_it_is_wanted():
    lines = of_those(__file__, "-n", "0", "--thorough")
    assert LEFT_OUT not in lines
    assert lines[-1].startswith("10 passed")


def test_nothing_is_left_out_where_it_is_named():
    lines = of_those(f"{__file__}::test_only_when_wanted", "-n", "0")
    assert LEFT_OUT not in lines
    assert lines[-1].startswith("1 passed")


def of_those(*words):
    """What a run of the examples of this file prints."""
    python = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    done = finished([*python, "-k", "one_of_nine or only_when", *words])
    assert done.returncode == 0, done.stdout
    return done.stdout.splitlines()
