"""Noise of a camera from one picture: of a sample, over the level, by its kinds.

It is what is random from sample to sample: shot and read noise, and rounding; not rows and columns.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Mask, Matrix, Vector, block_means
from core.errors import DataError, percent
from core.kernels import special
from core.physics.measurement import sample_noise
from core.physics.measurement.flat_blocks import (
    FINE,
    SIDE,
    FlatBlocks,
    PictureBlocks,
    VarianceLine,
    clear_of_ends,
    flat_blocks,
    picture_blocks,
    variance_line,
)
from core.physics.measurement.sample_noise import LineNoise, SampleNoise, no_noise
from core.physics.noise.noise_components import MeasuredNoise, NoiseCube

_COMPRESSED = (
    f"the picture was compressed in blocks of {SIDE} × {SIDE} samples, as JPEG does, so the "
    "noise is no longer the camera's"
)
_LEAST_BLOCKS = 24
_COARSE_STEPS = 0.5  # deviations of the noise in steps, below which rounding does not add 1/12
_HIDDEN_SHARE = 0.4  # of the blocks of noise that differs from place to place
_STILL, _STILL_SHARE = 1e-11, 0.05  # of the power: what single precision leaves; of the blocks
_SMALLEST, _LARGEST = 1e-12, 1e15  # numbers whose squares single precision holds
_WHITE = 0.1  # by which middle waves may exceed fine ones
_LEAST_UNEVEN = 0.3  # of the blocks, where the noise of one place does not vouch for another's
_COARSE_UNEVEN = 0.5  # by which coarse waves may exceed fine ones there
_LACKING, _SURE = 0.08, 4.0  # of the fine waves' power, and standard errors of chance
# Sigma is given where it is known to 3 % with a confidence of 95 %.
_WITHIN, _CONFIDENCE = 0.03, 1.96


def noise_of_picture(
    *,
    picture: Matrix,
    avoid: Mask | None = None,
    offset: float = 0.0,
    check: Callable[[], None] = lambda: None,
) -> SampleNoise:
    """Measure the noise in the flat parts of a picture.

    Parameters
    ----------
    avoid : ndarray of bool, optional
        Samples that do not count.
    offset : float
        Level without light, for the read noise.

    Raises
    ------
    DataError
        If the picture is no matrix of finite samples, or is smaller than a block.

    Notes
    -----
    Source: the choice of flat blocks by their coarse waves, and the variance of their fine ones,
    after Ponomarenko et al. 2007 (8 × 8 cosine transform); the line over the level as Foi et al.
    2008, fitted to the blocks themselves.
    """
    if picture.ndim != 2 or min(picture.shape) < SIDE:
        raise DataError(
            f"noise needs a picture of at least {SIDE} × {SIDE} samples, not "
            f"{' × '.join(map(str, picture.shape))}"
        )
    if avoid is not None and avoid.any() and not avoid.all():
        picture = np.where(avoid, np.median(picture[~avoid]), picture)
    largest = float(np.abs(picture).max())
    if largest > _LARGEST or 0.0 < largest < _SMALLEST:
        raise DataError(
            "noise can be measured only if the picture's largest number is between "
            f"{_SMALLEST:g} and {_LARGEST:g}, not {largest:.3g}. Give the picture in another "
            "unit"
        )
    low, high = sample_noise.clipped_ends(picture=picture)
    good = sample_noise.samples_that_count(picture=picture, avoid=avoid, low=low, high=high)
    blocks = picture_blocks(picture=picture, good=good, check=check)
    check()
    if avoid is not None and avoid.all():
        return no_noise(
            "no samples are left to measure", mean_level=math.nan, offset_dn=offset, step=None
        )
    mean = float(picture.mean() if avoid is None else picture[~avoid].mean())
    step = sample_noise.rounding_step(picture=picture)
    check()
    known: dict[str, Any] = {"mean_level": mean, "offset_dn": offset, "step": step}
    if sample_noise.compressed_in_blocks(picture=picture):
        return no_noise(_COMPRESSED, **known)
    enough = len(blocks.level) >= _LEAST_BLOCKS
    if enough and _still(blocks):
        return no_noise(_hidden(step), **known)
    flat = None
    if enough:
        hidden = 0.0 if step is None else (_COARSE_STEPS**2 + 1.0 / 12.0) * step**2
        flat = flat_blocks(blocks=blocks, at=mean, least=hidden, low=low, high=high)
    if flat is None or np.count_nonzero(flat.chosen) < _LEAST_BLOCKS:
        return no_noise(
            f"too few flat blocks of {SIDE} × {SIDE} samples: "
            f"{0 if flat is None else np.count_nonzero(flat.chosen)}; needed: at least "
            f"{_LEAST_BLOCKS} (texture or edges are everywhere)",
            **known,
        )
    return _measured(blocks, flat, mean, step, offset, check)


def _still(blocks: PictureBlocks) -> bool:
    least = _STILL * blocks.power.mean(axis=1) + (_STILL * blocks.level) ** 2
    still = np.count_nonzero(blocks.mean_power(FINE) <= least)
    return bool(still > _STILL_SHARE * len(blocks.level))


def _hidden(step: float | None) -> str:
    if step is None:
        return "the flat areas have no noise"
    return f"the noise is smaller than the converter's step of {step:.4g} and is hidden by rounding"


def _measured(
    blocks: PictureBlocks,
    flat: FlatBlocks,
    mean: float,
    step: float | None,
    offset: float,
    check: Callable[[], None],
) -> SampleNoise:
    level, variance = blocks.level[flat.chosen], flat.variance[flat.chosen]
    rounding = 0.0 if step is None else step**2 / 12.0
    line = flat.line if step is None else flat.line.rounded(level=level, step=step)
    if flat.even:
        at_mean, error = line.bounded(offset).at(mean)
    else:
        at_mean, error = flat.mean()
    refusal = _refusal(blocks, flat)
    if not refusal and (at_mean <= 0.0 or _CONFIDENCE * error > 2.0 * _WITHIN * at_mean):
        known = "Sigma has no value"
        if at_mean > 0.0:
            by = percent(0.5 * _CONFIDENCE * error / at_mean, 1)
            known = f"Sigma is {math.sqrt(at_mean):.4g}, uncertain by {by} at 95 % confidence"
        refusal = (
            f"the flat areas ({len(level)} blocks at levels {level.min():.4g} to "
            f"{level.max():.4g}) do not determine the noise at the picture's mean level, "
            f"{mean:.4g}, accurately enough. {known}; allowed uncertainty: "
            f"at most {percent(_WITHIN)}"
        )
    if not refusal and step is not None:
        shown = rounding + (_COARSE_STEPS * step) ** 2
        # Blocks scatter: of those just above the limit a third come out below it.
        if at_mean < shown or (not flat.even and np.mean(variance < shown) > _HIDDEN_SHARE):
            refusal = _hidden(step)
    if refusal:
        return no_noise(refusal, mean_level=mean, offset_dn=offset, step=step)
    remarks = []
    if flat.even:
        figures = sample_noise.gain_and_read_noise(
            line=line, level=level, rounding=rounding, offset=offset
        )
    else:
        reason = "the noise varies across the picture by more than the signal level explains"
        remarks.append(
            reason
            + " (the camera filters noise, or the scene has fine texture), so sigma is the square "
            "root of the mean variance"
        )
        figures = {"gain_reason": reason, "read_noise_reason": reason}
    sigma = math.sqrt(at_mean)
    down, across = np.divmod(blocks.place[flat.chosen], blocks.grid[1])
    model = flat.line.over(level)
    rows = line_noise(waves=blocks.rows[flat.chosen], noise=model, line=down)
    check()
    columns = line_noise(waves=blocks.columns[flat.chosen], noise=model, line=across)
    for name, part in (("rows", rows), ("columns", columns)):
        if part is not None and part.significant and part.sigma > sigma:
            remarks.append(
                f"whole {name} differ by {part.sigma:.3g}, more than the noise of one sample; "
                "the differences may be a pattern in the scene"
            )
    return SampleNoise(
        mean_level=mean,
        offset_dn=offset,
        step=step,
        sigma=sigma,
        sigma_error=error / (2.0 * sigma),
        levels=sample_noise.level_variances(level=level, variance=variance),
        rows=rows,
        columns=columns,
        remarks=tuple(remarks),
        **figures,
    )


def _refusal(blocks: PictureBlocks, flat: FlatBlocks) -> str:
    structure = flat.structure
    falls = structure.middle > _WHITE + 3.0 * structure.middle_error
    if falls:
        return (
            "the noise of the flattest areas falls towards high frequencies (power "
            f"low:middle:high = {1 + structure.coarse:.2f}:{1 + structure.middle:.2f}:1): the "
            "picture was blurred after the noise was added, or there is texture everywhere"
        )
    if structure.middle < -_WHITE - 3.0 * structure.middle_error:
        return (
            "the noise of the flattest areas rises towards high frequencies (power middle:high = "
            f"{1 + structure.middle:.2f}:1): the picture was sharpened, "
            "or a fine pattern covers it"
        )
    if structure.coarse < -max(_LACKING, _SURE * structure.coarse_error):
        return (
            "the noise of the flattest areas rises towards high frequencies (low frequencies "
            f"have {1 + structure.coarse:.2f} times the power of high ones): the picture was "
            "sharpened after the noise was added"
        )
    if abs(flat.lean) > _WHITE + 3.0 * flat.lean_error:
        first, then = ("rows", "columns") if flat.lean > 0.0 else ("columns", "rows")
        return (
            f"the noise of the flattest areas falls more along the {first} than along the "
            f"{then} (at middle frequencies, by {abs(flat.lean):.2f} times the high-frequency "
            f"power). The picture was blurred along the {first} after the noise "
            "was added, or there is texture everywhere"
        )
    share = np.count_nonzero(flat.chosen) / math.prod(blocks.grid)
    if not flat.even and (share < _LEAST_UNEVEN or structure.coarse > _COARSE_UNEVEN):
        return (
            f"no areas of uniform noise: {percent(share)} of the picture seems flat, but its low "
            f"frequencies have {1 + structure.coarse:.2f} times the power of the high ones, "
            "so there is texture everywhere"
        )
    return ""


# What whole rows, or columns, of a picture have of their own.

_LEAST_IN_ROW = 4  # flat blocks, for a median of a row of blocks
_LEAST_ROWS = 4  # rows of blocks
_NORMAL = 1.4826  # deviation over the median of absolute deviations, of a normal distribution
_MEDIAN = math.pi / 2.0  # variance of a median over that of a mean
_MEDIAN_SQUARE = 0.4549  # of a normal deviate
_FAR_SQUARE, _WITHIN_FAR, _MEAN_WITHIN = 9.0, 0.9973, 0.9733  # share, and mean square, below 3 σ
_ROUNDS = 30


def line_noise(
    *, waves: NDArray[np.float32], noise: Vector, line: NDArray[np.intp]
) -> LineNoise | None:
    """Offsets of rows from the waves down of the blocks that lie side by side.

    `waves` are coefficients of waves down, constant across, shape (blocks, waves); `noise` is the
    variance of a sample of each block, and `line` its row. What a row has of its own is common to
    all blocks of it, and so in their median, beyond the chance that their scatter leaves there. An
    edge along some blocks does not move a median; along all of them it is left out, as more than
    three deviations of the others.
    """
    order = np.argsort(line, kind="stable")
    ends = np.flatnonzero(np.diff(line[order])) + 1
    middles, spreads, chances = [], [], []
    for part in np.split(order, ends):
        if len(part) < _LEAST_IN_ROW:
            continue
        values = waves[part] / np.sqrt(noise[part])[:, np.newaxis]
        middle = np.median(values, axis=0)
        # The deviation of few values comes out low by that much.
        less = len(part) / (len(part) - 0.8)
        spreads.append((less * _NORMAL * np.median(np.abs(values - middle), axis=0)) ** 2)
        middles.append(np.median(waves[part], axis=0))
        density = float(np.mean(1.0 / np.sqrt(noise[part])))  # at the median, of unlike normals
        chances.append(_MEDIAN / (len(part) * density**2))
    if len(middles) < _LEAST_ROWS:
        return None
    # Scatter beyond the white noise, that of structure, is that of its wave all over the picture.
    scatter = np.median(spreads, axis=0)
    square = np.square(middles).ravel().astype(np.float64)
    chance = np.outer(chances, scatter).ravel()
    if not chance.min() > 0.0:
        return None
    own, error = _common_variance(square, chance)
    # A wave down of offsets σ is SIDE · σ² in an orthonormal transform of SIDE equal columns.
    return LineNoise(own / SIDE, error / SIDE)


def _common_variance(square: Vector, chance: Vector) -> tuple[float, float]:
    """Variance beyond chance that normal deviates with these squares have, and its error."""
    low, high = -float(chance.min()), float(square.max())
    for _ in range(60):
        middle = 0.5 * (low + high)
        if float(np.median(square / np.maximum(middle + chance, 1e-300))) > _MEDIAN_SQUARE:
            low = middle
        else:
            high = middle
    own = high
    for _ in range(_ROUNDS):
        total = max(own, 0.0) + chance
        near = square < _FAR_SQUARE * total
        weight = 1.0 / total[near] ** 2
        scale = _WITHIN_FAR / _MEAN_WITHIN
        before = own
        own = float(weight @ (scale * square[near] - chance[near]) / weight.sum())
        if abs(own - before) <= 1e-6 * float(total.mean()):
            break
    total = max(own, 0.0) + chance
    return own, math.sqrt(2.0 / float((1.0 / total**2).sum()))


# Noise of frames of one scene that does not move: by kinds, and temporal noise over the level.

_KEPT = 0.999  # of the blocks of noise alone that count
_MOVED = 0.3  # of the blocks with more, beyond which the scene moves
_MOVES = 6.0  # deviations of what differs from the first frame, beyond which something moves
_TRIM_ROUNDS = 10
_MOST_GROUPS = 16  # of levels
_TEMPORAL = "the noise figures contain temporal noise only, no fixed-pattern noise"


class SceneFrames:
    """Takes frames of a scene, of 2 rows and columns or more, one by one; keeps sums alone.

    A sample's variance in time needs no flat area. What whole rows, columns and frames share is
    taken off each frame against the first, by the means of their difference where nothing passes
    through.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._cube = NoiseCube(rows, columns)
        self._first: Matrix | None = None
        self._squares = np.zeros((rows, columns))
        self._own = np.zeros((rows, columns))
        self._still_squares = np.zeros((rows, columns))
        self._frames = 0

    def add(self, frame: NDArray[Any]) -> None:
        """Take another frame, shape (rows, columns)."""
        samples = np.asarray(frame, np.float64)
        if not np.isfinite(samples).all():
            raise DataError(
                "a frame has samples that are not finite numbers, so the noise cannot be measured"
            )
        self._cube.add(samples)
        if self._first is None:
            self._first = samples.copy()
        away = samples - self._first
        still = _still_samples(away)
        away -= _means(away, still, 1)
        away -= _means(away, still, 0)
        self._own += away
        away *= away
        self._squares += away
        away *= still
        self._still_squares += away
        self._frames += 1

    def measured(self, *, offset: float = 0.0) -> tuple[SampleNoise, MeasuredNoise]:
        """The noise of the frames so far, two or more; `offset` is the level without light.

        First what changes from frame to frame, without what whole rows, columns and frames share;
        then the seven components of 3-D noise, of which the fixed ones hold the scene.
        """
        components = self._cube.measured()
        n = self._frames
        assert self._first is not None
        variance = (self._squares - self._own**2 / n) / (n - 1)
        # Of that, what went into the means of rows and columns.
        share = self._still_squares / np.maximum(self._squares, np.finfo(np.float64).tiny)
        variance = _with_means(variance, variance * share)
        low, high = sample_noise.clipped_ends(picture=self._first)
        step = sample_noise.rounding_step(picture=self._first)
        level, power = (block_means(of, SIDE).ravel() for of in (self._first, variance))
        freedom = (n - 1) * SIDE * SIDE
        rounding = 0.0 if step is None else step**2 / 12.0
        line, chosen, reason = _settled(level, power, freedom, low, high)
        known: dict[str, Any] = {"mean_level": components.mean, "offset_dn": offset, "step": step}
        if float(np.median(power)) <= rounding + (_COARSE_STEPS * (step or 0.0)) ** 2:
            reason = "rounding hides the noise" if step else "the frames have no temporal noise"
        if line is None or reason:
            return no_noise(reason, **known), components
        at_mean, error = line.bounded(offset).at(components.mean)
        level, power = level[chosen], power[chosen]
        noise = SampleNoise(
            sigma=math.sqrt(at_mean),
            sigma_error=error / (2.0 * math.sqrt(at_mean)),
            levels=sample_noise.level_variances(level=level, variance=power),
            remarks=(_TEMPORAL,),
            **known,
            **sample_noise.gain_and_read_noise(
                line=line, level=level, rounding=rounding, offset=offset
            ),
        )
        return noise, components


def _still_samples(away: Matrix) -> NDArray[np.bool_]:
    """Samples that differ from the first frame's as most do: what passes through the scene not."""
    from_most = np.abs(away - np.median(away))
    spread = _NORMAL * float(np.median(from_most))
    if not spread > 0.0:
        return np.ones(away.shape, bool)
    return np.asarray(from_most <= _MOVES * spread)


def _means(away: Matrix, still: NDArray[np.bool_], axis: int) -> Matrix:
    """Means along an axis of what stands still; of all, where that is less than half."""
    counts = still.sum(axis=axis, keepdims=True)
    enough = 2 * counts >= away.shape[axis]
    of_still = np.sum(away, axis=axis, keepdims=True, where=still) / np.maximum(counts, 1)
    return np.asarray(np.where(enough, of_still, away.mean(axis=axis, keepdims=True)))


def _with_means(variance: Matrix, averaged: Matrix) -> Matrix:
    """Variances of samples, of those of the samples less the means of their rows and columns.

    `averaged` is the part of their variance that went into the means, both of shape (rows,
    columns). A sample less the mean of n that it is in has lost 2/n of its own variance, and got
    1/n of the mean variance of all n: shot noise of what is bright beside it. Exact for equal
    variances.
    """
    rows, columns = variance.shape
    whole = averaged / ((1.0 - 1.0 / rows) * (1.0 - 1.0 / columns))
    return np.asarray(
        variance
        + whole * (2.0 / rows + 2.0 / columns)
        - whole.mean(axis=1, keepdims=True) / columns
        - whole.mean(axis=0, keepdims=True) / rows
        - whole.mean() / (rows * columns)
    )


def _settled(
    level: Vector, power: Vector, freedom: int, low: float | None, high: float | None
) -> tuple[VarianceLine | None, NDArray[np.bool_], str]:
    """Line through the blocks that have no more than noise, these, and why there is none."""
    inside = clear_of_ends(level=level, variance=power, low=low, high=high)
    if np.count_nonzero(inside) < _LEAST_BLOCKS:
        reason = (
            f"fewer than {_LEAST_BLOCKS} blocks of {SIDE} × {SIDE} samples are free of clipping"
        )
        return None, inside, reason
    limit = 2.0 * float(special("gammaincinv")(freedom / 2.0, _KEPT)) / freedom
    chosen = inside & (power <= 2.0 * _by_level(level, power, inside))
    for _ in range(_TRIM_ROUNDS):
        if np.count_nonzero(chosen) < _LEAST_BLOCKS:
            return None, inside, _it_moves(1.0)
        line = variance_line(level=level[chosen], variance=power[chosen])
        before, chosen = chosen, inside & (power <= limit * line.over(level))
        if np.array_equal(before, chosen):
            break
    moved = 1.0 - np.count_nonzero(chosen) / np.count_nonzero(inside)
    if moved > _MOVED or np.count_nonzero(chosen) < _LEAST_BLOCKS:
        return None, chosen, _it_moves(moved)
    return line, chosen, ""


def _it_moves(share: float) -> str:
    return (
        f"{percent(share)} of the pixels change between the frames: the scene or the camera moved"
    )


def _by_level(level: Vector, power: Vector, inside: NDArray[np.bool_]) -> Vector:
    """Median variance of the blocks of about a block's level: bright ones have more by light alone.

    Where most blocks are dark, that of all blocks would leave out every bright one.
    """
    order = np.flatnonzero(inside)[np.argsort(level[inside], kind="stable")]
    groups = min(max(len(order) // _LEAST_BLOCKS, 1), _MOST_GROUPS)
    usual = np.zeros_like(power)
    for group in np.array_split(order, groups):
        usual[group] = np.median(power[group])
    return usual
