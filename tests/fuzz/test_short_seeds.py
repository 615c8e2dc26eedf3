"""A short seed of each fuzzer; a long one is a command: `python tests/fuzz/networks.py --help`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parent


@pytest.mark.parametrize(
    ("name", "count", "seed", "end"),
    [
        ("networks.py", 20, 2, "cases 20"),
        ("direct_sums.py", 20, 1, "cases 20"),
        pytest.param("editor_kills.py", 1, 1, "cases 1", marks=pytest.mark.thorough),
        pytest.param("study_kills.py", 2, 1, "no faults", marks=pytest.mark.thorough),
    ],
    ids=["networks", "direct_sums", "editor_kills", "study_kills"],
)
def test_no_finding(name, count, seed, end, tmp_path):
    done = subprocess.run(
        [sys.executable, FUZZ / name, "--count", str(count), "--seed", str(seed)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert end in " ".join(done.stdout.split())
