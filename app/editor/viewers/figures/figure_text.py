"""Figures as text: four digits, and a unit with the prefix that reads well."""

from __future__ import annotations

import math
from typing import Any

NONE = "—"
_PREFIXED = ("Hz", "K", "s", "W/m²/sr", "e-")
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def figure_text(value: Any, unit: str) -> str:
    """A figure in four digits with its unit, which may get a prefix; a dash for none."""
    if value is None:
        return NONE
    if not isinstance(value, int | float):
        return str(value)
    factor, shown_unit = prefixed(value, unit)
    text = f"{value / factor:.4g} {shown_unit}"
    return text.strip().replace("-", "\N{MINUS SIGN}")


def prefixed(value: float, unit: str) -> tuple[float, str]:
    """What a figure is divided by to be read well, and its unit with the prefix for that."""
    if unit in _PREFIXED and value and math.isfinite(value):
        power = min(9, max(-9, 3 * math.floor(math.log10(abs(float(f"{value:.4g}"))) / 3)))
        return 10.0**power, f"{_PREFIXES[power]}{unit}"
    return 1.0, unit
