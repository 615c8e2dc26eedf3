"""Scenes from arrays: numpy, or xarray with its units and coordinates."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError, ParameterError
from core.modules.declaration import declaration
from imagechain.parts.module_part import Part, file_values, simple
from imagechain.parts.plain_errors import plain_errors
from nodes.input_output.read_image import ReadImage
from nodes.input_output.source_file import HeldSamples

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
    array = samples if isinstance(samples, np.ndarray) else _as_array(samples)
    held = HeldSamples.of(array, "the array", centres, _numbers("widths_um", widths_um))
    params = file_values(declaration(ReadImage), values)
    plain = {name: value for name, value in params.items() if not isinstance(value, dict)}
    module = ReadImage.build(plain)
    assert isinstance(module, ReadImage)
    module.check()
    if len(plain) == len(params):
        module.of_samples(held, "scene")  # what it cannot be is refused here already
    return Part("read_image", params, held, "scene")


def _as_array(samples: Any) -> NDArray[Any]:
    try:
        return np.asarray(samples)
    except (TypeError, ValueError) as error:  # rows of unequal length, objects
        raise DataError(f"the array cannot be converted to numbers: {error}") from None


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
    """Interval of a coordinate that is an angle, mrad."""
    factor = _MRAD.get(str(coordinate.attrs.get("units", "")))
    if factor is None or len(coordinate) < 2:
        return None
    places = np.asarray(_numbers(name, coordinate.to_numpy()))
    steps = np.diff(places)
    mean = float((places[-1] - places[0]) / (len(places) - 1))
    if not mean or np.max(np.abs(steps - mean)) > _EVEN * abs(mean):
        raise DataError(f"the DataArray's coordinate {name} is not evenly spaced")
    return abs(mean) * factor
