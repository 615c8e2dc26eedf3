"""A process that keeps its memory between measurements."""

from __future__ import annotations

import os
import sys

from app.options.command_options import Options
from app.run import own_process

# Every block a measurement frees would else go back to the system, and its pages be faulted in
# again by the next one: half of the time of a transform, at the kernel's whim.
STEADY = {
    "MALLOC_MMAP_THRESHOLD_": str(1 << 30),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 32),
    "OPENBLAS_NUM_THREADS": "1",
}


def isolate(options: Options) -> None:
    """Start this command again with `STEADY` in its environment, unless it has it already."""
    if all(name in os.environ for name in STEADY):
        return
    sys.stdout.flush()
    os.execve(
        sys.executable,
        own_process.command("app.command.cli", *_words(options)),
        {**environment(), **STEADY},
    )


def environment() -> dict[str, str]:
    """Environment of a child as a user would have it, but able to find our packages."""
    return own_process.environment(
        {name: value for name, value in os.environ.items() if name not in STEADY}
    )


def _words(options: Options) -> list[str]:
    words = ["bench"]
    files = {
        "--json": options.bench_json,
        "--html": options.bench_html,
        "--markdown": options.bench_markdown,
        "--pictures": options.bench_pictures,
    }
    for option, path in files.items():
        words += [] if path is None else [option, str(path)]
    if options.quick:
        words.append("--quick")
    for part in options.parts:
        words += ["--only", part]
    if options.size is not None:
        words += ["--size", str(options.size)]
    return words
