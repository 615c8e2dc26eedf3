"""Which picture a network delivers: the one that is marked, else the only one there can be."""

from collections.abc import Collection, Iterable

from core.chain.engine import Plan, PlannedNode
from core.chain.wires import Image
from core.errors import ImagechainError, NetworkError, shown, thaw
from core.modules.declaration import Library, declaration
from core.network.network import Network, Node, marked_twice, reached
from core.network.validation import NetworkProblems
from core.records import dataclass, replace

ANALYSIS = "Analysis"  # the group whose modules compare and measure: their pictures are no output
HOW_TO_MARK = "select the node whose picture is the output and press O"
HOW_TO_NAME = "or give --final NODE.PORT"
_MOST_NAMED = 8


@dataclass(frozen=True)
class Output:
    port: str | None  # ``NODE.PORT``; None where there is none, or several could be meant
    # ports of the pictures that could be meant, where none of them is marked
    choices: tuple[str, ...] = ()

    @property
    def missing(self) -> str:
        """Why there is none, in one line; empty where there is one."""
        if self.port is not None:
            return ""
        if not self.choices:
            return "the network has no picture"
        named = ", ".join(map(shown, self.choices[:_MOST_NAMED]))
        more = len(self.choices) - _MOST_NAMED
        named += f" and {more} more" if more > 0 else ""
        return (
            f"this network ends in {len(self.choices)} pictures ({named}) and none is marked final"
        )


def find_output(plan: Plan) -> Output:
    """The picture that is marked as the output, else the one in which the network ends.

    A mark is the field `final` of a node, else of the network. Without one, it is the first picture
    of the only node at the end; analysis modules count if there are no others, pictures without
    inputs if there are none of both.
    """
    marked = plan.network.marked
    if len(marked) > 1:
        raise marked_twice(marked)
    if marked:
        return Output(_picture_of(plan, marked[0]))
    named = plan.network.extra.get("final")
    if named is not None:
        if not isinstance(named, str) or not _is_image(plan, named):
            raise NetworkError(
                f"final = {thaw(named)!r:.80} is not allowed: must be NODE.PORT of an image"
            )
        return Output(named)
    ends = _ends(plan)
    return Output(ends[0]) if len(ends) == 1 else Output(None, tuple(ends))


def how_to_choose(output: Output) -> str:
    """Which pictures there are and how to mark one, in one line; empty where none is to choose."""
    if not output.choices:
        return ""
    return f"{output.missing}: {HOW_TO_MARK}, {HOW_TO_NAME}"


def ending_images(plan: Plan) -> list[str]:
    return _leaves(plan, _seen_or_open(plan) or list(ports_of_images(plan)))


def sound_part(plan: Plan) -> Plan:
    """The plan without its failed nodes and what would name them; itself where none has failed."""
    failed = {name for name, node in plan.nodes.items() if node.error is not None}
    if not failed:
        return plan
    network = plan.network
    final = network.extra.get("final")
    lost = isinstance(final, str) and final.rpartition(".")[0] in failed
    sound = replace(
        network,
        nodes={name: node for name, node in network.nodes.items() if name not in failed},
        links=tuple(link for link in network.links if not {link.source, link.target} & failed),
        layout={},
        extra={} if lost else network.extra,
    )
    nodes = {name: node for name, node in plan.nodes.items() if name not in failed}
    return Plan(sound, nodes, plan.folder)


def ancestors(network: Network, *nodes: str) -> set[str]:
    """Every node that one of these hangs on."""
    upstream: set[str] = set()
    waiting = list(nodes)
    while waiting:
        for link in network.links_into(waiting.pop()):
            if link.source not in upstream:
                upstream.add(link.source)
                waiting.append(link.source)
    return upstream


def source_images(plan: Plan) -> list[str]:
    return [port for port in ports_of_images(plan) if not plan.nodes[_node(port)].inputs]


def _picture_of(plan: Plan, name: str) -> str:
    """A node's first picture; of a node that only takes one, that."""
    planned = plan.nodes.get(name)
    own = _first_image(planned, name) if planned is not None else None
    if own is not None:
        return own
    taken = [port for port in _sink_inputs(plan) if port[0] == name]
    if not taken:
        raise NetworkError(
            "this node is marked final but has no picture: mark a node with a picture", node=name
        )
    return taken[0][1]


def _ends(plan: Plan) -> list[str]:
    """The first pictures that nothing further is made of, of the best kind there is."""
    kinds: dict[int, list[str]] = {}
    for name, planned in plan.nodes.items():
        port = _first_image(planned, name)
        if port is not None:
            bare, analysis = not planned.inputs, planned.declaration.group == ANALYSIS
            kinds.setdefault(2 if bare else 1 if analysis else 0, []).append(port)
    return _leaves(plan, kinds[min(kinds)]) if kinds else []


def _leaves(plan: Plan, ports: list[str]) -> list[str]:
    """The ports on whose nodes none of the others' nodes hangs."""
    passed = ancestors(plan.network, *{_node(port) for port in ports})
    return [port for port in ports if _node(port) not in passed]


def _seen_or_open(plan: Plan) -> list[str]:
    linked = {f"{link.source}.{link.output}" for link in plan.network.links}
    main = {port for name in plan.nodes if (port := _first_image(plan.nodes[name], name))}
    open_ends = [port for port in ports_of_images(plan) if port not in linked]
    candidates = dict.fromkeys([*(port for _, port in _sink_inputs(plan)), *open_ends])
    beside = set(open_ends) - main
    groups = {port: plan.nodes[_node(port)].declaration.group for port in candidates}
    return [port for port in candidates if groups[port] != ANALYSIS and port not in beside]


def _sink_inputs(plan: Plan) -> list[tuple[str, str]]:
    nodes = plan.nodes.items()
    sinks = {name for name, one in nodes if one.module is not None and one.declaration.sink}
    pairs = [(link.target, f"{link.source}.{link.output}") for link in plan.network.links]
    return [(name, port) for name, port in pairs if name in sinks and _is_image(plan, port)]


def _first_image(planned: PlannedNode, name: str) -> str | None:
    """The node's first picture, which is its product; the others show how (its noise)."""
    outputs = planned.outputs.items()
    return next((f"{name}.{port}" for port, value in outputs if isinstance(value, Image)), None)


def ports_of_images(plan: Plan) -> Iterable[str]:
    for name, planned in plan.nodes.items():
        for port, value in planned.outputs.items():
            if isinstance(value, Image):
                yield f"{name}.{port}"


def _is_image(plan: Plan, port: str) -> bool:
    planned = plan.nodes.get(_node(port))
    output = None if planned is None else planned.outputs.get(port.rpartition(".")[2])
    return isinstance(output, Image)


def _node(port: str) -> str:
    return port.rpartition(".")[0]


# What judges the delivered picture, and has no part in it.


def delivering(network: Network, library: Library) -> set[str]:
    """The nodes of the delivered picture; if none is marked, of all that analysis does not make."""

    def makes_pictures(node: Node) -> bool:
        if node.module not in library:
            return True
        declared = declaration(library[node.module])
        images = any("image" in port.types for port in declared.outputs)
        return images and declared.group != ANALYSIS

    made = [name for name, node in network.nodes.items() if makes_pictures(node)]
    ends = network.output_nodes or made
    return {*ends, *ancestors(network, *ends)}


def without_judges(
    network: Network,
    error: ImagechainError,
    library: Library,
    spare: Collection[str] = (),
    *,
    figures_only: bool = False,
) -> tuple[Network, tuple[str, ...]] | None:
    """The network without the judges that have errors, and a line on each.

    None if the delivered picture, or one of `spare`, would go too; or with `figures_only` if
    another module than one of analysis has an error.
    """
    problems = error.problems if isinstance(error, NetworkProblems) else (error,)
    judges = set(network.nodes) - delivering(network, library)
    gone: set[str] = set()
    lines = []
    for problem in problems:
        if problem.node is None or problem.node not in judges:
            return None
        module = library.get(network.nodes[problem.node].module)
        if figures_only and (module is None or declaration(module).group != ANALYSIS):
            return None
        gone |= reached(network.followers, [problem.node])
        lines.append(f"{problem.node} is left out: {problem.message}")
    if not gone <= judges or gone & set(spare):
        return None
    nodes = {name: node for name, node in network.nodes.items() if name not in gone}
    links = tuple(link for link in network.links if not {link.source, link.target} & gone)
    return replace(network, nodes=nodes, links=links), tuple(lines)
