"""Which figures of a publication those of the report are drawn as.

A network may carry a field for it, `drawn_as`, with a text for each of these of our figures:
`stages`, the MTF of every stage; `total`, all of them together; `judged`, the MTF measured in the
final picture.
"""

from __future__ import annotations

from collections.abc import Mapping

from core.errors import NetworkError
from core.names import close
from core.network.network import Network

FIGURES = ("stages", "total", "judged")


def drawn_as(network: Network) -> dict[str, str]:
    """The publication's figure by ours.

    Raises
    ------
    NetworkError
        If the network's field is not as it should be.
    """
    given = network.extra.get("drawn_as", {})
    if not isinstance(given, Mapping):
        raise NetworkError("drawn_as must be an object of figures")
    for name, text in given.items():
        if name not in FIGURES:
            hint = close(name, FIGURES) or f"; there are {', '.join(FIGURES)}"
            raise NetworkError(f"drawn_as has an unknown figure {name!r:.80}{hint}")
        if not isinstance(text, str):
            raise NetworkError(f"drawn_as: {name} must be a text")
    return dict(given)


def named(caption: str, figure: str | None) -> str:
    """The caption, with the publication's figure before it."""
    return f"As {figure}. {caption}" if figure else caption
