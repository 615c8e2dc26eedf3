"""Noise of pictures: of the flat areas of one, and from frame to frame of several."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from app.measure.picture_measurement import NoiseFigures

Matrix = NDArray[np.float64]


def noise_of(
    *, picture: Matrix, check: Callable[[], None] = lambda: None
) -> tuple[NoiseFigures | None, str]:
    """Noise of one picture, or the reason why it could not be measured."""
    check()
    if min(picture.shape) < 3:
        return None, "the picture is too small"
    # Immerkær 1996, Computer Vision and Image Understanding 64, 300.
    inner = (
        picture[:-2, :-2] + picture[:-2, 2:] + picture[2:, :-2] + picture[2:, 2:]
        - 2.0 * (picture[:-2, 1:-1] + picture[2:, 1:-1] + picture[1:-1, :-2] + picture[1:-1, 2:])
        + 4.0 * picture[1:-1, 1:-1]
    )  # fmt: skip
    sigma = math.sqrt(math.pi / 2.0) / 6.0 * float(np.mean(np.abs(inner)))
    return NoiseFigures(
        sigma, sigma / math.sqrt(2.0 * inner.size), reason="levels not compared"
    ), ""


def pooled_noise(measured: Sequence[NoiseFigures]) -> NoiseFigures:
    """The noise of several pictures of one camera: mean of the variances."""
    if len(measured) == 1:
        return measured[0]
    count = len(measured)
    sigma = math.sqrt(math.fsum(one.sigma**2 for one in measured) / count)
    error = math.sqrt(math.fsum((one.sigma * one.sigma_error) ** 2 for one in measured))
    return NoiseFigures(sigma, error / max(sigma, 1e-300) / count, reason=measured[0].reason)
