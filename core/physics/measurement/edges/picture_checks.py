"""Signs that a picture was made so that no edge of it shows the camera's blur."""

import math

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.noise.digitisation import compressed_in_blocks

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_STRIPS = 16  # parts of a picture, whose differences give the doubt
_SURE = 6.0  # standard errors
_LEAST_SHIFT = 0.12  # samples
_LEAST_SIDE = 48
_LEAST_MISSING = 32  # samples of one number, in squares of 3 × 3
_LEAST_VALUES = 8  # beside them, or there is no noise
_FEW, _APART = 0.02, 0.1  # share of the samples beside, and how near to that number, of the range
_MOSAIC = 0.5  # logarithm of what the fine detail of one diagonal has over that of the other
_LEAST_DETAIL = 0.1  # of its mean, added where detail may be none


def why_no_picture(*, picture: NDArray[np.floating], interpolated_too: bool = False) -> str:
    """Why no edge of a picture can be believed; empty if nothing speaks against it.

    It is interlaced, interpolated from a mosaic of colour filters (whose edges may be measured as
    they are, `interpolated_too`), or compressed in blocks of 8 × 8 samples (JPEG).
    """
    if min(picture.shape) < _LEAST_SIDE:
        return ""
    shift, shift_error = row_shift(picture=picture)
    if abs(shift) > max(_LEAST_SHIFT, _SURE * shift_error):
        return (
            f"interlaced: the odd rows are shifted by {abs(shift):.2g} samples relative to the "
            "even rows; measure one field"
        )
    interpolated = why_interpolated(picture=picture)
    if interpolated and not interpolated_too:
        return f"{interpolated}; measure the samples of one filter colour"
    if compressed_in_blocks(picture=picture, period=2 if interpolated else 1):
        return (
            "compressed in blocks of 8 × 8 samples (JPEG): steps between blocks are larger than "
            "steps within them"
        )
    return ""


def why_interpolated(*, picture: NDArray[np.floating]) -> str:
    """Why a picture is taken as made of a mosaic of colour filters; empty if it is not."""
    if min(picture.shape) < _LEAST_SIDE:
        return ""
    mosaic, mosaic_error = mosaic_detail(picture=picture)
    if not abs(mosaic) > max(_MOSAIC, _SURE * mosaic_error):
        return ""
    return (
        "interpolated: on a checkerboard of samples, one colour has "
        f"{math.exp(abs(mosaic) / 2.0):.2g} times the fine detail of the other, a sign of "
        "demosaicing"
    )


def missing_samples(*, picture: NDArray[np.floating]) -> NDArray[np.bool_] | None:
    """Samples that hold one number in place of data, as borders of a warped picture do.

    Notes
    -----
    Looked at are the picture's extreme values and those of its corners. Light that is cut off at a
    limit comes near to it before it reaches it, since every camera blurs: next to such an area
    lie samples of all levels. Next to missing ones lie those of the scene, far from their number,
    and have noise.
    """
    corners = picture[:: picture.shape[0] - 1, :: picture.shape[1] - 1].ravel()
    missing = np.zeros(picture.shape, np.bool_)
    for value in np.unique(np.append(corners, (picture.min(), picture.max()))):
        same = _grown(~_grown(picture != value))
        if np.count_nonzero(same) < _LEAST_MISSING:
            continue
        beside = _grown(same) & ~same
        off = np.abs(picture[beside] - value)
        if len(off) == 0 or not off.min() > 0.0:
            off = off[off > 0.0]  # what the opening has cut off of the area
        if len(off) < _LEAST_SIDE // 2 or len(np.unique(off)) < _LEAST_VALUES:
            continue
        usual = max(float(np.median(off)), float(np.ptp(picture[picture != value])))
        if float(np.quantile(off, _FEW)) > _APART * usual:
            missing |= same | ((picture == value) & _grown(_grown(same)))
    return missing if missing.any() and not missing.all() else None


def clear_of(*, missing: NDArray[np.bool_], farthest: int) -> NDArray[np.float64]:
    """How many samples each sample is away from missing ones, across, down or both, to a limit."""
    from scipy import ndimage  # imported where it is used: start-up time

    away = ndimage.distance_transform_cdt(~missing, "chessboard")
    return np.asarray(np.minimum(away, farthest), np.float64)


def _grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """True where one of the 3 × 3 samples about a sample is."""
    wide = np.pad(mask, 1)
    down = wide[:-2] | wide[1:-1] | wide[2:]
    return np.asarray(down[:, :-2] | down[:, 1:-1] | down[:, 2:], np.bool_)


def row_shift(*, picture: NDArray[np.floating]) -> tuple[float, float]:
    """By how many samples the odd rows lie to the right of the even ones, and standard error.

    Notes
    -----
    A row less the mean of its neighbours is its slope times the shift, with a sign that changes
    from row to row; of straight edges it has no such sign. The error is from strips of rows.
    """
    rows = picture.shape[0]
    tops = np.linspace(0, rows - 4, _STRIPS + 1).astype(np.intp)
    products, squares = np.zeros(_STRIPS), np.zeros(_STRIPS)
    for k in range(_STRIPS):
        part = np.asarray(picture[tops[k] : tops[k + 1] + 4], np.float64)
        off = part[1:-1] - (part[:-2] + part[2:]) / 2.0
        both = (part[:-2] + 2.0 * part[1:-1] + part[2:]) / 4.0
        slope = (both[:, 2:] - both[:, :-2]) / 2.0
        odd = (np.arange(len(off)) + tops[k] + 1) % 2 * 2 - 1  # 1 in odd rows
        products[k] = -np.sum(odd[:, np.newaxis] * off[:, 1:-1] * slope)
        squares[k] = np.sum(slope**2)
    return _ratio(products, squares)


def mosaic_detail(*, picture: NDArray[np.floating]) -> tuple[float, float]:
    """How much finer detail has one diagonal of each 2 × 2 samples than the other, and its error.

    As a difference of logarithms, summed over the two samples of a diagonal; its standard error is
    from strips of rows. Detail is what a sample departs from the mean of its four neighbours, its
    median over the picture. Samples that were made of their neighbours have less. Rows or columns
    of two amplifiers differ too, but then both diagonals have one of each.
    """
    rows = picture.shape[0]
    tops = np.linspace(0, (rows - 4) // 2, _STRIPS + 1).astype(np.intp) * 2
    strips = []
    for k in range(_STRIPS):
        part = np.asarray(picture[tops[k] : tops[k + 1] + 4], np.float64)
        around = part[:-2, 1:-1] + part[2:, 1:-1] + part[1:-1, :-2] + part[1:-1, 2:]
        detail = np.abs(part[1:-1, 1:-1] - around / 4.0)
        least = _LEAST_DETAIL * float(detail.mean())
        if not least > 0.0:
            continue
        logs = [
            [math.log(float(np.median(detail[i::2, j::2])) + least) for j in (0, 1)] for i in (0, 1)
        ]
        strips.append(logs[0][0] + logs[1][1] - logs[0][1] - logs[1][0])
    if len(strips) < _STRIPS // 2:
        return 0.0, math.inf
    return float(np.mean(strips)), float(np.std(strips, ddof=1)) / math.sqrt(len(strips))


def _ratio(products: Vector, squares: Vector) -> tuple[float, float]:
    """Ratio of two sums over strips, and its standard error by leaving out each strip."""
    total, below = float(products.sum()), float(squares.sum())
    if not below > 0.0:
        return 0.0, math.inf
    others = (total - products) / np.maximum(below - squares, 1e-300 + 1e-9 * below)
    count = len(products)
    error = math.sqrt((count - 1) / count * float(np.sum((others - others.mean()) ** 2)))
    return total / below, error
