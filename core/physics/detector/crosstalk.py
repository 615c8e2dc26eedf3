"""Crosstalk between pixels: charge, light or capacitance that a neighbour gets of a pixel."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import positive

Kernel = tuple[tuple[float, ...], ...]
SIZES = (3, 5)
_SUM_TOLERANCE = 1e-6


def crosstalk_kernel(text: str) -> Kernel:
    """Kernel of numbers, rows separated by semicolons, as "0 0.02 0; 0.02 0.92 0.02; 0 0.02 0".

    3 × 3 or 5 × 5 numbers, 0 or above, that add up to 1 (within 1e-6) and are divided by their sum:
    of a lit pixel's signal, what the pixels round it get; row 0 is above it, column 0 left of it.
    """
    rows = [row.replace(",", " ").split() for row in text.strip().strip(";").split(";")]
    size = len(rows)
    try:
        numbers = [[float(word) for word in row] for row in rows]
    except ValueError as error:
        raise ParameterError(
            "kernel", text, f"give 3 × 3 or 5 × 5 numbers, rows separated by semicolons ({error})"
        ) from None
    if size not in SIZES or any(len(row) != size for row in numbers):
        counts = ", ".join(str(len(row)) for row in numbers)
        found = f"{size} row{'s' if size > 1 else ''} of {counts}"
        allowed = f"give 3 × 3 or 5 × 5 numbers, rows separated by semicolons, not {found}"
        raise ParameterError("kernel", text, allowed)
    flat = [value for row in numbers for value in row]
    if not all(0.0 <= value < math.inf for value in flat):
        raise ParameterError("kernel", text, "numbers of 0 or above")
    total = math.fsum(flat)
    if abs(total - 1.0) > _SUM_TOLERANCE:
        raise ParameterError("kernel", text, f"numbers that add up to 1, not {total:.6g}")
    return tuple(tuple(value / total for value in row) for row in numbers)


def crosstalk_otf(
    *,
    xi: ArrayLike,
    eta: ArrayLike,
    kernel: Kernel,
    pitch_x_mrad: float,
    pitch_y_mrad: float,
) -> NDArray[np.complex128]:
    """OTF of crosstalk.

    Parameters
    ----------
    xi, eta : array_like
        Frequencies, cycles/mrad; they broadcast.
    kernel : tuple of tuple of float
        As of `crosstalk_kernel`.
    pitch_x_mrad, pitch_y_mrad : float
        From one pixel to the next, above 0.

    Returns
    -------
    ndarray of complex128
        Σ k·e^(−2πi(ξx + ηy)), with x to the right and y downwards; 1 at frequency 0.

    Source: Holst and Lomheim 2007, CMOS/CCD Sensors and Camera Systems, chapter 10; Moore, Ninkov
    and Forrest 2006, Optical Engineering 45, 076402 (interpixel capacitance).
    """
    x = positive("pitch_x_mrad", pitch_x_mrad, unit="mrad")
    y = positive("pitch_y_mrad", pitch_y_mrad, unit="mrad")
    weights = np.asarray(kernel, np.float64)
    if not np.isfinite(weights).all():
        raise ParameterError("kernel", "a number that is not finite", "finite numbers")
    steps = np.arange(len(weights)) - len(weights) // 2
    across = [np.exp(-2j * np.pi * x * step * np.asarray(xi, np.float64)) for step in steps]
    along = [np.exp(-2j * np.pi * y * step * np.asarray(eta, np.float64)) for step in steps]
    return np.asarray(
        sum(
            row * sum(weight * wave for weight, wave in zip(line, across, strict=True))
            for line, row in zip(weights, along, strict=True)
        ),
        np.complex128,
    )
