"""Stray light of a lens as a wide second part of its point spread function."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.physics.checks import all_from_zero, positive, within


def veiling_glare_mtf(*, rho: ArrayLike, share: float, length_mrad: float) -> NDArray[np.float64]:
    """MTF of a lens that spreads a share of its light widely.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad, 0 or above.
    share : float
        Of the light that is spread, 0 to 1.
    length_mrad : float
        Length ℓ of the spread ℓ/(2π(r² + ℓ²)^(3/2)), above 0; half of it falls within √3·ℓ.

    Returns
    -------
    ndarray
        1 − g + g·e^(−2πℓρ), of the shape of `rho`; 1 at 0.

    Source: Bracewell 2000, The Fourier Transform and Its Applications, Hankel transforms.
    """
    frequency = all_from_zero("rho", rho)
    spread = within("share", share, 0.0, 1.0)
    length = positive("length_mrad", length_mrad, unit="mrad")
    with np.errstate(under="ignore"):
        return np.asarray(1.0 + spread * np.expm1(-2.0 * np.pi * length * frequency))
