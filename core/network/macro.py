"""Macros: nodes that hold a network of their own. Their inside, and names of nodes within."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from itertools import chain
from typing import Any

from core.errors import NetworkError, ParameterError, several, shown, thaw
from core.modules.declaration import Declaration, Library, Port, declaration
from core.modules.parameters import Parameter, complete
from core.network.expressions import rewritten
from core.network.network import EXPRESSION, MACRO, Link, Network, Node, passed_through
from core.records import dataclass, field, replace

SEPARATOR = "/"
"""Between a macro's id and that of a node inside: ``camera/blur``."""

DEEPEST = 8
"""So many macros may lie one inside the other."""

GROUP = "Macros"


def face_of_macro(body: Network) -> "Interface":
    """The ports and parameters that a macro shows; none where its fields are not sound."""
    try:
        return interface_of(body.extra)
    except NetworkError:
        return Interface()


def with_face(body: Network, face: "Interface") -> Network:
    others = {name: value for name, value in body.extra.items() if name not in FIELDS}
    extra = others | face.fields()
    return body if thaw(extra) == thaw(body.extra) else replace(body, extra=extra)


def opened(node: Node, *, linked: bool = True) -> Network:
    """The inside of a macro with the values that its node gives to exposed parameters.

    Its expressions among them if `linked`, though what they name lies around the macro. It is made
    once for a node, so that nodes which no edit touched stay the same objects.
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
    """A node of a macro's inside as it is called outside, ``camera/blur``."""
    auto = inner.auto if macro.auto is None else macro.auto
    # The same object each time, so that what is planned for it stays.
    made: dict[tuple[str, bool | None], Node] = vars(inner).setdefault("_under", {})
    if (macro.id, auto) not in made:
        outer = f"{macro.id}{SEPARATOR}{inner.id}"
        made[macro.id, auto] = replace(inner, id=outer, auto=auto)
    return made[macro.id, auto]


def path_of(network: Network, name: str) -> tuple[str, ...]:
    """The macros that a node lies in, from the outside, and its own id at the end."""
    path = []
    while (step := network.step_inside(name)) is not None:
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
    ends = (*chain(*face.inputs.values()), *face.outputs.values(), *face.parameters.values())
    inner = {
        name: declared_node(body.nodes[name], library)
        for name in {end[0] for end in ends}
        if name in body.nodes
    }
    inputs = []
    for name, ends in face.inputs.items():
        ports = [port for end in ends if (port := _port(inner, end, entry=True))]
        types = [
            kind
            for kind in (ports[0].types if ports else ())
            if all(kind in port.types for port in ports)
        ]
        if types:
            inputs.append(Port(name, tuple(types), any(port.required for port in ports)))
    outputs = [
        Port(name, port.types)
        for name, end in face.outputs.items()
        if (port := _port(inner, end, entry=False))
    ]
    parameters = [
        parameter
        for name, end in face.parameters.items()
        if (parameter := _parameter(name, body, inner.get(end[0]), end))
    ]
    text = body.description or f"{several(len(body.nodes), 'module')} in one node."
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
        sink=not outputs,
        panel=complete((), [parameter.name for parameter in parameters]),
    )


def _port(inner: Mapping[str, Declaration | None], end: "End", *, entry: bool) -> Port | None:
    declared = inner.get(end[0])
    if declared is None:
        return None
    return declared.input(end[1]) if entry else declared.output(end[1])


def _parameter(name: str, body: Network, inner: Declaration | None, end: "End") -> Parameter | None:
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
    if level > DEEPEST:
        raise NetworkError(f"{shown(where)}: macros are nested more than {DEEPEST} levels deep")


# What a macro shows of its inside: ports and parameters, by the inner node they stand for.

INPUTS, OUTPUTS, PARAMETERS = "inputs", "outputs", "parameters"
FIELDS = (INPUTS, OUTPUTS, PARAMETERS)

End = tuple[str, str]
"""An inner node, and its port or parameter."""
NewEnds = Callable[[End], Iterable[End]]


@dataclass(frozen=True)
class Interface:
    """The ports and parameters of a macro, in the order they are shown.

    An input has the inner inputs that it feeds: several, where one wire went to all of them. An
    output or parameter has the inner one that it stands for.
    """

    inputs: Mapping[str, tuple[End, ...]] = field(default_factory=dict)
    outputs: Mapping[str, End] = field(default_factory=dict)
    parameters: Mapping[str, End] = field(default_factory=dict)

    def fields(self) -> dict[str, Any]:
        """As the macro in a network file has them; empty ones are left out."""
        inputs = {
            name: text(ends[0]) if len(ends) == 1 else [text(end) for end in ends]
            for name, ends in self.inputs.items()
        }
        outputs = {name: text(end) for name, end in self.outputs.items()}
        parameters = {name: text(end) for name, end in self.parameters.items()}
        both = zip(FIELDS, (inputs, outputs, parameters), strict=True)
        return {name: entries for name, entries in both if entries}

    def mapped(self, entry: NewEnds, output: NewEnds, parameter: NewEnds) -> "Interface":
        """With what the functions give in the place of each inner end; without it for nothing."""
        inputs = {
            name: tuple(new for end in ends for new in entry(end))
            for name, ends in self.inputs.items()
        }
        outputs, parameters = (
            {name: new[0] for name, end in ends.items() if (new := tuple(function(end)))}
            for ends, function in ((self.outputs, output), (self.parameters, parameter))
        )
        return Interface({name: ends for name, ends in inputs.items() if ends}, outputs, parameters)

    def renamed(self, names: Mapping[str, str]) -> "Interface":
        def moved(end: End) -> tuple[End]:
            return ((names.get(end[0], end[0]), end[1]),)

        return self.mapped(moved, moved, moved)

    def without(self, gone: Collection[str]) -> "Interface":
        def left(end: End) -> tuple[End, ...]:
            return () if end[0] in gone else (end,)

        return self.mapped(left, left, left)


def text(end: End) -> str:
    """``NODE.NAME``."""
    return f"{end[0]}.{end[1]}"


def end_of(entry: str) -> End:
    """``NODE.NAME`` split at its last dot; a `NetworkError` if it is not of that form."""
    node, _, name = entry.rpartition(".")
    if not node or not name:
        raise NetworkError(f"{entry!r:.80} is not of the form NODE.NAME")
    return node, name


def interface_of(extra: Mapping[str, Any], where: str = "macro") -> Interface:
    """The interface among a macro's fields."""
    inputs = {}
    for name, entry in _entries(extra, INPUTS, where):
        several = entry if isinstance(entry, list) else [entry]
        if not several:
            raise NetworkError(f"{where}.{INPUTS}.{shown(name)} does not name an inner input")
        inputs[name] = tuple(_end(each, f"{where}.{INPUTS}.{shown(name)}") for each in several)
    outputs, parameters = (
        {
            name: _end(entry, f"{where}.{kind}.{shown(name)}")
            for name, entry in _entries(extra, kind, where)
        }
        for kind in (OUTPUTS, PARAMETERS)
    )
    return Interface(inputs, outputs, parameters)


def _entries(extra: Mapping[str, Any], kind: str, where: str) -> list[tuple[str, Any]]:
    entries = thaw(extra.get(kind, {}))
    if not isinstance(entries, dict):
        raise NetworkError(f"{where}.{kind} must be an object with a NODE.NAME for each name")
    for name in entries:
        if not name.strip() or any(mark in name for mark in ".=/") or not name.isprintable():
            raise NetworkError(
                f"{where}.{kind} has the name {name!r:.80}: a name must not be blank or contain "
                "'.', '=', '/' or a control character"
            )
    return list(entries.items())


def _end(entry: Any, where: str) -> End:
    if not isinstance(entry, str):
        raise NetworkError(f"{where} must be a string, NODE.NAME, not {entry!r:.60}")
    try:
        return end_of(entry)
    except NetworkError as error:
        raise NetworkError(f"{where}: {error.message}") from None


# Writing macros out: the plain network that a network with macros stands for.
#
# Whatever computes works on the plain network: a node inside of ``camera`` is called
# ``camera/blur`` there, in expressions too; wires go from inner node to inner node, and of the
# macros nothing is left but other names for their ports and parameters.


def expanded(network: Network, library: Library) -> Network:
    """The plain network; a network without macros is given back as it is."""
    if not has_macros(network):
        return network
    level = _level(network, library)
    sources = {end: level.source(end) for end in level.outputs}
    ports = {text(end): text(source) for end, source in sources.items() if source != ("", "")}
    final = network.extra.get("final")
    final = final if isinstance(final, str) else ""
    return Network(
        name=network.name,
        description=network.description,
        seed=network.seed,
        nodes=level.nodes,
        links=tuple(level.links),
        layout={name: at for name, at in network.layout.items() if name in level.nodes},
        extra={**network.extra, "final": ports[final]} if final in ports else network.extra,
        port_names=ports,
        parameter_names={text(end): text(inner) for end, inner in level.parameters.items()},
        aside=level.aside,
    )


def has_macros(network: Network) -> bool:
    return any(node.macro is not None for node in network.nodes.values())


def unfolded(network: Network) -> Network:
    """The network with the nodes inside of macros beside them, for what shows and edits them all.

    Links inside come along. The macros stay, and expressions are as they were written inside, so
    this is no network to compute.
    """
    if not has_macros(network):
        return network
    nodes = dict(_all_nodes(network.nodes.values()))
    links = [*network.links, *_inner_links(network)]
    return replace(network, nodes=nodes, links=tuple(links))


def _all_nodes(nodes: Any) -> Iterator[tuple[str, Node]]:
    for node in nodes:
        yield node.id, node
        if node.macro is not None:
            yield from _all_nodes(under(node, inner) for inner in opened(node).nodes.values())


def _inner_links(network: Network, prefix: str = "") -> Iterator[Link]:
    for name, node in network.nodes.items():
        if node.macro is not None:
            here = f"{prefix}{name}{SEPARATOR}"
            yield from (_prefixed(link, here) for link in node.macro.links)
            yield from _inner_links(node.macro, here)


def _prefixed(link: Link, prefix: str) -> Link:
    return Link(prefix + link.source, link.output, prefix + link.target, link.input)


@dataclass
class _Level:
    """A network with its macros written out, and what their ports stand for."""

    nodes: dict[str, Node] = field(default_factory=dict)
    links: list[Link] = field(default_factory=list)
    inputs: dict[End, tuple[End, ...]] = field(default_factory=dict)
    outputs: dict[End, End] = field(default_factory=dict)
    parameters: dict[End, End] = field(default_factory=dict)
    aside: dict[str, Node] = field(default_factory=dict)

    def source(self, end: End) -> End:
        """The output of a plain node that an output stands for; an empty end where it has none."""
        seen = set()
        while end in self.outputs and end not in seen:
            seen.add(end)
            end = self.outputs[end]
        return end if end not in self.outputs and end[0] in self.nodes else ("", "")

    def targets(self, end: End) -> tuple[End, ...]:
        itself = (end,) if end[0] in self.nodes else ()
        return self.inputs.get(end, itself)


def _level(network: Network, library: Library) -> _Level:
    level = _Level()
    for name, node in network.nodes.items():
        if node.macro is None:
            level.nodes[name] = node
        elif node.disabled:
            _add_disabled(level, network, node, library)
        else:
            _add_macro(level, node, library)
    for link in network.links:
        source = level.source((link.source, link.output))
        if source == ("", ""):
            if link.source in network.nodes:
                continue
            source = link.source, link.output  # of no node: that is reported as it stands
        end = (link.target, link.input)
        for target in level.targets(end) if link.target in network.nodes else (end,):
            level.links.append(Link(*source, *target))
    return level


def _inside(node: Node, end: End) -> End:
    return f"{node.id}{SEPARATOR}{end[0]}", end[1]


def _add_macro(level: _Level, node: Node, library: Library) -> None:
    body = opened(node, linked=False)
    face, inside = face_of_macro(body), _level(body, library)
    for inner in inside.nodes.values():
        plain = _within(node, inner)
        level.nodes[plain.id] = plain
    level.links += [_prefixed(link, f"{node.id}{SEPARATOR}") for link in inside.links]
    for name, ends in face.inputs.items():
        level.inputs[node.id, name] = tuple(
            _inside(node, target) for end in ends for target in inside.targets(end)
        )
    named = {(node.id, name): end for name, end in face.outputs.items()}
    named |= {_inside(node, end): end for end in inside.outputs}  # names of macros inside stay
    for outer, end in named.items():
        if (source := inside.source(end)) != ("", ""):
            level.outputs[outer] = _inside(node, source)
    _add_parameters(level, node, inside)


def _add_parameters(level: _Level, node: Node, inside: _Level) -> None:
    """What a macro's parameters stand for; its expressions name what lies around it."""
    for inner in inside.aside.values():
        plain = _within(node, inner)
        level.aside[plain.id] = plain
    for name, end in face_of_macro(opened(node)).parameters.items():
        level.parameters[node.id, name] = _inside(node, inside.parameters.get(end, end))
    for end, behind in inside.parameters.items():
        level.parameters[_inside(node, end)] = _inside(node, behind)
    for name in node.linked:
        place, parameter = level.parameters.get((node.id, name), ("", ""))
        for nodes in (level.nodes, level.aside):
            if place in nodes:
                params = {**nodes[place].params, parameter: node.params[name]}
                nodes[place] = replace(nodes[place], params=params)


def _within(macro: Node, inner: Node) -> Node:
    """A node of a macro's inside as `under` has it, with new names in its expressions too."""
    plain = under(macro, inner)
    if not plain.linked:
        return plain
    made: dict[str, Node] = vars(plain).setdefault("_within", {})
    if macro.id not in made:
        expressions = {}
        for name in plain.linked:
            raw = plain.params[name]
            if isinstance(raw[EXPRESSION], str):
                text = rewritten(raw[EXPRESSION], lambda *end: _inside(macro, end))
                expressions[name] = {**raw, EXPRESSION: text}
        made[macro.id] = replace(plain, params={**plain.params, **expressions})
    return made[macro.id]


def _add_disabled(level: _Level, network: Network, node: Node, library: Library) -> None:
    """A disabled macro is gone, and what would come out of it is what goes in."""
    inside = _level(opened(node, linked=False), library)
    inside.aside |= inside.nodes
    _add_parameters(level, node, inside)
    feeding: Mapping[str, Link] = {link.input: link for link in network.links_into(node.id)}
    for name in face_of_macro(opened(node)).outputs:
        link = feeding.get(passing_input(node, name, library) or "")
        level.outputs[node.id, name] = (link.source, link.output) if link else ("", "")
    for name in face_of_macro(opened(node)).inputs:
        level.inputs[node.id, name] = ()
