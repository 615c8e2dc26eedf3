"""How much of a quantizer's rounding error changes from frame to frame, and how much stays."""

from __future__ import annotations

import math

from core.errors import ParameterError
from core.physics.numerics.scalar_checks import positive


def rounding_variances(*, step: float, noise_variance: float) -> tuple[float, float]:
    """Variance of the rounding error that temporal noise stirs, and of that it leaves in place.

    Parameters
    ----------
    step : float
        From one level to the next, above zero.
    noise_variance : float
        Of the temporal noise before the quantizer, normal, in the unit of the step squared; 0 or
        above.

    Returns
    -------
    temporal, fixed : float
        Their sum is step²/12. What is rounded is taken to lie anywhere between two levels with
        equal chance, as of a picture with many levels; a picture of one level only has one fixed
        error.

    Raises
    ------
    ParameterError
        For a step that is not above zero or a negative variance.

    Notes
    -----
    The mean error of s + noise over the noise is a Fourier series in s; its mean square is
    step²/(2π²)·Σ exp(−4π²k²σ²/step²)/k². Source: Widrow and Kollár 2008, Quantization Noise,
    chapters 4 and 19 (the characteristic function method); for small σ the sum is
    π²/6 − √(πa) + a/2 with a = 4π²σ²/step², by Poisson's summation formula.
    """
    width = positive("step", step)
    if not 0.0 <= noise_variance < math.inf:
        raise ParameterError("noise_variance", noise_variance, "0 or above and finite")
    whole = width * width / 12.0
    a = 4.0 * math.pi**2 * (noise_variance / width / width)
    if a < 0.25:
        total = math.pi**2 / 6.0 - math.sqrt(math.pi * a) + 0.5 * a
    else:
        total = math.fsum(math.exp(-a * k * k) / (k * k) for k in range(1, 14))
    fixed = min(whole, width * width / (2.0 * math.pi**2) * total)
    return whole - fixed, fixed
