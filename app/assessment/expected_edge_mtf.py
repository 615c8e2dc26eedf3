"""The MTF that a slanted edge in the final picture should show: every step from the scene to it.

The stages' product is not all there is to it. A sample of the scene is a mean over its area, pixels
are combined, a frame grabber interpolates: each blurs too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.evaluation.work import Work
from core.lineage.linear_change import PlaceDependent
from core.physics.numerics.sinc import sinc
from core.physics.sampling.resampling import folded
from core.transfer.factors import factor_at
from nodes.analysis.lineage import ImageTransfer

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
        if isinstance(factor, PlaceDependent):
            if factor.x is not None:
                total = total * factor.mean_over(factor.x, xi, waves.seen_x)
            if factor.y is not None:
                total = total * factor.mean_over(factor.y, eta, waves.seen_y)
        else:
            total = total * factor_at(work, factor, *within)
    return np.asarray(np.abs(total), np.float64)
