"""The query how an Init & Trans node samples the scene."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import ClassVar

from app.editor.evaluation.queries import Passing, Query
from core.chain.engine import Plan
from core.chain.wires import Context


@dataclass(frozen=True)
class SamplingQuery(Query):
    """The sensor's geometry, as its data structure; None of a disabled node."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        """The data structure."""
        context = _context(plan, self.node)
        return context and context.key

    def answer(self, passing: Passing) -> Context | None:
        """The data structure."""
        return _context(passing.plan, self.node)


def _context(plan: Plan, node: str) -> Context | None:
    planned = plan.node(node)
    if planned.error is not None:
        raise planned.error
    return planned.outputs.get("context")
