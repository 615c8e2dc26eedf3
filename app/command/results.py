"""What a command leaves behind: files, all of them or none, and what it prints."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from app.options.command_options import Options
from app.options.stopping import too_late
from app.run.readout_tables import json_text
from core.atomic import write_bytes, write_text
from core.errors import Cancelled

Made = TypeVar("Made")


def written(
    outputs: Sequence[Path],
    inputs: Iterable[Path],
    stop: threading.Event,
    make: Callable[[], Made],
    content: Callable[[Made, Path], str | bytes],
) -> Made:
    """Make a result, and write what each file is to hold; files are reserved before any work."""
    from app.run.staging import Staging  # which takes numpy to load

    with Staging(None, inputs) as staging:
        for path in outputs:
            staging.claim(path)
        made = make()
        for path in outputs:
            staging.write(path, partial(write_content, content=content(made, path)))
        check_stop(stop)
        too_late(stop)
        staging.commit()
    return made


def write_content(path: Path, content: str | bytes) -> None:
    if isinstance(content, bytes):
        write_bytes(path, content)
    else:
        write_text(path, content)


def check_stop(stop: threading.Event) -> None:
    if stop.is_set():
        raise Cancelled("stopped on request")


def say(options: Options, *lines: str) -> None:
    """Print lines for people; none where the result is printed as JSON."""
    if lines and options.json is not True:
        print("\n".join(lines), flush=True)


def show(options: Options, facts: Callable[[], Any], *lines: str) -> None:
    """Print the result of a command: as JSON where that is wanted, else in lines."""
    say(options, *lines)
    if options.json is True:
        print(json_text(facts()), end="", flush=True)
