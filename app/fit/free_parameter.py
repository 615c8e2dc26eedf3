"""``--free NODE.PARAM[=LOW:HIGH]``: a parameter that the picture is to determine."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from app.run.option_values import Assignment, assignment, low_high
from app.run.overrides import behind, named_parameter
from core.errors import UsageError
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter
from core.network.network import EXPRESSION, Network

FREE = "--free"
_FORM = "NODE.PARAM, or NODE.PARAM=LOW:HIGH"
_MOST = 8  # names in a message
_ABOVE = 1e-12  # of a range whose low end is no value: above it


@dataclass(frozen=True)
class FreeParameter:
    port: str  # ``NODE.PARAM`` as it was given
    # where it is, inside a macro too
    node: str
    name: str
    # between what; infinite where the parameter has no end
    low: float
    high: float
    present: float | None  # its value in the network; None where it is empty there
    unit: str  # of the parameter

    @property
    def target(self) -> tuple[str, str]:
        return self.node, self.name


def free_parameters(
    texts: Sequence[str], network: Network, library: Library, *, option: str = FREE
) -> tuple[FreeParameter, ...]:
    """The parameters that are named; `option` is what named them, for messages."""
    if not texts:
        raise UsageError(
            f"{option}: name a parameter to fit{_such_as(numbers_of(network, library))}"
        )
    free = tuple(_one(text, network, library, option) for text in texts)
    seen: set[tuple[str, str]] = set()
    for parameter in free:
        if parameter.target in seen:
            raise UsageError(f"{option} {parameter.port} is given more than once")
        seen.add(parameter.target)
    return free


def numbers_of(network: Network, library: Library) -> list[str]:
    """``NODE.PARAM`` of every number that may be fitted, but those of the network's sources."""
    found = []
    for key, node in network.nodes.items():
        module, links = library.get(node.module), network.links_into(key)
        if module is None or node.disabled or not links:
            continue
        is_stage = any(link.input == "context" for link in links)
        found += [
            (not is_stage, p.name not in node.params, f"{key}.{p.name}")
            for p in declaration(module).parameters
            if p.kind == "number"
        ]
    return [name for *_, name in sorted(found, key=lambda one: one[:2])]


def _such_as(names: Sequence[str]) -> str:
    if not names:
        return ""
    more = f", or {len(names) - _MOST} more" if len(names) > _MOST else ""
    return f", such as {', '.join(names[:_MOST])}{more}"


def _given(text: str, network: Network, library: Library, option: str) -> Assignment:
    """The parts of what was given; a node or a parameter alone is completed in the message."""
    name, equals, ends = text.partition("=")
    if "." in name:
        return assignment(option, f"{name}={ends}", _FORM)
    numbers = numbers_of(network, library)
    like = [one for one in numbers if name in one.split(".")]
    raise UsageError(
        f"{option} {text!r:.120}: write {_FORM}{_such_as(like or numbers)}"
        if name or equals
        else f"{option}: name a parameter to fit{_such_as(numbers)}"
    )


def _one(text: str, network: Network, library: Library, called: str) -> FreeParameter:
    given = _given(text, network, library, called)
    target = behind(given, network)
    declared = named_parameter(called, target, network, library=library)
    if declared is None:
        raise UsageError(f"{called} {given.port}: the node's module is unknown")
    option = f"{called} {given.port}"
    if declared.kind != "number":
        raise UsageError(
            f"{option}: {declared.name} is {declared.allowed()}; only a parameter with a range "
            "of numbers can be fitted"
        )
    raw = network.nodes[target.node].params.get(target.name, declared.default)
    if isinstance(raw, Mapping) and EXPRESSION in raw:
        raise UsageError(
            f"{option}: an expression computes this parameter from others; fit those instead"
        )
    low, high = _range(declared, target.text, option)
    present = float(raw) if isinstance(raw, int | float) else None
    return FreeParameter(
        given.port, target.node, target.name, low, high, present, declared.param.unit
    )


def _range(declared: Parameter, text: str, option: str) -> tuple[float, float]:
    own_low = -math.inf if declared.param.low is None else float(declared.param.low)
    own_high = math.inf if declared.param.high is None else float(declared.param.high)
    end = own_low
    if math.isfinite(end) and (declared.param.above or declared.coerce(end) is None):
        own_low = end + _ABOVE * max(1.0, abs(end))
    if not text:
        return own_low, own_high
    low, high = low_high(option, text)
    if low == end:
        low = own_low
    if low < own_low or high > own_high:
        raise UsageError(f"{option}={text:.80}: {declared.name} is {declared.allowed()}")
    return low, high
