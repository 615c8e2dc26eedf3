"""How much of a picture a fit leaves beyond noise, and by how much that widens its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri

from app.fit.edge_fit import EdgesAt

Vector = NDArray[np.float64]

_RARE = 6e-5  # probability of a sum of squares by noise alone, below which it is no noise
_LEAST_DEGREES = 8
_IN_GROUP = 16  # residuals of neighbouring distances that are averaged
_NEAREST = 3.0  # samples about an edge
_LEVELS = 4  # levels and slopes of an edge, that count among its groups
# A chain of the wrong form: its residuals are 2.2 times the noise, and some of the step. Scenes'
# own edges are ideal to some percent of a step, which differs between edges: their scatter shows
# it. What all edges share does not scatter, and from 5 % on it has moved values by as much as any
# blur here does; fewer than 3 edges have no scatter, and 1 % is what an MTF is to be right to.
_HOPELESS, _MATERIAL, _OTHER_FORM = 5.0, 0.01, 0.05
FEWEST = 3  # edges, of which a scatter is taken


@dataclass(frozen=True)
class Misfit:
    # sum of the squared residuals in units of their noise, and degrees of freedom
    chi2: float
    degrees: int
    # the same of residuals averaged at equal distances from the edge
    shape_chi2: float
    shape_degrees: int
    # the same of the noise at the measured levels; part of the first two
    noise_chi2: float = 0.0
    noise_degrees: int = 0
    # what is left near the edge that is worst, beyond noise, as a share of its step
    material: float = 0.0
    edges: int = 0  # how many were fitted; 0 for a whole picture

    @property
    def chi2_per_degree(self) -> float:
        """1 where the residuals are noise."""
        return self.chi2 / max(1, self.degrees)

    @property
    def shape_per_degree(self) -> float:
        """1 where what is left of the edges has no shape."""
        return self.shape_chi2 / max(1, self.shape_degrees)

    @property
    def excess(self) -> float:
        """By which variances are widened for the edges: 1 unless there is a misfit."""
        edges = self.degrees - self.noise_degrees
        return max(
            _excess((self.chi2 - self.noise_chi2) / max(1, edges), edges),
            _excess(self.shape_per_degree, self.shape_degrees),
        )

    @property
    def is_hopeless(self) -> bool:
        """Whether the edges are of another form than the chain can give, and no error is known."""
        most = _MATERIAL if self.edges < FEWEST else _OTHER_FORM
        return self.excess > _HOPELESS and self.material > most

    @property
    def is_material(self) -> bool:
        """Whether more is left of a step than an error without a scatter allows for."""
        return self.excess > _HOPELESS and self.material > _MATERIAL

    @property
    def noise_excess(self) -> float:
        return _excess(self.noise_chi2 / max(1, self.noise_degrees), self.noise_degrees)


def misfit_of(edges: EdgesAt, noises: Vector, degrees: int, shared: tuple[int, int]) -> Misfit:
    """How much is left beyond noise, and how much of that has the shape of edges.

    `noises` are residuals of the noise at the measured levels, in standard errors; `degrees` of
    freedom are those of all; `shared` says how many parameters were fitted, and how many of them
    to the noise.
    """
    shape, groups, material = 0.0, 0, 0.0
    own = edges.own.shape[1] + _LEVELS
    for index, weight in enumerate(edges.weight):
        inside = weight > 0.0
        order = np.argsort(edges.distance[index][inside], kind="stable")
        ends = np.arange(0, len(order) - _IN_GROUP + 1, _IN_GROUP)
        if not len(ends):
            continue
        count = np.diff(np.append(ends, len(order)))
        total = np.add.reduceat(edges.residual[index][inside][order], ends)
        shape += float(np.sum(total**2 / count))
        groups += max(0, len(ends) - own)
        # What is left near the edge beyond its noise, of the step.
        near = (
            np.abs(np.add.reduceat(edges.distance[index][inside][order], ends) / count) < _NEAREST
        )
        if np.any(near):
            noise = 1.0 / (weight[inside].mean() * abs(float(edges.step[index])) + 1e-300)
            left = (total[near] / count[near]) ** 2 - 1.0 / count[near]
            material = max(material, noise * math.sqrt(max(float(left.mean()), 0.0)))
    chi2 = edges.cost + float(noises @ noises)
    return Misfit(
        chi2, degrees, shape, groups - shared[0], float(noises @ noises),
        max(0, len(noises) - shared[1]), material, len(edges.weight),
    )  # fmt: skip


def _excess(per_degree: float, degrees: int) -> float:
    """What is left for each degree, where noise alone would hardly ever leave as much."""
    if degrees < _LEAST_DEGREES:
        return 1.0
    return per_degree if per_degree * degrees > float(chdtri(degrees, _RARE)) else 1.0
