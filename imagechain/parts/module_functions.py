"""A function for every module, with its documented parameters as arguments."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable
from typing import Any, Literal

from app.run.preset_files import shipped_presets
from core.errors import NetworkError
from core.modules.declaration import Declaration, declaration, local_key, package_of
from core.modules.parameters import Parameter, plain
from core.names import close, shown
from core.network.file import read_network
from core.network.macro import declared_node
from imagechain.parts.module_part import Expression, Part, file_values
from imagechain.parts.plain_errors import plain_errors
from nodes.library import standard_library

_WIDTH = 96


def module_names() -> list[str]:
    """Keys of the built-in modules, and names of the packages that add others."""
    return sorted({package_of(key) or key for key in standard_library()})


def package_names() -> frozenset[str]:
    """Names of the installed packages that add modules."""
    return frozenset(filter(None, map(package_of, standard_library())))


class PackageModules:
    """The modules of an installed package, by their names."""

    def __init__(self, package: str) -> None:
        self._package = package

    def __getattr__(self, name: str) -> Callable[..., Part]:
        function = module_function(f"{self._package}.{name}")
        vars(self)[name] = function
        return function

    def __dir__(self) -> list[str]:
        names = (key for key in standard_library() if package_of(key) == self._package)
        return sorted(map(local_key, names))


def module_function(key: str) -> Callable[..., Part]:
    """The function that makes a module; an `AttributeError` if there is no such module."""
    library = standard_library()
    if key not in library:
        raise AttributeError(f"there is no module {key!r}{close(key, library)}")
    module = library[key]
    declared = declaration(module)
    signature = _signature(declared)

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
    function.__signature__ = signature
    function.__annotations__ = {
        **{p.name: p.annotation for p in signature.parameters.values()},
        "return": Part,
    }
    del function.__wrapped__
    result: Callable[..., Part] = function
    return result


@plain_errors
def part(module: str, **values: Any) -> Part:
    """Make a module by its key, also one from a plug-in, with values; see ``ic.modules``."""
    library = standard_library()
    if module not in library:
        raise NetworkError(f"there is no module {shown(module)}{close(module, library)}")
    return module_function(module)(**values)


def documentation(declared: Declaration) -> str:
    """The docstring: what the module does, its parameters, ports and read-outs."""
    lines = [declared.text, ""]
    if declared.parameters:
        lines += ["Parameters", "----------"]
        for parameter in declared.parameters:
            lines.append(f"{parameter.name} : {annotation_text(parameter)}")
            lines += textwrap.wrap(
                description(parameter), _WIDTH, initial_indent="    ", subsequent_indent="    "
            )
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


def description(parameter: Parameter) -> str:
    """A parameter in one line: meaning, unit, allowed values, default."""
    text = parameter.param.text
    unit = f" [{parameter.param.unit}]" if parameter.param.unit else ""
    usual = "empty" if parameter.default is None else repr(default(parameter))
    return f"{text}{unit}: {parameter.allowed()}; default {usual}"


def default(parameter: Parameter) -> Any:
    """The default as a Python value."""
    return () if parameter.default == () else plain(parameter.default)


def annotation(parameter: Parameter) -> Any:
    """The type of an argument."""
    kinds: dict[str, Any] = {
        "number": float | Expression,
        "integer": int | Expression,
        "switch": bool,
        "text": str,
        "path": str,
        "numbers": tuple[float, ...],
    }
    is_choice = parameter.kind == "choice"
    base = Literal[parameter.choices] if is_choice else kinds[parameter.kind]
    return base | None if parameter.empty else base


def annotation_text(parameter: Parameter) -> str:
    """The type of an argument as text."""
    kinds = {
        "number": "float | Expression",
        "integer": "int | Expression",
        "switch": "bool",
        "text": "str",
        "path": "str | PathLike[str]",
        "numbers": "Sequence[float]",
    }
    if parameter.kind == "choice":
        base = f"Literal[{', '.join(map(repr, parameter.choices))}]"
    else:
        base = kinds[parameter.kind]
    return f"{base} | None" if parameter.empty else base


def _signature(declared: Declaration) -> inspect.Signature:
    return inspect.Signature(
        [
            inspect.Parameter(
                parameter.name,
                inspect.Parameter.KEYWORD_ONLY,
                default=default(parameter),
                annotation=annotation(parameter),
            )
            for parameter in declared.parameters
        ],
        return_annotation=Part,
    )


def presets() -> dict[str, str]:
    """Titles of the shipped presets, by name."""
    return {one.path.stem: one.title for one in shipped_presets(standard_library())}


@plain_errors
def preset(name: str, **values: Any) -> Part:
    """Make a lens, a detector, a camera or light, to add to a chain as one node.

    Parameters
    ----------
    name : str
        One of `presets()`.
    **values
        Values of the parameters that the preset offers.
    """
    library = standard_library()
    places = {one.path.stem: one.path for one in shipped_presets(library)}
    if name not in places:
        hint = close(name, places) or f"; there are {', '.join(places)}"
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
