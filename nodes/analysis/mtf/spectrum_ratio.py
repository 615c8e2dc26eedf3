"""The MTF between two pictures, from the ratio of their spectra."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from core.chain.results import CurveData, Series
from core.evaluation.recipes import ends_lineage, in_blocks
from core.evaluation.work import Work
from core.filtering.mirrored import MeanFree
from core.transfer.grid import Edges, Grid

Array = NDArray[Any]
Vector = NDArray[np.float64]
_BLOCK_SAMPLES = 1 << 18
# Times the rounding of the samples: where the reference has less, the ratio would be noise.
_ABOVE_ROUNDING = 100.0


@in_blocks()  # numpy averages the rows as they come
@ends_lineage
def axes_ratio(
    work: Work, image: Array, reference: Array, *, grid: Grid, edges: Edges, unit: str
) -> CurveData:
    """|spectrum of image| / |spectrum of reference| on the axes xi and eta.

    On an axis the spectrum is that of the picture averaged across it, a 1-D transform. `edges`
    as in Init & Trans; `unit` is that of the grid's frequencies.
    """
    mirrored = edges == "reflect"
    across = grid.xi_mirrored() if mirrored else grid.xi_half()
    along = grid.eta_mirrored() if mirrored else np.abs(grid.eta()[: grid.rows // 2 + 1])
    largest = max(abs(float(reference.max())), abs(float(reference.min())))
    series = []
    for name, axis, frequency in (("horizontal", 0, across), ("vertical", 1, along)):
        work.check()
        above, below = (
            _modulus(np.mean(picture, axis=axis, dtype=np.float64), mirrored)
            for picture in (image, reference)
        )
        seen = below > _rounding(reference.dtype) * largest * math.sqrt(len(frequency))
        series.append(Series(name, frequency[seen], above[seen] / below[seen]))
    return _curves(series, unit)


@ends_lineage
def radial_ratio(
    work: Work, image: MeanFree, reference: MeanFree, *, grid: Grid, edges: Edges, unit: str
) -> CurveData:
    """Root of the ratio of the powers in rings of equal radial frequency, up to Nyquist.

    A ring's frequency is the mean over it, weighted with the reference's power.
    """
    mirrored = edges == "reflect"
    spacing = max(grid.frequency_interval_x, grid.frequency_interval_y) / (2 if mirrored else 1)
    rings = int(min(grid.nyquist_x, grid.nyquist_y) / spacing) + 1
    above, below, moment, count = (np.zeros(rings) for _ in range(4))
    xi = grid.xi_mirrored() if mirrored else grid.xi_half()
    eta = grid.eta_mirrored() if mirrored else grid.eta()
    weight = np.ones(len(xi))
    if not mirrored:
        weight[1 : (grid.columns + 1) // 2] = 2.0  # a half spectrum's column and its twin
    step = max(1, _BLOCK_SAMPLES // len(xi))
    for start in range(0, len(eta), step):
        work.check()
        rows = slice(start, start + step)
        rho = np.hypot(xi, eta[rows, np.newaxis])
        ring = np.rint(rho / spacing).astype(np.intp)
        inside = ring < rings
        ring, rho = ring[inside], rho[inside]
        powers = [_power(picture.values[rows]) * weight for picture in (image, reference)]
        power_above, power_below = (power[inside] for power in powers)
        above += np.bincount(ring, power_above, rings)
        below += np.bincount(ring, power_below, rings)
        moment += np.bincount(ring, power_below * rho, rings)
        count += np.bincount(ring, np.broadcast_to(weight, inside.shape)[inside], rings)
    # Unnormalised DCTs have twice the size of an FFT along each axis.
    size = grid.rows * grid.columns * (4.0 if mirrored else 1.0)
    above[0] += (image.mean * size) ** 2
    below[0] += (reference.mean * size) ** 2
    level = reference.mean**2 + float(np.sum(below)) / size**2
    floor = _rounding(reference.values.real.dtype) ** 2 * level * size
    seen = below > floor * count
    ratio = np.sqrt(above[seen] / below[seen])
    return _curves([Series("radial", moment[seen] / below[seen], ratio)], unit)


def _modulus(profile: Vector, mirrored: bool) -> Vector:
    transform = scipy.fft.dct(profile, type=2) if mirrored else scipy.fft.rfft(profile)
    return np.asarray(np.abs(transform), np.float64)


def _power(values: Array) -> Vector:
    """|values|² in double, which holds the square of every single-precision number."""
    real = values.real.astype(np.float64) ** 2
    return real + values.imag.astype(np.float64) ** 2 if np.iscomplexobj(values) else real


def _rounding(dtype: np.dtype[Any]) -> float:
    return _ABOVE_ROUNDING * float(np.finfo(dtype).eps)


def _curves(series: list[Series], unit: str) -> CurveData:
    return CurveData("MTF ratio", f"frequency ({unit})", "MTF ratio", tuple(series))
