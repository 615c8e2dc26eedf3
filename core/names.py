"""Names and plain JSON data of network documents."""

import difflib
import re
import unicodedata
from collections.abc import Iterable, Mapping
from pathlib import PurePath
from types import MappingProxyType
from typing import Any

from core.errors import NetworkError


def check_id(name: str) -> None:
    """Refuse a node id that is empty or has a dot, an equals sign or a control character."""
    # Cs: half a surrogate pair cannot be saved; Zl and Zp break lines as control characters do.
    barred = (c in ".=" or unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp") for c in name)
    if not name.strip() or any(barred):
        raise NetworkError(
            f"{name!r:.80} is not allowed as a node's id: it must not be blank or contain "
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
