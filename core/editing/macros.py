"""Changes of nodes inside of macros, and of the parameters that a macro shows."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from core.editing.operations import (
    ABSENT,
    Edit,
    Operation,
    Rename,
    SetField,
    SetOutput,
    Together,
    fresh_name,
    set_network_field,
    set_parameter,
)
from core.editing.references import dropped, renamed
from core.errors import NetworkError
from core.names import close, shown, thaw
from core.network.expressions import readable
from core.network.linked_values import (
    naming,
    references,
    with_names,
    with_references,
)
from core.network.macro import (
    PARAMETERS,
    SEPARATOR,
    End,
    checked_depth,
    depth,
    face_of_macro,
    interface_of,
    path_of,
    text,
    unfolded,
    with_face,
)
from core.network.network import Network, Node


@dataclass(frozen=True)
class Inside(Operation):
    """Carry an operation out inside of a macro.

    Ports and parameters that the macro shows follow the nodes they stand for; where these are gone,
    the wires to the macro's port and its value of the parameter go too.
    """

    macro: str
    operation: Operation

    def _usual_text(self) -> str:
        return self.operation.text

    def apply(self, network: Network) -> Network:
        node = network.node(self.macro)
        if node.macro is None:
            raise NetworkError(
                f"{shown(self.macro)} is not a macro, so there are no nodes inside it"
            )
        after = self.operation.apply(node.macro)
        if after is node.macro:
            return network
        checked_depth(1 + depth(after), self.macro)
        return _with_body(network, node, after, self.operation.moved(node.macro))

    def moved(self, network: Network) -> dict[str, str]:
        inside = network.node(self.macro).macro
        names = self.operation.moved(inside) if inside is not None else {}
        head = f"{self.macro}{SEPARATOR}"
        return {head + old: head + new for old, new in names.items()}


def _with_body(network: Network, node: Node, body: Network, moved: Mapping[str, str]) -> Network:
    """The network with another inside of a macro, and without what this does not show any more."""
    assert node.macro is not None
    face, outer, head = face_of_macro(body), face_of_macro(network), f"{node.id}{SEPARATOR}"
    params = {name: value for name, value in node.params.items() if name in face.parameters}
    changed = network.with_node(replace(node, params=params, macro=body))
    names = {head + old: head + new for old, new in moved.items()}
    if names and naming(changed, names):
        nodes = {name: with_names(other, names) for name, other in changed.nodes.items()}
        changed = changed.with_nodes(nodes)
    extra: Mapping[str, Any] = renamed(network.extra, names) if names else network.extra
    gone = set(unfolded(node.macro).nodes) - set(unfolded(body).nodes) - moved.keys()
    if gone:
        extra = dropped(extra, {head + name for name in gone})
    links = tuple(
        link
        for link in network.links
        if (link.source != node.id or link.output in face.outputs)
        and (link.target != node.id or link.input in face.inputs)
    )
    changed = replace(changed, links=links, extra=extra)
    shown_still = {
        name: end
        for name, end in outer.parameters.items()
        if end[0] != node.id or end[1] in face.parameters
    }
    if len(shown_still) < len(outer.parameters):
        changed = with_face(changed, replace(outer, parameters=shown_still))
    return changed


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
    """An operation on a field or name of a node inside, called ``camera/blur``, made to fit.

    A parameter that a macro shows is set inside, and no longer by the macro: what was set last
    holds.
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
    return operation


def _lies_inside(network: Network, name: str) -> bool:
    """Whether it names a node inside of a macro; not so of nodes that are yet to come."""
    return name not in network.nodes and network.has(name)


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


def expose(network: Network, node: str, parameter: str) -> Operation:
    """Show a parameter of an inner node, ``camera/init``, on the panel of the macro around it."""
    *macros, inner = path_of(network, node)
    if not macros:
        raise NetworkError(f"{shown(node)} is not inside a macro that could show its parameters")
    shown_already = exposed_as(network, node, parameter)
    if shown_already:
        raise NetworkError(
            f"{shown(macros[-1])} shows {shown(node)}.{parameter} already, as {shown_already}"
        )
    body = _body(network, macros)
    entries = parameters_of(body)
    wanted = fresh_name(parameter, entries)
    entries[wanted] = text((inner, parameter))
    interface_of({PARAMETERS: entries})  # whether the name is allowed
    label = f"Expose {node}.{parameter}"
    return at_level(tuple(macros), set_network_field(PARAMETERS, entries, label))


def hide(network: Network, macro: str, name: str, value_of: Callable[[str, str], Any]) -> Operation:
    """Take a parameter off a macro's panel; the value it was given there stays, inside.

    `value_of` gives the value of a node's parameter: it takes the place of an expression, which
    could name nothing from inside.
    """
    path = path_of(network, macro)
    body = _body(network, path)
    entries = parameters_of(body)
    _known(macro, entries, name)
    inner, parameter = face_of_macro(body).parameters[name]
    del entries[name]
    taking = set_network_field(PARAMETERS, entries or ABSENT)
    container = _body(network, path[:-1])
    for node, parameter_of, reference in references(container):
        itself = (node, parameter_of) == (path[-1], name)
        if (reference.node, reference.parameter) == (path[-1], name) and not itself:
            raise NetworkError(
                f"{shown(macro)}.{name} cannot be hidden, because {shown(node)}.{parameter_of} "
                "follows it; unlink that parameter first"
            )
    steps: tuple[Operation, ...] = (at_level(path, taking),)
    given = container.nodes[path[-1]].params.get(name, ABSENT)
    if name in container.nodes[path[-1]].linked:
        given = value_of(macro, name)
        given = ABSENT if isinstance(given, Mapping) else given  # it had none
    if given is not ABSENT:
        setting = set_parameter(SEPARATOR.join((*path, inner)), parameter, thaw(given))
        steps = (addressed(network, setting), *steps)
    return Together(steps, f"Hide {macro}.{name}")


def rename_exposed(network: Network, macro: str, old: str, new: str) -> Operation:
    """Give a parameter that a macro shows another name, wherever it is mentioned."""
    *outer, name = path_of(network, macro)
    rename = partial(_with_exposed_renamed, macro=name, old=old, new=new)
    return at_level(tuple(outer), Edit(rename, f"Rename {name}.{old} to {new}"))


def _with_exposed_renamed(network: Network, *, macro: str, old: str, new: str) -> Network:
    node = network.node(macro)
    if node.macro is None:
        raise NetworkError(f"{shown(macro)} is not a macro")
    entries = parameters_of(node.macro)
    _known(macro, entries, old)
    if new != old and new in entries:
        raise NetworkError(f"{shown(macro)} already has a parameter {shown(new)}")

    def name_of(name: str) -> str:
        return new if name == old else name

    def moved(node: str, name: str) -> End:
        return node, name_of(name) if node == macro else name

    entries = {name_of(name): end for name, end in entries.items()}
    interface_of({PARAMETERS: entries})
    body = replace(node.macro, extra={**node.macro.extra, PARAMETERS: entries})
    params = {name_of(name): value for name, value in node.params.items()}
    changed = network.with_node(replace(node, params=params, macro=body))
    if any((one.node, one.parameter) == (macro, old) for _, _, one in references(network)):
        if not readable(new):
            raise NetworkError(
                f"{shown(macro)}.{old} is followed by an expression: its name must be "
                f"one word of letters, digits and _, not {shown(new)}"
            )
        changed = changed.with_nodes(
            {name: with_references(other, moved) for name, other in changed.nodes.items()}
        )
    face = face_of_macro(network)
    ends = {name: moved(*end) for name, end in face.parameters.items()}
    return with_face(changed, replace(face, parameters=ends))


def exposed_as(network: Network, node: str, parameter: str) -> str:
    """What the macro around an inner node calls its parameter; empty where it is not shown."""
    *macros, inner = path_of(network, node)
    if not macros:
        return ""
    parameters = face_of_macro(_body(network, macros)).parameters
    return next((name for name, end in parameters.items() if end == (inner, parameter)), "")


def _body(network: Network, macros: list[str] | tuple[str, ...]) -> Network:
    for macro in macros:
        body = network.node(macro).macro
        if body is None:
            raise NetworkError(f"{shown(macro)} is not a macro")
        network = body
    return network


def _known(macro: str, entries: dict[str, str], name: str) -> None:
    if name not in entries:
        hint = close(name, entries) or f": it shows {', '.join(entries) or 'none'}"
        raise NetworkError(f"{shown(macro)} shows no parameter {shown(name)}{hint}")
