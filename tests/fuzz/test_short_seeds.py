"""A short seed of each fuzzer; a long one is a command: `python tests/fuzz/networks.py --help`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FUZZ = Path(__file__).parent


@pytest.mark.parametrize(
    ("name", "count", "seed"),
    [("networks.py", 20, 2), ("direct_sums.py", 20, 1), ("editor_kills.py", 1, 1)],
    ids=["networks", "direct_sums", "editor_kills"],
)
def test_no_finding(name, count, seed, tmp_path):
    done = subprocess.run(
        [sys.executable, FUZZ / name, "--count", str(count), "--seed", str(seed)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert f"cases {count}" in " ".join(done.stdout.split())
