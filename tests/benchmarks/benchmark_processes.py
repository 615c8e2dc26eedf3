"""Measurements in processes of their own: each is a program of this folder that prints JSON."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

from app.bench.timing import environment
from app.run.terminal import command


def figures_of(module: str, *words: object, **variables: str) -> list[dict[str, Any]]:
    """What a program of this folder has measured, a line for each."""
    environ = {**environment(), "OPENBLAS_NUM_THREADS": "1", **variables}
    environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parent), environ["PYTHONPATH"]])
    run = command(module, *map(str, words))
    done = subprocess.run(run, env=environ, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise RuntimeError(f"{module} {' '.join(map(str, words))}: {lines[-1]}")
    return [json.loads(line) for line in done.stdout.splitlines()]
