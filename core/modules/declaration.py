"""Declaring a module once: panel, schema, help, ports, validation and keys are derived from it.

    class JitterMTF(Module, key="jitter_mtf", title="Jitter MTF", group="Motion"):
        '''Blur from random line-of-sight motion within one exposure (Gaussian).'''

        sigma_mrad: float = param(0.02, "rms motion per axis", low=0)

        def run(self, context: Context, magnitude: Magnitude) -> MtfOutputs: ...

Parameters are the annotated fields, input ports the arguments of `run`, output ports the fields of
the named tuple it returns, read-outs the methods marked with `readout`, warnings those marked with
`warning`. A parameter that several modules share, or without a default, is
`Annotated[type, Param(text, …)]`. The class attribute `panel` groups the parameters where they are
many, `preview` makes what is drawn on top of the panel where it is not the curve of an `mtf` or
`ptf` output, `formulas` are those of the module's page in the handbook.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import types
import typing
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from core.errors import close, shown, unit_of
from core.modules.parameters import (
    Caution,
    Formula,
    Kind,
    Param,
    Parameter,
    Section,
    coerce_all,
    complete,
    param,
)
from core.records import dataclass, replace

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe, Step

__all__ = [  # what a module is declared with; the rest is for those who read declarations
    "Caution", "Formula", "Module", "NodeContext", "Param", "Section", "param", "readout",
    "warning",
]  # fmt: skip

_ALONG_Y = {
    "Horizontal": "Vertical",
    "horizontal": "vertical",
    "width of the aperture": "height of the aperture",
    "across the track": "along the track",
}


@dataclass(frozen=True)
class NodeContext:
    """Where a module runs: its node's id, the network's seed and folder. Not a port.

    `noise` is the name its noise is drawn under, where that is not the id.
    """

    node: str
    seed: int = 0
    folder: Path = Path()
    noise: str = ""

    def step(self, function: Callable[..., Any], *inputs: Recipe, **parameters: Any) -> Step:
        """A step of this node: to it belongs an error that the function raises."""
        from core.evaluation.recipes import Step  # numpy: who only reads declarations has no use

        return Step.of(function, *inputs, node=self.node, **parameters)


@dataclass(frozen=True)
class Port:
    """A typed connection point; an input may accept several types."""

    name: str
    types: tuple[str, ...]
    required: bool = True


def ports_text(ports: Iterable[Port]) -> str:
    """Ports in words, each with what it takes or gives."""
    return ", ".join(
        f"{port.name} ({' or '.join(port.types)}{'' if port.required else ', optional'})"
        for port in ports
    )


@dataclass(frozen=True)
class Readout:
    """A figure shown on the panel; with `unit_of` in the unit of the picture at that input.

    `axis` is x or y where the method gives one for each.
    """

    name: str
    unit: str
    meaning: str
    needs: tuple[str, ...]
    method: str
    unit_of: str = ""
    axis: str = ""


@dataclass(frozen=True)
class Declaration:
    """All that is known of a module without running it.

    `warnings` are the names of the methods that warn, each with its meaning and what it needs.
    """

    key: str
    title: str
    group: str
    version: int
    summary: str
    text: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    parameters: tuple[Parameter, ...]
    sink: bool
    panel: tuple[Section, ...]
    readouts: tuple[Readout, ...] = ()
    warnings: tuple[tuple[str, str, tuple[str, ...]], ...] = ()
    replaces: tuple[str, ...] = ()
    formulas: tuple[Formula, ...] = ()
    without_formula: str = ""
    explained: str = ""

    @property
    def listed(self) -> str:
        """The title as a list of modules shows it, explained where the name alone is not clear."""
        return f"{self.title} ({self.explained})" if self.explained else self.title

    @property
    def path_names(self) -> tuple[str, ...]:
        """The parameters that name files."""
        return tuple(p.name for p in self.parameters if p.kind == "path")

    def parameter(self, name: str) -> Parameter | None:
        return next((p for p in self.parameters if p.name == name), None)

    def input(self, name: str) -> Port | None:
        return next((p for p in self.inputs if p.name == name), None)

    def output(self, name: str) -> Port | None:
        return next((p for p in self.outputs if p.name == name), None)


def readout(
    unit: str = "", *, name: str = "", unit_of: str = ""
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Mark a method as a read-out in `unit`; its docstring is its meaning.

    Its arguments are named after the input ports it needs, or `outputs` for what `run` returned.
    It returns a value, or the recipe of one. `name` is for a read-out named like a parameter,
    `unit_of` names the input of whose picture it has the unit. A method with an argument `axis`
    gives two, for x and y: its name and meaning are those for x.
    """

    def mark(method: Callable[..., Any]) -> Callable[..., Any]:
        vars(method).update(readout_unit=unit, readout_name=name, readout_unit_of=unit_of)
        return method

    return mark


def warning(
    method: Callable[..., Caution | Recipe | None],
) -> Callable[..., Caution | Recipe | None]:
    """Mark a method that warns; its docstring names what of.

    Its arguments are as those of a read-out, and `given`, the names of the parameters that the
    network sets. It returns a `Caution`, or None where all is well. It is called whenever the node
    is planned: it compares values, and computes no pixels. Where samples have to be looked at, it
    returns the recipe of a `Caution` or None, which is computed where the samples are.
    """
    method.is_warning = True  # type: ignore[attr-defined]
    return method


@typing.dataclass_transform(frozen_default=True, kw_only_default=True)
class Module:
    """Base of every module; a subclass with a `key` is one of the library.

    A class without a key only shares parameters between modules. `replaces` lists keys the module
    had in old files, `renamed` the old names of parameters and ports. A module that `draws_noise`
    does so from its node's name. One that `counts_bands` sums a picture's bands up as a detector
    does; others get their sum with a warning, or pass them on. Parameters that no section of
    `panel` names stand below them without a title. `preview`, a method given the planned node, the
    work and the `NodeContext`, makes a `Preview`, which is as high as `preview_lines` lines of
    text. A module without `formulas` states in `without_formula` why there is none. Lists of
    modules show what a title `explained` means behind it.
    """

    key: ClassVar[str] = ""
    title: ClassVar[str] = ""
    explained: ClassVar[str] = ""
    group: ClassVar[str] = ""
    version: ClassVar[int] = 1
    replaces: ClassVar[tuple[str, ...]] = ()
    renamed: ClassVar[Mapping[str, str]] = {}
    sink: ClassVar[bool] = False
    draws_noise: ClassVar[bool] = False
    counts_bands: ClassVar[bool] = False
    panel: ClassVar[tuple[Section, ...]] = ()
    preview: ClassVar[Callable[..., Any] | None] = None
    preview_lines: ClassVar[float] = 11.5
    formulas: ClassVar[tuple[Formula, ...]] = ()
    without_formula: ClassVar[str] = ""
    run: ClassVar[Callable[..., Any]]

    def __init_subclass__(
        cls,
        *,
        key: str = "",
        title: str = "",
        group: str = "",
        version: int = 1,
        replaces: tuple[str, ...] = (),
        sink: bool = False,
        explained: str = "",
    ) -> None:
        super().__init_subclass__()
        cls.key, cls.title, cls.explained, cls.group = key, title, explained, group
        cls.version, cls.replaces, cls.sink = version, replaces, sink
        dataclass(frozen=True, kw_only=True)(cls)

    @classmethod
    def build(cls, values: Mapping[str, object]) -> Module:
        """Construct from plain values as a network file has them."""
        return cls(**coerce_all(declaration(cls).parameters, values, cls.title))

    def check(self) -> None:
        """Refuse combinations of parameters that make no sense (`ParameterError`)."""

    def values(self) -> dict[str, Any]:
        return {p.name: getattr(self, p.name) for p in declaration(type(self)).parameters}


def declaration(module: type[Module]) -> Declaration:
    untyped: Any = module  # mypy finds a class of frozen dataclasses unhashable
    return _derive(untyped)


@cache
def _derive(module: Any) -> Declaration:
    text = inspect.cleandoc(module.__doc__ or "")
    parameters = _parameters(module)
    marked = _marked(module, "is_warning")
    warnings = {name: (name, meaning, needs) for name, _, meaning, needs in marked}
    try:
        panel = complete(module.panel, [parameter.name for parameter in parameters])
    except TypeError as error:
        raise TypeError(f"{module.__name__}: {error}") from error
    own = ("key", "title", "group", "version", "replaces", "sink", "explained")
    return Declaration(
        summary=text.split("\n\n")[0].replace("\n", " "),
        text=text,
        inputs=_inputs(module),
        outputs=_outputs(module),
        parameters=parameters,
        readouts=_readouts(module),
        warnings=tuple(warnings.values()),
        panel=panel,
        **{name: getattr(module, name) for name in (*own, "formulas", "without_formula")},
    )


def _parameters(module: type[Module]) -> tuple[Parameter, ...]:
    hints = typing.get_type_hints(module, include_extras=True)
    parameters = []
    for field in dataclasses.fields(module):  # type: ignore[arg-type]
        base, own = hints[field.name], field.metadata.get("param")
        if own is None and typing.get_origin(base) is not typing.Annotated:
            allowed = "param(default, text), or Annotated[type, Param(...)]"
            raise TypeError(f"{module.__name__}.{field.name} needs {allowed}")
        base, own = (base, own) if own is not None else typing.get_args(base)[:2]
        kind, choices, empty = _kind(base, own)
        parameters.append(
            Parameter(
                name=field.name,
                kind=kind,
                default=... if field.default is dataclasses.MISSING else field.default,
                choices=choices,
                empty=empty,
                param=own if own.unit else replace(own, unit=unit_of(field.name)),
            )
        )
    return tuple(parameters)


def _kind(base: Any, param: Param) -> tuple[Kind, tuple[Any, ...], bool]:
    empty = False
    if typing.get_origin(base) in (typing.Union, types.UnionType):
        members = [arg for arg in typing.get_args(base) if arg is not type(None)]
        empty, base = len(members) < len(typing.get_args(base)), members[0]
    if param.choices:
        return "choice", param.choices, empty
    if typing.get_origin(base) is typing.Literal:
        return "choice", typing.get_args(base), empty
    if typing.get_origin(base) is tuple:
        return "numbers", (), empty
    kinds: dict[Any, Kind] = {bool: "switch", int: "integer", float: "number", str: "text"}
    if base is Path:
        return "path", (), empty
    return kinds[base], (), empty


def _types(hint: Any) -> tuple[tuple[str, ...], bool]:
    members = (
        typing.get_args(hint)
        if typing.get_origin(hint) in (typing.Union, types.UnionType)
        else (hint,)
    )
    names = tuple(m.port_type for m in members if m is not type(None))
    return names, type(None) not in members


def _inputs(module: type[Module]) -> tuple[Port, ...]:
    hints = typing.get_type_hints(module.run)
    ports = []
    for name in list(inspect.signature(module.run).parameters)[1:]:
        if hints[name] is NodeContext:
            continue
        names, required = _types(hints[name])
        ports.append(Port(name, names, required))
    return tuple(ports)


def _outputs(module: type[Module]) -> tuple[Port, ...]:
    result = typing.get_type_hints(module.run).get("return")
    if result is None or result is type(None):
        return ()
    return tuple(
        Port(name, _types(hint)[0]) for name, hint in typing.get_type_hints(result).items()
    )


def _marked(module: type[Module], mark: str) -> Iterator[tuple[str, Any, str, tuple[str, ...]]]:
    """Name, method, meaning and needs of the methods with a mark, those of bases first."""
    for klass in reversed(module.__mro__):
        for name, method in vars(klass).items():
            if hasattr(method, mark):
                meaning = " ".join(inspect.cleandoc(method.__doc__ or "").split())
                yield name, method, meaning, tuple(inspect.signature(method).parameters)[1:]


def _readouts(module: type[Module]) -> tuple[Readout, ...]:
    readouts = {}
    for attribute, method, meaning, needs in _marked(module, "readout_unit"):
        name, unit = method.readout_name or attribute, method.readout_unit
        others = tuple(need for need in needs if need != "axis")
        known = (others, attribute, method.readout_unit_of)
        if others == needs:
            readouts[name] = Readout(name, unit, meaning, *known)
            continue
        readouts[name] = Readout(name, unit, meaning, *known, "x")
        of_y = re.sub(r"_x(?=_|$)", "_y", name)
        words = re.sub("|".join(_ALONG_Y), lambda match: _ALONG_Y[match[0]], meaning)
        readouts[of_y] = Readout(of_y, unit, words, *known, "y")
    return tuple(readouts.values())


# A library of modules, handed to the engine: keys to classes, old keys included.
#
# The key of a module that a package of its own brings begins with that package's name and a dot:
# ``acme_optics.flare``. So a network says by itself which package it needs.

Library = Mapping[str, type[Module]]


class PackagedLibrary(Mapping[str, type[Module]]):
    """Modules by key, each loaded when it is asked for, and packages of which some could not be.

    The keys stand in the order the library shows them. `faults` gives by package why not all of its
    modules are there, in one line.
    """

    def __init__(
        self, keys: Iterable[str], load: Callable[[str], type[Module]], faults: Mapping[str, str]
    ) -> None:
        self._modules: dict[str, type[Module] | None] = dict.fromkeys(keys)
        self._load = load
        self.faults = MappingProxyType(dict(faults))

    def __getitem__(self, key: str) -> type[Module]:
        module = self._modules[key]
        if module is None:
            module = self._modules[key] = self._load(key)
        return module

    def __contains__(self, key: object) -> bool:
        return key in self._modules

    def __iter__(self) -> Iterator[str]:
        return iter(self._modules)

    def __len__(self) -> int:
        return len(self._modules)


def package_of(key: str) -> str:
    """The package that a module's key names; empty for a module of ours."""
    package, _, local = key.rpartition(".")
    names = (*package.split("."), local)
    return package if package and all(name.isidentifier() for name in names) else ""


def local_key(key: str) -> str:
    """A module's key without the name of its package."""
    return key[len(package_of(key)) :].removeprefix(".")


def where_absent(key: str, library: Library) -> str:
    """Why the library has no such module, if its key names the package it would be of."""
    package = package_of(key)
    if not package:
        return ""
    fault = library.faults.get(package) if isinstance(library, PackagedLibrary) else None
    if fault is not None:
        return f"the module belongs to the package {package}, which is installed, but {fault}"
    if any(package_of(other) == package for other in library):
        return f"the package {package} is installed but has no such module"
    return f"the module belongs to the package {package}, which is not installed here"


def no_module(key: str, library: Library) -> str:
    absent = where_absent(key, library)
    return f"there is no module {shown(key)}{f': {absent}' if absent else close(key, library)}"
