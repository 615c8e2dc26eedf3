"""Why edges are not used, in a few words of each kind, and what helps against it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple


class Refusal(NamedTuple):
    """A kind of reason.

    Parameters
    ----------
    part : str
        Of the reasons' texts, which have an edge's figures beside.
    words : str
        The reason without figures.
    helps : str
        What to photograph, or store, in its place; empty where nothing is wrong.
    """

    part: str
    words: str
    helps: str


_ROOM = "larger areas: some 20 samples on both sides of the edge without anything else"
_EVEN = "even areas on both sides: plain surfaces in even light"
_TURNED = "the edge turned by about 5° from rows and columns"
_LOSSLESS = "raw numbers, TIFF or PNG in place of JPEG"
REFUSALS = (
    Refusal("compressed", "compressed with loss", _LOSSLESS),
    Refusal("interlaced", "interlaced", "the odd or the even rows alone"),
    Refusal(
        "clipped", "clipped at black or white", "another exposure: no side at the end of the range"
    ),
    Refusal(
        "too little contrast",
        "too little contrast for its length and the noise",
        "more contrast or light, a longer edge, or the mean of several frames",
    ),
    Refusal("frame's side", "too near to the frame's side", "the edge farther inside"),
    Refusal("its spread", "its blur does not end in the room that it has", _ROOM),
    Refusal(
        "not straight", "not straight", "a cut, ruled or printed edge, flat; a shorter one where "
        "the lens bends lines",
    ),
    Refusal("not slanted", "not slanted enough", _TURNED),
    Refusal("cannot be supersampled", "not slanted enough", _TURNED),
    Refusal(
        "soft in the scene",
        "softer than other edges of the picture",
        "edges that are sharp by themselves and in focus: no shadows, nothing that moves, all at "
        "one distance",
    ),
    Refusal("another edge", "another edge too near", _ROOM),
    Refusal("sides or its contrast differ", "its sides are not even along it", _EVEN),
    Refusal("a side is not level", "a side is not level", _EVEN),
    Refusal("samples beside it", "too little room beside it", _ROOM),
    Refusal("samples lie about", "too short", "a longer edge"),
    Refusal("less clear than", "less clear than others, of which none can be used", ""),
    Refusal("not looked at", "not looked at, as clearer ones came first", ""),
)  # fmt: skip
_NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[+-]?\d+)?")
_MOST = 3


def refusal_of(why_not: str) -> Refusal:
    """The kind of a reason."""
    what = why_not.partition(":")[0]
    for one in REFUSALS:
        if one.part in what:
            return one
    return Refusal(what, _NUMBER.sub("…", what), "")


def counted(reasons: Iterable[str]) -> dict[Refusal, int]:
    """Kinds of reasons in the order in which they come first, and how often each does."""
    kinds: dict[str, tuple[Refusal, int]] = {}
    for why_not in reasons:
        kind = refusal_of(why_not)
        first, count = kinds.get(kind.words, (kind, 0))
        kinds[kind.words] = first, count + 1
    return dict(kinds.values())


def in_words(reasons: Iterable[str]) -> str:
    """The first kinds of reasons, each with how many edges it stands for, in one line."""
    kinds = list(counted(reasons).items())
    words = ", ".join(f"{kind.words} ({count})" for kind, count in kinds[:_MOST])
    left = sum(count for _, count in kinds[_MOST:])
    return f"{words}, other reasons ({left})" if left else words
