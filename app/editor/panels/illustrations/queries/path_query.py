"""The query of what the air does to every wavelength."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from core.chain.engine import Plan

Vector = NDArray[np.float64]
_POINTS = 401


@dataclass(frozen=True, eq=False)
class AirOverBand:
    """Transmission and path radiance of a path over a band.

    Parameters
    ----------
    wavelength_um, transmission, added : ndarray, shape (points,)
        µm; from 0 to 1; W/m²/sr/µm. All are empty where the picture has no band.
    mean, added_in_band : float
        Mean transmission of the band, by its light, and what is added in it, W/m²/sr.
    """

    wavelength_um: Vector
    transmission: Vector
    added: Vector
    mean: float
    added_in_band: float


@dataclass(frozen=True)
class PathQuery(Query):
    """The path of a node; None of a disabled one."""

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The table of the path."""
        planned = plan.node(self.node)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return table and table.key, planned.node.disabled

    def answer(self, passing: Passing) -> AirOverBand | None:
        """The path over the band."""
        planned = passing.plan.node(self.node)
        if planned.error is not None:
            raise planned.error
        table: Any = planned.outputs.get("table")
        if planned.node.disabled or table is None:
            return None
        figures = passing.work.value(table.recipe).as_dict()
        how = dict(table.recipe.parameters)
        air, band = how["air"], how["band_um"]
        places = np.empty(0) if band is None else _places(air.points, *band)
        return AirOverBand(
            places,
            np.exp(-air.depth(places)),
            air.added(places),
            figures["transmission"],
            figures["path_radiance"],
        )


def _places(points: tuple[tuple[float, float], ...], low: float, high: float) -> Vector:
    """Evenly over the band, and where a table has its points."""
    known = np.array([place for place, _ in points])
    inside = known[(known >= low) & (known <= high)]
    return np.unique(np.concatenate([np.linspace(low, high, _POINTS), inside]))
