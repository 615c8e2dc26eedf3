"""The errors a user can meet, each one line that states what, where, the value and what is allowed.

All but `Cancelled` and `PlugInError` are faults of the input: the command ends with exit code 2.
"""

from __future__ import annotations

import contextlib
import difflib
import re
import sys
import traceback
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePath
from types import CodeType, FrameType, MappingProxyType
from typing import TYPE_CHECKING, Any, Self, TypeVar

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from numpy.typing import NDArray

E = TypeVar("E", bound="ImagechainError")


class ImagechainError(Exception):
    """Base of every error this program raises on purpose.

    `node` is the id of the network's node the error belongs to, once known. `hint` is what to type
    on a command line against it; the message itself is read in the window too and names no option.
    """

    exit_code = 1

    def __init__(self, message: str, *, node: str | None = None, hint: str = "") -> None:
        super().__init__(message)
        self.message = " ".join(message.split())
        self.node = node
        self.hint = hint

    def at(self, node: str) -> Self:
        """The same error, placed on `node` unless it already has a place."""
        if self.node is not None:
            return self
        placed = _rebuilt(type(self), self.args, self.__dict__)
        placed.node = node
        placed.__cause__ = self.__cause__
        return placed

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (type(self), self.args, self.__dict__)

    def __str__(self) -> str:
        return f"{self.node}: {self.message}" if self.node else self.message


def how_to_install(extra: str) -> str:
    """How the packages of an extra are installed; no index has this program."""
    return f"run pip install '.[{extra}]' in Imagechain's source folder"


def _rebuilt(kind: type[E], args: tuple[Any, ...], state: dict[str, Any]) -> E:
    """Copy an error without its constructor, whose arguments are long gone."""
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(state)
    return error


def several(count: int, thing: str) -> str:
    """A number of things in words: 1 edge, 2 edges."""
    return f"{count} {thing}{'' if count == 1 else 's'}"


def percent(share: float, digits: int = 0) -> str:
    """A share in words: 0.32 is 32 %."""
    return f"{100 * share:.{digits}f} %"


class InputError(ImagechainError):
    """The input is at fault; the message states how to mend it."""

    exit_code = 2


_UNITS = {
    **{unit: unit for unit in ("mm", "cm", "m", "km", "nm", "mrad", "deg", "K", "mK", "Hz", "s")},
    **{unit: unit for unit in ("dB", "px", "cyc", "A", "W", "waves", "rad", "sr")},
    **{"um": "µm", "percent": "%", "e": "e-", "dn": "DN", "lux": "lx", "cm2": "cm²", "m2": "m²"},
}


def unit_of(name: str) -> str:
    """The unit that a name ends in: ``corner_Hz``, ``velocity_m_per_s``, ``extinction_per_km``."""
    *words, last = name.split("_")
    if words[1:] and words[-1] == "per" and last in _UNITS:
        return f"{_UNITS.get(words[-2], '1')}/{_UNITS[last]}"
    return _UNITS.get(last, "") if words else ""


class ParameterError(InputError):
    """A parameter whose value is not allowed: name, value, unit and range in one line.

    Without a unit it is the one that the name ends in. `also` names others that are empty too. A
    `clause` says itself what is wrong, whatever its first word: it may be a name such as 3-D Noise.
    """

    def __init__(
        self,
        parameter: str,
        value: object,
        allowed: str,
        *,
        unit: str | None = None,
        node: str | None = None,
        also: Sequence[str] = (),
        clause: bool = False,
    ) -> None:
        unit = unit_of(parameter) if unit is None and not also else unit
        self.parameters = (parameter, *also)
        # It is a range or a noun, or a clause already.
        rule = allowed if clause or not _RANGE.match(allowed) else f"must be {allowed}"
        if value is None:
            verb = "are" if also else "is"
            its_unit = f" ({unit})" if unit and unit != unit_of(parameter) else ""
            text = f"{listed(self.parameters)}{its_unit} {verb} empty: {rule}"
        else:
            shown = _shown(value) + (f" {unit}" if unit else "")
            text = f"{parameter} = {shown} is not allowed: {rule}"
        super().__init__(text, node=node)
        self.parameter = parameter
        self.value = value
        self.allowed = allowed
        self.unit = unit or ""


def listed(names: Sequence[str], joint: str = "and") -> str:
    """``a, b and c``."""
    return f" {joint} ".join(part for part in (", ".join(names[:-1]), names[-1]) if part)


_RANGE = re.compile(
    r"(?:an?|one|two|true|text|single|finite|equal|numbers?|above|below|from|within"
    r"|at (?:least|most)|large enough)\b(?!\.)|[-(]?\d"
)


def _shown(value: object) -> str:
    """The value as typed, shortened; Python refuses to print integers of thousands of digits."""
    if isinstance(value, int) and abs(value) >= 10**80:
        return f"an integer of {value.bit_length()} bits"
    return f"{value!r:.80}"


class DataError(InputError):
    """Samples that cannot be used: not finite, of a wrong shape, none at all."""


class FileError(InputError):
    """A file that is missing, damaged, of an unknown kind, or cannot be written."""


class ChangedFileError(FileError):
    """A file that another program has changed or removed since it was read or written."""


class NetworkError(InputError):
    """A document that is no network, or whose modules and links do not fit."""


class UnconnectedError(NetworkError):
    """An input that a module needs has no wire yet."""


class UsageError(InputError):
    """A command line that cannot be carried out."""


class PlugInError(ImagechainError):
    """A fault in the code of a plug-in; `fault` is what was raised there."""

    def __init__(self, message: str, fault: Exception, *, node: str | None = None) -> None:
        super().__init__(message, node=node)
        self.fault: Exception | None = fault

    def __reduce__(self) -> tuple[Any, ...]:
        # What others raise need not go to another process.
        return _rebuilt, (type(self), self.args, {**self.__dict__, "fault": None})


class Cancelled(ImagechainError):
    """The caller requested a stop before the work was done."""


class Suspended(Cancelled):
    """The caller requested a stop, and what has been done is kept: the message says where."""


# Names and plain JSON data of network documents.


FAULTS = (InputError, PlugInError)
"""All errors but that the caller wants to stop."""


@contextlib.contextmanager
def placed(node: str | None) -> Iterator[None]:
    """Errors of ours belong to the node, if there is one."""
    try:
        yield
    except ImagechainError as error:
        if node is None:
            raise
        raise error.at(node) from error


@contextlib.contextmanager
def writing(target: object) -> Iterator[None]:
    """What the system refuses is an error of ours, which says that a file cannot be written."""
    try:
        yield
    except OSError as error:
        raise FileError(f"cannot write {target}: {error.strerror or error}") from error


def check_id(name: str) -> None:
    """Refuse a node id that is empty or has a dot, an equals sign or a control character."""
    # Cs: half a surrogate pair cannot be saved; Zl and Zp break lines as control characters do.
    barred = (c in ".=" or unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp") for c in name)
    if not name.strip() or any(barred):
        raise NetworkError(
            f"{name!r:.80} is not allowed as a node's id: an id must not be blank or contain "
            "'.', '=' or a control character"
        )


def shown(text: str) -> str:
    """A name as it is where that is harmless in one line of text, else quoted."""
    return text if text and text.isprintable() and len(text) <= 80 else f"{text!r:.80}"


def shown_path(path: str) -> str:
    """A file's name with its folder, as `shown`; a long one keeps its end, which says the most."""
    if path.isprintable() and len(path) > 200:
        path = f"{path[:60]}…{path[-139:]}"
    return path if path and path.isprintable() else shown(path)


# Control characters but for tab and line ends, those that turn the direction of what follows, line
# ends of other kinds, and halves of surrogate pairs.
_BARRED = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: str) -> str:
    r"""The text with escapes such as ``\u001b`` for what a terminal or a page would obey.

    Bytes of file names that are no UTF-8 become escapes too. A JSON document stays one, and reads
    back the same.
    """
    return _BARRED.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


_LINE_ENDS = str.maketrans({"\t": r"\t", "\n": r"\n", "\r": r"\r"})


def in_line(text: str) -> str:
    """`printable`, with escapes for tabs and line ends too: a line that stays one."""
    return printable(text).translate(_LINE_ENDS)


def close(name: str, known: Iterable[str]) -> str:
    """A suggestion to end an error with, empty when nothing is like `name`."""
    # Comparing is quadratic in the length; no name is that long.
    alike = difflib.get_close_matches(name, known, n=1) if len(name) <= 64 else []
    return f"; did you mean {alike[0]}?" if alike else ""


def alike(name: str, known: Iterable[str]) -> str:
    """As `close`, up to three suggestions: names that are spelt like it, or that hold it."""
    names = list(known)
    word = name.casefold() if len(name) <= 64 else ""
    holding = sorted(
        (one for one in names if word and word in one.casefold()),
        key=lambda one: not one.casefold().startswith(word),
    )
    spelt = difflib.get_close_matches(word, names, n=3, cutoff=0.85)
    found = list(dict.fromkeys([*holding, *spelt]))[:3] or difflib.get_close_matches(word, names, 1)
    *first, last = found or [""]
    return f"; did you mean {', '.join(first)}{' or ' if first else ''}{last}?" if last else ""


SCALARS = frozenset({str, int, float, bool, type(None)})
"""Types of plain JSON data without parts: most of what a network holds, so looked for first."""


def freeze(value: Any) -> Any:
    """Plain JSON data that cannot be changed: tuples and read-only mappings."""
    if type(value) in SCALARS:
        return value
    if isinstance(value, Mapping):
        return MappingProxyType({name: freeze(item) for name, item in value.items()})
    if isinstance(value, list | tuple):
        return tuple(freeze(item) for item in value)
    return value.as_posix() if isinstance(value, PurePath) else value


def thaw(value: Any) -> Any:
    """Lists and dicts again; what is no plain data stays as it is."""
    if type(value) in SCALARS:
        return value
    if isinstance(value, Mapping):
        return {name: thaw(item) for name, item in value.items()}
    if isinstance(value, list) or type(value) is tuple:
        return [thaw(item) for item in value]
    return value


# Errors that a module's code raises become those of its node: floating point, plug-ins' faults.

PLUG_INS = "imagechain.modules"  # the entry points of packages that bring modules


@contextlib.contextmanager
def watched(node: str | None, module: str = "") -> Iterator[None]:
    """Refuse overflow, division by zero and invalid operations inside the block.

    Errors are placed on the node: ours, a `DataError`, or a `PlugInError` for any other error in
    the code of a plug-in. `module` is the key of the node's module, where that is known.
    """
    import numpy as np  # who only looks for plug-ins has no use for it

    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except MemoryError:
        raise
    except ImagechainError as error:
        if node is None or error.node is not None:
            raise
        raise error.at(node) from error
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
    """Refuse a transform of numbers too large for it, which raises no error by itself."""
    import numpy as np

    # One bad sample spreads over its whole transform, so that the sum cannot miss it.
    if not np.isfinite(np.sum(values, dtype=np.result_type(values.dtype, np.float64))):
        raise FloatingPointError("overflow encountered in transform")
