"""A finding that does not keep a network from running, but may make its figures wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace

from core.names import shown


@dataclass(frozen=True)
class Caution:
    """What a module warns of.

    Parameters
    ----------
    message : str
        What disagrees, with the values, in one line.
    remedy : str
        What to do about it, or when it is well.
    node, check : str
        The node it stands on, and the module's method that found it; the engine fills them in.
    """

    message: str
    remedy: str
    node: str = ""
    check: str = ""

    @property
    def text(self) -> str:
        """Both in one line, without the node."""
        return f"{self.message}: {self.remedy}"

    def at(self, node: str, check: str) -> Caution:
        """The same, of that node."""
        return replace(self, node=node, check=check)

    def __str__(self) -> str:
        return f"{shown(self.node)}: {self.text}"
