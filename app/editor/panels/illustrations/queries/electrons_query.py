"""The query of a focal plane's electrons and noises."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from app.editor.evaluation.queries import Passing, Query
from core.chain.engine import Plan


@dataclass(frozen=True)
class ElectronBudget:
    """Where a pixel's electrons come from, and its noise by source, at the picture's mean.

    Parameters
    ----------
    sources_e, noises_e : mapping of str to float
        Electrons by their source; standard deviations by theirs.
    temporal_e : float
        All noise that changes from frame to frame.
    full_well_e : float or None
        None where none is given.
    per_K : float or None
        Electrons per kelvin of the scene, where it is warm.
    netd_K, snr : float or None
        Where they mean something.
    """

    sources_e: Mapping[str, float]
    noises_e: Mapping[str, float]
    temporal_e: float
    full_well_e: float | None
    per_K: float | None
    netd_K: float | None
    snr: float | None

    @property
    def total_e(self) -> float:
        """All electrons."""
        return max(sum(self.sources_e.values()), 0.0)

    @property
    def fill(self) -> float | None:
        """Share of the well that is full; above 1 it overflows."""
        return self.total_e / self.full_well_e if self.full_well_e else None


@dataclass(frozen=True)
class ElectronsQuery(Query):
    """The figures of a focal plane; None of a disabled node."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The table of figures."""
        planned = plan.node(self.node)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return table and table.key

    def answer(self, passing: Passing) -> ElectronBudget | None:
        """Electrons and noises."""
        planned = passing.plan.node(self.node)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        if planned.node.disabled or table is None:
            return None
        figures: dict[str, Any] = passing.work.value(table.recipe).as_dict()
        module: Any = planned.module
        sources = ("scene", "signal_e"), ("optics", "optics_e"), ("housing", "housing_e")
        noises = (
            ("shot", "shot_noise_e"),
            ("read", "read_noise_e"),
            ("rounding", "quantization_noise_e"),
            ("fixed pattern", "fixed_pattern_e"),
        )
        return ElectronBudget(
            sources_e={name: figures[key] for name, key in (*sources, ("dark", "dark_e"))},
            noises_e={name: figures[key] for name, key in noises},
            temporal_e=figures["temporal_noise_e"],
            full_well_e=module.full_well_e,
            per_K=figures["responsivity_e_per_K"],
            netd_K=figures["netd_K"],
            snr=figures["snr"],
        )
