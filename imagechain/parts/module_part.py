"""Modules with their values, not yet in a chain, and the functions that make them."""

import inspect
import textwrap
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from app.run.preset_files import shipped_presets
from core.errors import NetworkError, ParameterError, close, shown, thaw
from core.modules.declaration import Declaration, declaration, local_key
from core.modules.parameters import Parameter, plain
from core.network.file import read_network
from core.network.linked_values import expression as raw_expression
from core.network.macro import declared_node
from core.network.network import Network
from core.records import dataclass, field
from imagechain.parts.plain_errors import plain_errors
from nodes.input_output.source_file import HeldSamples
from nodes.library import standard_library


@dataclass(frozen=True)
class Expression:
    """A number that follows other parameters: ``ic.expression("init.f_number * 0.05")``.

    The expression may contain numbers, ``NODE.PARAMETER``, ``+ - * / ^ ( )``, ``pi`` and functions
    such as ``sqrt`` and ``min``. A number with a unit (``3 um``) is converted to the parameter's
    own unit.
    """

    text: str


@dataclass(frozen=True)
class Part:
    """A module with values for some of its parameters, to add to a chain.

    All other parameters keep their defaults. `samples` holds a scene from an array. `name` is the
    default name of the node; if it is empty, the module's key is used. `inside` holds the modules
    of a macro.
    """

    module: str
    params: Mapping[str, Any] = field(default_factory=dict)
    samples: HeldSamples | None = field(default=None, repr=False)
    name: str = ""
    inside: Network | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "params", MappingProxyType(dict(self.params)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Part, (self.module, dict(self.params), self.samples, self.name, self.inside)


def file_values(declared: Declaration, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values as in a network file, each checked against its parameter."""
    return {name: file_value(declared, name, value) for name, value in values.items()}


def file_value(declared: Declaration, name: str, value: Any, *, node: str | None = None) -> Any:
    """A value as in a network file, checked against its parameter; errors name the node."""
    parameter = known_parameter(declared, name, value, node=node)
    raw = simple(value)
    numeric = parameter.kind in ("number", "integer")
    if isinstance(raw, Expression):
        raw = raw_expression(raw.text)
    elif numeric and isinstance(raw, str) and raw.lstrip().startswith("="):
        raw = raw_expression(raw.lstrip()[1:].strip())
    if isinstance(raw, dict) and numeric:  # read, and evaluated, with the network
        return raw
    try:
        return plain(parameter.coerce(raw))
    except ParameterError as error:
        raise (error if node is None else error.at(node)) from None


def known_parameter(
    declared: Declaration, name: str, value: Any, *, node: str | None = None
) -> Parameter:
    """The parameter with the given name; raises `ParameterError` if there is none."""
    parameter = declared.parameter(name)
    if parameter is None:
        names = [candidate.name for candidate in declared.parameters]
        hint = close(name, names) or f"; its parameters: {', '.join(names) or 'none'}"
        allowed = f"{declared.title} has no such parameter{hint}"
        raise ParameterError(shown(name), value, allowed, node=node)
    return parameter


def simple(value: Any) -> Any:
    """Convert numpy numbers, arrays, tuples and paths to plain Python values."""
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Path):
        return value.as_posix()
    return thaw(value)


def shown_value(value: Any) -> str:
    """A parameter's value as a short text."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


# A function for every module, with its documented parameters as arguments.

_WIDTH = 96


def module_function(key: str) -> Callable[..., Part]:
    """The function that makes a module; raises `AttributeError` if the module is unknown."""
    library = standard_library()
    if key not in library:
        raise AttributeError(f"there is no module {key!r}{close(key, library)}")
    module = library[key]
    declared = declaration(module)
    kind = inspect.Parameter.KEYWORD_ONLY
    arguments = [
        inspect.Parameter(one.name, kind, default=default(one), annotation=annotation(one)[0])
        for one in declared.parameters
    ]

    def made(**values: Any) -> Part:
        params = file_values(declared, values)
        plain_values = {name: v for name, v in params.items() if not isinstance(v, dict)}
        if len(plain_values) == len(params):  # combinations with expressions: when it is planned
            module.build(plain_values).check()
        return Part(key, params)

    function: Any = plain_errors(made)
    function.__name__ = function.__qualname__ = local_key(key)
    function.__module__ = "imagechain.modules"
    function.__doc__ = documentation(declared)
    function.__signature__ = inspect.Signature(arguments, return_annotation=Part)
    function.__annotations__ = {one.name: one.annotation for one in arguments} | {"return": Part}
    del function.__wrapped__
    result: Callable[..., Part] = function
    return result


@plain_errors
def part(module: str, **values: Any) -> Part:
    """Create a module from its key and parameter values. Modules from plug-ins work too."""
    library = standard_library()
    if module not in library:
        raise NetworkError(f"there is no module {shown(module)}{close(module, library)}")
    return module_function(module)(**values)


def documentation(declared: Declaration) -> str:
    """The docstring: the module's description, parameters, ports and read-outs."""
    lines = [declared.text, ""]
    if declared.parameters:
        lines += ["Parameters", "----------"]
        for parameter in declared.parameters:
            lines.append(f"{parameter.name} : {annotation(parameter)[1]}")
            unit = f" [{parameter.param.unit}]" if parameter.param.unit else ""
            usual = "empty" if parameter.default is None else repr(default(parameter))
            text = f"{parameter.param.text}{unit}: {parameter.allowed()}; default {usual}"
            lines += textwrap.wrap(text, _WIDTH, initial_indent="    ", subsequent_indent="    ")
        lines.append("")
    lines += ["Notes", "-----", f"{declared.title}, in the group {declared.group}."]
    inputs = [f"{port.name}{'' if port.required else ' (optional)'}" for port in declared.inputs]
    outputs = [port.name for port in declared.outputs]
    for title, names in (("Inputs", inputs), ("Outputs", outputs)):
        if names:
            lines += textwrap.wrap(f"{title}: {', '.join(names)}.", _WIDTH)
    if declared.readouts:
        names = [f"{r.name}{f' ({r.unit})' if r.unit else ''}" for r in declared.readouts]
        lines += textwrap.wrap(f"Read-outs: {', '.join(names)}.", _WIDTH)
    return "\n".join(lines).strip()


def default(parameter: Parameter) -> Any:
    """The default of a parameter, as a Python value."""
    return () if parameter.default == () else plain(parameter.default)


_TYPES: dict[str, tuple[Any, str]] = {
    "number": (float | Expression, "float | Expression"),
    "integer": (int | Expression, "int | Expression"),
    "switch": (bool, "bool"),
    "text": (str, "str"),
    "path": (str, "str | PathLike[str]"),
    "numbers": (tuple[float, ...], "Sequence[float]"),
}


def annotation(parameter: Parameter) -> tuple[Any, str]:
    """The type of a parameter's argument, as an object and as text."""
    if parameter.kind == "choice":
        choices = ", ".join(map(repr, parameter.choices))
        kind, text = Literal[parameter.choices], f"Literal[{choices}]"
    else:
        kind, text = _TYPES[parameter.kind]
    return (kind | None, f"{text} | None") if parameter.empty else (kind, text)


def presets() -> dict[str, str]:
    """Titles of the shipped presets, by name."""
    return {one.path.stem: one.title for one in shipped_presets(standard_library())}


@plain_errors
def preset(name: str, **values: Any) -> Part:
    """Create a lens, detector, camera or light source, to add to a chain as one node.

    Parameters
    ----------
    name : str
        A name from `presets()`.
    **values
        Values of the parameters that the preset offers.
    """
    library = standard_library()
    places = {one.path.stem: one.path for one in shipped_presets(library)}
    if name not in places:
        hint = close(name, places) or f"; the presets are {', '.join(places)}"
        raise NetworkError(f"there is no preset {shown(name)}{hint}")
    (node,) = read_network(places[name], library=library).nodes.values()
    declared = declared_node(node, library)
    assert declared is not None
    own = {
        parameter.name: str(places[name].parent / node.params[parameter.name])
        for parameter in declared.parameters
        if parameter.kind == "path" and parameter.name in node.params
    }
    params = {**node.params, **own, **file_values(declared, values)}
    return Part(node.module, params, None, node.id, node.macro)
