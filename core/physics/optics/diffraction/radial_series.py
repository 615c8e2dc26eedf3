"""A function of the radial frequency as series between its kinks, to a given tolerance.

Between kinks of half-integer powers, as edges of apertures make them, ρ = a + (b − a)·sin²(πs/2)
makes the function an analytic one of s, whose Chebyshev series converges like a power.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.numerics.chebyshev import chebyshev_sum

Vector = NDArray[np.float64]
SIZES = (16, 32, 64, 128, 256, 512, 1024)


@dataclass(frozen=True)
class RadialSeries:
    """Chebyshev series on pieces; 0 beyond the last."""

    ends: tuple[float, ...]
    coefficients: tuple[Vector, ...]

    @classmethod
    def of(
        cls, function: Callable[[Vector], Vector], *, ends: tuple[float, ...], tolerance: float
    ) -> RadialSeries:
        """Fit a function of radii.

        Parameters
        ----------
        function : callable
            What is fitted.
        ends : tuple of float
            Where pieces begin and end, rising from 0; beyond the last one the function is 0.
        tolerance : float
            Largest error.

        Raises
        ------
        DataError
            If 1024 terms of a piece do not reach it.
        """
        pieces = (_fit(function, low, high, tolerance) for low, high in pairwise(ends))
        return cls(ends, tuple(pieces))

    def at(self, rho: Vector) -> Vector:
        """Values at radii, 0 or above."""
        values = np.zeros(rho.shape)
        piece = np.searchsorted(self.ends, rho, side="right") - 1
        for index, coefficients in enumerate(self.coefficients):
            chosen = piece == index
            if chosen.any():
                low, high = self.ends[index], self.ends[index + 1]
                share = np.clip((rho[chosen] - low) / (high - low), 0.0, 1.0)
                place = 4.0 / np.pi * np.arcsin(np.sqrt(share)) - 1.0
                values[chosen] = chebyshev_sum(coefficients, place)
        return values


def _fit(function: Callable[[Vector], Vector], low: float, high: float, tolerance: float) -> Vector:
    for size in SIZES:
        place = np.cos(np.pi * (np.arange(size) + 0.5) / size)
        radii = low + (high - low) * np.sin(0.25 * np.pi * (place + 1.0)) ** 2
        coefficients = scipy.fft.dct(function(radii), type=2) / size
        coefficients[0] /= 2.0
        rest = np.cumsum(np.abs(coefficients[::-1]))[::-1]
        if rest[size - size // 4] <= tolerance:
            return np.asarray(coefficients[: max(2, int(np.count_nonzero(rest > tolerance / 8)))])
    raise DataError(
        f"the polychromatic OTF between {low:g} and {high:g} cycles/mrad takes more than "
        f"{SIZES[-1]} terms: give a larger tolerance, a number of wavelengths, or fewer waves of "
        "defocus"
    )
