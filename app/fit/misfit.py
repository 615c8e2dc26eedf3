"""How much of a picture a fit leaves beyond noise, and by how much that widens its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

_CERTAIN = 4.0  # standard deviations, from which on an excess counts


@dataclass(frozen=True)
class Misfit:
    """How well the chain's edges lie in the samples.

    Parameters
    ----------
    chi2, degrees
        Sum of the squared residuals in units of their noise, and degrees of freedom.
    shape_chi2, shape_degrees
        The same of residuals averaged at equal distances from the edge.
    noise_chi2, noise_degrees
        The same of the noise at the measured levels; part of the first two.
    """

    chi2: float
    degrees: int
    shape_chi2: float
    shape_degrees: int
    noise_chi2: float = 0.0
    noise_degrees: int = 0

    @property
    def chi2_per_degree(self) -> float:
        """1 where the residuals are noise."""
        return self.chi2 / max(1, self.degrees)

    @property
    def shape_per_degree(self) -> float:
        """1 where what is left of the edges has no shape."""
        return self.shape_chi2 / max(1, self.shape_degrees)

    @property
    def excess(self) -> float:
        """By which variances are widened for the edges: 1 unless there is a misfit."""
        edges = self.degrees - self.noise_degrees
        return max(
            _excess((self.chi2 - self.noise_chi2) / max(1, edges), edges),
            _excess(self.shape_per_degree, self.shape_degrees),
        )

    @property
    def noise_excess(self) -> float:
        """The same for the noise."""
        return _excess(self.noise_chi2 / max(1, self.noise_degrees), self.noise_degrees)


def _excess(per_degree: float, degrees: int) -> float:
    certain = degrees > 0 and per_degree > 1.0 + _CERTAIN * math.sqrt(2.0 / degrees)
    return per_degree if certain else 1.0
