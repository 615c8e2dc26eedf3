"""Zernike polynomials in Noll's order, and wavefront errors made of them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from core.errors import ParameterError

HIGHEST_NOLL_INDEX = 861  # 40 radial orders; beyond, samples of a pupil do not resolve them


def noll_order(*, noll_index: int) -> tuple[int, int]:
    """Radial order n and signed azimuthal order m (negative: sine) of Noll's index.

    Raises
    ------
    ParameterError
        If the index is not 1 to 861.
    """
    if not 1 <= noll_index <= HIGHEST_NOLL_INDEX:
        raise ParameterError("noll_index", noll_index, f"1 to {HIGHEST_NOLL_INDEX}")
    n = (math.isqrt(8 * noll_index - 7) - 1) // 2
    place = noll_index - n * (n + 1) // 2 - 1
    m = 2 * ((place + 1) // 2) if n % 2 == 0 else 2 * (place // 2) + 1
    return n, m if noll_index % 2 == 0 else -m


def zernike(*, noll_index: int, x: ArrayLike, y: ArrayLike) -> NDArray[np.float64]:
    """Zernike polynomial of unit rms over the unit disc.

    Parameters
    ----------
    noll_index : int
        Noll's index: 1 piston, 2 and 3 tilts in x and y, 4 defocus, 5 and 6 astigmatisms,
        7 and 8 comas, 11 spherical aberration.
    x, y : array_like
        Position over the pupil's radius; they broadcast. Outside the disc the polynomial goes on.

    Returns
    -------
    ndarray
        Value, dimensionless.

    Raises
    ------
    ParameterError
        If the index is not 1 to 861.

    Notes
    -----
    Source: Noll 1976, JOSA 66, 207, eqs. 1 and 2; the radial part as a Jacobi polynomial, whose
    recurrence does not cancel as Noll's sum of factorials does.
    """
    n, m = noll_order(noll_index=noll_index)
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    order = abs(m)
    depth = (n - order) // 2
    radial = (-1) ** depth * special.eval_jacobi(depth, order, 0, 1.0 - 2.0 * (x * x + y * y))
    azimuthal = (x + 1j * y) ** order
    part = azimuthal.imag if m < 0 else azimuthal.real
    scale = math.sqrt(n + 1) if m == 0 else math.sqrt(2 * (n + 1))
    value: NDArray[np.float64] = scale * radial * part
    return value


def wavefront_waves(
    *,
    x: ArrayLike,
    y: ArrayLike,
    coefficients_waves: Sequence[float] = (),
    defocus_waves: float = 0.0,
) -> NDArray[np.float64]:
    """Wavefront error of a pupil from Zernike coefficients and Seidel defocus.

    Parameters
    ----------
    x, y : array_like
        Position over the pupil's radius; they broadcast.
    coefficients_waves : sequence of float
        Coefficients in Noll's order from j = 1 (piston) on [waves rms].
    defocus_waves : float
        W20, the defocus at the pupil's rim [waves]: W = W20 (x² + y²).

    Returns
    -------
    ndarray
        Wavefront error [waves].

    Raises
    ------
    ParameterError
        If a coefficient is not finite or there are more than 861.
    """
    x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if not math.isfinite(defocus_waves):
        raise ParameterError("defocus_waves", defocus_waves, "a finite number", unit="waves")
    waves = np.zeros(np.broadcast_shapes(x.shape, y.shape)) + defocus_waves * (x * x + y * y)
    for index, coefficient in enumerate(coefficients_waves, start=1):
        if not math.isfinite(coefficient):
            name = f"coefficients_waves[{index}]"
            raise ParameterError(name, coefficient, "a finite number", unit="waves")
        if coefficient != 0.0:
            waves += coefficient * zernike(noll_index=index, x=x, y=y)
    return np.asarray(waves, dtype=np.float64)
