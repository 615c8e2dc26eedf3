"""Parts of a chain: modules with their values, the functions that make them, scenes from arrays."""

import inspect
import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np

from app.run.preset_files import shipped_presets
from app.run.terminal import number_text
from core.errors import DataError, NetworkError, ParameterError, close, placed, shown, thaw
from core.modules.declaration import Declaration, declaration, local_key
from core.modules.parameters import Parameter, plain
from core.network import file, macro
from core.network.linked_values import expression as raw_expression
from core.network.network import Network
from core.records import dataclass, field
from imagechain.parts.plain_errors import plain_errors
from nodes.input_output import read_image, source_file
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
    samples: source_file.HeldSamples | None = field(default=None, repr=False)
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
    with placed(node):
        return plain(parameter.coerce(raw))


def known_parameter(
    declared: Declaration, name: str, value: Any, *, node: str | None = None
) -> Parameter:
    """The parameter with the given name; raises `ParameterError` if there is none."""
    parameter = declared.parameter(name)
    if parameter is None:
        names = [candidate.name for candidate in declared.parameters]
        hint = close(name, names) or f"; its parameters: {', '.join(names) or 'none'}"
        allowed = f"{declared.title} has no such parameter{hint}"
        raise ParameterError(shown(name), value, allowed, node=node, clause=True)
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
    return str(value).lower() if isinstance(value, bool) else number_text(value)


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
    (node,) = file.read_network(places[name], library=library).nodes.values()
    declared = macro.declared_node(node, library)
    assert declared is not None
    own = {
        path: str(places[name].parent / node.params[path])
        for path in declared.path_names
        if path in node.params
    }
    params = {**node.params, **own, **file_values(declared, values)}
    return Part(node.module, params, None, node.id, node.macro)


_MRAD = {"mrad": 1.0, "rad": 1e3, "urad": 1e-3, "µrad": 1e-3, "deg": math.pi / 0.18}
_MRAD |= {"degree": _MRAD["deg"], "degrees": _MRAD["deg"], "radian": 1e3, "radians": 1e3}
_UM = {"um": 1.0, "µm": 1.0, "micrometer": 1.0, "micrometers": 1.0, "nm": 1e-3, "m": 1e6}
_UM |= {"nanometer": 1e-3, "nanometers": 1e-3, "micron": 1.0, "microns": 1.0}
_SPECTRAL = ("wavelength", "wavelengths", "wavelength_um", "band", "bands")
_EVEN = 1e-6  # of the interval, by which coordinates may lie off the grid


@plain_errors
def scene(
    samples: Any,
    *,
    fov_x_deg: float | None = None,
    fov_y_deg: float | None = None,
    unit: str | None = None,
    band_um: tuple[float, float] | None = None,
    wavelengths_um: Sequence[float] | None = None,
    widths_um: Sequence[float] | None = None,
    scale: float = 1.0,
) -> Part:
    """Make a scene from an array, to add to a chain; the array is copied, and no file is written.

    Parameters
    ----------
    samples : array_like or xarray.DataArray
        (rows, columns), the first row at the top, or (bands, rows, columns); finite real numbers. A
        `DataArray` has the dimensions y and x, and wavelength if it has bands, in any order. The
        unit is the attribute ``units``, and the band is the attribute ``band_um``. The field of
        view follows from the attributes ``interval_x_mrad`` and ``interval_y_mrad``, or from
        coordinates whose ``units`` are an angle.
    fov_x_deg, fov_y_deg : float, optional
        Horizontal and vertical field of view, degrees.
    unit : str, optional
        Unit of the samples times `scale`, for example ``K``; by default W/m²/sr, or W/m²/sr/µm for
        a scene with bands.
    band_um : (float, float), optional
        Cut-on and cut-off wavelength, µm; bands outside this range are ignored.
    wavelengths_um : sequence of float, optional
        Centre wavelength of every band, µm.
    widths_um : sequence of float, optional
        Width of every band, µm; by default each band extends half-way to its neighbours.
    scale : float
        Factor that multiplies the samples.
    """
    stated: dict[str, Any] = {}
    if hasattr(samples, "dims") and hasattr(samples, "coords"):
        samples, stated = _of_xarray(samples)
    given: dict[str, Any] = {"fov_x_deg": fov_x_deg, "fov_y_deg": fov_y_deg, "unit": unit}
    if band_um is not None:
        given["cut_on_um"], given["cut_off_um"] = _pair(simple(band_um))
    if wavelengths_um is not None:
        stated["wavelengths_um"] = wavelengths_um
    centres = _numbers("wavelengths_um", stated.pop("wavelengths_um", None))
    values = stated | {name: value for name, value in given.items() if value is not None}
    if scale != 1.0:
        values["scale"] = scale
    if centres is not None:
        values["bands"] = "all"
    try:
        array = samples if isinstance(samples, np.ndarray) else np.asarray(samples)
    except (TypeError, ValueError) as error:  # rows of unequal length, objects
        raise DataError(f"the array cannot be converted to numbers: {error}") from None
    held = source_file.HeldSamples.of(array, "the array", centres, _numbers("widths_um", widths_um))
    params = file_values(declaration(read_image.ReadImage), values)
    plain = {name: value for name, value in params.items() if not isinstance(value, dict)}
    module = read_image.ReadImage.build(plain)
    assert isinstance(module, read_image.ReadImage)
    module.check()
    if len(plain) == len(params):
        module.of_samples(held, "scene")  # what it cannot be is refused here already
    return Part("read_image", params, held, "scene")


def _numbers(name: str, values: Any) -> tuple[float, ...] | None:
    if values is None:
        return None
    try:
        return tuple(map(float, np.atleast_1d(np.asarray(values, np.float64))))
    except (TypeError, ValueError):
        raise ParameterError(name, values, "numbers") from None


def _pair(band: Any) -> tuple[Any, Any]:
    if not isinstance(band, list | tuple) or len(band) != 2:
        raise ParameterError(
            "band_um", band, "two numbers, the cut-on and cut-off wavelength in µm"
        )
    return band[0], band[1]


def _of_xarray(array: Any) -> tuple[Any, dict[str, Any]]:
    dims = tuple(map(str, array.dims))
    spectral = [dim for dim in dims if dim in _SPECTRAL] if len(dims) == 3 else []
    across = [dim for dim in dims if dim not in spectral]
    if len(across) != 2 or len(spectral) > 1:
        words = f"dimensions of the DataArray: {', '.join(dims) or 'none'}"
        raise DataError(f"{words}; allowed: y and x, or wavelength, y and x")
    if across == ["x", "y"]:
        across = ["y", "x"]
    array = array.transpose(*spectral, *across)
    attributes = array.attrs
    values: dict[str, Any] = {}
    if "units" in attributes:
        values["unit"] = str(attributes["units"])
    if "band_um" in attributes and not spectral:
        values["cut_on_um"], values["cut_off_um"] = _pair(simple(attributes["band_um"]))
    for axis, dim, length in zip("yx", across, array.shape[-2:], strict=True):
        interval = attributes.get(f"interval_{axis}_mrad")
        if interval is None and dim in array.coords:
            interval = _interval(array.coords[dim], dim)
        if interval is not None:
            (interval,) = _numbers(f"interval_{axis}_mrad", interval) or ()
            values[f"fov_{axis}_deg"] = interval * length / 1000.0 / (math.pi / 180.0)
    for dim in spectral:
        values["wavelengths_um"] = _wavelengths(array, dim)
    return array.to_numpy(), values


def _wavelengths(array: Any, dim: str) -> Any:
    """Wavelengths of the bands, µm: of the dimension's coordinate, or of another along it."""
    for name in dict.fromkeys((dim, *_SPECTRAL)):
        if name in array.coords and tuple(array.coords[name].dims) == (dim,):
            coordinate = array.coords[name]
            unit = str(coordinate.attrs.get("units", "um" if name == "wavelength_um" else ""))
            if unit in _UM:
                return np.asarray(coordinate.to_numpy(), np.float64) * _UM[unit]
    raise DataError(
        f"the dimension {dim} of the DataArray has no wavelengths. Give it a coordinate with the "
        "units µm or nm, or give wavelengths_um"
    )


def _interval(coordinate: Any, name: str) -> float | None:
    factor = _MRAD.get(str(coordinate.attrs.get("units", "")))
    if factor is None or len(coordinate) < 2:
        return None
    places = np.asarray(_numbers(name, coordinate.to_numpy()))
    steps = np.diff(places)
    mean = float((places[-1] - places[0]) / (len(places) - 1))
    if not mean or np.max(np.abs(steps - mean)) > _EVEN * abs(mean):
        raise DataError(f"the DataArray's coordinate {name} is not evenly spaced")
    return abs(mean) * factor
