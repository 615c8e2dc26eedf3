"""Strict JSON, for documents that are mailed round and edited by hand."""

from __future__ import annotations

import json
import math
import re
from typing import Any

from core.errors import NetworkError
from core.names import shown

LARGEST = 16 * 2**20  # characters; a network of a thousand nodes has about half a million
DEEPEST = 64
_STRING = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"', re.DOTALL)
_BRACKET = re.compile(r"[\[\]{}]")


def read_json(text: str, source: str) -> Any:
    """Parse `text`.

    Other than Python's `json`: a key that comes twice, NaN, Infinity, numbers beyond double
    precision, half surrogate pairs, and hostile size and depth are refused.

    Raises
    ------
    NetworkError
        Naming `source` and the fault.
    """
    if len(text) > LARGEST:
        raise NetworkError(f"{source}: larger than the {LARGEST >> 20} MiB a network may have")
    try:
        _check_depth(text)
        data = json.loads(
            text.removeprefix("\ufeff"),
            object_pairs_hook=_object,
            parse_int=_integer,
            parse_float=_number,
            parse_constant=_constant,
        )
        _walk(data)
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise NetworkError(f"{source}: not JSON: {error.msg} ({place})") from None
    except NetworkError as error:
        raise NetworkError(f"{source}: {error.message}") from None
    return data


def _check_depth(text: str) -> None:
    """Refuse deep nesting before it is parsed, which on a small stack would end the process."""
    depth = 0
    for bracket in _BRACKET.findall(_STRING.sub("", text)):
        depth += 1 if bracket in "[{" else -1
        if depth > DEEPEST:
            raise NetworkError(f"nested more than {DEEPEST} deep")


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    fields = dict(pairs)
    if len(fields) < len(pairs):
        seen: set[str] = set()
        for name, _ in pairs:
            if name in seen:
                raise NetworkError(f"the key {shown(name)} comes twice in one object")
            seen.add(name)
    return fields


def _integer(text: str) -> int:
    # Far below Python's limit of digits, whose error is none of ours.
    if len(text) > 300 and (len(text) > 310 or not math.isfinite(float(text))):
        raise NetworkError(f"a number of {len(text)} digits is too large")
    return int(text)


def _number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise NetworkError(f"the number {shown(text)} is too large")
    return number


def _constant(text: str) -> float:
    raise NetworkError(f"{text} is no number that JSON allows")


def _walk(data: Any) -> None:
    """Check depth and texts; by a list, so that the caller's own depth does not matter."""
    rest = [(data, 1)]
    while rest:
        value, depth = rest.pop()
        if depth > DEEPEST:
            raise NetworkError(f"nested more than {DEEPEST} deep")
        if isinstance(value, dict):
            for name in value:
                _check_text(name)
            rest.extend((item, depth + 1) for item in value.values())
        elif isinstance(value, list):
            rest.extend((item, depth + 1) for item in value)
        elif isinstance(value, str):
            _check_text(value)


def _check_text(text: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise NetworkError(f"{text!r:.80} is no valid Unicode text") from None
