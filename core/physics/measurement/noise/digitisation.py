"""What digitising leaves in a picture: clipping, rounding steps, blocks of compression."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.physics.measurement.noise.flat_blocks import SIDE

Matrix = NDArray[np.float64]
Mask = NDArray[np.bool_]

_LEAST = 64  # samples at the end of the values that make a pile


def clipped_ends(*, picture: Matrix) -> tuple[float | None, float | None]:
    """Lowest and highest value where samples pile up there: clipped."""
    low, high = float(picture.min()), float(picture.max())
    if not (math.isfinite(low) and math.isfinite(high)):
        raise DataError(
            "the picture has samples that are not finite numbers, so its noise cannot be measured"
        )
    if low == high:
        return None, None
    return (
        low if _piled_up(picture, low, np.min) else None,
        high if _piled_up(picture, high, np.max) else None,
    )


def _piled_up(picture: Matrix, end: float, nearest: Callable[[Matrix], Any]) -> bool:
    """Whether the end of the values holds at least as many samples as what lies next to it."""
    at_end = picture == end
    many = int(np.count_nonzero(at_end))
    if many < _LEAST:
        return False
    others = picture[~at_end]
    return many >= int(np.count_nonzero(others == nearest(others)))


def samples_that_count(
    *, picture: Matrix, avoid: Mask | None, low: float | None, high: float | None
) -> Mask | None:
    """Samples that count: not avoided, and not clipped; None where all do."""
    good = None if avoid is None else ~avoid
    for end in (low, high):
        if end is not None:
            free = picture != end
            good = free if good is None else good & free
    return good


# The step of the converter, from the values that occur in a picture.

_MOST = 1 << 19  # samples that are looked at
_REPEATED = 0.75  # values per sample beyond which there is no step
_LIKE = 0.05  # by how much steps may differ, as in numbers turned to radiance
_MOST_ALIKE = 0.9  # of the gaps that are whole steps


def rounding_step(*, picture: Matrix) -> float | None:
    """Smallest distance of two values where all are whole multiples of it; None of others.

    Notes
    -----
    Steps that differ by some percent count as one: a table has turned the numbers to another
    quantity. Noise of fewer values than samples is what shows a step at all.
    """
    every = max(1, picture.size // _MOST)
    values, many = np.unique(picture[::every], return_counts=True)
    if len(values) < 2 or len(values) > _REPEATED * many.sum():
        return None
    gaps = np.diff(values)
    step = float(np.quantile(gaps, 0.25, method="lower"))
    if not step > 1e-12 * float(np.abs(values).max()):
        return None
    steps = gaps / step
    whole = np.rint(steps)
    like = (whole >= 1.0) & (np.abs(steps - whole) <= _LIKE * whole)
    if float(np.mean(like)) < _MOST_ALIKE:
        return None
    return float(np.median(gaps[like] / whole[like]))


# Whether a picture was compressed in blocks of 8 × 8 samples, as JPEG does.

_RANKED = 4  # parts of a picture, whose steps are ranked
_SURE, _SURE_EITHER = 7.0, 2.5  # standard deviations: across and down together, and either


def compressed_in_blocks(*, picture: NDArray[np.floating], period: int = 1) -> bool:
    """Whether steps at the borders of blocks are larger than those within them.

    Steps of a block may repeat with another `period`: then only those of one phase are compared.
    """
    if min(picture.shape) <= SIDE:
        return False
    sure = [_block_steps(view, period) for view in (picture, picture.T)]
    return min(sure) > _SURE_EITHER and math.hypot(*sure) > _SURE


def _block_steps(picture: NDArray[np.floating], period: int) -> float:
    """How sure it is that steps between columns are larger at borders of blocks than in them.

    The mean rank of the border among the eight steps of a block, in standard deviations of the
    mean of so many random ranks (Wilcoxon); a scene's own edges are large in few blocks only. The
    borders are taken where the steps are largest: a picture may have been cropped.
    """
    blocks = (picture.shape[1] - 1) // SIDE
    sums = np.zeros((_RANKED, blocks, SIDE))
    for k, rows in enumerate(np.array_split(np.arange(picture.shape[0]), _RANKED)):
        part = np.asarray(picture[rows[0] : rows[-1] + 1, : blocks * SIDE + 1], np.float64)
        sums[k] = np.abs(np.diff(part, axis=1)).mean(axis=0).reshape(blocks, SIDE)
    best = -math.inf
    for phase in range(period):
        values = sums[:, :, phase::period, np.newaxis]
        ordered, count = values[..., 0][..., np.newaxis, :], SIDE // period
        rank = ((ordered < values).sum(axis=3) + (ordered <= values).sum(axis=3) - count) / 2.0
        means = rank.mean(axis=(0, 1))
        best = max(best, float(means.max()) * math.sqrt(_RANKED * blocks * 12.0 / (count**2 - 1)))
    return best
