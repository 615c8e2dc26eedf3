"""Numbers as illustrations write them: few digits, powers of ten in print."""

from __future__ import annotations

import math

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PLAIN = (1e-3, 1e5)  # sizes written without a power of ten


def brief(value: float, digits: int = 3) -> str:
    """A number in that many digits, such as 0.489 or 1.1·10¹¹."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}".replace("-0", "0")
    if _PLAIN[0] <= abs(value) < _PLAIN[1]:
        return signed(f"{value:.{digits}g}" if abs(value) < 10**digits else f"{value:.0f}")
    mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
    if "." in mantissa:
        mantissa = mantissa.rstrip("0").rstrip(".")
    return signed(f"{mantissa}·{power_of_ten(int(exponent))}")


def power_of_ten(exponent: int) -> str:
    """10 with its exponent raised."""
    return f"10{str(exponent).translate(_RAISED)}"


def signed(text: str) -> str:
    """With a true minus sign."""
    return text.replace("-", "\N{MINUS SIGN}")


def kelvin(value: float) -> str:
    """A small temperature in K or mK."""
    if value == 0 or abs(value) >= 0.1:
        return f"{brief(value)} K"
    return f"{brief(1e3 * value)} mK"


def electrons(value: float) -> str:
    """Electrons, as data sheets give them: e⁻, ke⁻ or Me⁻."""
    for least, unit, prefix in ((1e6, 1e6, "M"), (1e4, 1e3, "k")):
        if abs(value) >= least:
            return f"{brief(value / unit)} {prefix}e\N{SUPERSCRIPT MINUS}"
    return f"{brief(value)} e\N{SUPERSCRIPT MINUS}"


def pair(x: float, y: float, digits: int = 3) -> str:
    """Across × along, or one number where both are the same."""
    first, second = brief(x, digits), brief(y, digits)
    return first if first == second else f"{first} × {second}"
