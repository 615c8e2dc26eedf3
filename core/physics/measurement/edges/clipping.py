"""Signs that samples of an edge were cut off at a limit, where its MTF would be a wrong one.

A clipped side has no noise, while the rest has; without noise it looks as of a sharper camera.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.found_edge import FoundEdge, edge_samples

Vector = NDArray[np.float64]

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
            f"clipped: {share:.0%} of the edge's samples are at a limit" if share > _SHARE else ""
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
            f"clipped: {share:.0%} of the samples on one side are at the limit of the picture's "
            f"values, {limit:.6g}"
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
                f"the picture's values, but the noise of the step is {noise / contrast:.2g} of "
                "the contrast"
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
                    f"clipped: {shares[place]:.0%} of the edge's samples are at {limit:.6g}, the "
                    f"limit of the picture's values, at which {many} other edges are clipped"
                )
                made[place] = replace(made[place], used=False, why_not=reason)
    return made


def _piled_up(side: Vector, limit: float) -> bool:
    """Whether samples at a limit are far more than those of any other value."""
    others, counts = np.unique(side[side != limit], return_counts=True)
    return len(others) >= _OTHERS and len(side) - counts.sum() > _TIMES * int(counts.max())


def _quantum(value: Vector) -> float:
    """Step between the levels of a quantized picture; next to nothing, of any other."""
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
