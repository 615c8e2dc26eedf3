"""Whether the macros of a network are sound: what they show is there, and once each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping

from core.errors import ImagechainError, NetworkError, ParameterError
from core.modules.declaration import Declaration
from core.modules.library_type import Library
from core.names import close, shown
from core.network.expansion import has_macros
from core.network.graph import cycles
from core.network.interface import End, Interface, text
from core.network.macro import (
    SEPARATOR,
    declared_node,
    face_of_macro,
    macros_in,
    passing_input,
)
from core.network.network import Network, Node, cycle_error


def macro_problems(
    network: Network, library: Library, *, unfinished: bool = False
) -> list[ImagechainError]:
    """Every fault of the macros themselves; those of the nodes inside are not among them.

    Parameters
    ----------
    network : Network
        The document.
    library : mapping
        Modules by key; one that is not in it may have any ports and parameters.
    unfinished : bool
        Accept wires from a disabled macro that has nothing to pass on to them.
    """
    if not has_macros(network):
        return []
    faults: list[ImagechainError] = [*_one_name_twice(network)]
    for where, level in _levels(network):
        faults += [_placed(error, where) for error in _at_level(level, library, unfinished)]
    return faults


def _levels(network: Network) -> Iterator[tuple[str, Network]]:
    yield "", network
    for name, node in macros_in(network):
        if node.macro is not None:
            yield f"{name}{SEPARATOR}", node.macro


def _placed(error: ImagechainError, where: str) -> ImagechainError:
    error.node = f"{where}{error.node}" if error.node is not None else where[:-1] or None
    return error


def _at_level(level: Network, library: Library, unfinished: bool) -> Iterator[ImagechainError]:
    if any(node.macro is not None for node in level.nodes.values()):
        yield from (cycle_error(loop) for loop in cycles(level.followers))
    for node in level.nodes.values():
        if node.macro is not None:
            yield from _of_macro(node, node.macro, library)
            yield from _of_links(level, node, library, unfinished)


def _one_name_twice(network: Network) -> Iterator[NetworkError]:
    """Nodes whose ids are those of nodes inside: ``a/b`` beside the node b of the macro a."""
    names = Counter(_plain_names(network))
    for name, count in names.items():
        if count > 1:
            yield NetworkError(
                f"{shown(name)} is the name of {count} nodes, one of them inside of a macro: "
                "give one of them another id"
            )


def _plain_names(network: Network, prefix: str = "") -> Iterator[str]:
    for name, node in network.nodes.items():
        yield prefix + name
        if node.macro is not None:
            yield from _plain_names(node.macro, f"{prefix}{name}{SEPARATOR}")


def _of_macro(node: Node, body: Network, library: Library) -> Iterator[ImagechainError]:
    face = face_of_macro(body)
    declared = {name: declared_node(inner, library) for name, inner in body.nodes.items()}
    for kind, name, end in _shown(face):
        wrong = _missing(body, declared, kind, end)
        if wrong:
            yield NetworkError(
                f"its {kind} {shown(name)} names {shown(text(end))}{wrong}", node=node.id
            )
    fed = [end for ends in face.inputs.values() for end in ends]
    for kind, named in (("input", fed), ("parameter", list(face.parameters.values()))):
        for end, count in Counter(named).items():
            if count > 1:
                given = "fed by" if kind == "input" else "set by"
                yield NetworkError(
                    f"the inner {kind} {shown(text(end))} is {given} {count} {kind}s of the macro: "
                    "it takes one",
                    node=node.id,
                )
    for link in body.links:
        for name, targets in face.inputs.items():
            if (link.target, link.input) in targets:
                yield NetworkError(
                    f"its input {shown(name)} feeds {shown(link.text()[1])}, which has a link "
                    f"inside already ({link})",
                    node=node.id,
                )
    for name, value in node.params.items():
        if name not in face.parameters:
            hint = close(name, face.parameters) or _listed(face.parameters)
            title = body.name or "the macro"
            yield ParameterError(
                shown(name), value, f"{title} shows no such parameter{hint}", node=node.id
            )


def _shown(face: Interface) -> Iterator[tuple[str, str, End]]:
    for name, ends in face.inputs.items():
        for end in ends:
            yield "input", name, end
    for name, end in face.outputs.items():
        yield "output", name, end
    for name, end in face.parameters.items():
        yield "parameter", name, end


def _missing(
    body: Network, declared: dict[str, Declaration | None], kind: str, end: End
) -> str | None:
    """What is wrong with an inner port or parameter that a macro names."""
    if end[0] not in body.nodes:
        return f", but there is no node {shown(end[0])} inside{close(end[0], body.nodes)}"
    module = declared[end[0]]
    if module is None:
        return None
    known: Mapping[str, list[str]] = {
        "input": [port.name for port in module.inputs],
        "output": [port.name for port in module.outputs],
        "parameter": [parameter.name for parameter in module.parameters],
    }
    names = known[kind]
    if end[1] in names:
        return None
    hint = close(end[1], names) or _listed(names)
    return f", but {module.title} has no {kind} {shown(end[1])}{hint}"


def _of_links(
    level: Network, node: Node, library: Library, unfinished: bool
) -> Iterator[NetworkError]:
    assert node.macro is not None
    face = face_of_macro(node.macro)
    for link in level.links:
        for end, side, names in (
            ((link.target, link.input), "input", face.inputs),
            ((link.source, link.output), "output", face.outputs),
        ):
            if end[0] == node.id and end[1] not in names:
                hint = close(end[1], names) or _listed(names)
                yield NetworkError(
                    f"the macro has no {side} {shown(end[1])} (the link {link}){hint}",
                    node=node.id,
                )
        leaving = link.source == node.id and node.disabled and link.output in face.outputs
        if leaving and not unfinished and passing_input(node, link.output, library) is None:
            yield NetworkError(
                f"the link {link} brings nothing: the macro is disabled, and no input of its "
                f"passes on as {shown(link.output)}",
                node=node.id,
            )


def _listed(names: Iterable[str]) -> str:
    return f": it has {', '.join(names) or 'none'}"
