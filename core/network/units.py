"""Units that a number may be written in, by what they measure."""

import math
from collections.abc import Mapping
from fractions import Fraction

from core.names import close

Factor = Fraction | float

_DEGREE = math.pi / 180.0

# By what is measured: each unit's symbol, and the power of ten, or the factor, that makes it the
# first unit of its row. A symbol stands in one row alone. A unit that no row has is converted to no
# other.
_ROWS: Mapping[str, Mapping[str, int | Factor]] = {
    "length": {"m": 0, "nm": -9, "µm": -6, "um": -6, "mm": -3, "cm": -2, "km": 3},
    "time": {"s": 0, "ns": -9, "µs": -6, "us": -6, "ms": -3},
    "frequency": {"Hz": 0, "kHz": 3, "MHz": 6, "GHz": 9},
    "angle": {
        "rad": 0,
        "nrad": -9,
        "µrad": -6,
        "urad": -6,
        "mrad": -3,
        "deg": _DEGREE,
        "°": _DEGREE,
        "arcmin": _DEGREE / 60.0,
        "arcsec": _DEGREE / 3600.0,
    },
    "angular rate": {
        "rad/s": 0,
        "µrad/s": -6,
        "urad/s": -6,
        "mrad/s": -3,
        "deg/s": _DEGREE,
        "°/s": _DEGREE,
    },
    "speed": {"m/s": 0, "mm/s": -3, "km/s": 3, "km/h": Fraction(1000, 3600)},
    "angular frequency": {"cyc/mrad": 0, "cyc/rad": -3, "cyc/deg": 1.0 / (_DEGREE * 1000.0)},
    "temperature": {"K": 0, "mK": -3},
    "spectral radiance": {"W/m²/sr/µm": 0, "W/m²/sr/nm": 3, "W/cm²/sr/µm": 4},
    "spectral irradiance": {"W/m²/µm": 0, "W/m²/nm": 3},
    "electron count": {"e-": 0, "ke-": 3, "Me-": 6},
    "electron current": {"e-/s": 0, "ke-/s": 3},
    "current density": {"A/cm²": 0, "A/cm2": 0, "µA/cm²": -6, "nA/cm²": -9, "pA/cm²": -12},
    "responsivity": {"A/W": 0, "mA/W": -3},
    "gain": {"e-/DN": 0},
    "digital number": {"DN": 0},
    "extinction": {
        "1/km": 0,
        "/km": 0,
        "1/m": 3,
        "/m": 3,
        "1/cm": 5,
        "1/mm": 6,
        "1/µm": 9,
        "1/um": 9,
    },
    "radiance": {
        "W/m²/sr": 0,
        "W/m2/sr": 0,
        "W/m^2/sr": 0,
        "W/cm²/sr": 4,
        "W/cm2/sr": 4,
        "mW/cm²/sr": 1,
        "mW/cm2/sr": 1,
        "µW/cm²/sr": -2,
        "uW/cm2/sr": -2,
    },
    "illuminance": {"lx": 0, "mlx": -3, "klx": 3},
    "luminance": {"cd/m²": 0, "cd/m2": 0, "cd/m^2": 0},
    "detectivity": {"cm √Hz/W": 0, "cm Hz^0.5/W": 0, "Jones": 0},
    "turbulence": {"m^(-2/3)": 0},
    "proportion": {"": 0, "%": -2},
    "scatter": {"1/sr": 0, "/sr": 0},
    "image speed": {"px/s": 0},
    "sample count": {"px": 0, "samples": 0, "pixels": 0},
    "digital resolution": {"bit": 0, "bits": 0},
    "camera gain": {"dB": 0},
    "relative frequency": {"Nyquist": 0},
    "frequency per frame": {"cycles per frame": 0},
    "wavefront": {"waves": 0},
    "wavefront error": {"waves rms": 0},
}
_KINDS: Mapping[str, Mapping[str, Factor]] = {
    kind: {unit: Fraction(10) ** by if isinstance(by, int) else by for unit, by in row.items()}
    for kind, row in _ROWS.items()
}


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
    """The number in another unit; None where the units measure other things."""
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
