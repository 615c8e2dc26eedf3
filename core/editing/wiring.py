"""Links: why one cannot be made, which ways they lead, and those that follow from an edit."""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Literal

from core.editing.layout import Point
from core.editing.operations import (
    Operation,
    add_nodes,
    fresh_name,
    named,
    remove_nodes,
    rewire,
    together,
)
from core.errors import NetworkError, close, shown
from core.modules.declaration import Declaration, Library, Port, declaration, local_key, no_module
from core.network.macro import declared_node
from core.network.network import (
    Link,
    Network,
    Node,
    cycle_error,
    cycles,
    passed_through,
    reached,
    way_round,
)
from core.records import dataclass


def refusal(network: Network, library: Library, link: Link) -> str | None:
    wrong = misfit(network, library, link)
    if wrong is not None:
        return wrong
    way = way_between(network, link.target, link.source)
    if way is None:
        return None
    return f"this link would make a cycle: {way_round(way)}"


def misfit(network: Network, library: Library, link: Link) -> str | None:
    """Why the ends of a link do not fit each other; None where they do, even in a cycle."""
    for name in (link.source, link.target):
        if name not in network.nodes:
            return f"there is no node {shown(name)}{close(name, network.nodes)}"
    if link.source == link.target:
        return f"{shown(link.source)} cannot feed itself"
    giving, taking = (declared(network, library, end) for end in (link.source, link.target))
    output = giving.output(link.output) if giving else None
    entry = taking.input(link.input) if taking else None
    if giving and output is None:
        return _no_port(link.source, "output", link.output, giving.outputs)
    if taking and entry is None:
        return _no_port(link.target, "input", link.input, taking.inputs)
    if output and entry and not set(output.types) & set(entry.types):
        start, end = link.text()
        gives, takes = (" or ".join(port.types) for port in (output, entry))
        return f"{shown(start)} gives {gives}, but {shown(end)} takes {takes}"
    return None


def check_new_wires(before: Network, after: Network, library: Library) -> None:
    """Refuse a change that brings links no network may have."""
    for name, node in after.nodes.items():
        former = before.nodes.get(name)
        if node.macro is not None and node is not former:
            inside = (former.macro if former is not None else None) or Network()
            try:
                check_new_wires(inside, node.macro, library)
            except NetworkError as error:
                raise NetworkError(f"inside {shown(name)}: {error.message}") from None
    old = set(before.links)
    new = [link for link in after.links if link not in old]
    if not new:
        return
    for link in new:
        wrong = misfit(after, library, link)
        if wrong is not None:
            raise NetworkError(wrong)
    count = Counter((link.target, link.input) for link in after.links)
    for link in new:
        if count[link.target, link.input] > 1:
            raise NetworkError(f"{shown(link.text()[1])} would have more than one link")
    loops = cycles(after.followers)
    if loops and not cycles(before.followers):
        raise cycle_error(loops[0])


def way_between(network: Network, start: str, end: str) -> tuple[str, ...] | None:
    """The shortest way along links from one node to another, both included."""
    came_from = {start: start}
    for name in (border := [start]):
        fresh = [one for one in network.followers[name] if one not in came_from]
        came_from |= dict.fromkeys(fresh, name)
        border += fresh
    if end not in came_from:
        return None
    way = [end]
    while way[-1] != start:
        way.append(came_from[way[-1]])
    return tuple(reversed(way))


def declared(network: Network, library: Library, name: str) -> Declaration | None:
    node = network.nodes.get(name)
    return declared_node(node, library) if node is not None else None


def _no_port(node: str, side: str, port: str, ports: tuple[Port, ...]) -> str:
    names = [candidate.name for candidate in ports]
    listed = f"its {side}s: {', '.join(names)}" if names else f"it has no {side}s"
    return f"{shown(node)} has no {side} {shown(port)}{close(port, names) or f'; {listed}'}"


# Wires that follow from what is done: partners, what fits, nodes put in and taken out.

Output = tuple[str, str]
"""Node and port."""

MAGNITUDE, PHASE = "magnitude", "phase"
PARTNER = {MAGNITUDE: PHASE, PHASE: MAGNITUDE}
_FEW = ("context", "pupil")  # a network has few, every module takes the same, no chain goes on


def outputs_of(network: Network, library: Library, kind: str) -> list[Output]:
    return [
        (name, port.name)
        for name in network.nodes
        if (module := declared(network, library, name)) is not None
        for port in module.outputs
        if kind in port.types
    ]


def side_links(
    network: Network,
    library: Library,
    node: str,
    taken: Iterable[str],
    followers: Iterable[str] = (),
) -> list[Link]:
    """Links for the node's empty context and pupil inputs, where there is one candidate."""
    module = declared(network, library, node)
    if module is None:
        return []
    behind = reached(network.followers, {node, *followers})
    links = []
    for port in module.inputs:
        if port.name in taken or not port.required or port.types[0] not in _FEW:
            continue
        every = outputs_of(network, library, port.types[0])
        sources = [end for end in every if end[0] != node]
        if len(sources) == 1 and sources[0][0] not in behind:
            links.append(Link(*sources[0], node, port.name))
    return links


def port_of(ports: Iterable[Port], kind: str) -> Port | None:
    return next((port for port in ports if kind in port.types), None)


def _types(network: Network, library: Library, link: Link) -> tuple[str, ...]:
    """What a link brings, as its source has it; else as its target takes it."""
    source, target = (declared(network, library, one) for one in (link.source, link.target))
    port = source.output(link.output) if source else None
    if port is None and target:
        port = target.input(link.input)
    return port.types if port else ()


def inserted(network: Network, library: Library, link: Link, node: str) -> Operation | None:
    """Lead a wire, and its partner of magnitude and phase, through a node; None if none fits."""
    ends = _ends(network, library, link, node)
    if ends is None:
        return None
    entry, output, kind = ends
    through = [(link, entry, output)]
    partner = _partner(network, library, link, node, kind)
    if partner is not None:
        through.append(partner)
    while through:
        operation = _led(network, library, node, through)
        if _sound(network, library, operation):
            return operation
        through.pop()  # without the partner, then, before not at all
    return None


def _led(
    network: Network, library: Library, node: str, through: list[tuple[Link, Port, Port]]
) -> Operation:
    new = []
    for wire, entry, output in through:
        new += [
            Link(wire.source, wire.output, node, entry.name),
            Link(node, output.name, wire.target, wire.input),
        ]
    taken = {link.input for link in (*network.links_into(node), *new) if link.target == node}
    followers = {wire.target for wire, _, _ in through}
    new += side_links(network, library, node, taken, followers)
    return rewire(
        add=tuple(new), remove=tuple(wire for wire, _, _ in through), label=f"Insert {shown(node)}"
    )


def _ends(
    network: Network, library: Library, link: Link, node: str
) -> tuple[Port, Port, str] | None:
    """Where the wire goes into the node and out of it, and of what type it is."""
    free = node in network.nodes and not network.followers[node]
    if not free or link not in network.links or node in (link.source, link.target):
        return None
    taking = declared(network, library, link.target)
    wanted = taking.input(link.input) if taking else None
    for kind in _types(network, library, link):
        ports = _way_through(network, library, node, kind)
        if ports is not None and (wanted is None or kind in wanted.types):
            return (*ports, kind)
    return None


def _way_through(
    network: Network, library: Library, node: str, kind: str
) -> tuple[Port, Port] | None:
    """The node's first input and output of a type, where the input is empty."""
    module = declared(network, library, node)
    entry = port_of(module.inputs, kind) if module else None
    output = port_of(module.outputs, kind) if module else None
    linked = {wire.input for wire in network.links_into(node)}
    return (entry, output) if entry and output and entry.name not in linked else None


def _partner(
    network: Network, library: Library, link: Link, node: str, kind: str
) -> tuple[Link, Port, Port] | None:
    """The wire that is led through beside a magnitude or phase, and where."""
    if kind not in (MAGNITUDE, PHASE):
        return None
    other = PARTNER[kind]
    # The one that runs beside the link: from the same node, or to the same.
    wires = [
        one
        for one in network.links
        if one != link
        and (one.source == link.source or one.target == link.target)
        and other in _types(network, library, one)
    ]
    if len(wires) > 1:
        wires = [one for one in wires if (one.source, one.target) == (link.source, link.target)]
    wire = wires[0] if len(wires) == 1 else None
    ports = _way_through(network, library, node, other)
    if ports is None or wire is None or node in (wire.source, wire.target):
        return None
    return (wire, *ports)


def _sound(network: Network, library: Library, operation: Operation) -> bool:
    try:
        check_new_wires(network, operation.apply(network), library)
    except NetworkError:
        return False
    return True


Side = Literal["input", "output"]
End = tuple[str, str, Side]
"""Node, port and the port's side."""


@dataclass(frozen=True)
class Candidate:
    """A module a wire could lead to or come from, and the port it would have there."""

    module: str
    port: str


def fitting(library: Library, types: Collection[str], side: Side) -> tuple[Candidate, ...]:
    """Modules with a port on that side for a wire of one of these types, in the library's order."""
    wanted = set(types)
    candidates = []
    for key, module in library.items():
        known = declaration(module)
        ports = known.inputs if side == "input" else known.outputs
        candidates += [Candidate(key, port.name) for port in ports if wanted & set(port.types)]
    return tuple(candidates)


Bridge = tuple[Candidate, str, Candidate]
"""A transform, its output that leads on, and the module behind it."""


def bridged(library: Library, types: Collection[str]) -> Iterator[Bridge]:
    """Modules that fit behind a transform of what a wire carries: a spectrum's, of an image."""
    near = fitting(library, types, "input")
    met = {one.module for one in near}
    for kind in ("image", MAGNITUDE, PHASE):
        if kind in types or PARTNER.get(kind) in types:
            continue
        giving = {one.module: one.port for one in fitting(library, (kind,), "output")}
        transform = next((one for one in near if one.module in giving), None)
        for taking in fitting(library, (kind,), "input"):
            if transform is not None and taking.module not in met:
                met.add(taking.module)
                yield transform, giving[transform.module], taking


def new_node(
    network: Network, library: Library, module: str, at: Point | None
) -> tuple[str, Operation]:
    if module not in library:
        raise NetworkError(no_module(module, library))
    name = fresh_name(local_key(module), network.nodes)
    return name, add_nodes(((Node(name, module), at),))


def wired_to(
    network: Network, library: Library, end: End, candidate: Candidate, at: Point | None
) -> tuple[str, Operation]:
    """A new node of a candidate wired to a loose end; its other inputs too where certain."""
    name, adding = new_node(network, library, candidate.module, at)
    grown = adding.apply(network)
    node, port, side = end
    if side == "output":
        link = Link(node, port, name, candidate.port)
    else:
        link = Link(name, candidate.port, node, port)
        old = next((wire for wire in network.links_into(node) if wire.input == port), None)
        between = inserted(grown, library, old, name) if old else None
        if between is not None and link in between.apply(grown).links:
            return name, together((adding, between), adding.text)
    return name, together((adding, _wired_along(grown, library, link, name)), adding.text)


def transform_behind(network: Network, end: End, transform: Candidate) -> str:
    """The node of a transform that an output leads to already; empty where there is none."""
    onward = [link.target for link in network.links if (link.source, link.output) == end[:2]]
    return next((n for n in onward if network.nodes[n].module == transform.module), "")


def wired_behind(
    network: Network, library: Library, end: End, bridge: Bridge, places: Sequence[Point | None]
) -> tuple[str, Operation]:
    """A new node wired to an output by a transform: one that is there already, else a new one."""
    transform, output, candidate = bridge
    steps: tuple[Operation, ...] = ()
    between = transform_behind(network, end, transform)
    if not between:
        between, adding = wired_to(network, library, end, transform, places[0])
        steps, network = (adding,), adding.apply(network)
    start: End = (between, output, "output")
    name, adding = wired_to(network, library, start, candidate, places[1])
    network = adding.apply(network)
    known, giving = (declared(network, library, one) for one in (name, between))
    assert known is not None
    assert giving is not None
    taken = {link.input for link in network.links_into(name)}
    beside = [  # where the network has several contexts, the transform's own
        Link(between, entry.name, name, entry.name)
        for entry in known.inputs
        if entry.required and entry.name not in taken and giving.output(entry.name)
    ]
    text = f"Add {named([between, name])}" if steps else adding.text
    return name, together((*steps, adding, rewire(add=beside)), text)


def _wired_along(network: Network, library: Library, link: Link, node: str) -> Operation:
    """A link of a node that has no wires, and those of its other inputs that are certain."""
    wiring = rewire(add=(link, *_others(network, library, link, node)))
    check_new_wires(network, wiring.apply(network), library)
    return wiring


def _others(network: Network, library: Library, link: Link, node: str) -> list[Link]:
    module = declared(network, library, node)
    if module is None:
        return []
    taken = {link.input} if link.target == node else set()
    followers = {link.target} - {node}
    links = side_links(network, library, node, taken, followers)
    behind = reached(network.followers, {node, *followers})
    for kind in (MAGNITUDE, PHASE):
        port = port_of(module.inputs, kind)
        if port is None or port.name in taken or len(port.types) > 1:
            continue
        source = _spectrum(network, library, link, node, kind, required=port.required)
        if source is not None and source[0] not in behind:
            links.append(Link(*source, node, port.name))
    return links


def _spectrum(
    network: Network, library: Library, link: Link, node: str, kind: str, *, required: bool
) -> Output | None:
    every = [end for end in outputs_of(network, library, kind) if end[0] != node]
    module = declared(network, library, link.target)
    drawn_to = module.input(link.input) if module else None
    if link.target == node and drawn_to is not None and drawn_to.types == (PARTNER[kind],):
        # What travels beside the wire drawn: from the same node, else where it has been led to.
        same = [end for end in every if end[0] == link.source]
        every = same or [end for end in every if _is_open(network, library, *end)]
    elif not required:
        return None
    return every[0] if len(every) == 1 else None


def continued(
    network: Network, library: Library, node: str, module: str, at: Point | None
) -> tuple[str, Operation] | None:
    """A new node wired behind another one, and its name; None where no wire fits."""
    name, adding = new_node(network, library, module, at)
    wiring = wires_behind(adding.apply(network), library, node, name)
    return None if wiring is None else (name, together((adding, wiring), adding.text))


def wires_behind(
    network: Network, library: Library, node: str, new: str, *, branches: bool = True
) -> Operation | None:
    """What wires a node without wires on to another one; None where they have none in common."""
    known, added = declared(network, library, node), declared(network, library, new)
    if known is None or added is None:
        return None
    for output, entry in _pairs(known.outputs, added.inputs):
        onward = [link for link in network.links if (link.source, link.output) == (node, output)]
        between = None
        if len(onward) == 1 or not branches:
            between = _before_all(network, library, onward, new)
        if between is not None:
            return between
        if wiring := _wired(network, library, Link(node, output, new, entry), new):
            return wiring
    linked = {link.input for link in network.links_into(node)}
    empty = tuple(port for port in known.inputs if port.required and port.name not in linked)
    for output, entry in _pairs(added.outputs, empty):
        if wiring := _wired(network, library, Link(new, output, node, entry), new):
            return wiring
    return None


def _before_all(
    network: Network, library: Library, onward: Sequence[Link], new: str
) -> Operation | None:
    """Lead all wires of an output through a node; None where it does not fit between."""
    if not onward:
        return None
    # One that leads on first: what runs beside it is led through as well.
    first, *others = sorted(onward, key=lambda link: not network.followers[link.target])
    between = inserted(network, library, first, new)
    if between is None or not others:
        return between
    grown = between.apply(network)
    (out,) = (link for link in grown.links_into(first.target) if link.input == first.input)
    moved = [(Link(new, out.output, old.target, old.input), old) for old in others]
    fitting = [pair for pair in moved if misfit(grown, library, pair[0]) is None]
    rest = rewire(add=tuple(link for link, _ in fitting), remove=tuple(old for _, old in fitting))
    both = together((between, rest), f"Insert {shown(new)}")
    return both if _sound(network, library, both) else between


def wires_from_open_end(
    network: Network, library: Library, node: str, new: str
) -> Operation | None:
    """What wires a node without wires to an open end of another one; None where none fits.

    An output is open where no other node carries its kind of value on: a viewer leaves it open.
    """
    known, added = declared(network, library, node), declared(network, library, new)
    for output, entry in _pairs(known.outputs, added.inputs) if known and added else ():
        open_end = _is_open(network, library, node, output)
        if open_end and (wiring := _wired(network, library, Link(node, output, new, entry), new)):
            return wiring
    return None


def _wired(network: Network, library: Library, link: Link, node: str) -> Operation | None:
    try:
        return _wired_along(network, library, link, node)
    except NetworkError:
        return None  # another pair of ports may do


def _is_open(network: Network, library: Library, node: str, output: str) -> bool:
    known = declared(network, library, node)
    port = known.output(output) if known is not None else None
    kinds = set(port.types) if port is not None else set()
    if kinds <= set(_FEW):
        return True
    for link in network.links:
        if (link.source, link.output) == (node, output):
            target = declared(network, library, link.target)
            if target is None or any(kinds & set(onward.types) for onward in target.outputs):
                return False
    return True


def _pairs(outputs: tuple[Port, ...], inputs: tuple[Port, ...]) -> Iterator[tuple[str, str]]:
    """Outputs and the inputs they fit: what every module takes last, needed inputs first."""
    fitting = [
        (output.types[0] in _FEW, not entry.required, output.name, entry.name)
        for output in outputs
        for entry in inputs
        if set(output.types) & set(entry.types)
    ]
    # Sorted by the first two alone: of equal ones the order of the declaration counts.
    return ((pair[2], pair[3]) for pair in sorted(fitting, key=lambda pair: pair[:2]))


def dissolved(
    network: Network, library: Library, names: Collection[str], verb: str = "Delete"
) -> Operation:
    """Take nodes out; what each passed on is led past it, as it would with them disabled.

    No wire is led past a node that is fed several of its type: which one is the user's to say.
    """
    text = f"{verb} {named([shown(name) for name in names])}"
    new, taking = _led_past(network, library, set(names)), remove_nodes(tuple(names), text)
    return together((taking, rewire(add=new)), text) if new else taking


def detached(network: Network, library: Library, names: Collection[str]) -> Operation:
    """Take the wires between nodes and the others away, and lead them past as `dissolved` does."""
    old = tuple(link for link in network.links if (link.source in names) != (link.target in names))
    text = f"Detach {named([shown(name) for name in names])}"
    return rewire(add=_led_past(network, library, set(names)), remove=old, label=text)


def _led_past(network: Network, library: Library, gone: set[str]) -> tuple[Link, ...]:
    new = []
    for link in network.links:
        if link.source in gone and link.target not in gone:
            start = _origin(network, library, gone, (link.source, link.output))
            past = Link(*start, link.target, link.input) if start is not None else None
            if past and past.source != past.target and misfit(network, library, past) is None:
                new.append(past)
    return tuple(new)


def _origin(network: Network, library: Library, gone: set[str], end: Output) -> Output | None:
    """The output outside `gone` whose value reaches an output inside; None where none does."""
    seen = set()
    while end[0] in gone:
        name, output = end
        module = declared(network, library, name)
        if name in seen or module is None:  # a cycle, which no sound network has
            return None
        seen.add(name)
        entry = passed_through(module).get(output)
        port = module.output(output)
        linked = {link.input: link for link in network.links_into(name)}
        if entry not in linked or port is None:
            return None
        alike = [
            taking.name
            for taking in module.inputs
            if taking.name in linked and set(port.types) & set(taking.types)
        ]
        if len(alike) > 1:
            return None
        end = linked[entry].source, linked[entry].output
    return end
