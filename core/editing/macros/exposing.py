"""Operations on the parameters that a macro shows of its inside."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from core.editing.fields import set_network_field, set_parameter
from core.editing.macros.inside import addressed, at_level, parameters_of
from core.editing.nodes import fresh_name
from core.editing.operation import ABSENT, Operation, Together
from core.errors import NetworkError
from core.expressions.grammar import ExpressionError, Reference, readable
from core.names import close, shown, thaw
from core.network.interface import PARAMETERS, End, interface_of, text
from core.network.linked_values import references_in, with_references
from core.network.macro import SEPARATOR, face_of_macro, path_of, with_face
from core.network.network import Network


def expose(network: Network, node: str, parameter: str, name: str = "") -> Operation:
    """Show a parameter of an inner node on the panel of the macro it lies in.

    Parameters
    ----------
    network : Network
        The whole network.
    node : str
        The inner node, ``camera/init``.
    parameter : str
        Its parameter.
    name : str, optional
        What it is called there; its own name, or the next that is free.

    Raises
    ------
    NetworkError
        If the node lies in no macro, or the parameter is shown already.
    """
    *macros, inner = path_of(network, node)
    if not macros:
        raise NetworkError(f"{shown(node)} lies in no macro that could show its parameters")
    shown_already = exposed_as(network, node, parameter)
    if shown_already:
        raise NetworkError(
            f"{shown(macros[-1])} shows {shown(node)}.{parameter} already, as {shown_already}"
        )
    body = _body(network, macros)
    entries = parameters_of(body)
    if name in entries:
        raise NetworkError(f"{shown(macros[-1])} has a parameter {shown(name)} already")
    wanted = name or fresh_name(parameter, entries)
    entries[wanted] = text((inner, parameter))
    interface_of({PARAMETERS: entries})  # whether the name is allowed
    label = f"Expose {node}.{parameter}"
    return at_level(tuple(macros), set_network_field(PARAMETERS, entries, label))


def hide(network: Network, macro: str, name: str, value_of: Callable[[str, str], Any]) -> Operation:
    """Take a parameter off a macro's panel; the value it was given there stays, inside.

    Parameters
    ----------
    network : Network
        The whole network.
    macro, name : str
        The macro, ``camera`` or ``camera/lens``, and its parameter.
    value_of : callable
        The value of a node's parameter: it takes the place of an expression, which could name
        nothing from inside.

    Raises
    ------
    NetworkError
        If the macro shows no such parameter, or another follows it.
    """
    path = path_of(network, macro)
    body = _body(network, path)
    entries = parameters_of(body)
    _known(macro, entries, name)
    inner, parameter = face_of_macro(body).parameters[name]
    del entries[name]
    taking = set_network_field(PARAMETERS, entries or ABSENT)
    container = _body(network, path[:-1])
    for node, parameter_of, reference in _references_to(container, path[-1]):
        itself = (node, parameter_of) == (path[-1], name)
        if reference.parameter == name and not itself:
            raise NetworkError(
                f"{shown(macro)}.{name} cannot be hidden: {shown(node)}.{parameter_of} follows it; "
                "unlink that first"
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


@dataclass(frozen=True)
class RenameExposed(Operation):
    """Give a parameter that a macro shows another name, wherever it is mentioned.

    Parameters
    ----------
    macro : str
        Id of the macro, in the network the operation is applied to.
    old, new : str
        The names.
    """

    macro: str
    old: str
    new: str

    @property
    def text(self) -> str:
        """What it does."""
        return f"Rename {self.macro}.{self.old} to {self.new}"

    def apply(self, network: Network) -> Network:
        """The network with the new name."""
        node = network.node(self.macro)
        if node.macro is None:
            raise NetworkError(f"{shown(self.macro)} is no macro")
        entries = parameters_of(node.macro)
        _known(self.macro, entries, self.old)
        if self.new != self.old and self.new in entries:
            raise NetworkError(f"{shown(self.macro)} has a parameter {shown(self.new)} already")

        def name_of(name: str) -> str:
            return self.new if name == self.old else name

        entries = {name_of(name): end for name, end in entries.items()}
        interface_of({PARAMETERS: entries})
        body = replace(node.macro, extra={**node.macro.extra, PARAMETERS: entries})
        params = {name_of(name): value for name, value in node.params.items()}
        changed = network.with_node(replace(node, params=params, macro=body))
        if any(one.parameter == self.old for _, _, one in _references_to(network, self.macro)):
            changed = self._named_anew(changed)
        face = face_of_macro(network)
        ends = {
            name: (end[0], name_of(end[1])) if end[0] == self.macro else end
            for name, end in face.parameters.items()
        }
        return with_face(changed, face.with_parameters(ends))

    def _named_anew(self, network: Network) -> Network:
        """With the new name in the expressions that follow it."""
        if not readable(self.new):
            raise NetworkError(
                f"{shown(self.macro)}.{self.old} is followed by an expression: its name must be "
                f"one word of letters, digits and _, not {shown(self.new)}"
            )

        def moved(node: str, parameter: str) -> End:
            ours = (node, parameter) == (self.macro, self.old)
            return (node, self.new) if ours else (node, parameter)

        try:
            return network.with_nodes(
                {name: with_references(node, moved) for name, node in network.nodes.items()}
            )
        except ExpressionError as error:
            raise NetworkError(error.message) from None


def rename_exposed(network: Network, macro: str, old: str, new: str) -> Operation:
    """Give a parameter that a macro shows another name; the macro may lie in others."""
    *outer, name = path_of(network, macro)
    return at_level(tuple(outer), RenameExposed(name, old, new))


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
            raise NetworkError(f"{shown(macro)} is no macro")
        network = body
    return network


def _references_to(network: Network, macro: str) -> Iterator[tuple[str, str, Reference]]:
    """Node and parameter of each expression around a macro that names it, and what it names."""
    for node in network.nodes.values():
        for parameter in node.linked:
            for reference in references_in(node.params[parameter]):
                if reference.node == macro:
                    yield node.id, parameter, reference


def _known(macro: str, entries: dict[str, str], name: str) -> None:
    if name not in entries:
        hint = close(name, entries) or f": it shows {', '.join(entries) or 'none'}"
        raise NetworkError(f"{shown(macro)} shows no parameter {shown(name)}{hint}")
