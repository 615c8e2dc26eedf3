"""Edges of pictures: searched for, measured one by one, and pooled by direction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.measure.picture_measurement import BY_HAND, FREQUENCIES, MeasuredEdge, MtfCurve
from app.measure.refused_edges import in_words
from core.errors import DataError
from core.physics.measurement.edges.edge_found import FoundEdge
from core.physics.measurement.edges.edge_mtf import crossing_error, measure_edge
from core.physics.measurement.edges.edge_pooling import LARGEST_ANGLE_DEG, pooled_mtf
from core.physics.measurement.edges.edge_search import find_edges
from core.physics.measurement.edges.long_tails import LongTails, long_tails
from core.physics.measurement.edges.picture_suspicions import missing_samples
from core.physics.measurement.edges.slanted_edge import falls_to

Matrix = NDArray[np.float64]


def edges_of(
    *,
    picture: Matrix,
    number: int,
    clip_levels: tuple[float, float] | None = None,
    check: Callable[[], None] = lambda: None,
) -> tuple[MeasuredEdge, ...]:
    """The edges of one picture, measured.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite.
    number : int
        Of the picture among those measured.
    clip_levels : tuple of float, optional
        Lowest and highest number that a sample can have.
    check : callable
        Called between steps; may raise to stop.
    """
    seen = find_edges(picture=picture, clip_levels=clip_levels, interpolated_too=True, check=check)
    used = [edge for edge in seen if edge.used]
    missing = missing_samples(picture=picture) if used else None
    tails = long_tails(picture=picture, edges=used, missing=missing, check=check)
    return tuple(_measured(picture, number, edge, tails, check) for edge in seen)


def _measured(
    picture: Matrix,
    number: int,
    edge: FoundEdge,
    tails: LongTails | None,
    check: Callable[[], None],
) -> MeasuredEdge:
    if not edge.used:
        return MeasuredEdge(number, edge, None, edge.why_not)
    try:
        curve = measure_edge(
            picture=picture, edge=edge, frequency=np.array(FREQUENCIES), tails=tails, check=check
        )
    except DataError as error:
        return MeasuredEdge(number, edge, None, error.message)
    return MeasuredEdge(number, edge, curve, "")


def pooled(
    edges: Sequence[MeasuredEdge], direction: Literal["x", "y"]
) -> tuple[MtfCurve | None, str]:
    """The MTF of all used edges whose normals lie near an axis, or the reason why there is none."""
    curves = [edge.curve for edge in edges if edge.used and edge.curve is not None]
    together = pooled_mtf(edges=curves, axis=direction)
    if together is None:
        return None, _no_edge([edge for edge in edges if edge.direction == direction], direction)
    frequency, mtf, sigma = together.frequency, together.mtf, together.sigma
    half = falls_to(frequency=frequency, mtf=mtf, level=0.5)
    error = None
    if half is not None:
        error = crossing_error(frequency=frequency, mtf=mtf, sigma=sigma, crossing=half)
    return MtfCurve(frequency, mtf, sigma, half, error, together.edges, together.excess), ""


def _no_edge(near: Sequence[MeasuredEdge], direction: str) -> str:
    """Why there is no MTF in a direction."""
    across = "across" if direction == "x" else "along"
    if not near:
        return (
            f"no straight edge whose normal lies within {LARGEST_ANGLE_DEG:g}° of {direction} "
            f"({across}) was seen"
        )
    if removed := sum(edge.why_not == BY_HAND for edge in near):
        many = "1 edge" if removed == 1 else f"{removed} edges"
        return f"{many} that would give it {'is' if removed == 1 else 'are'} {BY_HAND}"
    if len(near) == 1:
        return f"the one edge that would give it cannot be used: {near[0].why_not}"
    words = in_words(edge.why_not for edge in near)
    return f"none of the {len(near)} edges that would give it can be used: {words}"
