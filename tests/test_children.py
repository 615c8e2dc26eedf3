"""Children of the tests can be stopped, however the tests were started."""

import subprocess
import sys

import pytest

from child_process import PATIENCE_S, ROOT

IGNORED = "print(next(l for l in open('/proc/self/status') if l.startswith('SigIgn')).split()[1])"
STOPPING = {1, 2, 3, 15}  # hang up, interrupt, quit, terminate


def ignored():
    """The signals that a child of this process ignores from its start."""
    # Python's own choices, the broken pipe among them, are not those of a child: no site, no main.
    told = subprocess.run(
        [sys.executable, "-S", "-c", IGNORED],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE_S,
    )
    mask = int(told.stdout, 16)
    return {number for number in range(1, 65) if mask >> (number - 1) & 1}


def test_a_child_ignores_no_signal_to_stop():
    assert not ignored() & STOPPING


@pytest.mark.parametrize("started", ["nohup", "trap '' INT QUIT;"])
def test_nor_where_the_tests_were_started_with_them_ignored(started):
    """As in the background, or to outlive the terminal."""
    test = f"{__file__}::{test_a_child_ignores_no_signal_to_stop.__name__}"
    python = f'"{sys.executable}" -m pytest -q -n 0 -p no:cacheprovider "{test}"'
    done = subprocess.run(
        ["bash", "-c", f"{started} {python}"],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout
