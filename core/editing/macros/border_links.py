"""Expressions at the border of a macro: what they name when nodes go into one, or come out."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import Any

from core.editing.nodes import fresh_name
from core.errors import NetworkError
from core.expressions.grammar import ExpressionError
from core.names import thaw
from core.network.interface import End, Interface
from core.network.linked_values import named_nodes, new_name, with_names, with_references
from core.network.network import EXPRESSION, Network, Node


def with_lifted(
    network: Network, members: Collection[str], parameters: Mapping[str, End]
) -> dict[str, End]:
    """Parameters for a macro of these nodes to show: also those that follow nodes outside of it.

    From inside of a macro nothing outside can be named: such an expression becomes one of the
    macro's own parameter.
    """
    shown_ends = dict(parameters)
    for name in members:
        for parameter, leaders in named_nodes(network.nodes[name]).items():
            outside = any(not _lies_in(leader, members) for leader in leaders)
            if outside and (name, parameter) not in shown_ends.values():
                shown_ends[fresh_name(parameter, shown_ends)] = (name, parameter)
    return shown_ends


def expressions_for_macro(
    members: Mapping[str, Node], face: Interface, names: Mapping[str, str]
) -> dict[str, Any]:
    """The expressions that a macro's own parameters take over from the nodes inside of it.

    Parameters
    ----------
    members : mapping
        The nodes by id, as they were.
    face : Interface
        What the macro shows.
    names : mapping of str to str
        What the nodes are called from now on.
    """
    params = {}
    for name, (inner, parameter) in face.parameters.items():
        leaders = named_nodes(members[inner]).get(parameter, frozenset())
        if any(not _lies_in(leader, members) for leader in leaders):
            params[name] = _renamed(members[inner], names).params[parameter]
    return params


def inside_of_macro(
    node: Node, face: Interface, lifted: Collection[str], values: Mapping[str, Any]
) -> Node:
    """A node that goes into a macro, without the expressions that the macro has taken over.

    Parameters
    ----------
    node : Node
        The node.
    face : Interface
        What the macro shows.
    lifted : collection of str
        Those of the macro's parameters that have taken over an expression.
    values : mapping
        By parameter of the macro: the value that the inner one has from then on.
    """
    params = dict(node.params)
    for name in lifted:
        inner, parameter = face.parameters[name]
        if inner == node.id:
            del params[parameter]
            if name in values:
                params[parameter] = values[name]
    return node if params == node.params else replace(node, params=params)


def values_of_lifted(
    parameters: Mapping[str, End], value_of: Callable[[str, str], Any]
) -> dict[str, Any]:
    """The present values of parameters, by the name that the macro shows them under."""
    values = {name: thaw(value_of(*end)) for name, end in parameters.items()}
    return {
        name: value
        for name, value in values.items()
        if value is not None and not (isinstance(value, dict) and EXPRESSION in value)
    }


def with_moved_names(nodes: Iterable[Node], names: Mapping[str, str]) -> dict[str, Node]:
    """The nodes with other names in their expressions.

    Raises
    ------
    NetworkError
        If an expression would become too long.
    """
    return {node.id: _renamed(node, names) for node in nodes}


def after_ungrouping(
    node: Node, macro: str, face: Interface, names: Mapping[str, str], moved: Mapping[str, str]
) -> Node:
    """A node whose expressions name the nodes that lay in a macro, no longer the macro.

    Parameters
    ----------
    node : Node
        A node around the macro.
    macro : str
        The macro's id.
    face : Interface
        What it showed.
    names : mapping of str to str
        What the nodes inside are called from now on, by their own ids.
    moved : mapping of str to str
        The same by their whole names, and those of nodes inside of them.

    Raises
    ------
    NetworkError
        If an expression would become too long.
    """

    def instead(leader: str, parameter: str) -> End:
        end = face.parameters.get(parameter) if leader == macro else None
        if end is not None:
            return names[end[0]], end[1]
        return new_name(leader, moved), parameter

    try:
        return with_references(node, instead)
    except ExpressionError as error:
        raise NetworkError(error.message) from None


def _renamed(node: Node, names: Mapping[str, str]) -> Node:
    try:
        return with_names(node, names)
    except ExpressionError as error:
        raise NetworkError(error.message) from None


def _lies_in(name: str, members: Collection[str]) -> bool:
    return name in members or new_name(name, dict.fromkeys(members, "")) != name
