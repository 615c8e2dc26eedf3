"""How stages whose transfer functions multiply share in what is lost."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.errors import DataError


def loss(*, mtf: float) -> float:
    """What a transfer function takes from a frequency: −ln |MTF|.

    Parameters
    ----------
    mtf : float
        Its value there, signed.

    Returns
    -------
    float
        0 for what passes whole, infinite for what lets nothing through, below 0 for what
        amplifies.

    Raises
    ------
    DataError
        For a value that is not finite.

    Notes
    -----
    Moduli of stages multiply, so their losses add. That of a Gaussian blur of deviation σ is
    2π²σ²f²: at one frequency Gaussian blurs share as their variances.
    """
    if not math.isfinite(mtf):
        raise DataError(f"an MTF of {mtf} has no loss: it must be finite")
    if mtf == 0.0:
        return math.inf
    return 0.0 - math.log(abs(mtf))


def shares_of_losses(*, losses: Sequence[float]) -> list[float]:
    """Share of each stage in all that is lost.

    Parameters
    ----------
    losses : sequence of float
        Of each stage, −ln |MTF|.

    Returns
    -------
    list of float
        Those of stages that lose add up to 1. What amplifies has a share below 0: how much of the
        loss it makes up for. Where nothing is lost, shares are those of all that is amplified, and
        add up to −1. Stages that let nothing through share all of it alike.
    """
    if math.inf in losses:
        opaque = list(losses).count(math.inf)
        return [1.0 / opaque if value == math.inf else 0.0 for value in losses]
    whole = math.fsum(value for value in losses if value > 0.0)
    whole = whole or -math.fsum(losses)
    return [value / whole if value else 0.0 for value in losses]
