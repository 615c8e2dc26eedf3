"""Scenes from arrays: numpy, or xarray with its units and coordinates."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from core.errors import DataError
from core.modules.declaration import declaration
from imagechain.common.plain_errors import plain_errors
from imagechain.parts.module_part import Part, file_values, simple
from nodes.input_output.held_samples import HeldSamples
from nodes.input_output.read_image import ReadImage

_MRAD = {"mrad": 1.0, "rad": 1e3, "urad": 1e-3, "µrad": 1e-3, "deg": math.pi / 0.18}
_MRAD |= {"degree": _MRAD["deg"], "degrees": _MRAD["deg"], "radian": 1e3, "radians": 1e3}
_EVEN = 1e-6  # of the interval, by which coordinates may lie off the grid


@plain_errors
def scene(
    samples: Any,
    *,
    fov_x_deg: float | None = None,
    fov_y_deg: float | None = None,
    unit: str | None = None,
    band_um: tuple[float, float] | None = None,
    scale: float = 1.0,
) -> Part:
    """A scene from an array, to be added to a chain; it is copied, and no file is written.

    Parameters
    ----------
    samples : array_like or xarray.DataArray
        (rows, columns), the first row on top; finite real numbers. Of a `DataArray` with the
        dimensions y and x, in any order, the unit is its attribute ``units``, the field of view
        follows from its coordinates where these have an angle's ``units``, or from its attributes
        ``interval_x_mrad`` and ``interval_y_mrad``, and the band is its attribute ``band_um``.
    fov_x_deg, fov_y_deg : float, optional
        Field of view across and along, degrees.
    unit : str, optional
        Unit of the samples times `scale`: W/m²/sr if not given, ``K``, ``DN``, …
    band_um : (float, float), optional
        Cut-on and cut-off wavelength, µm.
    scale : float
        Factor on the samples.

    Raises
    ------
    ImagechainError
        If the array is no picture, or a value is not allowed.
    """
    stated: dict[str, Any] = {}
    if hasattr(samples, "dims") and hasattr(samples, "coords"):
        samples, stated = _of_xarray(samples)
    given = {"fov_x_deg": fov_x_deg, "fov_y_deg": fov_y_deg, "unit": unit}
    if band_um is not None:
        given["cut_on_um"], given["cut_off_um"] = simple(band_um)
    values = stated | {name: value for name, value in given.items() if value is not None}
    if scale != 1.0:
        values["scale"] = scale
    array = samples if isinstance(samples, np.ndarray) else np.asarray(samples)
    held = HeldSamples.of(array)
    params = file_values(declaration(ReadImage), values)
    module = ReadImage.build({k: v for k, v in params.items() if not isinstance(v, dict)})
    module.check()
    return Part("read_image", params, held, "scene")


def _of_xarray(array: Any) -> tuple[Any, dict[str, Any]]:
    """Samples of a `DataArray`, and what it says of them."""
    dims = tuple(map(str, array.dims))
    if len(dims) == 2 and dims == ("x", "y"):
        array = array.transpose("y", "x")
    if len(dims) != 2:
        raise DataError(f"the DataArray has the dimensions {', '.join(dims)}: allowed are y and x")
    attributes = array.attrs
    values: dict[str, Any] = {}
    if "units" in attributes:
        values["unit"] = str(attributes["units"])
    if "band_um" in attributes:
        values["cut_on_um"], values["cut_off_um"] = map(float, attributes["band_um"])
    for axis, dim, length in zip("yx", array.dims, array.shape, strict=True):
        interval = attributes.get(f"interval_{axis}_mrad")
        if interval is None and dim in array.coords:
            interval = _interval(array.coords[dim], str(dim))
        if interval is not None:
            values[f"fov_{axis}_deg"] = float(interval) * length / 1000.0 / (math.pi / 180.0)
    return array.to_numpy(), values


def _interval(coordinate: Any, name: str) -> float | None:
    """Interval of a coordinate that is an angle, mrad."""
    factor = _MRAD.get(str(coordinate.attrs.get("units", "")))
    places = np.asarray(coordinate.to_numpy(), np.float64)
    if factor is None or len(places) < 2:
        return None
    steps = np.diff(places)
    mean = float((places[-1] - places[0]) / (len(places) - 1))
    if not mean or np.max(np.abs(steps - mean)) > _EVEN * abs(mean):
        raise DataError(f"the DataArray's coordinate {name} is not evenly spaced")
    return abs(mean) * factor
