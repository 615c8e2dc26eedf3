"""Find the edges of a picture from which an MTF can be measured, and why others cannot be used."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.edges.edge_limits import (
    BEYOND,
    LARGEST_REACH,
    LEAST_LENGTH,
    LEAST_REACH,
    Surroundings,
    frame_reach,
    least_contrast,
    surroundings,
    why_clipped,
    why_cut_off,
    why_piled_up,
    without_those_at,
)
from core.physics.measurement.edges.edge_line import EdgeSamples, edge_samples, rectangle_samples
from core.physics.measurement.edges.picture_checks import (
    FoundEdge,
    clear_of,
    missing_samples,
    why_no_picture,
)
from core.physics.measurement.edges.ridges import (
    SMOOTHING,
    Piece,
    ridge_points,
    rough_noise,
    spread_out,
    straight_pieces,
)
from core.physics.measurement.edges.spread_fit import SpreadFit, fit_spread

_ENDS = 1.0  # samples left off at both ends, where corners are rounded
_LARGEST_GAP = 0.7  # samples between distances; beyond 0.75 nothing can be measured
_BENT_REACH = 4.0  # least radius of a bent edge, in its reaches
_ENOUGH_USED = 48  # edges of a picture
_LEAST_EXAMINED, _MOST_EXAMINED = 400, 1500  # candidates of a picture
_SAMPLES_EXAMINED = 10_000  # of a picture, for each candidate between these numbers
_BLURRED = 2.0  # times a step's contrast may be what its gradient says, for its blur
_LEAST_SOFTNESS = 0.5  # samples, below which none is softer than another
_WIDTHS_IN_REACH = 5.5  # so many standard deviations, and nothing of a Gaussian is left
_PIECE = 5.0  # samples, of an edge whose places are compared
_OFF_COURSE = 0.15  # samples


def find_edges(
    *,
    picture: NDArray[np.floating],
    clip_levels: tuple[float, float] | None = None,
    interpolated_too: bool = False,
    check: Callable[[], None] = lambda: None,
) -> tuple[FoundEdge, ...]:
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

    Notes
    -----
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
    missing = missing_samples(picture=picture)
    clear = None
    if missing is not None:
        clear = clear_of(missing=missing, farthest=LARGEST_REACH + BEYOND + 2)
        picture = np.where(missing, np.median(picture[~missing]), picture)
    share = 0.0 if missing is None else float(missing.mean())
    noise = rough_noise(picture=picture, missing=share)
    check()
    points = ridge_points(picture=picture, noise_sigma=noise, check=check)
    steep = noise / (_BLURRED * SMOOTHING * math.sqrt(2.0 * math.pi))
    pieces = straight_pieces(
        points=points,
        shape=picture.shape,
        least_length=LEAST_LENGTH,
        least_strength=steep * least_contrast(1e9),
        strength_of_16=steep * least_contrast(16.0),
    )
    if clear is not None:  # the steps to missing samples are no edges
        pieces = [piece for piece in pieces if clear[round(piece.y), round(piece.x)] > LEAST_REACH]
    extremes = (float(picture.min()), float(picture.max()))
    enough = min(max(_LEAST_EXAMINED, picture.size // _SAMPLES_EXAMINED), _MOST_EXAMINED)
    waiting = _in_turn(pieces, picture.shape)
    found: list[FoundEdge] = []
    used = 0
    while len(found) < min(enough, len(pieces)) and used < _ENOUGH_USED:
        check()
        found.append(_examined(picture, waiting[len(found)], noise, clip_levels, extremes, clear))
        used += found[-1].used
        if used == _ENOUGH_USED or len(found) == min(enough, len(pieces)):
            found = without_soft(edges=found)
            used = sum(edge.used for edge in found)
    if clip_levels is None:
        found = without_those_at(edges=found, picture=picture, extremes=extremes)
    reason = _enough(used, len(found))
    found.extend(replace(_rough(piece, noise), why_not=reason) for piece in waiting[len(found) :])
    reason = ""
    if any(edge.used for edge in found):
        reason = why_no_picture(picture=picture, interpolated_too=interpolated_too)
    if reason:
        found = [replace(edge, used=False, why_not=reason) if edge.used else edge for edge in found]
    found.sort(key=lambda edge: (not edge.used, -edge.length * edge.contrast))
    return tuple(found)


def _examined(
    picture: NDArray[np.floating],
    piece: Piece,
    noise: float,
    clip_levels: tuple[float, float] | None,
    extremes: tuple[float, float],
    clear: NDArray[np.float64] | None,
) -> FoundEdge:
    """A piece as an edge, used or not."""
    rough = _rough(piece, noise)
    least = rough.contrast
    if _BLURRED * least < least_contrast(piece.length) * noise:
        return replace(
            rough,
            why_not=f"too little contrast: about {least / noise:.2g} times the noise, of at "
            f"least {least_contrast(piece.length):.2g} for its length",
        )
    room = frame_reach(piece=piece, shape=picture.shape, clear=clear)
    reach = min(float(room.max()), float(LARGEST_REACH + BEYOND))
    if reach < LEAST_REACH:
        return replace(rough, why_not=f"too near to the frame's side: {reach:.1f} samples")
    samples = rectangle_samples(
        picture=picture,
        middle=(piece.x, piece.y),
        angle_deg=piece.angle_deg,
        half_length=piece.length / 2.0,
        reach=reach,
        bend=piece.bend,
    )
    around = surroundings(
        samples=samples, length=piece.length, reach=reach, room=room, noise_sigma=noise
    )
    edge = _with_surroundings(rough, around)
    if around.why_not:
        return replace(edge, why_not=around.why_not)
    return _settled(picture, edge, clip_levels, extremes)


def _rough(piece: Piece, noise: float) -> FoundEdge:
    """A piece as an edge of the contrast that its gradient needs at least."""
    return FoundEdge(
        x=piece.x,
        y=piece.y,
        angle_deg=_turned(piece.angle_deg),
        length=piece.length,
        reach=float(LEAST_REACH),
        low=0.0,
        high=piece.strength * SMOOTHING * math.sqrt(2.0 * math.pi),
        noise_sigma=noise,
        used=False,
        bend=piece.bend,
    )


def _in_turn(pieces: Sequence[Piece], shape: tuple[int, ...]) -> list[Piece]:
    """Pieces in the order in which they are looked at."""
    order = spread_out(
        x=np.array([piece.x for piece in pieces]),
        y=np.array([piece.y for piece in pieces]),
        angle_deg=np.array([piece.angle_deg for piece in pieces]),
        merit=np.array([piece.strength * math.sqrt(piece.length) for piece in pieces]),
        shape=shape,
    )
    return [pieces[k] for k in order]


def _enough(used: int, examined: int) -> str:
    """Why the rest of the candidates was not looked at."""
    if used >= _ENOUGH_USED:
        return f"not looked at: {used} edges that are clearer or farther apart can be used"
    if used == 0:
        return f"less clear than {examined} others, of which none can be used"
    return (
        f"not looked at: less clear than {examined} others, of which {used} can be used, or "
        "crowded among them"
    )


def _turned(angle_deg: float) -> float:
    """An angle in (-180, 180]."""
    return 180.0 - (180.0 - angle_deg) % 360.0


def _with_surroundings(rough: FoundEdge, around: Surroundings) -> FoundEdge:
    """The edge over the length and reach that belong to it."""
    ends = _ENDS if not around.why_not else 0.0
    start = max(around.start, -rough.length / 2.0 + ends)
    end = min(around.end, rough.length / 2.0 - ends)
    return replace(
        _part_of(rough, start, end),
        reach=around.reach,
        low=around.low,
        high=around.high,
        noise_sigma=around.noise_sigma,
    )


def _part_of(edge: FoundEdge, start: float, end: float) -> FoundEdge:
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
    edge: FoundEdge,
    clip_levels: tuple[float, float] | None,
    extremes: tuple[float, float],
) -> FoundEdge:
    """The edge on its fitted course, used if nothing speaks against it."""
    samples = edge_samples(picture=picture, edge=edge)
    reason = why_clipped(samples=samples, clip_levels=clip_levels, extremes=extremes)
    if reason:
        return replace(edge, why_not=reason)
    half_length = edge.length / 2.0
    fit = fit_spread(
        samples=samples, reach=edge.reach, half_length=half_length, coarse_turns=2, fine_turns=0
    )
    edge = _on_course(edge, fit)
    if clip_levels is None:
        away = samples.along / half_length
        distance = samples.distance - fit.turn * away - fit.bend * away**2
        reason = why_cut_off(
            samples=samples, distance=distance, reach=edge.reach, extremes=extremes
        ) or why_piled_up(value=samples.value, distance=distance, extremes=extremes)
        if reason:
            return replace(edge, why_not=reason)
    off = _off_course(samples, fit, half_length)
    if edge.reach < _WIDTHS_IN_REACH * edge.softness:
        return replace(
            edge,
            why_not=f"its spread, {edge.softness:.2g} samples wide, does not end within the "
            f"{edge.reach:g} samples that belong to it",
        )
    if off > _OFF_COURSE:
        return replace(edge, why_not=f"not straight: parts of it lie {off:.2g} samples off")
    radius = (edge.length / 2.0) ** 2 / max(2.0 * abs(edge.bend), 1e-9)
    if radius < _BENT_REACH * edge.reach:
        return replace(edge, why_not=f"not straight: bends by {abs(edge.bend):.2g} samples")
    if fit.gap > _LARGEST_GAP:
        return replace(
            edge,
            why_not=f"not slanted enough: at {edge.angle_deg:.1f}° its samples lie at distances "
            f"{fit.gap:.2g} samples apart, of at most {_LARGEST_GAP:g}",
        )
    return replace(edge, used=True)


def _on_course(edge: FoundEdge, fit: SpreadFit) -> FoundEdge:
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


def _off_course(samples: EdgeSamples, fit: SpreadFit, half_length: float) -> float:
    """Largest distance, less three standard errors, of a piece of an edge from its course."""
    away = samples.along / half_length
    distance = samples.distance - fit.turn * away - fit.bend * away**2
    slope = fit.slopes(distance)
    pieces = max(3, round(2.0 * half_length / _PIECE))
    piece = np.clip(((away + 1.0) / 2.0 * pieces).astype(np.intp), 0, pieces - 1)
    square = np.bincount(piece, slope**2, pieces)
    moved = np.bincount(piece, slope * fit.residual, pieces) / np.maximum(square, 1e-300)
    noise = float(np.std(fit.residual))
    return float(np.max(np.abs(moved) - 3.0 * noise / np.sqrt(np.maximum(square, 1e-300))))


# Edges that are soft in the scene itself, among those that the camera made as soft as they are.

_ALIKE_DEG = 35.0  # between directions whose blur is nearly the same
_SOFTER = 1.8  # times the width of the sharpest edge of the same direction
_SOFTER_THAN_ANY = 4.0  # times that of any direction: motion may blur so much
_COMPARABLE = 0.5  # of an edge's contrast over its noise, that a sharper one must have


def without_soft(*, edges: Sequence[FoundEdge]) -> list[FoundEdge]:
    """Refuse edges that are far wider than the sharpest ones.

    Notes
    -----
    A camera blurs all edges of one direction alike, where its blur does not change over the
    field; shadows, vapour and what lies out of focus are soft by themselves. The same is done by
    width classes in natural scene derived frequency responses (van Zwanenberg and others, 2021).
    Blur by motion differs with direction, and an edge of another direction is only compared with
    much sharper ones.
    """
    used = [edge for edge in edges if edge.used]
    return [_judged(edge, used) if edge.used else edge for edge in edges]


def _judged(edge: FoundEdge, others: Sequence[FoundEdge]) -> FoundEdge:
    surer = [
        other
        for other in others
        if _clarity(other) >= _COMPARABLE * _clarity(edge) and other.softness > 0.0
    ]
    alike = [other.softness for other in surer if _between(edge, other) <= _ALIKE_DEG]
    for widths, times in (
        (alike, _SOFTER),
        ([other.softness for other in surer], _SOFTER_THAN_ANY),
    ):
        sharpest = min(widths)
        if edge.softness > times * sharpest:
            return replace(
                edge,
                used=False,
                why_not=f"soft in the scene: its spread is {edge.softness:.2g} samples wide, "
                f"that of others {sharpest:.2g}",
            )
    return edge


def _clarity(edge: FoundEdge) -> float:
    return edge.contrast / max(edge.noise_sigma, 1e-12 * abs(edge.contrast))


def _between(one: FoundEdge, other: FoundEdge) -> float:
    """Angle between two edges' courses, 0 to 90°."""
    turn = np.abs(one.angle_deg - other.angle_deg) % 180.0
    return float(min(turn, 180.0 - turn))
