"""Changes of nodes inside of macros, and of the parameters that a macro shows."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from core.editing.operations import (
    ABSENT,
    Edit,
    Inside,
    Operation,
    SetOutput,
    Together,
    body_of,
    exposed_as,
    fresh_name,
    set_network_field,
    set_parameter,
)
from core.errors import NetworkError
from core.names import shown, thaw
from core.network.expressions import readable
from core.network.linked_values import references, with_references
from core.network.macro import (
    PARAMETERS,
    SEPARATOR,
    End,
    face_of_macro,
    interface_of,
    path_of,
    text,
    with_face,
)
from core.network.network import Network


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


def parameters_of(body: Network) -> dict[str, Any]:
    """The parameters a macro shows, as its file has them."""
    return dict(thaw(body.extra.get(PARAMETERS, {})))


def expose(network: Network, node: str, parameter: str) -> Operation:
    """Show a parameter of an inner node, ``camera/init``, on the panel of the macro around it."""
    *macros, inner = path_of(network, node)
    if not macros:
        raise NetworkError(
            f"{shown(node)} is not inside a macro, so no macro can show its parameters"
        )
    shown_already = exposed_as(network, node, parameter)
    if shown_already:
        raise NetworkError(
            f"{shown(macros[-1])} already shows {shown(node)}.{parameter} as {shown_already}"
        )
    body = body_of(network, macros)
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
    body = body_of(network, path)
    entries = parameters_of(body)
    inner, parameter = face_of_macro(body).parameters[name]
    del entries[name]
    taking = set_network_field(PARAMETERS, entries or ABSENT)
    container = body_of(network, path[:-1])
    for node, parameter_of, reference in references(container):
        itself = (node, parameter_of) == (path[-1], name)
        if (reference.node, reference.parameter) == (path[-1], name) and not itself:
            raise NetworkError(
                f"{shown(macro)}.{name} cannot be hidden, because {shown(node)}.{parameter_of} "
                f"follows it; unlink {shown(node)}.{parameter_of} first"
            )
    steps: tuple[Operation, ...] = (at_level(path, taking),)
    given = container.nodes[path[-1]].params.get(name, ABSENT)
    if name in container.nodes[path[-1]].linked:
        given = value_of(macro, name)
        given = ABSENT if isinstance(given, Mapping) else given  # it had none
    if given is not ABSENT:
        setting = set_parameter(SEPARATOR.join((*path, inner)), parameter, thaw(given))
        steps = (setting, *steps)
    return Together(steps, f"Hide {macro}.{name}")


def rename_exposed(network: Network, macro: str, old: str, new: str) -> Operation:
    """Give a parameter that a macro shows another name, wherever it is mentioned."""
    *outer, name = path_of(network, macro)
    rename = partial(_with_exposed_renamed, macro=name, old=old, new=new)
    return at_level(tuple(outer), Edit(rename, f"Rename {name}.{old} to {new}"))


def _with_exposed_renamed(network: Network, *, macro: str, old: str, new: str) -> Network:
    node = network.node(macro)
    assert node.macro is not None
    entries = parameters_of(node.macro)
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
                f"an expression uses {shown(macro)}.{old}, so the new name must be one word of "
                f"letters, digits and _, not {shown(new)}"
            )
        changed = changed.with_nodes(
            {name: with_references(other, moved) for name, other in changed.nodes.items()}
        )
    face = face_of_macro(network)
    ends = {name: moved(*end) for name, end in face.parameters.items()}
    return with_face(changed, replace(face, parameters=ends))
