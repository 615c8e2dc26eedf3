"""What a node shows of itself, from its module's declaration or, for lack of one, its links."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from app.editor.declared_text import says_more
from core.modules.declaration import Declaration, Port
from core.modules.library_type import package_of
from core.network.network import Link, Node

COLOUR = "colour"  # field of a node in the file
Side = Literal["input", "output"]


@dataclass(frozen=True)
class PortFace:
    """A port as it is drawn; without types where the module does not declare it."""

    side: Side
    name: str
    types: tuple[str, ...] = ()
    required: bool = True

    @property
    def tooltip(self) -> str:
        """Text shown at the pointer."""
        if not self.types:
            return f"{self.name}: {self.side} of an unknown type"
        kinds = " or ".join(self.types)
        need = "" if self.side == "output" else ", required" if self.required else ", optional"
        return f"{self.name}: {self.side}, {kinds}{need}"


@dataclass(frozen=True)
class NodeFace:
    """A node as it is drawn.

    Parameters
    ----------
    id : str
        The node's id: the user's name for it, which is its title.
    module : str
        The module's title; its key where the module is not known.
    group : str
        The library's group; empty where the module is not known.
    summary : str
        What the module does, for the tooltip.
    inputs, outputs : tuple of PortFace
        The ports from top to bottom.
    known : bool
        Whether the library has the module.
    disabled : bool
        Whether the node only passes its input through.
    output : bool
        Whether its picture is marked as what the network delivers.
    colour : str
        Name of the colour that the user gave it; empty for that of its group.
    macro : bool
        Whether it holds nodes of its own.
    """

    id: str
    module: str
    group: str
    summary: str
    inputs: tuple[PortFace, ...]
    outputs: tuple[PortFace, ...]
    known: bool = True
    disabled: bool = False
    output: bool = False
    colour: str = ""
    macro: bool = False

    @property
    def subtitle(self) -> str:
        """The module's title, where it is more than the name again."""
        return self.module if says_more(self.module, self.id) else ""

    @property
    def tooltip(self) -> str:
        """Text shown at the pointer."""
        state = " (disabled: passes its input through)" if self.disabled else ""
        mark = "\nIts picture is marked as the network's output." if self.output else ""
        within = "\nDouble-click, or Enter, shows the nodes inside." if self.macro else ""
        return f"{self.id} · {self.module}{state}\n{self.summary}{mark}{within}"

    def port(self, side: Side, name: str) -> PortFace | None:
        """The port of that name."""
        ports = self.inputs if side == "input" else self.outputs
        return next((port for port in ports if port.name == name), None)


def _absent(module: str) -> str:
    package = package_of(module)
    of_package = f"; it is of the package {package}" if package else ""
    return f"The library has no module {module}{of_package}."


def face_of(
    node: Node, declared: Declaration | None, links: Sequence[Link], *, output: bool = False
) -> NodeFace:
    """The face of a node with the links at it; ports that only a link names are shown too."""
    inputs = _faces("input", declared.inputs if declared else ())
    outputs = _faces("output", declared.outputs if declared else ())
    coming = (link.input for link in links if link.target == node.id)
    going = (link.output for link in links if link.source == node.id)
    return NodeFace(
        id=node.id,
        module=declared.title if declared else node.module,
        group=declared.group if declared else "",
        summary=declared.summary if declared else _absent(node.module),
        inputs=inputs + _missing("input", inputs, coming),
        outputs=outputs + _missing("output", outputs, going),
        known=declared is not None,
        disabled=node.disabled,
        output=output,
        colour=colour_of(node),
        macro=node.macro is not None,
    )


def colour_of(node: Node) -> str:
    """Name of the colour that the user gave a node."""
    colour = node.extra.get(COLOUR)
    return colour if isinstance(colour, str) else ""


def _faces(side: Side, ports: Iterable[Port]) -> tuple[PortFace, ...]:
    return tuple(PortFace(side, port.name, port.types, port.required) for port in ports)


def _missing(side: Side, known: tuple[PortFace, ...], names: Iterable[str]) -> tuple[PortFace, ...]:
    there = {port.name for port in known}
    return tuple(PortFace(side, name) for name in dict.fromkeys(names) if name not in there)
