"""The question of the figures strip: what the electronics' read-outs say of the sensor."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from app.chain import ancestors, final_image
from app.editor.evaluation.wants import Passing, Want
from app.sound_plan import sound_part
from core.engine import Plan
from core.errors import ImagechainError

MODULE = "electronics_noise"
SHOWN = (
    ("g_number", "G#"),
    ("bandwidth_Hz", "Bandwidth"),
    ("ner", "NER"),
    ("netd_detector_K", "NETD detector"),
    ("netd_system_K", "NETD system"),
    ("snr", "SNR"),
    ("quantization_rms", "Quantization"),
)


@dataclass(frozen=True)
class Figure:
    """One read-out; `value` None where there is none."""

    name: str
    caption: str
    value: Any
    unit: str
    meaning: str


@dataclass(frozen=True)
class Figures:
    """The read-outs of one node; `node` None where the network has no electronics."""

    node: str | None
    figures: tuple[Figure, ...] = ()


@dataclass(frozen=True)
class FiguresWant(Want):
    """Figures of the electronics that lead to the final picture.

    Parameters
    ----------
    preferred : str or None
        The node to tell of if there are several; else it is the last one.
    """

    urgency: ClassVar[int] = 1

    preferred: str | None = None

    def key(self, plan: Plan) -> Hashable:
        """The node and what its figures are made of."""
        name = self.node(plan)
        if name is None:
            return self, None
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return self, name, planned.node.disabled, getattr(table, "key", None)

    def answer(self, passing: Passing) -> Figures:
        """The figures."""
        plan = passing.plan
        name = self.node(plan)
        if name is None:
            return Figures(None)
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        values: Mapping[str, Any] = {}
        if not planned.node.disabled:
            values = passing.engine.readouts(plan, name, passing.work)
        declared = {each.name: each for each in planned.declaration.readouts}
        return Figures(
            name,
            tuple(
                Figure(
                    readout,
                    caption,
                    values.get(readout),
                    declared[readout].unit,
                    declared[readout].meaning,
                )
                for readout, caption in SHOWN
            ),
        )

    def node(self, plan: Plan) -> str | None:
        """Id of the node whose figures are told; None without electronics.

        Of several, the preferred one, else the last one that leads to the final picture, else the
        last of all.
        """
        named = [name for name, node in plan.network.nodes.items() if node.module == MODULE]
        if not named or self.preferred in named:
            return self.preferred if named else None
        leading = set(named)
        try:
            final = final_image(sound_part(plan))
        except ImagechainError:
            final = None
        if final is not None:
            last = final.rpartition(".")[0]
            leading = ancestors(plan.network, last) | {last}
        order = [name for name in plan.nodes if name in named]
        return next((name for name in reversed(order) if name in leading), order[-1])
