"""Whether a network fits the library: every fault, each with what would be right."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from core.errors import ImagechainError, NetworkError, ParameterError, close, shown, thaw, watched
from core.modules.declaration import Declaration, Library, Port, declaration, where_absent
from core.network.linked_values import with_values
from core.network.macro import (
    SEPARATOR,
    End,
    Interface,
    declared_node,
    expanded,
    face_of_macro,
    has_macros,
    macros_in,
    passing_input,
    text,
)
from core.network.network import (
    Link,
    Network,
    Node,
    cycle_error,
    cycles,
    marked_twice,
    passed_through,
)

MOST_SUGGESTIONS = 100  # comparing names is slow, and a hostile file has a million wrong ones


class NetworkProblems(NetworkError):
    """A network with one or more faults; reads as the first of them."""

    def __init__(self, problems: Sequence[ImagechainError]) -> None:
        super().__init__(problems[0].message, node=problems[0].node)
        self.problems = tuple(problems)
        self.exit_code = problems[0].exit_code
        self.fault = getattr(problems[0], "fault", None)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.problems,), self.__dict__


def check_network(
    network: Network, *, library: Library, keep_unknown: bool = False, unfinished: bool = False
) -> None:
    faults = problems(network, library=library, keep_unknown=keep_unknown, unfinished=unfinished)
    if faults:
        raise NetworkProblems(faults) from faults[0]


def problems(
    network: Network, *, library: Library, keep_unknown: bool = False, unfinished: bool = False
) -> list[ImagechainError]:
    """Every fault of a network: of its nodes, of its links, cycles, then what is missing.

    `keep_unknown` accepts modules that are not in the library; `unfinished` what keeps it from
    running but not from being worked on: inputs without a link, several nodes marked as the output.
    """
    faults = macro_problems(network, library, unfinished=unfinished)
    plain = expanded(network, library)
    survey = _Survey(plain, library)
    survey.nodes(keep_unknown)
    survey.links()
    survey.faults += [] if faults else [cycle_error(loop) for loop in cycles(plain.followers)]
    survey.faults[:0] = faults
    if not unfinished:
        survey.missing()
        if len(network.marked) > 1:
            survey.faults.append(marked_twice(network.marked))
    return survey.faults


def plain_network(network: Network, *, library: Library) -> Network:
    """The network with its macros written out, for whatever computes; as it is without any."""
    if macro_problems(network, library):
        check_network(network, library=library)
    return expanded(network, library)


class _Survey:
    def __init__(self, network: Network, library: Library) -> None:
        resolved = with_values(network, library=library)
        self.network = resolved.network
        self.unresolved = resolved.faults
        self.library = library
        self.faults: list[ImagechainError] = []
        self.suggestions = 0
        self.declared: dict[str, Declaration] = {
            name: declaration(library[node.module])
            for name, node in network.nodes.items()
            if node.module in library
        }

    def _add(self, text: str, node: str | None) -> None:
        self.faults.append(NetworkError(text, node=node))

    def _close(self, name: str, known: Iterable[str]) -> str:
        self.suggestions += 1
        return close(name, known) if self.suggestions <= MOST_SUGGESTIONS else ""

    def nodes(self, keep_unknown: bool) -> None:
        for node in self.network.nodes.values():
            if node.id in self.declared:
                self._parameters(node, self.declared[node.id])
            elif not keep_unknown:
                absent = where_absent(node.module, self.library)
                hint = f": {absent}" if absent else self._close(node.module, self.library)
                hint = hint or "; the command `imagechain modules` lists all modules"
                self._add(f"there is no module {shown(node.module)}{hint}", node.id)

    def _parameters(self, node: Node, declared: Declaration) -> None:
        known = {parameter.name: parameter for parameter in declared.parameters}
        values = thaw(node.params)
        before = len(self.faults)
        without_value = {error.parameter: error for error in self.unresolved.get(node.id, ())}
        for name, value in values.items():
            if name in without_value:
                self.faults.append(without_value[name])
            elif name not in known:
                hint = self._close(name, known)
                allowed = f"{declared.title} has no such parameter{hint or _listed(known)}"
                self.faults.append(
                    ParameterError(shown(name), value, allowed, node=node.id, clause=True)
                )
            else:
                self._attempt(node, known[name].coerce, value)
        for name, parameter in known.items():
            if parameter.required and name not in values:
                self.faults.append(ParameterError(name, None, parameter.allowed(), node=node.id))
        if len(self.faults) == before:
            # Combinations make sense to judge only once each value does.
            module = self.library[node.module]
            self._attempt(node, lambda given: module.build(given).check(), values)

    def _attempt(self, node: Node, step: Callable[[Any], object], value: Any) -> None:
        try:
            with watched(node.id, node.module):
                step(value)
        except ImagechainError as error:
            self.faults.append(error)

    def links(self) -> None:
        into: dict[tuple[str, str], list[Link]] = {}
        for link in self.network.links:
            source = self._port(link, link.source, link.output, "output")
            target = self._port(link, link.target, link.input, "input")
            if source and target and not set(source.types) & set(target.types):
                gives, takes = " or ".join(source.types), " or ".join(target.types)
                what = f"the output gives {gives}, but the input takes {takes}"
                self._add(f"the link {link} does not fit: {what}", link.target)
            into.setdefault((link.target, link.input), []).append(link)
        for (name, port), links in into.items():
            if len(links) > 1:
                sources = ", ".join(shown(link.text()[0]) for link in links[:8])
                self._add(
                    f"the input {shown(port)} has {len(links)} links ({sources}); only one is "
                    "allowed",
                    name if name in self.network.nodes else None,
                )

    def _port(self, link: Link, name: str, port: str, side: str) -> Port | None:
        if name not in self.network.nodes:
            other = link.target if side == "output" else link.source
            hint = self._close(name, self.network.nodes)
            self._add(
                f"the link {link} names {shown(name)}, which is not a node of this network{hint}",
                other if other in self.network.nodes else None,
            )
            return None
        declared = self.declared.get(name)
        if declared is None:
            return None
        ports = declared.outputs if side == "output" else declared.inputs
        match = next((candidate for candidate in ports if candidate.name == port), None)
        if match is None:
            names = [candidate.name for candidate in ports]
            hint = self._close(port, names) or _listed(names)
            self._add(f"{declared.title} has no {side} {shown(port)} (the link {link}){hint}", name)
        return match

    def missing(self) -> None:
        linked = {(link.target, link.input) for link in self.network.links}
        leaving: dict[str, list[Link]] = {}
        for link in self.network.links:
            leaving.setdefault(link.source, []).append(link)
        for name, declared in self.declared.items():
            needed = [port for port in declared.inputs if port.required]
            if self.network.nodes[name].disabled:
                needed = self._needed_of_disabled(declared, leaving.get(name, []))
            for port in needed:
                if (name, port.name) not in linked:
                    kinds = " or ".join(port.types)
                    self._add(f"the input {port.name} needs a link that carries {kinds}", name)

    def _needed_of_disabled(self, declared: Declaration, leaving: list[Link]) -> list[Port]:
        """A disabled module needs what it passes on, and can give nothing else."""
        through = passed_through(declared)
        passed = " and ".join(dict.fromkeys(through.values())) or "nothing"
        used = {link.output for link in leaving}
        for link in leaving:
            made = link.output in through or link.output in ("mtf", "ptf")  # then 1, or 0
            if declared.output(link.output) and not made:
                self._add(
                    f"the link {link} carries nothing: {declared.title} is disabled; it passes on "
                    f"{passed} and gives no {link.output}",
                    link.source,
                )
        sources = {source for output, source in through.items() if output in used}
        main = declared.outputs[0].name if declared.outputs else ""
        if main in through:
            sources.add(through[main])
        return [port for port in declared.inputs if port.name in sources]


def _listed(names: Iterable[str]) -> str:
    return f"; allowed: {', '.join(names) or 'none'}"


# Whether the macros of a network are sound: what they show is there, and once each.


def macro_problems(
    network: Network, library: Library, *, unfinished: bool = False
) -> list[ImagechainError]:
    """Every fault of the macros themselves; those of the nodes inside are not among them."""
    if not has_macros(network):
        return []
    faults: list[ImagechainError] = [*_one_name_twice(network)]
    inside = ((f"{name}{SEPARATOR}", node.macro) for name, node in macros_in(network))
    for where, level in (("", network), *inside):
        for error in _at_level(level or Network(), library, unfinished):
            error.node = f"{where}{error.node}" if error.node is not None else where[:-1] or None
            faults.append(error)
    return faults


def _at_level(level: Network, library: Library, unfinished: bool) -> Iterator[ImagechainError]:
    if any(node.macro is not None for node in level.nodes.values()):
        yield from (cycle_error(loop) for loop in cycles(level.followers))
    for node in level.nodes.values():
        if node.macro is not None:
            yield from _of_macro(node, node.macro, library)
            yield from _of_links(level, node, library, unfinished)


def _one_name_twice(network: Network) -> Iterator[NetworkError]:
    """Nodes whose ids are those of nodes inside: ``a/b`` beside the node b of the macro a."""
    inside = (
        f"{macro}{SEPARATOR}{name}"
        for macro, node in macros_in(network)
        for name in (node.macro.nodes if node.macro is not None else ())
    )
    names = Counter((*network.nodes, *inside))
    for name, count in names.items():
        if count > 1:
            yield NetworkError(
                f"{shown(name)} is the id of {count} nodes, one of them inside a macro. Give "
                "each node an id of its own"
            )


def _of_macro(node: Node, body: Network, library: Library) -> Iterator[ImagechainError]:
    face = face_of_macro(body)
    declared = {name: declared_node(inner, library) for name, inner in body.nodes.items()}
    for kind, name, end in _shown(face):
        wrong = _missing(body, declared, kind, end)
        if wrong:
            yield NetworkError(
                f"the macro's {kind} {shown(name)} names {shown(text(end))}{wrong}", node=node.id
            )
    fed = [end for ends in face.inputs.values() for end in ends]
    for kind, named in (("input", fed), ("parameter", list(face.parameters.values()))):
        for end, count in Counter(named).items():
            if count > 1:
                given = "fed by" if kind == "input" else "set by"
                yield NetworkError(
                    f"the inner {kind} {shown(text(end))} is {given} {count} {kind}s of the "
                    "macro; only one is allowed",
                    node=node.id,
                )
    for link in body.links:
        for name, targets in face.inputs.items():
            if (link.target, link.input) in targets:
                yield NetworkError(
                    f"the macro's input {shown(name)} feeds {shown(link.text()[1])}, which already "
                    f"has a link inside the macro ({link})",
                    node=node.id,
                )
    for name, value in node.params.items():
        if name not in face.parameters:
            hint = close(name, face.parameters) or _listed(face.parameters)
            title = body.name or "the macro"
            allowed = f"{title} shows no such parameter{hint}"
            yield ParameterError(shown(name), value, allowed, node=node.id, clause=True)


def _shown(face: Interface) -> Iterator[tuple[str, str, End]]:
    for name, ends in face.inputs.items():
        for end in ends:
            yield "input", name, end
    for name, end in face.outputs.items():
        yield "output", name, end
    for name, end in face.parameters.items():
        yield "parameter", name, end


def _missing(
    body: Network, declared: dict[str, Declaration | None], kind: str, end: End
) -> str | None:
    """What is wrong with an inner port or parameter that a macro names."""
    if end[0] not in body.nodes:
        return f", but there is no node {shown(end[0])} inside{close(end[0], body.nodes)}"
    module = declared[end[0]]
    if module is None:
        return None
    known: Mapping[str, list[str]] = {
        "input": [port.name for port in module.inputs],
        "output": [port.name for port in module.outputs],
        "parameter": [parameter.name for parameter in module.parameters],
    }
    names = known[kind]
    if end[1] in names:
        return None
    hint = close(end[1], names) or _listed(names)
    return f", but {module.title} has no {kind} {shown(end[1])}{hint}"


def _of_links(
    level: Network, node: Node, library: Library, unfinished: bool
) -> Iterator[NetworkError]:
    assert node.macro is not None
    face = face_of_macro(node.macro)
    for link in level.links:
        for end, side, names in (
            ((link.target, link.input), "input", face.inputs),
            ((link.source, link.output), "output", face.outputs),
        ):
            if end[0] == node.id and end[1] not in names:
                hint = close(end[1], names) or _listed(names)
                yield NetworkError(
                    f"the macro has no {side} {shown(end[1])} (the link {link}){hint}", node=node.id
                )
        leaving = link.source == node.id and node.disabled and link.output in face.outputs
        if leaving and not unfinished and passing_input(node, link.output, library) is None:
            yield NetworkError(
                f"the link {link} carries nothing: the macro is disabled, and none of its inputs "
                f"is passed on as {shown(link.output)}",
                node=node.id,
            )
