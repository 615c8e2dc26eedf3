"""The terminal of a command: what is printed, closed streams, and signals to stop."""

import contextlib
import json
import math
import os
import re
import signal
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path, PurePath
from types import FrameType
from typing import Any, TextIO

from core.errors import printable, several

MOST_WARNINGS = 5
"""How many kinds of warnings are shown of many points."""
_NUMBER = re.compile(r"(?<!\w)\d[\d.]*(e[+-]?\d+)?")
_ROUNDING = 1e-15
_SIZES = {  # from, up to, the unit in which that is written
    "K": ((1e-9, 0.2, 1e-3, "mK"),),
    "s": ((1e-9, 1e-3, 1e-6, "µs"), (1e-3, 1.0, 1e-3, "ms")),
    "e-": ((1e4, 1e6, 1e3, "ke-"), (1e6, 1e15, 1e6, "Me-")),
    "Hz": ((1e4, 1e6, 1e3, "kHz"), (1e6, 1e15, 1e6, "MHz")),
    "mm": ((1e3, 1e6, 1e3, "m"),),
    "m": ((1e-9, 1e-3, 1e-6, "µm"), (1e-3, 0.1, 1e-3, "mm"), (1e4, 1e12, 1e3, "km")),
}
_IN_LINE = str.maketrans("\t\n\r", "   ")


def number_text(value: Any) -> str:
    """A figure in up to six digits, as people read it."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if _is_real(value):
        return f"{float(value):.6g}"
    return str(value)


def exact(value: Any) -> str:
    """A value in full, as tables have it; nothing where there is none."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(float(value)) if isinstance(value, float) else str(value)


def sized(value: Any, unit: str) -> tuple[Any, str]:
    """A value in the size of its unit that data sheets use (25 mK, 4 ms, 7 Me-), in four digits."""
    if isinstance(value, int | float) and value:
        for least, beyond, size, written in _SIZES.get(unit, ()):
            if least <= abs(value) < beyond:
                return four_digits(value / size), written
    return four_digits(value), unit if value is not None else ""


def four_digits(value: Any) -> Any:
    """The value in four digits: a data sheet gives no more."""
    return float(f"{value:.4g}") if _is_real(value) else value


def _is_real(value: Any) -> bool:
    """Whether it is a floating-point number, of numpy's types too, which need not be loaded."""
    return isinstance(value, Real) and not isinstance(value, Integral)


def with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def without_rounding(value: Any, unit: str) -> Any:
    """The value; of ratios and radians, 0 for what rounding leaves of 0."""
    if unit in ("", "rad") and _is_real(value):
        return 0.0 if abs(float(value)) < _ROUNDING else value
    return value


def jsonable(value: Any) -> Any:
    if hasattr(value, "tolist"):  # of numpy
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, Mapping):
        return {str(name): jsonable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(item) for item in value]
    return value.as_posix() if isinstance(value, PurePath) else value


def values_of(thing: object, *names: str) -> dict[str, Any]:
    return {name: getattr(thing, name) for name in names}


def json_text(value: Any, indent: int = 2) -> str:
    text = json.dumps(jsonable(value), indent=indent, ensure_ascii=False, allow_nan=False)
    return printable(text) + "\n"


def warning_lines(warnings: Iterable[object]) -> list[str]:
    return [printable(f"warning: {warning}") for warning in warnings]


def warned_points(points: Sequence[Sequence[str]]) -> list[str]:
    """How many points have warnings, and what these say; texts with other numbers count as one."""
    first: dict[str, str] = {}
    counts: Counter[str] = Counter()
    for warnings in points:
        kinds = {_NUMBER.sub("0", line): line for line in reversed(warnings)}
        counts.update(kinds.keys())
        first = {**kinds, **first}
    if not first:
        return []
    count = sum(map(bool, points))
    lines = [f"{count} of {several(len(points), 'point')} with warnings:"]
    for kind, number in counts.most_common(MOST_WARNINGS):
        lines.append(printable(f"warning: {first[kind]} ({number} point{'s' * (number > 1)})"))
    if len(counts) > MOST_WARNINGS:
        lines.append(f"and {len(counts) - MOST_WARNINGS} more")
    return lines


def columns(rows: Iterable[Sequence[str]], *, right: Sequence[int] = ()) -> str:
    """Rows with their cells in line; the columns in `right` end together."""
    rows = [[printable(cell).translate(_IN_LINE) for cell in row] for row in rows]
    if not rows:
        return ""
    widths = [max(len(row[index]) for row in rows) for index in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            cell.rjust(width) if index in right else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP


class Stopped(KeyboardInterrupt):
    """Raised by a signal to stop.

    After a plain KeyboardInterrupt inside ``exec`` the interpreter would end by the signal.
    """


class Stop(threading.Event):
    """Set on a signal to stop, and the handler of these signals.

    `Stopped` is raised only inside `during`, whose caller catches it: anywhere else, such as in
    the caller's own ``except``, it would end the process with a traceback.
    """

    def __init__(self) -> None:
        super().__init__()
        self.is_late = False
        self._noted = False

    def during(self, function: Callable[..., object], *words: object) -> None:
        function(*words)

    def __call__(self, _number: int, frame: FrameType | None) -> None:
        """Note the signal; raise where it can be caught, and nothing is being cleared away."""
        if not self._noted:
            # A signal within `set` would wait for its lock for ever.
            self._noted = True
            self.set()
        if self.is_late or isinstance(sys.exception(), Stopped):
            return
        while frame is not None and frame.f_code is not Stop.during.__code__:
            frame = frame.f_back
        if frame is not None:
            raise Stopped


def too_late(cancel: threading.Event | None) -> None:
    """From now on a stop that is tied to signals is only noted: files are being put in place."""
    if isinstance(cancel, Stop):
        cancel.is_late = True


@contextlib.contextmanager
def stoppable(*, to_the_end: bool = False) -> Iterator[Stop]:
    """Make Ctrl-C and the signals to end raise `Stopped`, and set the event.

    Code that swallows every exception may hide it from the caller. If the process ends after it
    (`to_the_end`), Ctrl-C ends the rest without a traceback, and a second signal changes nothing.
    """
    stop = Stop()
    previous: dict[signal.Signals, Any] = {}
    hook = sys.unraisablehook

    def report(unraisable: Any) -> None:
        # One that is raised while an object is being deleted goes no further; Python prints it.
        if not isinstance(unraisable.exc_value, Stopped):
            hook(unraisable)

    sys.unraisablehook = report
    with contextlib.suppress(ValueError):  # not the main thread
        for name in _SIGNALS:
            number = getattr(signal, name, None)
            # Ignored, as by nohup: to stay so.
            if number is not None and signal.getsignal(number) != signal.SIG_IGN:
                previous[number] = signal.signal(number, stop)
    try:
        yield stop
    finally:
        for number, handler in previous.items():
            again = stop.is_set() and number != signal.SIGINT
            at_end = signal.SIG_IGN if again else signal.SIG_DFL
            signal.signal(number, at_end if to_the_end else handler)
        if not to_the_end:
            sys.unraisablehook = hook


@contextlib.contextmanager
def usable_streams() -> Iterator[None]:
    """Make names of any alphabet printable, and replace closed streams by the null device.

    Without it `print` writes to standard output what was meant for a closed standard error, and
    the next file that is opened takes the number of the closed stream.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: PTH123, SIM115
        stream = getattr(sys, name)
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        # The interpreter flushes at its end: what fails then changes the exit code.
        for stream in (sys.stdout, sys.stderr):
            try:
                stream.flush()
            except (OSError, ValueError):
                discard(stream)


def discard(stream: TextIO) -> None:
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def print_error(line: str) -> None:
    """Print a line to standard error; drop it where that is full or gone."""
    try:
        print(line, file=sys.stderr, flush=True)
    except (OSError, ValueError):
        discard(sys.stderr)


def version() -> str:
    """The version that is installed; read only when needed, as it takes 20 ms."""
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"


def versions() -> dict[str, str]:
    import numpy as np
    import scipy

    python = ".".join(map(str, sys.version_info[:3]))
    numbers = {"numpy": np.__version__, "scipy": scipy.__version__}
    return {"imagechain": version(), "python": python, **numbers}


# Starting our own modules in processes of their own.


def command(module: str, *words: str) -> list[str]:
    """Words that run one of our modules in a new process, wherever that starts."""
    return [sys.executable, "-P", "-m", module, *words]


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """Environment of a child: the variables given, or this process's, and our packages."""
    root = str(Path(__file__).resolve().parents[2])
    known = dict(os.environ if variables is None else variables)
    path = [root, *filter(None, [known.get("PYTHONPATH")])]
    return {**known, "PYTHONPATH": os.pathsep.join(path)}
