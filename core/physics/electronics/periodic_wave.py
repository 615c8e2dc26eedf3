"""Periodic noise: a sinusoid, plain or modulated in amplitude."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.numerics.scalar_checks import finite, within


def periodic_pattern(
    *,
    x_mrad: ArrayLike,
    y_mrad: ArrayLike,
    amplitude: float,
    xi: float,
    eta: float,
    phase_rad: float = 0.0,
    modulation: float = 0.0,
    modulation_xi: float = 0.0,
    modulation_eta: float = 0.0,
    modulation_phase_rad: float = 0.0,
) -> NDArray[np.float64]:
    """Sinusoidal pattern A·(1 + m·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ).

    Parameters
    ----------
    x_mrad, y_mrad : array_like
        Positions in mrad, of shapes that broadcast: a row of columns and a column of rows make a
        frame at the cost of vectors.
    amplitude : float
        Amplitude A in the unit of the image, of either sign.
    xi, eta : float
        Frequency of the pattern in x and y in cycles/mrad.
    phase_rad : float
        Phase φ at the origin in radians.
    modulation : float
        Depth m of the amplitude modulation, 0 (none) to 1.
    modulation_xi, modulation_eta : float
        Frequency of the modulation in cycles/mrad.
    modulation_phase_rad : float
        Phase φₘ of the modulation in radians.

    Returns
    -------
    ndarray of float64
        The pattern, of the common shape, to be added to an image.

    Raises
    ------
    ParameterError
        When a value is not finite, or the depth is outside 0 to 1.

    Notes
    -----
    Source: Tantalo 1996, chapter 3 ("simple sinusoidal noise models and modified periodic noise").
    """
    x = np.asarray(x_mrad, dtype=np.float64)
    y = np.asarray(y_mrad, dtype=np.float64)
    size = finite("amplitude", amplitude)
    depth = within("modulation", modulation, 0.0, 1.0)
    frequencies = (finite("xi", xi, unit="cyc/mrad"), finite("eta", eta, unit="cyc/mrad"))
    pattern = size * _wave(x, y, *frequencies, finite("phase_rad", phase_rad, unit="rad"))
    if depth > 0.0:
        envelope = _wave(
            x,
            y,
            finite("modulation_xi", modulation_xi, unit="cyc/mrad"),
            finite("modulation_eta", modulation_eta, unit="cyc/mrad"),
            finite("modulation_phase_rad", modulation_phase_rad, unit="rad"),
        )
        pattern = pattern * (1.0 + depth * envelope)
    return np.asarray(pattern, dtype=np.float64)


def _wave(
    x: NDArray[np.float64], y: NDArray[np.float64], xi: float, eta: float, phase: float
) -> NDArray[np.float64]:
    """sin(2π(ξx + ηy) + φ) by the addition theorem: sines of the axes, not of the frame."""
    across = 2.0 * math.pi * xi * x + phase
    along = 2.0 * math.pi * eta * y
    wave = np.sin(across) * np.cos(along)
    return np.asarray(wave + np.cos(across) * np.sin(along), dtype=np.float64)
