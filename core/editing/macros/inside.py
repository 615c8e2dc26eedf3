"""Changes of nodes that lie inside of macros, as changes of the whole network."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from core.editing.fields import SetField
from core.editing.links import Rewire
from core.editing.macros.border_links import with_moved_names
from core.editing.nodes import Move, Remove, Rename
from core.editing.operation import ABSENT, Operation, Together
from core.editing.output_mark import SetOutput
from core.editing.references import dropped, renamed
from core.errors import NetworkError
from core.names import shown, thaw
from core.network.expansion import unfolded
from core.network.interface import PARAMETERS, Interface
from core.network.linked_values import naming
from core.network.macro import (
    SEPARATOR,
    checked_depth,
    depth,
    face_of_macro,
    path_of,
    with_face,
)
from core.network.network import Link, Network, Node


@dataclass(frozen=True)
class Inside(Operation):
    """Carry an operation out inside of a macro.

    Ports and parameters that the macro shows follow the nodes they stand for; where these are gone,
    the wires to the macro's port and its value of the parameter go too.

    Parameters
    ----------
    macro : str
        The macro's id.
    operation : Operation
        Of the network inside; an `Inside` itself where that has the macro meant.
    """

    macro: str
    operation: Operation

    @property
    def text(self) -> str:
        """What it does."""
        return self.operation.text

    def apply(self, network: Network) -> Network:
        """The network with the change inside."""
        node = network.node(self.macro)
        if node.macro is None:
            raise NetworkError(f"{shown(self.macro)} is no macro: nothing lies inside of it")
        after = self.operation.apply(node.macro)
        if after is node.macro:
            return network
        checked_depth(1 + depth(after), self.macro)
        return with_body(network, node, after, self.operation.moved(node.macro))

    def moved(self, network: Network) -> dict[str, str]:
        """The names of nodes inside."""
        inside = network.node(self.macro).macro
        names = self.operation.moved(inside) if inside is not None else {}
        head = f"{self.macro}{SEPARATOR}"
        return {head + old: head + new for old, new in names.items()}


def with_body(
    network: Network, node: Node, body: Network, moved: Mapping[str, str] = MappingProxyType({})
) -> Network:
    """The network with another inside of a macro, and without what this does not show any more.

    `moved` has what nodes inside are called now that had another name.
    """
    assert node.macro is not None
    face = face_of_macro(body)
    params = {name: value for name, value in node.params.items() if name in face.parameters}
    links = tuple(link for link in network.links if not _to_missing(link, node.id, face))
    extra = _mentions(network, node, body, moved)
    changed = network.with_node(replace(node, params=params, macro=body))
    changed = replace(_following_names(changed, node.id, moved), extra=extra)
    if len(links) < len(network.links):
        changed = replace(changed, links=links)
    outer = face_of_macro(network)
    shown_still = {
        name: end
        for name, end in outer.parameters.items()
        if end[0] != node.id or end[1] in face.parameters
    }
    if len(shown_still) < len(outer.parameters):
        changed = with_face(changed, outer.with_parameters(shown_still))
    return changed


def _following_names(network: Network, macro: str, moved: Mapping[str, str]) -> Network:
    """The network with the new names of nodes inside where its expressions name them."""
    head = f"{macro}{SEPARATOR}"
    names = {head + old: head + new for old, new in moved.items()}
    if not names or not naming(network, names):
        return network
    return network.with_nodes(with_moved_names(network.nodes.values(), names))


def _to_missing(link: Link, macro: str, face: Interface) -> bool:
    gone_output = link.source == macro and link.output not in face.outputs
    return gone_output or (link.target == macro and link.input not in face.inputs)


def _mentions(
    network: Network, node: Node, body: Network, moved: Mapping[str, str]
) -> Mapping[str, Any]:
    """The network's fields that name nodes inside, after these have changed."""
    assert node.macro is not None
    before, after = set(unfolded(node.macro).nodes), set(unfolded(body).nodes)
    extra: Mapping[str, Any] = network.extra
    head = f"{node.id}{SEPARATOR}"
    for old, new in moved.items():
        extra = renamed(extra, head + old, head + new)
    gone = before - after - moved.keys()
    return dropped(extra, {head + name for name in gone}) if gone else extra


def at_level(path: tuple[str, ...], operation: Operation) -> Operation:
    """An operation of the network inside the macros of a path, as one of the whole network."""
    if not path:
        return operation
    if isinstance(operation, SetOutput):  # there is one output in all the network
        head = "".join(f"{macro}{SEPARATOR}" for macro in path)
        return replace(operation, nodes=tuple(head + name for name in operation.nodes))
    for macro in reversed(path):
        operation = Inside(macro, operation)
    return operation


def addressed(network: Network, operation: Operation) -> Operation:
    """An operation that names nodes as `core.network.expansion.unfolded` does, made to fit.

    A parameter that a macro shows is set inside, and no longer by the macro: what was set last
    holds.

    Raises
    ------
    NetworkError
        If nodes of several macros take part in one operation.
    """
    match operation:
        case Together():
            steps = [addressed(network, step) for step in operation.operations]
            return Together(steps, operation.label)
        case SetField(("nodes", node, *rest)) if _lies_inside(network, node):
            *macros, name = path_of(network, node)
            inner = replace(operation, path=("nodes", name, *rest), label=operation.text)
            step = at_level(tuple(macros), inner)
            return _set_inside(network, tuple(macros), (name, rest[-1]), step, rest[0] == "params")
        case Rename(old, new) if _lies_inside(network, old):
            *macros, name = path_of(network, old)
            return at_level(tuple(macros), Rename(name, new))
        case Remove(names):
            path, local = _common(network, names)
            return at_level(path, replace(operation, names=local)) if path else operation
        case Move(positions):
            path, local = _common(network, tuple(positions))
            places = dict(zip(local, positions.values(), strict=True))
            return at_level(path, replace(operation, positions=places)) if path else operation
        case Rewire(add, remove):
            return _rewired(network, operation, (*add, *remove))
    return operation


def _lies_inside(network: Network, name: str) -> bool:
    """Whether it names a node inside of a macro; not so of nodes that are yet to come."""
    return name not in network.nodes and network.has(name)


def _common(network: Network, names: tuple[str, ...]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The macros that all these nodes lie in, and their own ids."""
    paths = [path_of(network, name) if network.has(name) else (name,) for name in names]
    levels = {path[:-1] for path in paths}
    if len(levels) > 1:
        raise NetworkError("these nodes lie in different macros")
    return next(iter(levels), ()), tuple(path[-1] for path in paths)


def _rewired(network: Network, operation: Rewire, links: tuple[Link, ...]) -> Operation:
    ends = dict.fromkeys(end for link in links for end in (link.source, link.target))
    path, local = _common(network, tuple(ends))
    if not path:
        return operation
    names = dict(zip(ends, local, strict=True))
    add, remove = (
        tuple(replace(link, source=names[link.source], target=names[link.target]) for link in group)
        for group in (operation.add, operation.remove)
    )
    return at_level(path, replace(operation, add=add, remove=remove, label=operation.text))


def _set_inside(
    network: Network,
    macros: tuple[str, ...],
    end: tuple[str, str],
    step: Operation,
    is_parameter: bool,
) -> Operation:
    """The step, and taking away the values by which macros outside set the same parameter."""
    levels = [network]
    for macro in macros:
        body = levels[-1].nodes[macro].macro
        assert body is not None
        levels.append(body)
    steps = [step]
    while is_parameter and len(levels) > 1:
        face = face_of_macro(levels.pop())
        name = next((name for name, inner in face.parameters.items() if inner == end), None)
        if name is None:
            break
        macro = macros[len(levels) - 1]
        if name in levels[-1].nodes[macro].params:
            taking = SetField(("nodes", macro, "params", name), ABSENT)
            steps.append(at_level(macros[: len(levels) - 1], taking))
        end = macro, name
    return steps[0] if len(steps) == 1 else Together(steps, step.text)


def parameters_of(body: Network) -> dict[str, Any]:
    """The parameters a macro shows, as its file has them."""
    return dict(thaw(body.extra.get(PARAMETERS, {})))
