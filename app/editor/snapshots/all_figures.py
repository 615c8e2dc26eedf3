"""The query of all figures of a network: the read-outs of every node, with their units."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

from app.editor.declared_text import label_of
from app.editor.evaluation.queries import Passing, Query
from app.editor.tradeoff.side_work import SideWork
from core.chain.engine import Plan
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work


@dataclass(frozen=True)
class NodeFigure:
    """One read-out of a node.

    Parameters
    ----------
    node, name : str
        The node's id, and the read-out's name in files.
    caption : str
        The read-out's name in words.
    value : object
        A number, a text or a truth value; None where there is none.
    unit, meaning : str
        As declared.
    """

    node: str
    name: str
    caption: str
    value: Any
    unit: str
    meaning: str


def all_figures(passing: Passing, work: Work) -> tuple[NodeFigure, ...]:
    """The read-outs of all nodes in the network's order; of those that fail, none."""
    figures: list[NodeFigure] = []
    for name, planned in passing.plan.nodes.items():
        if planned.error is not None or planned.node.disabled:
            continue
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        if not declared:
            continue
        try:
            values = passing.engine.readouts(passing.plan, name, work)
        except Cancelled:
            raise
        except ImagechainError:  # the node's badge has it
            continue
        for key, value in values.items():
            readout = declared[key]
            figures.append(
                NodeFigure(name, key, label_of(key), value, planned.unit(readout), readout.meaning)
            )
    return tuple(figures)


@dataclass(frozen=True)
class AllFiguresQuery(Query):
    """The figures of the network as it stands, once edits pause."""

    waits: ClassVar[bool] = True

    def key(self, plan: Plan) -> Hashable:
        """What the nodes make their figures of."""
        return tuple(
            (
                name,
                repr(planned.module),
                planned.node.disabled,
                planned.error is None,
                tuple(getattr(value, "key", None) for value in planned.inputs.values()),
                tuple(getattr(value, "key", None) for value in planned.outputs.values()),
            )
            for name, planned in plan.nodes.items()
        )

    def answer(self, passing: Passing) -> tuple[NodeFigure, ...]:
        """The figures."""
        return all_figures(passing, SideWork(passing.work))
