"""Units that a number may be written in, by what they measure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

from core.names import close

Factor = Fraction | float

_TEN = Fraction(10)
_DEGREE = math.pi / 180.0

# By what is measured: each unit's symbol and how many of the first unit it is. A symbol stands in
# one row alone. A unit that no row has is converted to no other.
_KINDS: Mapping[str, Mapping[str, Factor]] = MappingProxyType(
    {
        "length": {
            "m": _TEN**0,
            "nm": _TEN**-9,
            "µm": _TEN**-6,
            "um": _TEN**-6,
            "mm": _TEN**-3,
            "cm": _TEN**-2,
            "km": _TEN**3,
        },
        "time": {
            "s": _TEN**0,
            "ns": _TEN**-9,
            "µs": _TEN**-6,
            "us": _TEN**-6,
            "ms": _TEN**-3,
        },
        "frequency": {"Hz": _TEN**0, "kHz": _TEN**3, "MHz": _TEN**6, "GHz": _TEN**9},
        "angle": {
            "rad": _TEN**0,
            "nrad": _TEN**-9,
            "µrad": _TEN**-6,
            "urad": _TEN**-6,
            "mrad": _TEN**-3,
            "deg": _DEGREE,
            "°": _DEGREE,
            "arcmin": _DEGREE / 60.0,
            "arcsec": _DEGREE / 3600.0,
        },
        "angular rate": {
            "rad/s": _TEN**0,
            "µrad/s": _TEN**-6,
            "urad/s": _TEN**-6,
            "mrad/s": _TEN**-3,
            "deg/s": _DEGREE,
            "°/s": _DEGREE,
        },
        "speed": {
            "m/s": _TEN**0,
            "mm/s": _TEN**-3,
            "km/s": _TEN**3,
            "km/h": Fraction(1000, 3600),
        },
        "angular frequency": {
            "cyc/mrad": _TEN**0,
            "cyc/rad": _TEN**-3,
            "cyc/deg": 1.0 / (_DEGREE * 1000.0),
        },
        "temperature": {"K": _TEN**0, "mK": _TEN**-3},
        "spectral radiance": {
            "W/m²/sr/µm": _TEN**0,
            "W/m²/sr/nm": _TEN**3,
            "W/cm²/sr/µm": _TEN**4,
        },
        "spectral irradiance": {"W/m²/µm": _TEN**0, "W/m²/nm": _TEN**3},
        "number of electrons": {"e-": _TEN**0, "ke-": _TEN**3, "Me-": _TEN**6},
        "current of electrons": {"e-/s": _TEN**0, "ke-/s": _TEN**3},
        "gain": {"e-/DN": _TEN**0},
        "digital number": {"DN": _TEN**0},
        "extinction": {"1/km": _TEN**0, "/km": _TEN**0, "1/m": _TEN**3, "/m": _TEN**3},
        "radiance": {
            "W/m²/sr": _TEN**0,
            "W/m2/sr": _TEN**0,
            "W/m^2/sr": _TEN**0,
            "W/cm²/sr": _TEN**4,
            "W/cm2/sr": _TEN**4,
            "mW/cm²/sr": _TEN**1,
            "mW/cm2/sr": _TEN**1,
            "µW/cm²/sr": _TEN**-2,
            "uW/cm2/sr": _TEN**-2,
        },
        "luminance": {"cd/m²": _TEN**0, "cd/m2": _TEN**0, "cd/m^2": _TEN**0},
        "detectivity": {"cm √Hz/W": _TEN**0, "cm Hz^0.5/W": _TEN**0, "Jones": _TEN**0},
        "turbulence": {"m^(-2/3)": _TEN**0},
        "share": {"": _TEN**0, "%": _TEN**-2},
        "count of samples": {"px": _TEN**0, "samples": _TEN**0, "pixels": _TEN**0},
        "resolution of numbers": {"bit": _TEN**0, "bits": _TEN**0},
        "frequency of the samples": {"Nyquist": _TEN**0},
        "frequency in the frame": {"cycles per frame": _TEN**0},
        "wavefront": {"waves": _TEN**0},
        "wavefront error": {"waves rms": _TEN**0},
    }
)


def canonical(unit: str) -> str:
    """The unit with its micro sign as declarations write it: Unicode has two."""
    return unit.replace("\N{GREEK SMALL LETTER MU}", "µ")


def symbols() -> tuple[str, ...]:
    """Every symbol that can be written behind a number, longest first."""
    every = {symbol for row in _KINDS.values() for symbol in row if symbol}
    return tuple(sorted(every, key=len, reverse=True))


def kind_of(unit: str) -> str:
    """What a unit measures; empty for one that is converted to no other."""
    return next((kind for kind, row in _KINDS.items() if canonical(unit) in row), "")


def fitting(unit: str) -> tuple[str, ...]:
    """The units that convert to `unit`, itself included."""
    row = _KINDS.get(kind_of(unit), {})
    return tuple(symbol for symbol in row if symbol) or ((unit,) if unit else ())


def converted(number: Fraction | float, unit: str, wanted: str) -> Fraction | float | None:
    """The number in another unit; None where the units measure other things.

    By fractions where the units allow: 600 µrad are 0.6 mrad, not the double beside it.
    """
    unit, wanted = canonical(unit), canonical(wanted)
    if unit == wanted:
        return number
    row = _KINDS.get(kind_of(unit), {})
    if wanted not in row:
        return None
    have, want = row[unit], row[wanted]
    if isinstance(have, Fraction) and isinstance(want, Fraction):
        ratio = have / want
        return number * ratio if isinstance(number, Fraction) else number * float(ratio)
    return float(number) * (float(have) / float(want))


def similar(unit: str) -> str:
    """A suggestion for a unit that there is not, to end an error with."""
    folded = {symbol.casefold(): symbol for symbol in symbols()}
    if unit.casefold() in folded:
        return f"; did you mean {folded[unit.casefold()]}?"
    return close(unit, symbols())
