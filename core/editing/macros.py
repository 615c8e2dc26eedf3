"""Macros: nodes grouped and ungrouped, changes inside, and the parameters that one shows."""

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import partial
from typing import Any

from core.editing import operations
from core.editing.backdrops import FIELD as BACKDROPS
from core.editing.backdrops import backdrops_of, dots_among, dots_of, joined_fields
from core.editing.layout import Point, shifted
from core.editing.operations import ABSENT, Operation, fresh_name, inside, named, together
from core.errors import NetworkError, shown, thaw
from core.modules.declaration import Library
from core.network import linked_values
from core.network.expressions import readable
from core.network.linked_values import with_names, with_references
from core.network.macro import (
    PARAMETERS,
    SEPARATOR,
    End,
    Interface,
    checked_depth,
    declared_node,
    depth,
    face_of_macro,
    interface_of,
    opened,
    path_of,
    text,
    unfolded,
    with_face,
)
from core.network.network import EXPRESSION, MACRO, Link, Network, Node, cycle_error, cycles
from core.records import replace


def at_level(path: tuple[str, ...], operation: Operation) -> Operation:
    """An operation of the network inside the macros of a path, as one of the whole network."""
    if not path:
        return operation
    if operation.marks is not None:  # there is one output in all the network
        head = "".join(f"{macro}{SEPARATOR}" for macro in path)
        return operations.mark_output(tuple(head + name for name in operation.marks))
    for macro in reversed(path):
        operation = inside(macro, operation)
    return operation


def parameters_of(body: Network) -> dict[str, Any]:
    return dict(thaw(body.extra.get(PARAMETERS, {})))


def expose(network: Network, node: str, parameter: str) -> Operation:
    """Show a parameter of an inner node, ``camera/init``, on the panel of the macro around it."""
    *macros, inner = path_of(network, node)
    if not macros:
        raise NetworkError(
            f"{shown(node)} is not inside a macro, so no macro can show its parameters"
        )
    shown_already = operations.exposed_as(network, node, parameter)
    if shown_already:
        raise NetworkError(
            f"{shown(macros[-1])} already shows {shown(node)}.{parameter} as {shown_already}"
        )
    body = operations.body_of(network, macros)
    entries = parameters_of(body)
    wanted = fresh_name(parameter, entries)
    entries[wanted] = text((inner, parameter))
    interface_of({PARAMETERS: entries})  # whether the name is allowed
    label = f"Expose {node}.{parameter}"
    return at_level(tuple(macros), operations.set_network_field(PARAMETERS, entries, label))


def hide(network: Network, macro: str, name: str, value_of: Callable[[str, str], Any]) -> Operation:
    """Take a parameter off a macro's panel; the value it was given there stays, inside.

    `value_of` gives the value of a node's parameter: it takes the place of an expression, which
    could name nothing from inside.
    """
    path = path_of(network, macro)
    body = operations.body_of(network, path)
    entries = parameters_of(body)
    inner, parameter = face_of_macro(body).parameters[name]
    del entries[name]
    taking = operations.set_network_field(PARAMETERS, entries or ABSENT)
    container = operations.body_of(network, path[:-1])
    for node, parameter_of, reference in linked_values.references(container):
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
        setting = operations.set_parameter(SEPARATOR.join((*path, inner)), parameter, thaw(given))
        steps = (setting, *steps)
    return together(steps, f"Hide {macro}.{name}")


def rename_exposed(network: Network, macro: str, old: str, new: str) -> Operation:
    *outer, name = path_of(network, macro)
    rename = partial(_with_exposed_renamed, macro=name, old=old, new=new)
    return at_level(tuple(outer), Operation(rename, f"Rename {name}.{old} to {new}"))


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
    if any(
        (one.node, one.parameter) == (macro, old) for _, _, one in linked_values.references(network)
    ):
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


# Making one node of several, a macro, and several of one again; the picture stays the same.


def group(
    network: Network,
    library: Library,
    names: Iterable[str],
    name: str = "macro",
    where: str = "",
    value_of: Callable[[str, str], Any] | None = None,
) -> tuple[str, Operation]:
    """What makes one node of several, and its name; what draws noise draws the same afterwards.

    `where` are the macros this happens in, as ``camera/``. `value_of` gives the value of a node's
    parameter, in a macro with what is set from outside; by default as the network alone has it.
    """
    members = tuple(dict.fromkeys(names))
    if not members:
        raise NetworkError("select the nodes to group first")
    inner = {member: network.node(member) for member in members}
    fresh = fresh_name(name, set(network.nodes) - set(members))
    around = face_of_macro(network)
    parameters: dict[str, End] = {}
    for end in around.parameters.values():
        if end[0] in members:
            parameters[fresh_name(end[1], parameters)] = end
    # From inside of a macro nothing outside can be named: such an expression becomes one of the
    # macro's own parameter.
    for member, node in inner.items():
        for parameter in node.linked:
            end = member, parameter
            if _follows_others(node, parameter, members) and end not in parameters.values():
                parameters[fresh_name(parameter, parameters)] = end
    inputs = _inputs_of(network, library, members, around)
    face = Interface(inputs, _outputs_of(network, library, members, around), parameters)
    value_of = value_of or linked_values.resolved(network, library=library).value
    given = {name: thaw(value_of(*end)) for name, end in parameters.items()}
    values = {
        name: value
        for name, value in given.items()
        if value is not None and not (isinstance(value, dict) and EXPRESSION in value)
    }
    noisy = _noisy(network, library, members, where)
    moved = {
        name: f"{fresh}{SEPARATOR}{name}" for name in operations.of_nodes(members, network.nodes)
    }
    nodes = {one: node for one, node in network.nodes.items() if one in members}
    lifted = {}
    for outer, (own, parameter) in parameters.items():
        if _follows_others(network.nodes[own], parameter, members):
            lifted[outer] = with_names(network.nodes[own], moved).params[parameter]
            params = operations.with_field(nodes[own].params, parameter, values.get(outer, ABSENT))
            nodes[own] = replace(nodes[own], params=params)
    body = Network(
        nodes={inside: _with_noise(node, where + inside, noisy) for inside, node in nodes.items()},
        links=tuple(one for one in network.links if {one.source, one.target} <= nodes.keys()),
        layout={inside: at for inside, at in network.layout.items() if inside in nodes},
        extra={**face.fields(), **joined_fields({}, dots_among(network, nodes))},
    )
    try:
        after = _with_macro(network, fresh, face, body, lifted, moved)
    except NetworkError as error:
        if "cycle" not in error.message:
            raise
        raise NetworkError(
            "these nodes cannot be grouped: a path of wires leaves them and returns "
            f"({error.message})"
        ) from None
    return fresh, operations.restored(after, f"Group {named(members)}", moved)


def ungroup(
    network: Network, library: Library, name: str, where: str = ""
) -> tuple[tuple[str, ...], Operation]:
    """What puts the nodes of a macro in its place, under names that are free; and the names."""
    node = network.node(name)
    if node.macro is None:
        raise NetworkError(f"{shown(name)} is not a macro, so it cannot be ungrouped")
    if node.disabled:
        raise NetworkError(f"{shown(name)} is disabled: enable it first, then ungroup it")
    taken = set(network.nodes) - {name}
    body, fresh = node.macro, {}
    for inner in body.nodes:
        fresh[inner] = fresh_name(inner, taken)
        taken.add(fresh[inner])
    noisy = _noisy(body, library, body.nodes, f"{where}{name}{SEPARATOR}")
    moved = {
        f"{name}{SEPARATOR}{old}": fresh[inner] + old.removeprefix(inner)
        for inner in body.nodes
        for old in operations.of_nodes([inner], body.nodes)
    }
    body = opened(node, linked=False)
    face, around = face_of_macro(body), face_of_macro(network)

    def placed(end: End) -> End:
        return fresh[end[0]], end[1]

    def instead(leader: str, parameter: str) -> End:
        end = face.parameters.get(parameter) if leader == name else None
        return (linked_values.new_name(leader, moved), parameter) if end is None else placed(end)

    nodes: dict[str, Node] = {}
    for other, one in network.nodes.items():
        changed = with_references(one, instead)
        if other != name:
            nodes[other] = changed
            continue
        for old, plain in _plain_nodes(changed, body, face, fresh).items():
            noise = _with_noise(plain, f"{where}{name}{SEPARATOR}{old}", noisy)
            nodes[fresh[old]] = _without_own(noise, where + fresh[old])
    x, y = 0.0, 0.0  # how far the macro was moved since it stood in the middle of its nodes
    if body.layout and name in network.layout:
        middle, at = _middle(body.layout), network.layout[name]
        x, y = at[0] - middle[0], at[1] - middle[1]
    layout = {other: at for other, at in network.layout.items() if other != name}
    for old, at in body.layout.items():
        if old in body.nodes:
            layout[fresh[old]] = at[0] + x, at[1] + y
    extra = operations.renamed(
        operations.without_dots(network.extra, _links_at(network, {name})), moved
    )
    if backdrops_of(body):
        extra[BACKDROPS] = [
            *thaw(network.extra.get(BACKDROPS, [])),
            *(
                {**entry, "x": entry["x"] + x, "y": entry["y"] + y}
                for entry in thaw(body.extra[BACKDROPS])
                if isinstance(entry, dict) and {"x", "y"} <= entry.keys()
            ),
        ]
    dots = {
        link.renamed(fresh): tuple(shifted(at, (x, y)) for at in points)
        for link, points in dots_of(body).items()
    }
    extra |= joined_fields(extra, dots)
    outputs, parameters = (
        {port: (end,) for port, end in ends.items()} for ends in (face.outputs, face.parameters)
    )

    def behind(of: Mapping[str, Iterable[End]]) -> Callable[[End], Iterable[End]]:
        return lambda end: map(placed, of.get(end[1], ())) if end[0] == name else (end,)

    starts, ends = behind(outputs), behind(face.inputs)
    links = [link.renamed(fresh) for link in body.links]
    for link in network.links:
        targets = tuple(ends((link.target, link.input)))
        links += [Link(*s, *t) for s in starts((link.source, link.output)) for t in targets]
    after = replace(network, nodes=nodes, links=tuple(links), layout=layout, extra=extra)
    if around != Interface():
        after = with_face(after, around.mapped(ends, starts, behind(parameters)))
    return tuple(fresh.values()), operations.restored(after, f"Ungroup {name}", moved)


def _with_macro(
    network: Network,
    name: str,
    face: Interface,
    body: Network,
    lifted: Mapping[str, Any],
    moved: Mapping[str, str],
) -> Network:
    inner = body.nodes
    checked_depth(1 + depth(body), name)
    nodes: dict[str, Node] = {}
    for other, node in network.nodes.items():
        if other not in inner:
            nodes[other] = with_names(node, moved)
        elif name not in nodes:
            nodes[name] = Node(name, MACRO, params=lifted, macro=body)
    layout = {other: at for other, at in network.layout.items() if other not in inner}
    if body.layout:
        layout[name] = _middle(body.layout)
    entry = {end: (name, port) for port, ends in face.inputs.items() for end in ends}
    exits = {end: (name, port) for port, end in face.outputs.items()}
    shown_as = {end: (name, parameter) for parameter, end in face.parameters.items()}
    links: dict[Link, None] = {}  # of several that become one, one
    for link in network.links:
        if not (link.source in inner and link.target in inner):
            start, end = (link.source, link.output), (link.target, link.input)
            links[Link(*exits.get(start, start), *entry.get(end, end))] = None
    extra = operations.renamed(
        operations.without_dots(network.extra, _links_at(network, inner)), moved
    )
    changed = replace(network, nodes=nodes, links=tuple(links), layout=layout, extra=extra)
    around = face_of_macro(network)
    if around != Interface():

        def instead(of: Mapping[End, End]) -> Callable[[End], tuple[End]]:
            return lambda end: (of.get(end, end),)

        outer = around.mapped(*map(instead, (entry, exits, shown_as)))
        inputs = {port: tuple(dict.fromkeys(ends)) for port, ends in outer.inputs.items()}
        changed = with_face(changed, replace(outer, inputs=inputs))
    loops = cycles(changed.followers)
    if loops and not cycles(network.followers):
        raise cycle_error(loops[0])
    return changed


def _plain_nodes(
    macro: Node, body: Network, face: Interface, fresh: Mapping[str, str]
) -> dict[str, Node]:
    """The nodes of a macro with their new ids and the values that it gives them, by the old ids."""
    inner = {name: with_names(node, fresh) for name, node in body.nodes.items()}
    for name, (own, parameter) in face.parameters.items():
        if name in macro.linked and own in inner:
            params = {**inner[own].params, parameter: macro.params[name]}
            inner[own] = replace(inner[own], params=params)
    return {
        name: replace(node, id=fresh[name], auto=node.auto if macro.auto is None else macro.auto)
        for name, node in inner.items()
    }


def _follows_others(node: Node, parameter: str, members: Collection[str]) -> bool:
    inside = dict.fromkeys(members, "")
    found = linked_values.references_in(node.params[parameter]) if parameter in node.linked else ()
    leaders = {one.node for one in found} - set(members)
    return any(linked_values.new_name(leader, inside) == leader for leader in leaders)


def _noisy(network: Network, library: Library, names: Iterable[str], where: str) -> frozenset[str]:
    chosen = {name: network.nodes[name] for name in names}
    return frozenset(
        where + name
        for name, node in unfolded(Network(nodes=chosen)).nodes.items()
        if node.macro is None
        and (node.noise or node.module not in library or library[node.module].draws_noise)
    )


def _with_noise(node: Node, name: str, noisy: frozenset[str]) -> Node:
    """The node, drawing its noise, and that of nodes inside, under the name it has until now."""
    if node.macro is None:
        return node if node.noise or name not in noisy else replace(node, noise=name)
    return _each_inside(
        node, lambda inner: _with_noise(inner, f"{name}{SEPARATOR}{inner.id}", noisy)
    )


def _without_own(node: Node, name: str) -> Node:
    """The node without the name of its noise where it is called so anyway."""
    if node.macro is None:
        return replace(node, noise="") if node.noise == name else node
    return _each_inside(node, lambda inner: _without_own(inner, f"{name}{SEPARATOR}{inner.id}"))


def _each_inside(macro: Node, change: Callable[[Node], Node]) -> Node:
    assert macro.macro is not None
    nodes = {name: change(inner) for name, inner in macro.macro.nodes.items()}
    if all(nodes[name] is inner for name, inner in macro.macro.nodes.items()):
        return macro
    return replace(macro, macro=replace(macro.macro, nodes=nodes))


def _middle(layout: Mapping[str, Point]) -> Point:
    xs, ys = zip(*layout.values(), strict=True)
    return (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2


def _links_at(network: Network, names: Collection[str]) -> set[Link]:
    return {link for link in network.links if link.source in names or link.target in names}


def _inputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, tuple[End, ...]]:
    """Inputs of the macro: one for each output outside that feeds it, then those without a wire."""
    fed: dict[End, list[End]] = {}
    for name, named_ends in around.inputs.items():
        if inner := [end for end in named_ends if end[0] in members]:
            fed["", name] = inner
    place = {name: number for number, name in enumerate(network.nodes)}
    for link in sorted(network.links, key=lambda link: (place.get(link.target, -1), link)):
        if link.target in members and link.source not in members:
            fed.setdefault((link.source, link.output), []).append((link.target, link.input))
    inputs: dict[str, tuple[End, ...]] = {}
    for ends in fed.values():
        inputs[fresh_name(ends[0][1], inputs)] = tuple(ends)
    linked = {(link.target, link.input) for link in network.links}
    linked |= {end for ends in inputs.values() for end in ends}
    for name in members:
        declared = declared_node(network.nodes[name], library)
        for port in declared.inputs if declared else ():
            if port.required and (name, port.name) not in linked:
                inputs[fresh_name(port.name, inputs)] = ((name, port.name),)
    return inputs


def _outputs_of(
    network: Network, library: Library, members: tuple[str, ...], around: Interface
) -> dict[str, End]:
    """Outputs of the macro: those that feed nodes outside, then the first of nodes that end it."""
    ends = {end: None for end in around.outputs.values() if end[0] in members}
    place = {name: number for number, name in enumerate(network.nodes)}
    for link in sorted(network.links, key=lambda link: (place.get(link.source, -1), link)):
        if link.source in members and link.target not in members:
            ends[link.source, link.output] = None
    leading_on = {link.source for link in network.links}
    for name in members:
        declared = declared_node(network.nodes[name], library)
        if name not in leading_on and declared is not None and declared.outputs:
            ends[name, declared.outputs[0].name] = None
    outputs: dict[str, End] = {}
    for end in ends:
        outputs[fresh_name(end[1], outputs)] = end
    return outputs
