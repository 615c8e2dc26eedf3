"""Unit, focal length and field of view as headers of different origin word them.

Keys are compared without regard to case, with underscores as spaces:

- unit: ``data units``, ``radiance units``, ``units``, ``unit``, ``BUNIT`` (FITS)
- focal length: ``focal length mm``, ``focal length``, ``FOCALLEN`` (FITS),
  ``Exif:FocalLength``, ``nominalFocalLength`` (OpenEXR); mm unless µm, mm, cm or m follows
- horizontal field of view: ``fov x deg``, ``fov x``, ``fov``, ``field of view x``,
  ``field of view``, ``horizontal fov``, ``hfov``
- vertical field of view: ``fov y deg``, ``fov y``, ``field of view y``, ``vertical fov``, ``vfov``;
  degrees unless deg, mrad or rad follows; ``fov = {x, y}`` gives both

The same keys are found in a description of the form ``key = value``, one on a line or separated
by commas or semicolons. A zero means absent.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from core.errors import FileError

_UNIT_KEYS = ("data units", "radiance units", "units", "unit", "bunit")
_FOCAL_KEYS = (
    "focal length mm",
    "focal length",
    "focallen",
    "exif:focallength",
    "nominalfocallength",
)
_FOV_X_KEYS = (
    "fov x deg",
    "fov x",
    "field of view x",
    "horizontal fov",
    "hfov",
    "fov",
    "field of view",
)
_FOV_Y_KEYS = ("fov y deg", "fov y", "field of view y", "vertical fov", "vfov")
_BOTH_FOV_KEYS = ("fov", "field of view")

_LENGTHS_MM = {"": 1.0, "mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "µm": 1e-3, "μm": 1e-3}
_ANGLES_DEG = {
    "": 1.0,
    "deg": 1.0,
    "degree": 1.0,
    "degrees": 1.0,
    "°": 1.0,
    "rad": math.degrees(1.0),
    "mrad": math.degrees(1e-3),
}
_QUANTITY = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*([^\d\s]*)")

FieldValue = str | int | float | Sequence[str]


@dataclass(frozen=True)
class HeaderFields:
    """The fields every kind of header may offer; None where it does not."""

    unit: str | None = None
    focal_length_mm: float | None = None
    fov_x_deg: float | None = None
    fov_y_deg: float | None = None


def header_fields(
    fields: Mapping[str, FieldValue], *, description: str = "", where: str
) -> HeaderFields:
    """Read the common fields from a header's keys, then from its description.

    A key whose value is no length or no angle is refused; in the description, free text in which
    ``key = value`` pairs may stand, it is prose. `where` names the file in messages.
    """
    own = {_normal(key): _texts(value) for key, value in fields.items()}
    described = _in_description(description)
    return HeaderFields(
        unit=_unit(own) or _unit(described),
        focal_length_mm=_focal_length(own, where) or _leniently(_focal_length, described),
        fov_x_deg=_fov_x(own, where) or _leniently(_fov_x, described),
        fov_y_deg=_fov_y(own, where) or _leniently(_fov_y, described),
    )


_Texts = Mapping[str, Sequence[str]]


def _normal(key: str) -> str:
    return " ".join(key.lower().replace("_", " ").split())


def _texts(value: FieldValue) -> list[str]:
    if isinstance(value, str | int | float):
        return [str(value).strip()]
    return [str(item).strip() for item in value]


def _in_description(description: str) -> dict[str, list[str]]:
    pairs = re.findall(r"([^=:\n;,]+)[=:]([^\n;,]+)", description)
    return {_normal(key): [value.strip()] for key, value in pairs}


def _unit(fields: _Texts) -> str | None:
    for key in _UNIT_KEYS:
        text = ", ".join(fields.get(key, ()))
        if text and text.lower() not in ("unknown", "none"):
            return text
    return None


def _focal_length(fields: _Texts, where: str) -> float | None:
    return _first(fields, _FOCAL_KEYS, _LENGTHS_MM, where, 0)


def _fov_x(fields: _Texts, where: str) -> float | None:
    return _angle(_first(fields, _FOV_X_KEYS, _ANGLES_DEG, where, 0), where)


def _fov_y(fields: _Texts, where: str) -> float | None:
    own = _first(fields, _FOV_Y_KEYS, _ANGLES_DEG, where, 0)
    return _angle(own or _first(fields, _BOTH_FOV_KEYS, _ANGLES_DEG, where, 1), where)


def _leniently(read: Callable[[_Texts, str], float | None], described: _Texts) -> float | None:
    """Read from prose, where a pair that is no quantity is no fault of the file."""
    try:
        return read(described, "description")
    except FileError:
        return None


def _first(
    fields: _Texts, keys: Sequence[str], factors: Mapping[str, float], where: str, place: int
) -> float | None:
    for key in keys:
        values = fields.get(key, ())
        if len(values) > place and values[place]:
            return _quantity(values[place], factors, key, where) or None
    return None


def _quantity(text: str, factors: Mapping[str, float], key: str, where: str) -> float:
    match = _QUANTITY.fullmatch(text)
    factor = factors.get(match[2].lower()) if match else None
    value = float(match[1]) * factor if match and factor else math.nan
    if not math.isfinite(value) or value < 0:
        units = ", ".join(unit for unit in factors if unit.isascii() and unit)
        raise FileError(f"{where}: {key} = {text!r:.60} is not a positive number (with {units})")
    return value


def _angle(degrees: float | None, where: str) -> float | None:
    if degrees is not None and degrees >= 180:
        raise FileError(f"{where}: field of view {degrees:g} deg; allowed: above 0, below 180")
    return degrees
