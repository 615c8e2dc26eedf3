"""The command ``imagechain``, in this process or in one of its own."""

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from unittest.mock import patch

import click

from app.command.cli import COMMAND_LINE, main
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


def read_words(name: str, *words: str, stop: object = None) -> click.Context:
    """The command of these words, which must be such as it takes."""
    with COMMAND_LINE.make_context("imagechain", [name]) as above:
        command = COMMAND_LINE.get_command(above, name)
        assert command is not None
        return command.make_context(name, [*words], parent=above, obj=stop)


def run_process(*words: object, folder: Path, env: Mapping[str, str] = NOTHING) -> Done:
    """The command as a user starts it."""
    command = [sys.executable, "-m", "app.command.cli", *map(str, words)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **env}
    return finished(command, folder=folder, env=environment)
