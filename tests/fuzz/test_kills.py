"""A short seed of the kills, by the command that carries out a long one."""

import subprocess
import sys
from pathlib import Path


def test_runs_that_are_ended_leave_whole_files_and_say_what_is_true(tmp_path):
    script = Path(__file__).with_name("kills.py")
    done = subprocess.run(
        [sys.executable, script, "--count", "4", "--seed", "7", "--pages", "0"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("4 trials: ")
    assert done.stdout.endswith("; faults 0\nno faults\n")
