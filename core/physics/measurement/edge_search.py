"""Find the edges of a picture from which an MTF can be measured, and why others cannot be used."""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from core.arrays import Matrix, Vector
from core.errors import percent, several
from core.physics.measurement import found_edge, ridges
from core.physics.measurement.spread_fit import SpreadFit, fit_spread
from core.records import replace

_LARGEST_REACH = 20
_BEYOND = 2  # samples beyond the reach that are looked at, for a neighbour's blur
_LEAST_REACH = 5
_LEAST_LENGTH = 11.0
_LEAST_CONTRAST = 5.0  # of the noise, for the longest edges
_CONTRAST_OF_16 = 10.0  # the same for one of 16 samples
_REACHES = (20, 16, 13, 10, 8, 6, 5)
_ENOUGH_REACH = 16.0  # beyond which more reach is worth no length
_CELL = 3.0  # samples along the edge
_LEVEL = 0.04  # of the contrast, by which a level side may differ across it
_ALIKE = 0.06  # of the contrast, by which pieces of the edge may differ
_NEIGHBOUR = 0.2  # of the contrast, that the level just beyond the reach may differ by
_OVERSHOOT = 0.35  # of the contrast, beyond the levels
_SURE = 4.0  # standard errors
_STEEP = 2  # samples beside an edge where its level changes fast
_ENDS = 1.0  # samples left off at both ends, where corners are rounded
_LARGEST_GAP = 0.7  # samples between distances; beyond 0.75 nothing can be measured
_BENT_REACH = 4.0  # least radius of a bent edge, in its reaches
_ENOUGH_USED = 48  # edges of a picture
_LEAST_EXAMINED, _MOST_EXAMINED = 400, 1500  # candidates of a picture
_SAMPLES_EXAMINED = 10_000  # of a picture, for each candidate between these numbers
_BLURRED = 2.0  # times a step's contrast may be what its gradient says, for its blur
_LEAST_SOFTNESS = 0.5  # samples, below which none is softer than another
_WIDTHS_IN_REACH = 5.5  # so many standard deviations, and nothing of a Gaussian is left
_NEAR, _LEAST_STEP = 3.0, 0.3  # samples about an edge, and between its two levels


def find_edges(
    *,
    picture: NDArray[np.floating],
    clip_levels: tuple[float, float] | None = None,
    interpolated_too: bool = False,
    check: Callable[[], None] = lambda: None,
) -> tuple[found_edge.FoundEdge, ...]:
    """Find straight, isolated, unclipped steps of a picture.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite. Those that hold one number in place of data
        (`missing_samples`) are left out.
    clip_levels : tuple of float, optional
        Lowest and highest level that a sample can have.
    interpolated_too : bool
        Whether edges of a picture made of a mosaic of colour filters are used.

    Returns
    -------
    tuple of FoundEdge
        All candidates, those used first, by their contrast over the noise and their length.

    Where there are many, the clearest are looked at first, by the root of their length times their
    slope, spread over frame and directions, until 48 can be used: what the edges of a picture share
    in error is by then larger than what more of them would take off.

    Sources: van den Bergh, MTF Mapper (edges as pieces of outlines with one direction, samples
    by their distance, edges at 45° and 26.57° named); van Zwanenberg, Triantaphillidou, Jenkin
    and Psarrou, Edge detection techniques for quantifying spatial imaging system performance and
    image quality, 2019, and Natural scene derived camera edge spatial frequency response, 2021
    (step test in each row, other edges masked, steps isolated in natural scenes).
    """
    picture = np.asarray(picture)
    missing = found_edge.missing_samples(picture=picture)
    clear = None
    if missing is not None:
        clear = found_edge.clear_of(missing=missing, farthest=_LARGEST_REACH + _BEYOND + 2)
        picture = np.where(missing, np.median(picture[~missing]), picture)
    share = 0.0 if missing is None else float(missing.mean())
    noise = ridges.rough_noise(picture=picture, missing=share)
    check()
    points = ridges.ridge_points(picture=picture, noise_sigma=noise, check=check)
    steep = noise / (_BLURRED * ridges.SMOOTHING * math.sqrt(2.0 * math.pi))
    pieces = ridges.straight_pieces(
        points=points,
        shape=picture.shape,
        least_length=_LEAST_LENGTH,
        least_strength=steep * _least_contrast(1e9),
        strength_of_16=steep * _least_contrast(16.0),
    )
    if clear is not None:  # the steps to missing samples are no edges
        pieces = [piece for piece in pieces if clear[round(piece.y), round(piece.x)] > _LEAST_REACH]
    extremes = (float(picture.min()), float(picture.max()))
    enough = min(max(_LEAST_EXAMINED, picture.size // _SAMPLES_EXAMINED), _MOST_EXAMINED)
    waiting = _in_turn(pieces, picture.shape)
    found: list[found_edge.FoundEdge] = []
    used = 0
    while len(found) < min(enough, len(pieces)) and used < _ENOUGH_USED:
        check()
        found.append(_examined(picture, waiting[len(found)], noise, clip_levels, extremes, clear))
        used += found[-1].used
        if used == _ENOUGH_USED or len(found) == min(enough, len(pieces)):
            found = without_soft(edges=found)
            used = sum(edge.used for edge in found)
    if clip_levels is None:
        found = found_edge.without_those_at(edges=found, picture=picture, extremes=extremes)
    reason = _enough(used, len(found))
    found.extend(replace(_rough(piece, noise), why_not=reason) for piece in waiting[len(found) :])
    reason = ""
    if any(edge.used for edge in found):
        reason = found_edge.why_no_picture(picture=picture, interpolated_too=interpolated_too)
    if reason:
        found = [replace(edge, why_not=edge.why_not or reason) for edge in found]
    found.sort(key=lambda edge: (not edge.used, -edge.length * edge.contrast))
    return tuple(found)


def _examined(
    picture: NDArray[np.floating],
    piece: ridges.Piece,
    noise: float,
    clip_levels: tuple[float, float] | None,
    extremes: tuple[float, float],
    clear: Matrix | None,
) -> found_edge.FoundEdge:
    """A piece as an edge, perhaps with the reason why it is not used."""
    rough = _rough(piece, noise)
    least = rough.contrast
    if _BLURRED * least < _least_contrast(piece.length) * noise:
        return replace(
            rough,
            why_not=f"too little contrast: about {least / noise:.2g} times the noise; an edge "
            f"of this length needs at least {_least_contrast(piece.length):.2g}",
        )
    room = _frame_reach(rough, picture.shape, clear)
    reach = min(float(room.max()), float(_LARGEST_REACH + _BEYOND))
    if reach < _LEAST_REACH:
        return replace(rough, why_not=f"too close to the frame's border: {reach:.1f} samples")
    samples = found_edge.edge_samples(picture=picture, edge=replace(rough, reach=reach))
    edge = _within_surroundings(rough, samples, reach, room)
    return edge if edge.why_not else _settled(picture, edge, clip_levels, extremes)


def _rough(piece: ridges.Piece, noise: float) -> found_edge.FoundEdge:
    return found_edge.FoundEdge(
        x=piece.x,
        y=piece.y,
        angle_deg=_turned(piece.angle_deg),
        length=piece.length,
        reach=float(_LEAST_REACH),
        low=0.0,
        high=piece.strength * ridges.SMOOTHING * math.sqrt(2.0 * math.pi),
        noise_sigma=noise,
        bend=piece.bend,
    )


def _in_turn(pieces: Sequence[ridges.Piece], shape: tuple[int, ...]) -> list[ridges.Piece]:
    order = ridges.spread_out(
        x=np.array([piece.x for piece in pieces]),
        y=np.array([piece.y for piece in pieces]),
        angle_deg=np.array([piece.angle_deg for piece in pieces]),
        merit=np.array([piece.strength * math.sqrt(piece.length) for piece in pieces]),
        shape=shape,
    )
    return [pieces[k] for k in order]


def _enough(used: int, examined: int) -> str:
    if used >= _ENOUGH_USED:
        return f"not examined: {used} stronger or better separated edges are enough"
    if used == 0:
        return f"not examined: no stronger edge can be used ({examined} examined)"
    return (
        f"not examined: weaker than {several(examined, 'other edge')} ({used} usable), or too "
        "close to one of them"
    )


def _turned(angle_deg: float) -> float:
    """An angle in (-180, 180]."""
    return 180.0 - (180.0 - angle_deg) % 360.0


def _part_of(edge: found_edge.FoundEdge, start: float, end: float) -> found_edge.FoundEdge:
    """The part of an edge from one place along it to another, on its own tangent."""
    across_x, across_y = edge.normal
    middle, half = (start + end) / 2.0, edge.length / 2.0
    off = edge.bend * (middle / half) ** 2
    tilt = math.atan(2.0 * edge.bend * middle / half**2)
    return replace(
        edge,
        x=edge.x + off * across_x - middle * across_y,
        y=edge.y + off * across_y + middle * across_x,
        angle_deg=_turned(edge.angle_deg - math.degrees(tilt)),
        length=end - start,
        bend=edge.bend * ((end - start) / edge.length) ** 2,
    )


def _settled(
    picture: NDArray[np.floating],
    edge: found_edge.FoundEdge,
    clip_levels: tuple[float, float] | None,
    extremes: tuple[float, float],
) -> found_edge.FoundEdge:
    """The edge on its fitted course, used if nothing speaks against it."""
    samples = found_edge.edge_samples(picture=picture, edge=edge)
    half_length = edge.length / 2.0
    fit = fit_spread(
        samples=samples, reach=edge.reach, half_length=half_length, coarse_turns=2, fine_turns=0
    )
    edge = _on_course(edge, fit)
    away = samples.along / half_length
    distance = samples.distance - fit.turn * away - fit.bend * away**2
    reason = found_edge.why_clipped(
        value=samples.value, distance=distance, extremes=extremes, clip_levels=clip_levels
    )
    if not reason and clip_levels is None:
        near = samples.value[np.abs(distance) < _NEAR]
        if 2.0 * _NEAR * float(np.mean(~np.isin(near, extremes))) < _LEAST_STEP:
            reason = (
                "clipped: nearly all of the edge's samples have one of two values, so the "
                "blur is mostly lost"
            )
    reason = reason or _misshapen(edge, fit)
    return replace(edge, why_not=reason)


def _misshapen(edge: found_edge.FoundEdge, fit: SpreadFit) -> str:
    if edge.reach < _WIDTHS_IN_REACH * edge.softness:
        return (
            "the edge spread is wider than the clear area around the edge: "
            f"{edge.softness:.2g} samples, in an area of {edge.reach:g} samples"
        )
    radius = (edge.length / 2.0) ** 2 / max(2.0 * abs(edge.bend), 1e-9)
    if radius < _BENT_REACH * edge.reach:
        return f"not straight: the edge bends by {abs(edge.bend):.2g} samples"
    if fit.gap > _LARGEST_GAP:
        return (
            f"not slanted enough: at {edge.angle_deg:.1f}°, the supersampled profile has "
            f"gaps of {fit.gap:.2g} samples; allowed: at most {_LARGEST_GAP:g}"
        )
    return ""


def _on_course(edge: found_edge.FoundEdge, fit: SpreadFit) -> found_edge.FoundEdge:
    """The edge turned, bent and moved as the fit has it, through the middle of the step."""
    across_x, across_y = edge.normal
    place = np.linspace(-edge.reach, edge.reach, 801)
    low, high = fit.levels
    spread = (fit.at(place) - low) / (high - low)
    middle = float(place[int(np.argmax(spread > 0.5))])
    near = place[np.abs(place) < 3.0]
    blur = -near * np.exp(-0.5 * near**2) / math.sqrt(2.0 * math.pi) * (place[1] - place[0])
    height = float(np.max(np.convolve(spread, blur, mode="valid")))
    softness = math.sqrt(max(1.0 / (2.0 * math.pi * height**2) - 1.0, 0.0)) if height > 0 else 9.0
    return replace(
        edge,
        x=edge.x + middle * across_x,
        y=edge.y + middle * across_y,
        angle_deg=_turned(edge.angle_deg - math.degrees(math.atan(fit.turn / (edge.length / 2.0)))),
        bend=edge.bend + fit.bend,
        softness=max(softness, _LEAST_SOFTNESS),
    )


# How much of a picture belongs to an edge alone: its length and reach, and what limits them.


def _cells_along(length: float) -> int:
    return max(3, round(length / _CELL))


def _frame_reach(
    edge: found_edge.FoundEdge, shape: tuple[int, ...], clear: Matrix | None
) -> Vector:
    """Samples on both sides of each cell along an edge to the frame's border, or to missing ones.

    `clear` is how far each sample of the frame is from missing ones.
    """
    across_x, across_y = edge.normal
    place = np.linspace(-0.5, 0.5, _cells_along(edge.length) + 1)
    off = edge.bend * 4.0 * place**2
    x = edge.x - place * edge.length * across_y + off * across_x
    y = edge.y + place * edge.length * across_x + off * across_y
    reach = np.full(len(place), np.inf)
    for at, across, last in ((x, across_x, shape[1] - 1), (y, across_y, shape[0] - 1)):
        if abs(across) > 1e-3:
            reach = np.minimum(reach, np.minimum(at, last - at) / abs(across))
    if clear is not None:
        row, column = (
            np.clip(np.rint(at), 0, last - 1).astype(np.intp)
            for at, last in zip((y, x), shape, strict=True)
        )
        reach = np.minimum(reach, clear[row, column] - 1.5)
    return np.asarray(np.maximum(np.minimum(reach[1:], reach[:-1]), 0.0), np.float64)


def _within_surroundings(
    edge: found_edge.FoundEdge, samples: found_edge.EdgeSamples, reach: float, room: Vector
) -> found_edge.FoundEdge:
    """The edge over the length and reach within which it is one step between level sides.

    `samples` fill its length and `reach`, `room` is beside each cell of it to the frame's border.

    The samples' means in cells of one sample by four are compared with the medians along the
    edge. Of the runs of cells that agree within 6 % of the contrast (and four standard errors of
    the noise) to a reach, the one of the largest length times reach is chosen; its sides must be
    level within 4 %.
    """
    length, noise_sigma = edge.length, edge.noise_sigma
    wide = int(min(reach, _LARGEST_REACH + _BEYOND))
    cells = _cells_along(length)
    column = np.rint(samples.distance).astype(np.intp) + wide
    row = np.clip(((samples.along / length + 0.5) * cells).astype(np.intp), 0, cells - 1)
    inside = (column >= 0) & (column <= 2 * wide)
    column, row, value = column[inside], row[inside], samples.value[inside]
    distance = samples.distance[inside]
    size = 2 * wide + 1
    profile = _medians(row * size + column, value, cells, size)
    near, far = 3, min(6, wide)
    low = float(np.median(profile[wide - far : wide - near + 1]))
    high = float(np.median(profile[wide + near : wide + far + 1]))
    contrast = high - low
    whole = _part_of(edge, -length / 2, length / 2)
    nothing = replace(whole, reach=float(wide), low=low, high=high)
    if not contrast > _least_contrast(length) * noise_sigma:
        return replace(nothing, why_not=_contrast_reason(contrast, noise_sigma, length))
    residual = value - np.interp(distance, np.arange(-wide, wide + 1), profile)
    count = np.bincount(row * size + column, minlength=cells * size).reshape(cells, size)
    total = np.bincount(row * size + column, residual, cells * size).reshape(cells, size)
    off = np.abs(total) / np.maximum(count, 1)
    doubt = _SURE * noise_sigma / np.sqrt(np.maximum(count, 1))
    good = off <= _ALIKE * contrast + doubt
    good[:, wide - _STEEP : wide + _STEEP + 1] = True  # there a mean depends on the phase
    best, reasons = None, {}
    for reach_now in sorted({r for r in _REACHES if r <= wide}, reverse=True):
        within = good[:, wide - reach_now : wide + reach_now + 1]
        in_frame = room >= reach_now - 0.5
        beside = np.abs(np.arange(-wide, wide + 1))
        first, last = _longest_run(np.asarray(within.all(axis=1)) & in_frame)
        piece_length = (last - first) * length / cells
        if piece_length < _LEAST_LENGTH:
            shoulders = (beside > _STEEP) & (beside <= reach_now)
            reasons[reach_now] = (
                "too close to the frame's border"
                if not in_frame.any()
                else (
                    "brightness or contrast varies along the edge: the largest deviation is "
                    f"{percent(off[:, shoulders].max() / contrast)} of the edge's contrast"
                )
            )
            continue
        chosen = (row >= first) & (row < last)
        sides = _sides(
            distance[chosen], value[chosen], reach_now, noise_sigma, profile, wide, piece_length
        )
        if isinstance(sides, str):
            reasons[reach_now] = sides
            continue
        score = piece_length * min(reach_now, _ENOUGH_REACH)
        if best is None or score > best[0]:
            start, end = (k * length / cells - length / 2 for k in (first, last))
            best = (score, start, end, float(reach_now), sides)
    if best is None:
        why_not = reasons[min(reasons)] if reasons else "too close to the frame's border"
        return replace(nothing, why_not=why_not)
    _, start, end, reach, (low, high, noise) = best
    start, end = max(start, -length / 2.0 + _ENDS), min(end, length / 2.0 - _ENDS)
    own = _part_of(edge, start, end)
    return replace(own, reach=reach, low=low, high=high, noise_sigma=noise)


def _least_contrast(length: float) -> float:
    return max(_LEAST_CONTRAST, _CONTRAST_OF_16 * math.sqrt(16.0 / length))


def _contrast_reason(contrast: float, noise_sigma: float, length: float) -> str:
    if not contrast > 0.0:
        return (
            "too little contrast: away from the edge, the bright side is no brighter than the "
            "dark side"
        )
    times = contrast / max(noise_sigma, 1e-300)
    return (
        f"too little contrast: {times:.2g} times the noise; an edge of this length needs at "
        f"least {_least_contrast(length):.2g}"
    )


def _medians(place: NDArray[np.intp], value: Vector, cells: int, size: int) -> Vector:
    """Median over the cells along the edge of the mean at each distance."""
    count = np.bincount(place, minlength=cells * size).reshape(cells, size)
    total = np.bincount(place, value, cells * size).reshape(cells, size)
    means = np.where(count > 0, total / np.maximum(count, 1), np.inf)
    means.sort(axis=0)
    known = np.sum(count > 0, axis=0)
    columns = np.arange(size)
    lower = means[np.maximum(known - 1, 0) // 2, columns]
    upper = means[np.minimum(known // 2, np.maximum(known - 1, 0)), columns]
    return np.asarray(np.where(known > 0, (lower + upper) / 2.0, np.median(value)), np.float64)


def _longest_run(agree: NDArray[np.bool_]) -> tuple[int, int]:
    """First, and one beyond the last, of the longest run of true values."""
    steps = np.flatnonzero(np.diff(np.concatenate([[False], agree, [False]]).astype(np.int8)))
    if len(steps) == 0:
        return 0, 0
    starts, ends = steps[::2], steps[1::2]
    k = int(np.argmax(ends - starts))
    return int(starts[k]), int(ends[k])


def _sides(
    distance: Vector,
    value: Vector,
    reach: int,
    noise_sigma: float,
    profile: Vector,
    wide: int,
    length: float,
) -> tuple[float, float, float] | str:
    """Levels and noise of the outer halves of both sides, or why they are not level."""
    levels, variances, steps = [], [], []
    for side in (-1.0, 1.0):
        away = side * distance
        inner = value[(away > 0.5 * reach) & (away <= 0.75 * reach)]
        outer = value[(away > 0.75 * reach) & (away <= reach)]
        if len(inner) < 8 or len(outer) < 8:
            return "too little clear area beside the edge"
        error = math.sqrt(inner.var() / len(inner) + outer.var() / len(outer))
        levels.append(float(np.mean(np.concatenate([inner, outer]))))
        variances.append(float((inner.var() + outer.var()) / 2.0))
        steps.append((abs(float(outer.mean() - inner.mean())), error))
    contrast = levels[1] - levels[0]
    noise = math.sqrt(sum(variances) / 2.0)
    if not contrast > _least_contrast(length) * max(noise, noise_sigma):
        return _contrast_reason(contrast, max(noise, noise_sigma), length)
    for change, error in steps:
        if change > _LEVEL * contrast + 3.0 * error:
            return (
                "a side is not level: the level still changes by "
                f"{percent(change / contrast)} of the contrast at {reach} samples from the edge"
            )
    seen = min(reach + _BEYOND, wide)
    place = np.arange(-seen, seen + 1)
    part = (profile[wide - seen : wide + seen + 1] - levels[0]) / contrast
    doubt = _SURE * noise / contrast / math.sqrt(max(1.0, len(value) / (2.0 * reach + 1.0)))
    off = np.abs(part - (place > 0))
    beyond = off[(np.abs(place) > reach / 2.0) & (np.abs(place) <= reach)]
    inside = np.maximum(part - 1.0, -part)[np.abs(place) <= reach / 2.0]
    neighbour = off[np.abs(place) > reach]
    if neighbour.max(initial=0.0) > _NEIGHBOUR + doubt:
        return f"another edge too close: about {reach + _BEYOND} samples away"
    if beyond.max() > _ALIKE + doubt or inside.max() > _OVERSHOOT + doubt:
        farthest = int(np.abs(place[off > _ALIKE + doubt]).max())
        return f"another edge too close: about {farthest} samples away"
    return levels[0], levels[1], noise


# Edges that are soft in the scene itself, among those that the camera made as soft as they are.

_ALIKE_DEG = 35.0  # between directions whose blur is nearly the same
_SOFTER = 1.8  # times the width of the sharpest edge of the same direction
_SOFTER_THAN_ANY = 4.0  # times that of any direction: motion may blur so much
_FAINTER = 3.0  # times less contrast than an edge of another direction, where nothing confirms it
_COMPARABLE = 0.5  # of an edge's contrast over its noise, that a sharper one must have


def without_soft(*, edges: Sequence[found_edge.FoundEdge]) -> list[found_edge.FoundEdge]:
    """Refuse edges that are far wider than the sharpest ones.

    Notes
    -----
    A camera blurs all edges of one direction alike, where its blur does not change over the
    field; shadows, vapour and what lies out of focus are soft by themselves. The same is done by
    width classes in natural scene derived frequency responses (van Zwanenberg and others, 2021).
    Blur by motion differs with direction, and an edge of another direction is only compared with
    much sharper ones; a faint edge that is the only one of its direction as with those of its own.
    """
    used = [edge for edge in edges if edge.used]
    return [_judged(edge, used) if edge.used else edge for edge in edges]


def _judged(
    edge: found_edge.FoundEdge, others: Sequence[found_edge.FoundEdge]
) -> found_edge.FoundEdge:
    surer = [
        other
        for other in others
        if _clarity(other) >= _COMPARABLE * _clarity(edge) and other.softness > 0.0
    ]
    alike = [other.softness for other in surer if _between(edge, other) <= _ALIKE_DEG]
    faint = _FAINTER * _clarity(edge) < max(_clarity(other) for other in others)
    lone = sum(_between(edge, other) <= _ALIKE_DEG for other in others) == 1
    for widths, times in (
        (alike, _SOFTER),
        ([other.softness for other in surer], _SOFTER if lone and faint else _SOFTER_THAN_ANY),
    ):
        sharpest = min(widths)
        if edge.softness > times * sharpest:
            return replace(
                edge,
                why_not=f"soft in the scene: the edge spread is {edge.softness:.2g} samples, "
                f"compared with {sharpest:.2g} for sharper edges",
            )
    return edge


def _clarity(edge: found_edge.FoundEdge) -> float:
    return edge.contrast / max(edge.noise_sigma, 1e-12 * abs(edge.contrast))


def _between(one: found_edge.FoundEdge, other: found_edge.FoundEdge) -> float:
    turn = np.abs(one.angle_deg - other.angle_deg) % 180.0
    return float(min(turn, 180.0 - turn))
