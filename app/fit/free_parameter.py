"""``--free NODE.PARAM[=LOW:HIGH]``: a parameter that the picture is to determine."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from app.run.option_values import Assignment, assignment, low_high
from app.run.overrides import behind, named_parameter
from core.errors import UsageError, several
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter
from core.network.network import EXPRESSION, Network
from core.records import dataclass

FREE = "--free"
_FORM = "NODE.PARAM, or NODE.PARAM=LOW:HIGH"
_MOST = 8  # names in a message
_ABOVE = 1e-12  # of a range whose low end is no value: above it


@dataclass(frozen=True)
class FreeParameter:
    port: str  # ``NODE.PARAM`` as it was given
    node: str  # where it is, inside a macro too
    name: str
    low: float  # between what; infinite where the parameter has no end
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
    more = f", or {several(len(names) - _MOST, 'other')}" if len(names) > _MOST else ""
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
            f"{option}: an expression computes this parameter; fit the parameters in the "
            "expression instead"
        )
    low, high = _range(declared, target.text, option)
    present = float(raw) if isinstance(raw, int | float) else None
    ends, unit = (low, high), declared.param.unit
    return FreeParameter(given.port, target.node, target.name, *ends, present, unit)


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


# Where the fit begins: places over the whole range of each free parameter, the best of them.

Vector = NDArray[np.float64]
Cost = Callable[[Vector], float]

_PLACES = 13
_WIDE = 30.0  # an end over the other, from which on places are equal factors apart
_FAR = 1000.0  # times the present value, beyond which the end of a range says nothing
_DECADES_KNOWN, _DECADES_UNKNOWN = 1.5, 4.0  # about the present value, or about 1
_SHARES = 1e-4, 0.3  # of a range to both sides of 0, in equal factors
_ROUNDS = 2
_DRAWN = 32  # sets for each parameter beyond the first
_APART = 0.3  # of a value, between starts
_DIFFERENT = 0.05  # of values, between solutions


def places(parameter: FreeParameter) -> Vector:
    """Numbers over the range of a parameter: equal steps, and factors about its present value."""
    low, high, now = parameter.low, parameter.high, parameter.present
    scale = abs(now) if now else 1.0
    if low > 0.0 and high / low >= _WIDE and high / low <= _FAR:
        return np.geomspace(low, high, _PLACES)
    if low < 0.0 < high and not now:
        # Such as ±20 waves of defocus: most of it is far beyond what any picture shows.
        shares = np.geomspace(*_SHARES, _PLACES)
        return np.sort(np.concatenate([low * shares, high * shares]))
    if high - low <= (_WIDE if low < 0.0 else _FAR) * scale:
        inside = (high - low) * 1e-3
        grid = np.linspace(low + inside, high - inside, _PLACES)
        if not now or low > 0.0:
            return grid
        about = now * np.geomspace(0.03, 30.0, _PLACES)
        return np.unique(np.concatenate([grid, about[(about > low) & (about < high)]]))
    decades = _DECADES_KNOWN if now else _DECADES_UNKNOWN
    first = max(scale * 10.0**-decades, low if low > 0.0 else 0.0)
    last = min(scale * 10.0**decades, high)
    if last <= first:  # the whole range lies beside the present value
        first, last = (low, high) if low > 0.0 else (1e-4 * high, high)
    step = 10.0 ** (1.0 / 6.0)
    count = max(_PLACES, math.ceil(math.log(last / first) / math.log(step)) + 1)
    upper = np.geomspace(first, last, count)
    if low < 0.0:
        lower = -upper[(-upper >= low)]
        return np.sort(np.concatenate([lower, upper]))
    return upper


def starts(free: Sequence[FreeParameter], cost: Cost, *, count: int, seed: int) -> list[Vector]:
    """Values from which to go downhill, the best first."""
    grids = [places(parameter) for parameter in free]
    here = np.array([_begin(p, grid) for p, grid in zip(free, grids, strict=True)])
    seen: dict[tuple[float, ...], float] = {}

    def looked_at(values: Vector) -> float:
        key = tuple(float(v) for v in values)
        if key not in seen:
            seen[key] = cost(values)
        return seen[key]

    looked_at(here)
    rounds = _ROUNDS if len(free) > 1 else 1
    for _, index in itertools.product(range(rounds), range(len(free))):
        varied = np.arange(len(free)) == index
        trials = [np.where(varied, value, here) for value in grids[index]]
        here = min([here, *trials], key=looked_at)
    if len(free) > 1:
        generator = np.random.default_rng(seed)
        count_drawn = _DRAWN * (len(free) - 1)
        columns = [generator.permutation(np.linspace(0, len(g) - 1, count_drawn)) for g in grids]
        for number in range(count_drawn):
            drawn = [g[round(c[number])] for g, c in zip(grids, columns, strict=True)]
            looked_at(np.array(drawn))
    chosen: list[Vector] = []
    for key in sorted(seen, key=lambda k: seen[k]):
        values = np.array(key)
        if not math.isfinite(seen[key]):
            break
        if all(_is_apart(values, other) for other in chosen):
            chosen.append(values)
        if len(chosen) == count:
            break
    return chosen


def _begin(parameter: FreeParameter, grid: Vector) -> float:
    now = parameter.present
    if now is not None and parameter.low < now < parameter.high:
        return now
    return float(grid[len(grid) // 2])


def _is_apart(one: Vector, other: Vector) -> bool:
    scale = np.maximum(np.abs(one), np.abs(other)) + 1e-300
    return bool(np.max(np.abs(one - other) / scale) > _APART)


def apart(solutions: Sequence[Vector]) -> list[Vector]:
    """Those that differ, but for a sign, from all before them."""
    chosen: list[Vector] = []
    for one in solutions:
        if all(
            np.max(np.abs(np.abs(one) - np.abs(other)) / (np.abs(one) + np.abs(other) + 1e-300))
            > _DIFFERENT
            for other in chosen
        ):
            chosen.append(one)
    return chosen


def middle_of(parameter: FreeParameter) -> float:
    now = parameter.present
    if now is not None and now != 0.0 and parameter.low < now < parameter.high:
        return now
    grid = places(parameter)
    return float(grid[len(grid) // 2])


def inner(parameter: FreeParameter) -> tuple[float, ...]:
    """Values a quarter of the places from both ends."""
    grid = places(parameter)
    return float(grid[len(grid) // 4]), float(grid[(3 * len(grid)) // 4])
