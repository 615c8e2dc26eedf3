"""The edges of a picture that a chain is fitted to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.fit.patch import Patch, patch_of
from app.fit.window import window_about
from app.measure.refused_edges import in_words
from core.physics.measurement.edges.edge_found import FoundEdge
from core.physics.measurement.edges.edge_samples import edge_samples
from core.physics.measurement.edges.edge_search import find_edges

Matrix = NDArray[np.float64]

_MOST_EDGES = 40
_MOST_SAMPLES = 60_000


@dataclass(frozen=True)
class EdgeChoice:
    """The edges of pictures: those that are fitted, and why others are not.

    Parameters
    ----------
    patches : tuple of Patch
        Samples of the edges, the clearest first.
    refused : tuple of str
        Why not, of every other candidate.
    """

    patches: tuple[Patch, ...]
    refused: tuple[str, ...]

    @property
    def reasons(self) -> str:
        """Why candidates were refused, the clearest first, in one line."""
        if not self.refused:
            return "nothing in it looks like a straight edge"
        seen = len(self.refused) + len(self.patches)
        return f"of {seen} candidates: {in_words(self.refused)}"


def edges_in(
    *,
    pictures: Sequence[Matrix],
    clip_levels: tuple[float, float] | None = None,
    check: Callable[[], None] = lambda: None,
) -> EdgeChoice:
    """Search for the edges of pictures, and take the samples of the clearest.

    Parameters
    ----------
    pictures : sequence of ndarray
        Samples, shape (rows, columns), finite.
    clip_levels : tuple of float, optional
        Lowest and highest number that a sample can have.
    check : callable
        Called between steps; may raise to stop.
    """
    usable: list[tuple[float, Patch]] = []
    refused: list[str] = []
    for number, picture in enumerate(pictures):
        for edge in find_edges(picture=picture, clip_levels=clip_levels, check=check):
            if not edge.used:
                refused.append(edge.why_not)
                continue
            made = _patch(picture, edge, number, many=len(pictures) > 1)
            if isinstance(made, str):
                refused.append(made)
            else:
                # A picture without noise still has the rounding of its numbers.
                noise = max(edge.noise_sigma, made.least_variance**0.5)
                usable.append((edge.contrast / noise * len(made.value) ** 0.5, made))
    usable.sort(key=lambda pair: -pair[0])
    chosen: list[Patch] = []
    samples = 0
    for _, patch in usable[:_MOST_EDGES]:
        if chosen and samples + len(patch.value) > _MOST_SAMPLES:
            break
        chosen.append(patch)
        samples += len(patch.value)
    return EdgeChoice(tuple(chosen), tuple(refused))


def _patch(picture: Matrix, edge: FoundEdge, number: int, *, many: bool) -> Patch | str:
    samples = edge_samples(picture=picture, edge=edge)
    where = f" of picture {number + 1}" if many else ""
    return patch_of(
        name=f"edge at x {edge.x:.0f}, y {edge.y:.0f}{where}",
        angle_deg=edge.angle_deg,
        distance=samples.distance,
        along=samples.along,
        value=samples.value,
        curvature=edge.bend / (edge.length / 2.0) ** 2,
        picture=number,
        place=(edge.x, edge.y),
        window=window_about(picture=picture, edge=edge),
    )
