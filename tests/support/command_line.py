"""The command ``imagechain``, in this process or in one of its own."""

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from unittest.mock import patch

from app.command.cli import main
from child_process import ROOT, finished

NOTHING: Mapping[str, str] = {}
Done = subprocess.CompletedProcess[str]


def run_here(*words: object, folder: Path, env: Mapping[str, str] = NOTHING) -> Done:
    """The real `main` on these words: what the process would end with and print.

    For all that is not about the process itself: to start one takes a second of computing.
    """
    given = [str(word) for word in words]
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2))
    with (
        contextlib.chdir(folder),
        patch.dict(os.environ, env),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        code = main(given)
    return Done(given, code, *(stream.buffer.getvalue().decode() for stream in (out, err)))


def run_process(*words: object, folder: Path, env: Mapping[str, str] = NOTHING) -> Done:
    """The command as a user starts it."""
    command = [sys.executable, "-m", "app.command.cli", *map(str, words)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **env}
    return finished(command, folder=folder, env=environment)
