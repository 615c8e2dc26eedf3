"""Averaging over the sensitive width of a detector element."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.numerics.scalar_checks import non_negative, positive
from core.physics.numerics.sinc import sinc


def aperture_mtf(*, frequency: ArrayLike, effective_ifov_mrad: float) -> NDArray[np.float64]:
    """MTF of a rectangular detector element along one axis, signed.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    effective_ifov_mrad : float
        pitch·fill/focal length, zero or above
        (`core.physics.sampling.detector_sampling.ifov_mrad`).

    Returns
    -------
    ndarray of float64
        sinc(IFOV·frequency); negative beyond the first zero, where the phase is π.

    Raises
    ------
    ParameterError
        When the IFOV is negative or not finite.

    Notes
    -----
    Source: Tantalo 1996, eqs. 4.44 and 4.48; the MTF in x and y is the product of two of these.
    """
    width = non_negative("effective_ifov_mrad", effective_ifov_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        return sinc(width * np.asarray(frequency, dtype=np.float64))


def first_zero_cyc_per_mrad(*, effective_ifov_mrad: float) -> float:
    """Frequency at which the element averages one whole cycle: 1/IFOV.

    Parameters
    ----------
    effective_ifov_mrad : float
        pitch·fill/focal length, above zero.

    Returns
    -------
    float
        First zero of the detector MTF in cycles/mrad.

    Raises
    ------
    ParameterError
        When the IFOV is not positive and finite.

    Notes
    -----
    Source: Tantalo 1996, eqs. 4.45-4.46 and 4.49-4.50 (the "sinc width").
    """
    return 1.0 / positive("effective_ifov_mrad", effective_ifov_mrad, unit="mrad")
