"""An edge found in a picture: where it runs, and what of the picture belongs to it."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.arrays import Index, Mask, Vector
from core.errors import percent
from core.physics.measurement.sample_noise import compressed_in_blocks
from core.records import dataclass, replace


@dataclass(frozen=True)
class FoundEdge:
    """A straight, or slightly bent, step between two levels of a picture."""

    # its middle; that of the sample in row i and column j is x = j, y = i
    x: float
    y: float
    angle_deg: float  # of the normal to the brighter side, from the x axis to +y, in (-180, 180]
    length: float  # samples
    reach: float  # samples on both sides, along the normal, that belong to this edge alone
    # levels on both sides
    low: float
    high: float
    noise_sigma: float  # of a sample on the flat sides, mean square of both
    why_not: str = ""  # why its MTF cannot be measured; empty where it can
    bend: float = 0.0  # samples, to the brighter side, of both ends off the line through the middle
    # standard deviation of the Gaussian with the line spread's height, samples, the height taken
    # after a blur of one sample; 0 where it was not measured
    softness: float = 0.0

    @property
    def used(self) -> bool:
        """Whether its MTF can be measured."""
        return not self.why_not

    @property
    def contrast(self) -> float:
        """Difference of the levels."""
        return self.high - self.low

    @property
    def normal(self) -> tuple[float, float]:
        """Unit vector (x, y) towards the brighter side."""
        angle = math.radians(self.angle_deg)
        return math.cos(angle), math.sin(angle)

    @property
    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The two ends (x, y) of the edge."""
        (across_x, across_y), half = self.normal, self.length / 2.0
        x, y = self.x + self.bend * across_x, self.y + self.bend * across_y
        return (
            (x + half * across_y, y - half * across_x),
            (x - half * across_y, y + half * across_x),
        )


# The samples of a picture that belong to an edge, by their distance from it.


@dataclass(frozen=True)
class EdgeSamples:
    """Samples about an edge, in the order of the picture's rows."""

    # of each sample's middle from the edge along its normal, positive on the brighter side
    distance: Vector
    along: Vector  # place along the edge, 0 at its middle
    value: Vector
    column: Index  # where each is in the picture
    row: Index

    def taken(self, which: Mask | Index) -> "EdgeSamples":
        """Some of them, by a mask or in an order."""
        distance, along, value = self.distance[which], self.along[which], self.value[which]
        return EdgeSamples(distance, along, value, self.column[which], self.row[which])


def edge_samples(*, picture: NDArray[np.floating], edge: FoundEdge) -> EdgeSamples:
    """Take the samples within an edge's reach and length; bent, its course is a parabola."""
    across_x, across_y = edge.normal
    half_length, wide = edge.length / 2.0, edge.reach + abs(edge.bend)
    half_x = abs(across_x) * wide + abs(across_y) * half_length
    half_y = abs(across_y) * wide + abs(across_x) * half_length
    rows, columns = picture.shape
    top, left = max(0, math.ceil(edge.y - half_y)), max(0, math.ceil(edge.x - half_x))
    bottom = max(top, min(rows, math.floor(edge.y + half_y) + 1))
    right = max(left, min(columns, math.floor(edge.x + half_x) + 1))
    x = np.arange(left, right) - edge.x
    y = (np.arange(top, bottom) - edge.y)[:, np.newaxis]
    along = across_x * y - across_y * x
    distance = across_x * x + across_y * y - edge.bend * (along / half_length) ** 2
    inside = (np.abs(distance) <= edge.reach) & (np.abs(along) <= half_length)
    value = picture[top:bottom, left:right][inside].astype(np.float64)
    row, column = np.nonzero(inside)
    return EdgeSamples(distance[inside], along[inside], value, column + left, row + top)


# Signs that samples of an edge were cut off at a limit, where its MTF would be a wrong one.
#
# A clipped side has no noise, while the rest has; without noise it looks as of a sharper camera.

_SHARE = 0.02  # of an edge's samples, at a limit that is known
_PILED = 0.1  # of a side's, at one that is not
_ALL_AT_LIMIT = 0.9  # of a side's
_OTHERS, _TIMES = 4, 3  # other values of a side that has noise; as often as any of them
_BESIDE = 3.0  # samples from the edge, where its sides begin
_NOISE_MATTERS = 1e-3  # of the contrast: less on a side may be the end of the step
_NOISE_SHOWS = 3e-3  # of the contrast, on the step, where a line that is a little askew leaves 1e-3
_QUIET = 0.1  # of the other side's noise
_LEAST_CUT, _LEAST_CUT_SHARE = 2, 0.3  # edges that show a limit to others which reach it
_LEAST_SAMPLES, _SPACING = 10, 0.125  # of a half of the step, and samples between neighbours
_FADED, _SURE = 0.52, 2.5  # of the bright side's noise, of photons; times the doubt of that


def why_clipped(
    *,
    value: Vector,
    distance: Vector,
    extremes: tuple[float, float],
    clip_levels: tuple[float, float] | None = None,
    askew: float = 0.0,
) -> str:
    """Why an edge is taken as clipped; empty if it is not.

    Parameters
    ----------
    distance : ndarray
        Of the samples from the edge, positive on the brighter side.
    extremes : tuple of float
        Least and largest sample of the picture.
    clip_levels : tuple of float, optional
        Lowest and highest level that a sample can have.
    askew : float
        What looks like noise on the step, as the edge's course is not known better.

    Notes
    -----
    Where the limits are not known, a side shows noise that was cut off by many samples of exactly
    the picture's extreme value, far more than of any other. A side with that value alone was cut
    off if the other side or the step has noise; that of photons fades by itself towards 0.
    """
    if clip_levels is not None:
        share = float(np.mean((value <= clip_levels[0]) | (value >= clip_levels[1])))
        return (
            f"clipped: {percent(share)} of the edge's samples are at a clipping level"
            if share > _SHARE
            else ""
        )
    contrast, half = float(np.ptp(value)), 0.5 * float(np.abs(distance).max(initial=0.0))
    sides = value[distance < -_BESIDE], value[distance > _BESIDE]
    if not contrast > 0.0 or not len(sides[0]) or not len(sides[1]):
        return ""
    near = value[np.abs(distance) < _BESIDE]
    shares = [float(np.mean(side == limit)) for side, limit in zip(sides, extremes, strict=True)]
    for bright, (side, share, limit) in enumerate(zip(sides, shares, extremes, strict=True)):
        if share < _PILED:
            continue
        other = sides[1 - bright]
        at_limit = (
            f"clipped: {percent(share)} of the samples on one side are at the limit of the "
            f"picture's values, {limit:.6g}"
        )
        if share < _ALL_AT_LIMIT:
            # Near the edge a side without noise has the end of the step, which varies too.
            far = value[distance > half if bright else distance < -half]
            if len(far) and float(far.std()) > _NOISE_MATTERS * contrast and _piled_up(side, limit):
                return at_limit
            continue
        fades = not bright and limit == 0.0
        noisy = float(other.std()) > _NOISE_MATTERS * contrast
        if not fades and noisy and float(side.std()) < _QUIET * float(other.std()):
            return at_limit
        noise, count = _noise_of_step(value, distance, limit, contrast)
        least = _FADED * float(other.std()) * np.exp(_SURE / np.sqrt(count)) if fades else 0.0
        if noise > max(_NOISE_SHOWS * contrast, 2.0 * _quantum(near), least, askew):
            return (
                f"clipped: the samples beside the edge are constant at {limit:.6g}, the limit of "
                f"the picture's values, but the noise on the edge is {noise / contrast:.2g} "
                "times the contrast"
            )
    return ""


def without_those_at(
    *, edges: Sequence[FoundEdge], picture: NDArray[np.floating], extremes: tuple[float, float]
) -> list[FoundEdge]:
    """Refuse edges that reach an extreme value at which others were found to be cut off.

    A limit is the picture's, not an edge's; noise shows it on one edge better than on another.
    """
    made = list(edges)
    cut = [edge.why_not.startswith("clipped") for edge in made]
    for limit in extremes if sum(cut) >= _LEAST_CUT else ():
        shares = {
            place: float(np.mean(edge_samples(picture=picture, edge=edge).value == limit))
            for place, edge in enumerate(made)
            if edge.used or cut[place]
        }
        reaching = [place for place, share in shares.items() if share > _SHARE]
        many = sum(cut[place] for place in reaching)
        if many < max(_LEAST_CUT, _LEAST_CUT_SHARE * len(reaching)):
            continue
        for place in reaching:
            if made[place].used:
                reason = (
                    f"clipped: {percent(shares[place])} of the edge's samples are at {limit:.6g}, "
                    f"the limit of the picture's values, at which {many} other edges are clipped"
                )
                made[place] = replace(made[place], why_not=reason)
    return made


def _piled_up(side: Vector, limit: float) -> bool:
    """Whether samples at a limit are far more than those of any other value."""
    others, counts = np.unique(side[side != limit], return_counts=True)
    return len(others) >= _OTHERS and len(side) - counts.sum() > _TIMES * int(counts.max())


def _quantum(value: Vector) -> float:
    gaps = np.diff(np.unique(value))
    return float(gaps.min()) if len(gaps) else 0.0


def _noise_of_step(
    value: Vector, distance: Vector, limit: float, contrast: float
) -> tuple[float, int]:
    """Noise on the half of the step beside a limit, and of how many samples."""
    away = np.abs(value - limit) / contrast
    inside = (away > 0.1) & (away < 0.46) & (np.abs(distance) < _BESIDE)
    order = np.argsort(distance[inside], kind="stable")
    place, level = distance[inside][order], value[inside][order]
    gap = place[2:] - place[:-2]
    close = (gap < _SPACING) & (gap > 0.0)
    count = int(np.count_nonzero(close))
    if count < _LEAST_SAMPLES:
        return 0.0, max(count, 1)
    share = (place[1:-1] - place[:-2])[close] / gap[close]
    off = level[1:-1][close] - (1.0 - share) * level[:-2][close] - share * level[2:][close]
    return float(np.sqrt(np.mean(off**2 / (1.0 + share**2 + (1.0 - share) ** 2)))), count


# Signs that a picture was made so that no edge of it shows the camera's blur.


_STRIPS = 16  # parts of a picture, whose differences give the doubt
_SURE_SIGN = 6.0  # standard errors
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
    if abs(shift) > max(_LEAST_SHIFT, _SURE_SIGN * shift_error):
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
    if not abs(mosaic) > max(_MOSAIC, _SURE_SIGN * mosaic_error):
        return ""
    return (
        "interpolated: the samples on one half of a checkerboard have "
        f"{math.exp(abs(mosaic) / 2.0):.2g} times the fine detail of the other half, a sign of "
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
