"""The MTF that a slanted edge in the final picture should show: every step from the scene to it.

The stages' product is not all there is to it. A sample of the scene is a mean over its area, pixels
are combined, a frame grabber interpolates: each blurs too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.evaluation.work import Work
from core.physics.numerics.sinc import sinc
from core.physics.sampling.interpolation import interpolation_mtf
from core.physics.sampling.resampling import folded, resampling_response
from core.transfer.factors import Factor, Law, Separable
from nodes.analysis.lineage import ImageTransfer
from nodes.analysis.lineage.line_transfer import factor_at
from nodes.transform.interpolate import taps

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Waves:
    """Frequencies in cycles per sample of the final picture, and where in it they are looked at.

    `seen_x` and `seen_y` are the shares of the frame's width and height, about its middle.
    """

    x: Vector
    y: Vector
    seen_x: float
    seen_y: float


def expected_mtf(passed: ImageTransfer, work: Work, waves: Waves) -> Vector:
    """Modulus of all steps at these pairs of frequencies.

    An interpolated picture differs from place to place: what counts is the mean over what is seen.
    """
    xi, eta = waves.x / passed.grid.interval_x_mrad, waves.y / passed.grid.interval_y_mrad
    scene = passed.source_grid
    fx, fy = xi * scene.interval_x_mrad, eta * scene.interval_y_mrad
    total = sinc(fx) * sinc(fy)  # samples of the scene are means over their area
    # A filter of samples repeats itself beyond their Nyquist frequency.
    within = folded(fx) / scene.interval_x_mrad, folded(fy) / scene.interval_y_mrad
    for factor in passed.factors:
        if factor.part != "mtf":
            continue
        work.check()
        if isinstance(factor, Separable) and _interpolates(factor):
            total = total * _interpolated(factor.x, xi, waves.seen_x)
            total = total * _interpolated(factor.y, eta, waves.seen_y)
        else:
            total = total * factor_at(work, factor, *within)
    return np.asarray(np.abs(total), np.float64)


def _interpolates(factor: Factor) -> bool:
    return any(law.function is interpolation_mtf for law in factor.laws)


def _interpolated(law: Law | None, frequency: Vector, seen: float) -> Vector:
    """Mean response of the new samples that are seen."""
    if law is None:
        return np.ones(len(frequency))
    given = dict(law.parameters)
    old, new = given["old"], given["new"]
    base, further = taps(old, new, given["order"], None)
    places = (np.arange(new) + 0.5) * old / new - 0.5
    # How much of each new sample lies within what is seen of them.
    away = np.abs(np.arange(new) + 0.5 - 0.5 * new)
    share = np.clip(0.5 * max(1.0, seen * new) + 0.5 - away, 0.0, 1.0)
    used = share > 0.0
    return resampling_response(
        frequency=frequency * law.scale * given["interval_mrad"],
        places=places[used],
        base=base[used],
        further=[(index[used], weight[used]) for index, weight in further],
        share=share[used],
    )
