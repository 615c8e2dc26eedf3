"""The network document: nodes, links and where they lie on the canvas. Immutable, plain data."""

import heapq
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from numbers import Integral
from types import MappingProxyType
from typing import Any

from core.errors import NetworkError, ParameterError, check_id, close, freeze, shown, thaw
from core.modules.declaration import Declaration, Library, declaration
from core.modules.parameters import LARGEST_INTEGER
from core.records import dataclass, field, fields, replace

NODE_FIELDS = ("module", "params", "auto", "disabled", "final", "noise", "macro")
NETWORK_FIELDS = ("format", "version", "name", "description", "seed", "nodes", "links", "layout")
MACRO = "macro"
"""Module of a node that holds a network of its own."""

EXPRESSION = "expression"
"""The field of a parameter that follows others, in the place of its value."""
SEEDS = f"a whole number from 0 to {LARGEST_INTEGER}"


class _Frozen:
    """Copies and pickles by its fields: read-only mappings support neither."""

    def __reduce__(self) -> tuple[Any, ...]:
        values = tuple(thaw(getattr(self, f.name)) for f in fields(self))  # type: ignore[arg-type]
        return type(self), values


@dataclass(frozen=True)
class Node(_Frozen):
    """One module on the canvas; `id` is the user's name for it, unique in the network.

    `params` is what was set, as plain JSON values; what is left out has its default. `auto` is
    Auto-Generate, None where the file does not set it. A disabled node passes its main input
    through. With `final` the network's output is its first picture or, of a sink, the picture it
    takes. `noise` is the name its noise is drawn under, where that is not its id. `macro` is the
    inside of a macro: nodes, links and layout, `name` its title, its interface in `extra`. `extra`
    are other fields of the file, such as pinned panels, kept as they are.
    """

    id: str
    module: str
    params: Mapping[str, Any] = field(default_factory=dict)
    auto: bool | None = None
    disabled: bool = False
    extra: Mapping[str, Any] = field(default_factory=dict)
    final: bool = False
    noise: str = ""
    macro: "Network | None" = None

    def __post_init__(self) -> None:
        check_id(self.id)
        _check_extra(self.extra, NODE_FIELDS)
        if (self.macro is not None) != (self.module == MACRO):
            raise NetworkError(
                f"{self.id}: a node of the module {MACRO} needs the field macro; other nodes must "
                "not have it"
            )
        _set(self, params=freeze(self.params), extra=freeze(self.extra))

    @cached_property
    def linked(self) -> tuple[str, ...]:
        return tuple(
            name
            for name, value in self.params.items()
            if isinstance(value, Mapping) and EXPRESSION in value
        )


@dataclass(frozen=True, order=True)
class Link:
    """A wire from the output of `source` to the input of `target`."""

    source: str
    output: str
    target: str
    input: str

    @classmethod
    def between(cls, start: str, end: str) -> "Link":
        """From ``NODE.PORT`` to ``NODE.PORT``, each split at its last dot."""
        ends = []
        for text in (start, end):
            node, _, port = text.rpartition(".")
            if not node or not port:
                raise NetworkError(f"{text!r:.80} is not a port: write NODE.PORT")
            ends += [node, port]
        return cls(*ends)

    def renamed(self, names: Mapping[str, str]) -> "Link":
        source, target = (names.get(node, node) for node in (self.source, self.target))
        return Link(source, self.output, target, self.input)

    def text(self) -> list[str]:
        return [f"{self.source}.{self.output}", f"{self.target}.{self.input}"]

    def __str__(self) -> str:
        return " → ".join(shown(end) for end in self.text())


@dataclass(frozen=True)
class Network(_Frozen):
    """A document. Its nodes keep their order; that of links means nothing, so it is not kept.

    `layout` gives points of the canvas by node, `extra` the file's other fields. Where macros have
    been written out (`core.network.macro`), `port_names` and `parameter_names` give for the
    ``NODE.NAME`` of a macro that of the inner node it stands for; `aside` has the nodes inside of
    disabled macros, which only give parameters that others may follow.
    """

    name: str = ""
    description: str = ""
    seed: int = 0
    nodes: Mapping[str, Node] = field(default_factory=dict)
    links: tuple[Link, ...] = ()
    layout: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    extra: Mapping[str, Any] = field(default_factory=dict)
    port_names: Mapping[str, str] = field(default_factory=dict)
    parameter_names: Mapping[str, str] = field(default_factory=dict)
    aside: Mapping[str, Node] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_seed(self.seed)
        _check_extra(self.extra, NETWORK_FIELDS)
        for name, node in self.nodes.items():
            if name != node.id:
                raise NetworkError(f"the node {node.id} is stored under the id {shown(name)}")
        for name in ("nodes", "port_names", "parameter_names", "aside"):
            _set(self, **{name: MappingProxyType(dict(getattr(self, name)))})
        links = tuple(sorted(self.links))
        _set(self, links=links, layout=freeze(self.layout), extra=freeze(self.extra))

    @cached_property
    def _inward(self) -> Mapping[str, tuple[Link, ...]]:
        inward: dict[str, list[Link]] = {}
        for link in self.links:
            inward.setdefault(link.target, []).append(link)
        return {name: tuple(links) for name, links in inward.items()}

    @cached_property
    def followers(self) -> Mapping[str, tuple[str, ...]]:
        """The nodes that each node's links lead to; links to nowhere do not count."""
        targets_of: dict[str, dict[str, None]] = {name: {} for name in self.nodes}
        for link in self.links:
            if link.source in targets_of and link.target in targets_of:
                targets_of[link.source][link.target] = None
        return {name: tuple(targets) for name, targets in targets_of.items()}

    @property
    def marked(self) -> tuple[str, ...]:
        """The nodes that are marked as the output; one at most where the network is sound."""
        names: dict[str, None] = {}
        for name, node in self.nodes.items():
            if node.final:
                names[name] = None
            if node.macro is not None:
                names.update(dict.fromkeys(f"{name}/{inner}" for inner in node.macro.marked))
        return tuple(names)

    @property
    def output_nodes(self) -> tuple[str, ...]:
        """The nodes whose picture is marked as the output, also by the network's own field."""
        port = self.extra.get("final")
        named = port.rpartition(".")[0] if isinstance(port, str) else ""
        return self.marked or ((named,) if self.has(named) else ())

    def step_inside(self, name: str) -> tuple[str, str] | None:
        """The macro that a name such as ``camera/optics/blur`` begins with, and the rest of it."""
        if name in self.nodes:
            return None
        for place, letter in enumerate(name):
            macro, rest = name[:place], name[place + 1 :]
            node = self.nodes.get(macro) if letter == "/" else None
            if node is not None and node.macro is not None and node.macro.has(rest):
                return macro, rest
        return None

    def has(self, name: str) -> bool:
        """Whether there is a node of that id, or, as ``MACRO/NODE``, inside of a macro."""
        return name in self.nodes or self.step_inside(name) is not None

    def parameter_behind(self, node: str, name: str) -> tuple[str, str]:
        """The node and parameter that a macro's parameter stands for; others stand for itself."""
        inner, _, parameter = self.parameter_names.get(f"{node}.{name}", "").rpartition(".")
        return (inner, parameter) if inner else (node, name)

    def node(self, name: str) -> Node:
        if name not in self.nodes:
            hint = close(name, self.nodes)
            raise NetworkError(f"{shown(name)} is not a node of this network{hint}")
        return self.nodes[name]

    def links_into(self, node: str) -> tuple[Link, ...]:
        return self._inward.get(node, ())

    def unlinked_outputs(self, library: Library) -> tuple[tuple[str, str], ...]:
        """Node and port of every output that no link leaves and that has a value."""
        linked = {(link.source, link.output) for link in self.links}
        outputs = []
        for node in self.nodes.values():
            if node.module not in library:
                continue
            declared = declaration(library[node.module])
            through = passed_through(declared)
            for port in declared.outputs:
                alive = port.name in through or not node.disabled
                if alive and (node.id, port.name) not in linked:
                    outputs.append((node.id, port.name))
        return tuple(outputs)

    def order(self) -> tuple[str, ...]:
        """Ids of the nodes, each after those it is linked from; else in the document's order."""
        ordered = topological(self.followers)
        if len(ordered) < len(self.nodes):
            raise cycle_error(cycles(self.followers)[0])
        return ordered

    def with_parameter(self, node: str, name: str, value: Any) -> "Network":
        old = self.node(node)
        return self.with_node(replace(old, params={**old.params, name: value}))

    def with_node(self, node: Node) -> "Network":
        """With a node in the place of the one of its id.

        All else is taken over as it is: it has been checked and frozen, and a drag makes a new
        network with each move of the mouse.
        """
        self.node(node.id)
        return self.with_nodes({**self.nodes, node.id: node})

    def with_nodes(self, nodes: Mapping[str, Node]) -> "Network":
        """With other nodes of the same ids, in the same order; all else is taken over as it is."""
        changed = object.__new__(Network)
        vars(changed).update(vars(self), nodes=MappingProxyType(dict(nodes)))
        return changed

    def with_seed(self, seed: int) -> "Network":
        whole = isinstance(seed, Integral) and not isinstance(seed, bool)
        return replace(self, seed=int(seed) if whole else seed)  # one of NumPy's, too


def passed_through(declared: Declaration) -> dict[str, str]:
    """Which input each output of a disabled module passes on.

    Only the first output of a type takes part: a module's noise is no image to go on with.
    """
    taken: set[str] = set()
    through = {}
    for output in declared.outputs:
        fitting = (port.name for port in declared.inputs if set(output.types) <= set(port.types))
        source = next(fitting, None)
        if source is not None and not taken.intersection(output.types):
            through[output.name] = source
        taken.update(output.types)
    return through


def check_seed(seed: object) -> None:
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed <= LARGEST_INTEGER:
        raise ParameterError("seed", seed, SEEDS)


def cycle_error(loop: tuple[str, ...]) -> NetworkError:
    """The error for links that form a cycle, placed on its first node."""
    way = way_round(loop)
    return NetworkError(f"the links form a cycle: {way}; remove one of these links", node=loop[0])


def way_round(loop: Iterable[str]) -> str:
    """A cycle in one line, from its first name to that again."""
    names = tuple(loop)
    short = names if len(names) <= 12 else (*names[:11], "…", names[-1])
    return " → ".join((*short, names[0]))


def with_marks(network: Network, marked: Collection[str], extra: Mapping[str, Any]) -> Network:
    """The network with these nodes marked as the output and no others, and with other fields."""
    nodes = {}
    for name, node in network.nodes.items():
        if node.final != (name in marked):
            node = replace(node, final=name in marked)  # noqa: PLW2901
        inside = {
            other.removeprefix(f"{name}/") for other in marked if other.startswith(f"{name}/")
        }
        if node.macro is not None and set(node.macro.marked) != inside:
            node = replace(node, macro=with_marks(node.macro, inside, node.macro.extra))  # noqa: PLW2901
        nodes[name] = node
    return replace(network, nodes=nodes, extra=extra)


def marked_twice(marked: tuple[str, ...]) -> NetworkError:
    named = ", ".join(map(shown, marked[:8])) + (", …" if marked[8:] else "")
    return NetworkError(
        f"{len(marked)} nodes are marked as the output ({named}); only one is allowed"
    )


def _check_extra(extra: Mapping[str, Any], taken: tuple[str, ...]) -> None:
    for name in extra:
        if name in taken:
            raise NetworkError(f"the field {name} is reserved and cannot be an extra field")


def _set(target: object, **values: Any) -> None:
    for name, value in values.items():
        object.__setattr__(target, name, value)


# Order and cycles of a directed graph given as each node's followers; no recursion.

Followers = Mapping[str, Sequence[str]]


def topological(followers: Followers) -> tuple[str, ...]:
    """Nodes after all they follow; among those that are free, in the order of the mapping."""
    names = list(followers)
    place = {name: number for number, name in enumerate(names)}
    waiting = dict.fromkeys(names, 0)
    for targets in followers.values():
        for target in targets:
            waiting[target] += 1
    free = [place[name] for name in names if not waiting[name]]
    ordered = []
    while free:
        name = names[heapq.heappop(free)]
        ordered.append(name)
        for target in followers[name]:
            waiting[target] -= 1
            if not waiting[target]:
                heapq.heappush(free, place[target])
    return tuple(ordered)


def reached(followers: Mapping[str, Iterable[str]], starts: Iterable[str]) -> set[str]:
    """These nodes and all that follow them."""
    found = set(starts)
    rest = list(found)
    while rest:
        fresh = [name for name in followers.get(rest.pop(), ()) if name not in found]
        found.update(fresh)
        rest += fresh
    return found


def cycles(followers: Followers) -> list[tuple[str, ...]]:
    """Cycles, no two with a node in common, each once round from its first node on; none if none.

    Where one leads on to another, the first may be found only when the other has gone.
    """
    place = {name: number for number, name in enumerate(followers)}
    left = place.keys() - set(topological(followers))
    leaders: dict[str, list[str]] = {name: [] for name in left}
    for name in left:
        for target in left.intersection(followers[name]):
            leaders[target].append(name)
    left -= set(topological(leaders))  # now each of them leads to another one
    loops = []
    seen: set[str] = set()
    for start in followers:
        way: dict[str, int] = {}
        name = start
        while name in left and name not in seen and name not in way:
            way[name] = len(way)
            name = next(target for target in followers[name] if target in left)
        seen.update(way)
        if name in way:
            loop = list(way)[way[name] :]
            first = loop.index(min(loop, key=place.__getitem__))
            loops.append((*loop[first:], *loop[:first]))
    return sorted(loops, key=lambda loop: place[loop[0]])
