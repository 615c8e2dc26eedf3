"""Errors that a module's code raises become those of its node: floating point, plug-ins' faults.

Floating-point faults never become NaN or infinity. Other errors in the code of a plug-in name its
package, file and line; other errors in our own stay what they are.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import CodeType, FrameType
from typing import TYPE_CHECKING, Any

from core.errors import DataError, ImagechainError, PlugInError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from numpy.typing import NDArray

PLUG_INS = "imagechain.modules"  # the entry points of packages that bring modules


@contextmanager
def watched(node: str | None, module: str = "") -> Iterator[None]:
    """Refuse overflow, division by zero and invalid operations inside the block.

    Errors are placed on the node: a `DataError`, or a `PlugInError` for any other error in the code
    of a plug-in. `module` is the key of the node's module, where that is known.
    """
    import numpy as np  # who only looks for plug-ins has no use for it

    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (ImagechainError, MemoryError):
        raise
    except Exception as error:
        is_range = isinstance(error, ArithmeticError)
        of_user = is_range and not isinstance(error, ZeroDivisionError)
        if not (of_user or (isinstance(error, OSError) and error.filename is not None)):
            fault = plug_in_error(error, node, module)
            if fault is not None:
                raise fault from error
        if not is_range:
            raise
        raise DataError(
            f"numbers overflow the floating-point range ({error}): a parameter or a sample is "
            "too large or too small",
            node=node,
        ) from error


def plug_in_error(error: Exception, node: str | None, module: str = "") -> PlugInError | None:
    """The error that names the plug-in in whose code another was raised; None where in no such.

    `module` is the key of the node's module; where it is not given, it is found by the code.
    """
    frames = _plug_in_frames(error)
    if not frames:
        return None
    key = module or _module_of(frames[0][0])
    what = f"module {key} of the " if key else ""
    message = f"a fault in the {what}plug-in {_package(frames[-1][0])}: {with_place(error)}"
    return PlugInError(message, error, node=node)


def with_place(error: BaseException) -> str:
    """What was raised, and the file and line of the plug-in where that was, in one line."""
    text = f"{type(error).__name__}: {' '.join(str(error).split()) or 'no reason given':.300}"
    frames = _plug_in_frames(error)
    if not frames:
        return text
    frame, line = frames[-1]
    file, package = Path(frame.f_code.co_filename), _package(frame)
    if package in file.parts:
        file = Path(*file.parts[file.parts.index(package) :])
    return f"{text} ({file.as_posix()}, line {line})"


def _plug_in_frames(error: BaseException) -> list[tuple[FrameType, int]]:
    names = {point.module.partition(".")[0] for point in plug_ins()}
    frames = traceback.walk_tb(error.__traceback__)
    return [(frame, line) for frame, line in frames if _package(frame) in names]


def plug_ins() -> list[EntryPoint]:
    """Entry points of installed modules; where no package names any, their reader is not loaded."""
    for place in map(Path, sys.path):
        entries = place.glob("*-[Ii][Nn][Ff][Oo]/entry_points.txt")
        if place.is_file() or any(PLUG_INS.encode() in entry.read_bytes() for entry in entries):
            from importlib.metadata import entry_points  # takes 20 ms

            return list(entry_points(group=PLUG_INS))
    return []


def _package(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", "")).partition(".")[0]


def _module_of(frame: FrameType) -> str:
    """The key of the module that is declared beside a function, and names it."""
    function = frame.f_code.co_name
    for kind in frame.f_globals.values():
        key = getattr(kind, "key", None) if isinstance(kind, type) else None
        codes = [getattr(value, "__code__", None) for value in vars(kind).values()] if key else []
        own = [code for code in codes if isinstance(code, CodeType)]
        if any(code is frame.f_code or function in code.co_names for code in own):
            return str(key)
    return ""


def require_finite(values: NDArray[Any]) -> None:
    """Refuse a transform of numbers too large for it, which raises no error by itself.

    Raises `FloatingPointError` for `watched` to make a `DataError` of.
    """
    import numpy as np

    # One bad sample spreads over its whole transform, so that the sum cannot miss it.
    if not np.isfinite(np.sum(values, dtype=np.result_type(values.dtype, np.float64))):
        raise FloatingPointError("overflow encountered in transform")
