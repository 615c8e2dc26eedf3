"""A short seed of the random networks; a long one is a command."""

import subprocess
import sys
from pathlib import Path

FUZZ = Path(__file__).parent


def test_random_networks_give_no_finding(tmp_path):
    done = subprocess.run(
        [sys.executable, FUZZ / "networks.py", "--count", "10", "--seed", "2"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    numbers = [f"--seed 2 --first {number}" for number in range(10)]
    assert (done.returncode, done.stderr.splitlines()) == (0, numbers), done.stdout
    assert "cases 10" in " ".join(done.stdout.split())
