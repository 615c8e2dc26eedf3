"""Impulse responses of a chain's transfer function, cut short with a bound on what that costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.transfer.factors import Edges, Factor, Grid
from core.transfer.product import Product

Array = NDArray[Any]
Vector = NDArray[np.float64]
Truncation = Literal["half_width", "error", "none"]


@dataclass(frozen=True)
class Cut:
    """Where kernels end; `error` is what all together may cost, as in `Kernels.error_bound`."""

    truncation: Truncation
    half_width_px: int
    error: float


@dataclass(frozen=True)
class Kernel:
    """One pass of the convolution: weights, of one row or column for a pass along one axis.

    The tap at lag 0 is at (`before_y`, `before_x`); `dropped` and `whole` are sums of the moduli of
    the taps cut off, and of all.
    """

    taps: Vector
    before_y: int
    before_x: int
    dropped: float
    whole: float


@dataclass(frozen=True)
class Kernels:
    """The passes in order, and the response to a uniform frame."""

    passes: tuple[Kernel, ...]
    at_zero: float

    @property
    def taps(self) -> int:
        """Multiplications a sample."""
        return sum(kernel.taps.size for kernel in self.passes)

    @property
    def error_bound(self) -> float:
        """Largest error of a sample over the scene's largest departure from its mean.

        A tap h that is left out changes a sample by |h| times that departure at most. Of passes
        in turn, each one's loss goes through the others.
        """
        total = 0.0
        for place, kernel in enumerate(self.passes):
            before = math.prod(other.whole - other.dropped for other in self.passes[:place])
            after = math.prod(other.whole for other in self.passes[place + 1 :])
            total += kernel.dropped * before * after
        return total


@ends_lineage
def impulse_responses(
    work: Work, *, factors: tuple[Factor, ...], grid: Grid, edges: Edges, cut: Cut
) -> Kernels:
    """Kernels with which a convolution is the multiplication by these factors.

    Separable factors give a row and a column. Others give one kernel in two dimensions; it takes
    the separable ones in if it is not even in x and in y, since only an even kernel leaves a
    mirrored frame mirrored for the next pass.
    """
    product = Product(factors)
    period_y, period_x = _period(grid.rows, edges), _period(grid.columns, edges)
    xi = scipy.fft.rfftfreq(period_x, grid.interval_x_mrad)
    eta = scipy.fft.rfftfreq(period_y, grid.interval_y_mrad)
    has_x = any(factor.x is not None for factor in product.separable)
    has_y = any(factor.y is not None for factor in product.separable)
    whole: list[Array] = []
    if product.planar:
        alone = product.symmetric
        evaluate = product.plane if alone else product.total
        both = scipy.fft.fftfreq(period_y, grid.interval_y_mrad)
        plane = np.asarray(evaluate(work, xi, both), np.complex128)
        if period_y % 2 == 0:
            # At Nyquist a picture's spectrum has eta and −eta in one: the mean of both acts.
            middle = period_y // 2
            other = np.asarray(evaluate(work, xi, -both[middle : middle + 1]))
            plane[middle] = 0.5 * (plane[middle] + other[0])
        work.check()
        whole.append(scipy.fft.irfft2(plane, s=(period_y, period_x), workers=work.policy.workers))
        has_x, has_y = has_x and alone, has_y and alone
    if has_x:
        whole.append(scipy.fft.irfft(product.across(work, xi), n=period_x)[np.newaxis, :])
    if has_y:
        whole.append(scipy.fft.irfft(product.along(work, eta), n=period_y)[:, np.newaxis])
    sums = [float(np.sum(np.abs(taps))) for taps in whole]
    passes = []
    for place, taps in enumerate(whole):
        others = math.prod(sums[:place] + sums[place + 1 :])
        passes.append(_shortened(taps, sums[place], cut, cut.error / (len(whole) * others)))
    return Kernels(tuple(passes), product.at_zero(work))


def _period(size: int, edges: Edges) -> int:
    """Samples after which the frame repeats; one sample mirrored is still one value."""
    return 2 * size if edges == "reflect" else size


def _shortened(taps: Array, whole: float, cut: Cut, allowed: float) -> Kernel:
    """The taps around lag 0 with that in the middle; `taps` have it first and wrap round."""
    lags = [np.arange(size) - size // 2 for size in taps.shape]
    taps = np.asarray(scipy.fft.fftshift(taps), np.float64)
    distance = np.maximum.outer(np.abs(lags[0]), np.abs(lags[1]))
    rings = np.bincount(distance.ravel(), np.abs(taps).ravel())
    # What lies beyond each half width, summed from the outside for small sums to stay precise.
    beyond = np.append(np.cumsum(rings[::-1])[::-1][1:], 0.0)
    reach = len(rings) - 1
    if cut.truncation == "half_width":
        reach = min(reach, cut.half_width_px)
    elif cut.truncation == "error":
        reach = int(np.argmax(beyond <= allowed))
    inside_reach = [np.flatnonzero(np.abs(lag) <= reach) for lag in lags]
    inside = taps[
        inside_reach[0][0] : inside_reach[0][-1] + 1, inside_reach[1][0] : inside_reach[1][-1] + 1
    ]
    before_y, before_x = (-int(lag[k[0]]) for lag, k in zip(lags, inside_reach, strict=True))
    return Kernel(np.ascontiguousarray(inside), before_y, before_x, float(beyond[reach]), whole)
