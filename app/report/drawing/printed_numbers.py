"""Numbers as they are printed in reports."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.run.readout_tables import number_text, without_rounding

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: Any, unit: str | None = None) -> str:
    """As `number_text`, with a true minus sign and powers of ten in print.

    With its unit given, what rounding leaves of 0 is shown as 0.
    """
    if value is None:
        return "–"
    if unit is not None:
        value = without_rounding(value, unit)
    text = number_text(value)
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        return text
    mantissa, exponent, power = text.replace("-", "−").partition("e")
    if not exponent:
        return mantissa
    raised = str(int(power.replace("−", "-"))).translate(_RAISED)
    return (
        f"{mantissa.removesuffix('1')}10{raised}"
        if mantissa in ("1", "−1")
        else (f"{mantissa}·10{raised}")
    )


def short(value: float | None, digits: int = 4) -> str:
    return number(None if value is None else float(f"{value:.{digits}g}"))
