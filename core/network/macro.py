"""Macros: nodes that hold a network of their own. Their inside, and names of nodes within."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from core.errors import NetworkError, ParameterError
from core.modules.declaration import Declaration, Port, declaration
from core.modules.library_type import Library
from core.modules.panel_sections import complete
from core.modules.parameters import Parameter
from core.names import shown, thaw
from core.network.interface import FIELDS, End, Interface, interface_of
from core.network.network import MACRO, Network, Node, passed_through

SEPARATOR = "/"
"""Between a macro's id and that of a node inside: ``camera/blur``."""

DEEPEST = 8
"""So many macros may lie one inside the other."""

GROUP = "Macros"


def face_of_macro(body: Network) -> Interface:
    """The ports and parameters that a macro shows; none where its fields are not sound."""
    try:
        return interface_of(body.extra)
    except NetworkError:
        return Interface()


def with_face(body: Network, face: Interface) -> Network:
    """The inside of a macro with other ports and parameters."""
    others = {name: value for name, value in body.extra.items() if name not in FIELDS}
    extra = others | face.fields()
    return body if thaw(extra) == thaw(body.extra) else replace(body, extra=extra)


def opened(node: Node, *, linked: bool = True) -> Network:
    """The inside of a macro with the values that its node gives to exposed parameters.

    It is made once for a node, so that nodes which no edit touched stay the same objects.

    Parameters
    ----------
    node : Node
        The macro.
    linked : bool
        With the node's expressions as well, though what they name lies around the macro.
    """
    assert node.macro is not None
    made: dict[bool, Network] = vars(node).setdefault("_opened", {})
    if linked not in made:
        left_out = () if linked else node.linked
        body = node.macro
        for name, (inner, parameter) in face_of_macro(body).parameters.items():
            if name in node.params and name not in left_out and inner in body.nodes:
                body = body.with_parameter(inner, parameter, node.params[name])
        made[linked] = body
    return made[linked]


def under(macro: Node, inner: Node) -> Node:
    """A node of a macro's inside as it is called outside, ``camera/blur``.

    The same object each time, so that what is planned for it stays.
    """
    auto = inner.auto if macro.auto is None else macro.auto
    made: dict[tuple[str, bool | None], Node] = vars(inner).setdefault("_under", {})
    if (macro.id, auto) not in made:
        outer = f"{macro.id}{SEPARATOR}{inner.id}"
        made[macro.id, auto] = replace(inner, id=outer, auto=auto)
    return made[macro.id, auto]


def step_inside(network: Network, name: str) -> tuple[str, str] | None:
    """The macro that a name such as ``camera/optics/blur`` begins with, and the rest of it."""
    if name in network.nodes:
        return None
    for place, letter in enumerate(name):
        if letter == SEPARATOR:
            node = network.nodes.get(name[:place])
            if node is not None and node.macro is not None and node.macro.has(name[place + 1 :]):
                return name[:place], name[place + 1 :]
    return None


def path_of(network: Network, name: str) -> tuple[str, ...]:
    """The macros that a node lies in, from the outside, and its own id at the end.

    Raises
    ------
    NetworkError
        If there is no such node.
    """
    path = []
    while (step := step_inside(network, name)) is not None:
        macro, name = step
        path.append(macro)
        inside = network.nodes[macro].macro
        assert inside is not None
        network = inside
    network.node(name)
    return (*path, name)


def macros_in(network: Network) -> Iterator[tuple[str, Node]]:
    """Every macro with its name, those inside of others after them."""
    for name, node in network.nodes.items():
        if node.macro is not None:
            yield name, node
            for inner, other in macros_in(node.macro):
                yield f"{name}{SEPARATOR}{inner}", other


def depth(network: Network) -> int:
    """How many macros lie one inside the other."""
    bodies = [node.macro for node in network.nodes.values() if node.macro is not None]
    return max((1 + depth(body) for body in bodies), default=0)


def declared_node(node: Node, library: Library) -> Declaration | None:
    """What a node's module declares, or a macro shows of its inside; None of an unknown module."""
    if node.macro is not None:
        return _declared_macro(node, node.macro, library)
    module = library.get(node.module)
    return declaration(module) if module is not None else None


def _declared_macro(node: Node, body: Network, library: Library) -> Declaration:
    face = face_of_macro(body)
    inner = {
        name: declared_node(body.nodes[name], library)
        for name in {end[0] for end in _ends(face)}
        if name in body.nodes
    }
    inputs = []
    for name, ends in face.inputs.items():
        ports = [port for end in ends if (port := _port(inner.get(end[0]), end[1], True))]
        types = [kind for kind in (ports[0].types if ports else ()) if _all_take(ports, kind)]
        if types:
            inputs.append(Port(name, tuple(types), any(port.required for port in ports)))
    outputs = [
        Port(name, port.types)
        for name, end in face.outputs.items()
        if (port := _port(inner.get(end[0]), end[1], False))
    ]
    parameters = [
        parameter
        for name, end in face.parameters.items()
        if (parameter := _parameter(name, body, inner.get(end[0]), end))
    ]
    text = body.description or f"{len(body.nodes)} modules in one node."
    return Declaration(
        key=MACRO,
        title=body.name or node.id.rpartition(SEPARATOR)[2],
        group=GROUP,
        version=1,
        summary=text.split("\n\n")[0].replace("\n", " "),
        text=text,
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        parameters=tuple(parameters),
        readouts=(),
        warnings=(),
        replaces=(),
        sink=not outputs,
        panel=complete((), [parameter.name for parameter in parameters]),
        illustration="",
    )


def _ends(face: Interface) -> Iterator[End]:
    for ends in face.inputs.values():
        yield from ends
    yield from face.outputs.values()
    yield from face.parameters.values()


def _port(declared: Declaration | None, name: str, entry: bool) -> Port | None:
    if declared is None:
        return None
    return declared.input(name) if entry else declared.output(name)


def _all_take(ports: list[Port], kind: str) -> bool:
    return all(kind in port.types for port in ports)


def _parameter(name: str, body: Network, inner: Declaration | None, end: End) -> Parameter | None:
    """The inner declaration under its outer name; its default is the value inside."""
    known = inner.parameter(end[1]) if inner is not None else None
    if known is None:
        return None
    default: Any = body.nodes[end[0]].params.get(end[1], known.default)
    try:
        if end[1] in body.nodes[end[0]].params:
            default = known.coerce(thaw(default))
    except ParameterError:  # reported where the network is checked
        default = known.default
    return replace(known, name=name, default=default)


def passing_input(node: Node, output: str, library: Library) -> str | None:
    """Which input a disabled macro passes on as this output."""
    declared = declared_node(node, library)
    return None if declared is None else passed_through(declared).get(output)


def checked_depth(level: int, where: str) -> None:
    """Refuse macros that lie too deep inside of others.

    Raises
    ------
    NetworkError
        Saying how deep they may lie.
    """
    if level > DEEPEST:
        raise NetworkError(
            f"{shown(where)}: macros lie more than {DEEPEST} deep one inside the other"
        )
