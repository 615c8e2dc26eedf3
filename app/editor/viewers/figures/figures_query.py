"""The query of the figures strip: the sensor's figures among the electronics' read-outs."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

from app.editor.error_text import error_text
from app.editor.evaluation.queries import Passing, Query
from app.editor.viewers.network_ports import HOW_TO_MARK
from app.run.figures import SENSOR_FIGURES, sensor_node
from app.run.output import find_output
from app.run.sound_plan import sound_part
from core.chain.engine import Plan
from core.errors import ImagechainError


@dataclass(frozen=True)
class Figure:
    """One read-out; `value` None where there is none, `reason` why, where that is known."""

    name: str
    caption: str
    value: Any
    unit: str
    meaning: str
    reason: str = ""


@dataclass(frozen=True)
class Figures:
    """The read-outs of one node.

    Parameters
    ----------
    node : str or None
        The electronics; None where there is none, or it is not clear which leads to the output.
    figures : tuple of Figure
        Its read-outs.
    output : str or None
        Port of the picture that the network delivers.
    missing : str
        Why there is none, in one line.
    choices : tuple of str
        Ports of the pictures that could be meant, where none is marked.
    """

    node: str | None
    figures: tuple[Figure, ...] = ()
    output: str | None = None
    missing: str = ""
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class FiguresQuery(Query):
    """Figures of the electronics that lead to the final picture.

    Parameters
    ----------
    preferred : str or None
        The node to show if there are several; else it is the last one.
    """

    urgency: ClassVar[int] = 1

    preferred: str | None = None

    def key(self, plan: Plan) -> Hashable:
        """The node and what its figures are made of."""
        output = _output_of(plan)
        name = sensor_node(plan, self.preferred)
        if name is None:
            return self, output
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return self, output, name, planned.node.disabled, getattr(table, "key", None)

    def answer(self, passing: Passing) -> Figures:
        """The figures."""
        plan = passing.plan
        output = _output_of(plan)
        name = sensor_node(plan, self.preferred)
        if name is None:
            return Figures(None, (), *output)
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        engine, values, reasons = passing.engine, dict[str, Any](), dict[str, str]()
        if not planned.node.disabled:
            values = engine.readouts(plan, name, passing.work)
            reasons = {
                readout: engine.why_none(plan, name, passing.work, readout)
                for readout, _ in SENSOR_FIGURES[planned.node.module]
                if values.get(readout) is None
            }
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        return Figures(
            name,
            tuple(
                Figure(
                    readout,
                    caption,
                    values.get(readout),
                    declared[readout].unit,
                    declared[readout].meaning,
                    reasons.get(readout, ""),
                )
                for readout, caption in SENSOR_FIGURES[planned.node.module]
            ),
            *output,
        )


def _output_of(plan: Plan) -> tuple[str | None, str, tuple[str, ...]]:
    """The picture that the network delivers, or why there is none, and the candidates for it."""
    try:
        output = find_output(sound_part(plan))
    except ImagechainError as error:
        return None, error_text(error), ()
    missing = f"{output.missing}; {HOW_TO_MARK}" if output.choices else output.missing
    return output.port, missing, output.choices
