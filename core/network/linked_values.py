"""Parameters that follow others: a network's expressions, and the same network with their values.

In a file such a parameter is ``{"expression": "init.f_number * 2"}``. All that computes takes the
network through `with_values` first, so that modules, keys and reports meet plain numbers.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from core.errors import NetworkError, ParameterError, close, shown, thaw
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter, plain
from core.network import expressions
from core.network.macro import SEPARATOR, expanded
from core.network.network import EXPRESSION, Network, Node, cycles, reached, topological, way_round
from core.records import dataclass, field, replace

_Place = tuple[str, str]  # node and parameter


class LinkError(ParameterError):
    """An expression that gives no allowed value, why, and what is allowed."""

    def __init__(
        self, parameter: Parameter, raw: object, why: str, *, node: str | None = None
    ) -> None:
        unit = parameter.param.unit
        must = "" if why.startswith(_ONLY) else f" The result must be {parameter.allowed()}"
        end = "." if must and not why.endswith("?") else ""
        text = expression_text(raw)
        super().__init__(parameter.name, text, parameter.allowed(), unit=unit, node=node)
        self.message = " ".join(
            f"{parameter.name} = {shown(text)} is not allowed: {why}{end}{must}"
            f"{f' ({unit})' if unit and must else ''}".split()
        )
        self.why = why


_ONLY = "only a numeric parameter can follow other parameters"


@dataclass(frozen=True)
class ResolvedNetwork:
    """A network whose expressions have become values.

    Nodes in `faults` have an expression without an allowed value; it is left in its place there.
    """

    network: Network
    faults: Mapping[str, tuple[LinkError, ...]] = field(default_factory=dict)

    def node(self, name: str) -> Node | None:
        """The plain node of a name, also one inside of a disabled macro; None where none is."""
        return self.network.nodes.get(name) or self.network.aside.get(name)

    def value(self, node: str, parameter: str) -> Any:
        name, behind = self.network.parameter_behind(node, parameter)
        known = self.node(name)
        return known.params.get(behind) if known is not None else None

    def faults_of(self, node: Node) -> dict[str, LinkError]:
        """What is wrong with a node's expressions, by parameter; of a macro, with those behind."""
        faults = {}
        for name in node.linked:
            behind, parameter = self.network.parameter_behind(node.id, name)
            for fault in self.faults.get(behind, ()):
                if fault.parameter == parameter:
                    faults[name] = fault
        return faults


def expression(text: str) -> dict[str, Any]:
    """A parameter's value as a network file has it where it follows others."""
    return {EXPRESSION: text}


def expression_text(raw: object) -> str:
    """The expression of a raw value that has one, as written; else the value itself."""
    inside = raw.get(EXPRESSION) if isinstance(raw, Mapping) else raw
    return inside if isinstance(inside, str) else f"{thaw(inside)!r:.80}"


def with_values(
    network: Network, *, library: Library, known: Callable[[str], Node | None] | None = None
) -> ResolvedNetwork:
    """The network with the value of every expression in its place.

    A network without expressions is returned as it is. Those of modules that are not in the
    library, and of parameters that their module has not, stay: validation reports them. `known`
    gives a node of an earlier call, by its id: one that is equal is taken again, so that it is not
    planned anew.
    """
    if not any(node.linked for node in (*network.nodes.values(), *network.aside.values())):
        return ResolvedNetwork(network)
    survey = _Survey(network, library)
    survey.read()
    survey.refuse_cycles()
    survey.evaluate()
    nodes, aside = dict(network.nodes), dict(network.aside)
    for name, values in survey.by_node().items():
        place = nodes if name in nodes else aside
        node = replace(place[name], params={**place[name].params, **values})
        earlier = known(name) if known is not None else None
        # To Python, 1 is true and 1.0: equal, but not the same in a file.
        same = earlier == node and repr(earlier.params) == repr(node.params)
        place[name] = earlier if earlier is not None and same else node
    faults: dict[str, tuple[LinkError, ...]] = {}
    for (name, _), error in survey.faults.items():
        faults[name] = (*faults.get(name, ()), error)
    changed = network.with_nodes(nodes)
    return ResolvedNetwork(replace(changed, aside=aside) if network.aside else changed, faults)


def resolved(network: Network, *, library: Library) -> ResolvedNetwork:
    """A document with its macros written out and values in the place of expressions."""
    return with_values(expanded(network, library), library=library)


def with_names(node: Node, names: Mapping[str, str]) -> Node:
    """The node with other names in its expressions, by the old names."""
    return with_references(node, lambda one, parameter: (new_name(one, names), parameter))


def with_references(node: Node, moved: expressions.Moved) -> Node:
    """The node with expressions that name other nodes and parameters; errors as `with_names`."""
    changed = {}
    for name in node.linked:
        raw = node.params[name]
        text = raw[EXPRESSION]
        if isinstance(text, str) and (new := expressions.rewritten(text, moved)) != text:
            if len(new) > expressions.LONGEST:
                raise NetworkError(
                    f"an expression would become {len(new)} characters long; at most "
                    f"{expressions.LONGEST} are allowed"
                )
            changed[name] = {**raw, EXPRESSION: new}
    return replace(node, params={**node.params, **changed}) if changed else node


def new_name(name: str, names: Mapping[str, str]) -> str:
    """What a node is called where it, or a macro that it lies in, has got another name."""
    head = next((head for head in _heads(name) if head in names), None)
    return name if head is None else names[head] + name.removeprefix(head)


def _heads(name: str) -> Iterator[str]:
    """The name, then those of the macros it may lie in, the innermost first."""
    yield name
    while SEPARATOR in name:
        name = name.rpartition(SEPARATOR)[0]
        yield name


def references_in(raw: Mapping[str, Any]) -> tuple[expressions.Reference, ...]:
    """What an expression names; nothing where it cannot be read."""
    text = raw[EXPRESSION]
    try:
        return expressions.parse_expression(text).references if isinstance(text, str) else ()
    except expressions.ExpressionError:
        return ()


def references(network: Network) -> Iterator[tuple[str, str, expressions.Reference]]:
    """Node and parameter of every expression, with each thing that it names, in order."""
    for node in network.nodes.values():
        for parameter in node.linked:
            for reference in references_in(node.params[parameter]):
                yield node.id, parameter, reference


def naming(network: Network, names: Collection[str]) -> list[tuple[str, str]]:
    """Node and parameter of every expression that names one of these nodes, or what lies inside."""
    places = {
        (node, parameter): None
        for node, parameter, reference in references(network)
        if any(head in names for head in _heads(reference.node))
    }
    return list(places)


def following(network: Network, node: str) -> set[str]:
    """The nodes whose parameters follow that node's, also by way of others; not itself."""
    followers: dict[str, set[str]] = {}
    for follower, _, reference in references(network):
        leader, _ = network.parameter_behind(reference.node, reference.parameter)
        followers.setdefault(leader, set()).add(follower)
    return reached(followers, {node}) - {node}


class _Survey:
    def __init__(self, network: Network, library: Library) -> None:
        self.network = network
        self.library = library
        self.nodes = {**network.aside, **network.nodes}
        self.parameters: dict[_Place, Parameter] = {}
        self.parsed: dict[_Place, expressions.Expression] = {}
        self.values: dict[_Place, Any] = {}
        self.faults: dict[_Place, LinkError] = {}

    def by_node(self) -> dict[str, dict[str, Any]]:
        nodes: dict[str, dict[str, Any]] = {}
        for (name, parameter), value in self.values.items():
            nodes.setdefault(name, {})[parameter] = value
        return nodes

    def read(self) -> None:
        for node in self.nodes.values():
            for name in node.linked:
                place = (node.id, name)
                module = self.library.get(node.module)
                parameter = declaration(module).parameter(name) if module is not None else None
                if parameter is None:
                    continue
                self.parameters[place] = parameter
                try:
                    self.parsed[place] = _parsed(node.params[name], parameter)
                except expressions.ExpressionError as error:
                    self._refuse(place, error.message)

    def refuse_cycles(self) -> None:
        self.followers: dict[_Place, list[_Place]] = {place: [] for place in self.parsed}
        for place, parsed in self.parsed.items():
            for reference in parsed.references:
                leader = self._place(reference)
                if leader in self.parsed:
                    self.followers[leader].append(place)
        graph: Any = self.followers
        for loop in cycles(graph):
            way = way_round(f"{shown(node)}.{name}" for node, name in map(tuple, loop))
            for node, name in map(tuple, loop):
                why = f"the parameter follows itself: {way}. Give one of these parameters a value"
                self._refuse((node, name), why)

    def evaluate(self) -> None:
        graph: Any = self.followers
        ordered: Any = topological(graph)
        for place in dict.fromkeys((*ordered, *self.parsed)):  # then those behind a cycle
            if place not in self.faults:
                self._evaluate(place)

    def _evaluate(self, place: _Place) -> None:
        parameter = self.parameters[place]
        try:
            value = expressions.value_of(
                self.parsed[place], unit=parameter.param.unit, lookup=self._value_of_reference
            )
            coerced = parameter.coerce(value)
        except ParameterError:
            self._refuse(place, f"the expression gives {_amount(value, parameter)}")
        except expressions.ExpressionError as error:
            self._refuse(place, error.message)
        else:
            self.values[place] = plain(coerced)

    def _refuse(self, place: _Place, why: str) -> None:
        node, name = place
        raw = self.nodes[node].params[name]
        self.faults[place] = LinkError(self.parameters[place], raw, why, node=node)

    def _place(self, reference: expressions.Reference) -> _Place:
        return self.network.parameter_behind(reference.node, reference.parameter)

    def _value_of_reference(self, reference: expressions.Reference) -> float:
        text = reference.text
        place = name, parameter_name = self._place(reference)
        node = self.nodes.get(name)
        if node is None:
            raise expressions.ExpressionError(self._no_node(reference))
        if place in self.values:
            return _number(self.values[place], text)
        if place in self.faults or place in self.parsed:
            raise expressions.ExpressionError(
                f"{text} has no value until its own error is corrected"
            )
        module = self.library.get(node.module)
        if module is None:
            raise expressions.ExpressionError(f"{text} belongs to an unknown module")
        declared = declaration(module)
        parameter = declared.parameter(parameter_name)
        if parameter is None:
            known = [one.name for one in declared.parameters]
            hint = close(parameter_name, known) or f"; its parameters: {', '.join(known) or 'none'}"
            raise expressions.ExpressionError(f"{declared.title} has no parameter {text}{hint}")
        if parameter_name not in node.params:
            return _number(None if parameter.required else parameter.default, text)
        try:
            return _number(parameter.coerce(thaw(node.params[parameter_name])), text)
        except ParameterError:
            raise expressions.ExpressionError(
                f"{text} itself has a value that is not allowed"
            ) from None

    def _no_node(self, reference: expressions.Reference) -> str:
        name = reference.node
        ports = [port.rpartition(".") for port in self.network.parameter_names]
        own = [parameter for macro, _, parameter in ports if macro == name]
        head = f"{name}{SEPARATOR}"
        if own or any(other.startswith(head) for other in self.nodes):
            hint = (
                close(reference.parameter, own) or f"; parameters shown: {', '.join(own) or 'none'}"
            )
            return f"the macro {shown(name)} shows no parameter {reference.text}{hint}"
        hint = close(name, [*self.nodes, *dict.fromkeys(macro for macro, _, _ in ports)])
        return f"{reference.text} names {shown(name)}, which is not a node{hint}"


def _parsed(raw: Mapping[str, Any], parameter: Parameter) -> expressions.Expression:
    text = raw[EXPRESSION]
    if not isinstance(text, str):
        raise expressions.ExpressionError("an expression must be text")
    if len(raw) > 1:
        others = ", ".join(shown(name) for name in raw if name != EXPRESSION)
        raise expressions.ExpressionError(
            f"only the field {EXPRESSION} is allowed; remove {others:.80}"
        )
    if parameter.kind not in ("number", "integer"):
        raise expressions.ExpressionError(
            f"{_ONLY}, but this parameter must be {parameter.allowed()}"
        )
    return expressions.parse_expression(text)


def _number(value: Any, text: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        what = "is empty" if value is None else f"is {shown(str(thaw(value)))}"
        raise expressions.ExpressionError(f"{text} {what}; an expression needs numbers")
    return value


def _amount(value: float, parameter: Parameter) -> str:
    unit = f" {parameter.param.unit}" if parameter.param.unit else ""
    number = repr(value) if isinstance(value, float) else f"{value}"
    return f"{number:.40}{unit}"
