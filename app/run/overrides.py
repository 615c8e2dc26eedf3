"""Parameters that a command names: changes of a network, and values that are varied."""

import contextlib
import json
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.run.option_values import Assignment, assignment
from app.run.shipped import Place
from app.run.terminal import with_unit
from core.errors import NetworkError, ParameterError, UsageError, close, in_line, placed, shown
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter, plain
from core.network.file import read_network
from core.network.linked_values import expression
from core.network.network import Network, passed_through, with_marks
from core.network.validation import check_network, plain_network
from core.records import dataclass, field, replace

# JSON takes neither a sign +, nor a number without digits before or after the point.
_NUMBER = re.compile(r"([+-]?)([0-9]*)(\.?)([0-9]*)([eE][+-]?[0-9]+)?", re.ASCII)


@dataclass(frozen=True)
class GivenNetwork:
    place: Place
    settings: tuple[Assignment, ...] = ()
    disabled: tuple[str, ...] = ()
    final: str | None = None
    # pictures in place of scenes, ``[NODE=]FILE``, and what is said of them, None where nothing is
    scenes: tuple[str, ...] = ()
    scene_details: Mapping[str, Any] = field(default_factory=dict)
    seed: int | None = None

    def opened(self, library: Library) -> tuple[Network, list[str]]:
        return self.changed(read_network(self.place.path, library=library), library)

    def changed(self, network: Network, library: Library) -> tuple[Network, list[str]]:
        """The network with its macros written out, changed and valid; lines on a new scene."""
        if not network.nodes:
            raise NetworkError(f"{shown(str(self.place.path))}: the network has no nodes")
        network, lines = self._with_scenes(plain_network(network, library=library), library)
        network = with_settings(network, self.settings, library=library)
        network = with_disabled(network, self.disabled, library=library)
        if self.final is not None:
            network = with_final(network, self.final, library=library)
        if self.seed is not None:
            network = network.with_seed(self.seed)
        check_network(network, library=library)
        return network, lines

    def _with_scenes(self, network: Network, library: Library) -> tuple[Network, list[str]]:
        given = {name: value for name, value in self.scene_details.items() if value is not None}
        if given and not self.scenes:
            raise UsageError(f"--{next(iter(given)).replace('_', '-')} needs --scene FILE")
        lines: list[str] = []
        for text in self.scenes:
            from app.run.own_scene import OwnScene, scene_nodes, with_own_scene
            from core.chain.engine import Engine
            from core.evaluation.recipes import Store

            node, _, file = text.partition("=")
            named = file and node in scene_nodes(network, library)
            details = {name.removeprefix("scene_"): value for name, value in given.items()}
            replaced = with_own_scene(
                network,
                OwnScene(Path(file if named else text), option="--scene-", **details),
                library=library,
                plan=Engine(library, Store(0)).plan(network, folder=self.place.folder),
                node=node if named else None,
            )
            lines += (in_line(f"{replaced.node}: {line}") for line in replaced.lines)
            network = replaced.network
        return network, lines


def with_settings(network: Network, settings: Iterable[Assignment], *, library: Library) -> Network:
    """The network with every ``--set`` carried out; of two for one parameter the last holds.

    A value is taken as JSON where it is JSON that fits the parameter, else as a number as people
    write it (``.5``, ``+3``), else as text. Behind a further ``=`` it is an expression that the
    parameter follows from then on. A file's name is relative to the current folder.
    """
    for outer in settings:
        setting = behind(outer, network)
        parameter = named_parameter("--set", setting, network, library=library)
        if parameter is None:  # the check of the whole network reports it
            continue
        value = from_here(plain(_fitting(parameter, setting)), parameter)
        network = network.with_parameter(setting.node, setting.name, value)
    return network


def with_disabled(network: Network, names: Iterable[str], *, library: Library) -> Network:
    """The network with nodes switched off, or all nodes of a macro: they pass on what comes in."""
    for name in names:
        inside = [node for node in network.nodes if node.startswith(f"{name}/")]
        if name not in network.nodes and not inside:
            known = near(name, network.nodes)
            raise UsageError(f"--disable {shown(name)}: there is no node of this name{known}")
        for node in [name] if name in network.nodes else inside:
            module = library.get(network.nodes[node].module)
            declared = None if module is None else declaration(module)
            needed = bool(network.followers.get(node))
            if declared is not None and needed and not passed_through(declared):
                raise UsageError(
                    f"--disable {shown(node)}: {declared.title} has no input to pass on; disable a "
                    "node with an input, such as a blur or a source of noise"
                )
            network = network.with_node(replace(network.nodes[node], disabled=True))
    return network


def with_final(network: Network, port: str, *, library: Library) -> Network:
    port = network.port_names.get(port, port)
    name, dot, output = port.rpartition(".")
    if not dot:
        raise UsageError(f"--final {shown(port)} is not allowed: must be NODE.PORT")
    node = network.nodes.get(name)
    if node is None:
        known = near(name, network.nodes)
        raise UsageError(f"--final {port:.120}: there is no node {shown(name)}{known}")
    module = library.get(node.module)
    if module is not None:
        outputs = declaration(module).outputs
        pictures = [candidate.name for candidate in outputs if "image" in candidate.types]
        if output not in pictures:
            known = close(output, pictures) or f"; its pictures: {', '.join(pictures) or 'none'}"
            raise UsageError(f"--final {port:.120}: {name} has no picture {shown(output)}{known}")
    return with_marks(network, (), {**network.extra, "final": port})


def from_here(value: Any, parameter: Parameter, folder: Path | None = None) -> Any:
    """A file name with all its folders, from the current folder or the one given."""
    if parameter.kind != "path" or not isinstance(value, str) or not value:
        return value
    return (folder or Path()).joinpath(value).absolute().as_posix()


def behind(setting: Assignment, network: Network) -> Assignment:
    """The setting of the inner parameter that a macro's stands for; else the same setting."""
    node, name = network.parameter_behind(setting.node, setting.name)
    return setting if node == setting.node else replace(setting, node=node, name=name)


def named_parameter(
    option: str, setting: Assignment, network: Network, *, library: Library
) -> Parameter | None:
    """The parameter that an option names; None where the node's module is unknown."""
    node = network.nodes.get(setting.node)
    if node is None:
        by_macro = [name.rpartition(".") for name in network.parameter_names]
        own = [name for macro, _, name in by_macro if macro == setting.node]
        if own:
            known = near(setting.name, own)
            raise UsageError(
                f"{option} {setting.port}: the macro has no such parameter on its panel{known}"
            )
        nodes = dict.fromkeys([*network.nodes, *(macro for macro, _, _ in by_macro)])
        known = near(setting.node, nodes)
        raise UsageError(f"{option} {setting.port}: there is no node {shown(setting.node)}{known}")
    module = library.get(node.module)
    if module is None:
        return None
    declared = declaration(module)
    parameter = declared.parameter(setting.name)
    if parameter is None:
        names = [candidate.name for candidate in declared.parameters]
        known = near(setting.name, names)
        raise UsageError(
            f"{option} {setting.port}: {declared.title} has no parameter "
            f"{shown(setting.name)}{known}"
        )
    return parameter


def first_taken(text: str, take: Callable[[Any], Any]) -> Any:
    """What a text means: JSON or a number if `take` does not refuse that, else itself."""
    values: list[Any] = [text]
    with contextlib.suppress(ValueError, RecursionError):  # no JSON, so a text
        values.insert(0, _read(text))
    refusals = []
    for value in values:
        try:
            return take(value)
        except ParameterError as error:
            refusals.append(error)
    raise refusals[0]


def _fitting(parameter: Parameter, setting: Assignment) -> Any:
    text = setting.text.strip()
    if text.startswith("=") and parameter.kind in ("number", "integer"):
        return expression(text[1:].strip())
    with placed(setting.node):
        return first_taken(setting.text, parameter.coerce)


def _read(text: str) -> Any:
    number = _NUMBER.fullmatch(text)
    if number and (number[2] or number[4]):
        sign, whole, point, rest, power = (part or "" for part in number.groups())
        fraction = f".{rest or '0'}" if point else ""
        text = f"{'-' if sign == '-' else ''}{whole.lstrip('0') or '0'}{fraction}{power}"
    return json.loads(text)


def near(name: str, known: Iterable[str]) -> str:
    """The end of an error: the name that may be meant, else all there are."""
    names = list(known)
    return close(name, names) or f"; allowed: {', '.join(names) or 'none'}"


OPTION = "--vary"
FORM = "NODE.PARAM=FROM:TO:COUNT, FROM:TO:COUNT:log, or a list a,b,c"
_DRAWN = "NODE.PARAM=FROM:TO, FROM:TO:log, or a list a,b,c"
MOST = 1000
_MOST_VARIED = 2
_DECIMAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?", re.ASCII)
_COUNT = re.compile(r"[0-9]{1,9}", re.ASCII)


@dataclass(frozen=True)
class Variation:
    """A parameter and the values it takes; `log` if they are equal factors apart.

    `given` is its name as it was given, which may be that of a macro's parameter. Of a `span`,
    values are drawn later. `names` has how values that are files are shown.
    """

    node: str
    parameter: Parameter
    values: tuple[Any, ...] = ()
    log: bool = False
    given: str = ""
    span: tuple[float, float] | None = None
    names: Mapping[Any, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        return self.given or f"{self.node}.{self.parameter.name}"

    @property
    def unit(self) -> str:
        return self.parameter.param.unit

    @property
    def title(self) -> str:
        return with_unit(self.text, self.unit)

    @property
    def is_files(self) -> bool:
        return bool(self.names)

    @property
    def is_numeric(self) -> bool:
        return not self.is_files and all(is_number(value) for value in self.values)

    def shown(self, value: Any) -> Any:
        return self.names.get(value, value)

    def drawn(self, shares: Sequence[float]) -> list[Any]:
        """The values at shares of the range, from 0 to below 1."""
        if self.span is None:
            return [self.values[int(share * len(self.values))] for share in shares]
        low, high = self.span
        if self.parameter.kind == "integer":
            first, count = int(low), int(high) - int(low) + 1
            return [first + int(share * count) for share in shares]
        if self.log:
            return [float(low * (high / low) ** share) for share in shares]
        return [float(low + (high - low) * share) for share in shares]


def is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def spaced(
    low: float, high: float, count: int, *, log: bool = False, whole: bool = False
) -> tuple[float | int, ...]:
    """So many values from one to the other: equal steps, or factors; each whole one once."""
    make = np.geomspace if log else np.linspace
    values = [float(f"{value:.12g}") for value in make(low, high, count)]
    values[0], values[-1] = low, high
    if whole:
        return tuple(dict.fromkeys(round(value) for value in values))
    return tuple(values)


def variation(
    text: str, network: Network, *, library: Library, most: int = MOST, drawn: bool = False
) -> Variation:
    """The values of ``--vary``, whose range is not checked here; or a range to be `drawn` from."""
    setting = behind(assignment(OPTION, text, _DRAWN if drawn else FORM), network)
    parameter = one_value(OPTION, setting, network, library)
    if parameter.kind in ("number", "integer") and ":" in setting.text:
        return _range(setting, parameter, most, drawn=drawn)
    parts = setting.text.split(",")
    if len(parts) > most:
        raise UsageError(
            f"{OPTION} {setting.port}: {len(parts)} values; at most {most} are allowed"
        )
    values = tuple(dict.fromkeys(_value(part.strip(), parameter, setting) for part in parts))
    return Variation(setting.node, parameter, values)


def variations(texts: Sequence[str], network: Network, library: Library) -> tuple[Variation, ...]:
    """The axes of a trade-off: what moves along the curves, which is given first, comes last."""
    if not 1 <= len(texts) <= _MOST_VARIED:
        raise UsageError(
            f"{OPTION} is given {len(texts)} times: give it once, or twice for a family of curves"
        )
    axes = [variation(text, network, library=library) for text in texts]
    last, counts = axes[-1], [len(axis.values) for axis in axes]
    if len({axis.text for axis in axes}) < len(axes):
        raise UsageError(f"{OPTION} {last.text} is given twice: vary another parameter")
    if math.prod(counts) > MOST:
        product = " × ".join(map(str, counts))
        raise UsageError(f"{OPTION} {last.text}: {product} values; at most {MOST} are allowed")
    return tuple(axes[::-1])


def one_value(option: str, setting: Assignment, network: Network, library: Library) -> Parameter:
    parameter = named_parameter(option, setting, network, library=library)
    if parameter is None or parameter.kind == "numbers":
        raise UsageError(f"{option} {setting.port}: a list of numbers cannot be varied")
    return parameter


def _range(setting: Assignment, parameter: Parameter, most: int, *, drawn: bool) -> Variation:
    said = f"{OPTION} {setting.port}={setting.text:.80}"
    parts = setting.text.split(":")
    if log := parts[-1] == "log":
        del parts[-1]
    if len(parts) != (2 if drawn else 3) or not all(map(_DECIMAL.fullmatch, parts[:2])):
        how = f"for random points, write {_DRAWN}" if drawn else f"write {FORM}"
        raise UsageError(f"{said}: {how}")
    low, high = float(parts[0]), float(parts[1])
    whole = parameter.kind == "integer"
    if not np.isfinite([low, high]).all() or low == high or (drawn and low > high):
        raise UsageError(
            f"{said}: FROM and TO must be different numbers{', with FROM below TO' * drawn}"
        )
    if log and (low <= 0 or high <= 0):
        raise UsageError(f"{said}: log needs FROM and TO above 0")
    if drawn:
        if whole and not (low.is_integer() and high.is_integer()):
            raise UsageError(f"{said}: FROM and TO must be whole numbers")
        span = (int(low), int(high)) if whole else (low, high)
        return Variation(setting.node, parameter, (), log, span=span)
    if not _COUNT.fullmatch(parts[2]) or not 2 <= int(parts[2]) <= most:
        raise UsageError(
            f"{OPTION} {setting.port}: COUNT = {parts[2]:.20} is not allowed: must be 2 to {most}"
        )
    values = spaced(low, high, int(parts[2]), log=log, whole=whole)
    return Variation(setting.node, parameter, values, log)


def _value(text: str, parameter: Parameter, setting: Assignment) -> Any:
    def taken(reading: Any) -> Any:
        try:
            coerced = parameter.coerce(reading)
        except ParameterError:
            numeric = parameter.kind in ("number", "integer") and is_number(reading)
            if numeric and np.isfinite(float(reading)):
                return reading
            raise
        return reading if is_number(reading) and coerced is None else plain(coerced)

    with placed(setting.node):
        return from_here(first_taken(text, taken), parameter)


def taken_value(parameter: Parameter, value: Any) -> Any:
    """A value as a network file has it, once the parameter takes it, and not as none."""
    coerced = parameter.coerce(value)
    if coerced is None and value is not None:
        why = "this value leaves the parameter empty, as null does"
        raise ParameterError(parameter.name, value, why)
    return plain(coerced)
