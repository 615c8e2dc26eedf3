"""Edges that are soft in the scene itself, among those that the camera made as soft as they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from core.physics.measurement.edges.edge_found import FoundEdge

_ALIKE_DEG = 35.0  # between directions whose blur is nearly the same
_SOFTER = 1.8  # times the width of the sharpest edge of the same direction
_SOFTER_THAN_ANY = 4.0  # times that of any direction: motion may blur so much
_COMPARABLE = 0.5  # of an edge's contrast over its noise, that a sharper one must have


def without_soft(*, edges: Sequence[FoundEdge]) -> list[FoundEdge]:
    """Refuse edges that are far wider than the sharpest ones.

    Parameters
    ----------
    edges : sequence of FoundEdge
        Edges, used and refused.

    Returns
    -------
    list of FoundEdge
        The same, the soft ones with their reason.

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
