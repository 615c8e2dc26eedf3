"""Read-outs that are one figure of a module's table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from core.chain.results import TableData
from core.evaluation.recipes import Recipe, Step, ends_lineage, with_reason
from core.evaluation.work import Work
from core.modules.declaration import Module, readout


@ends_lineage
def figure_reason(work: Work, table: TableData, *, name: str) -> str:
    """Why that value of a table is none."""
    return next(row.reason for row in table.rows if row.name == name)


@with_reason(figure_reason)
@ends_lineage
def figure(work: Work, table: TableData, *, name: str) -> float | int | str | None:
    """One value of a table."""
    return table.as_dict()[name]


def of_table(outputs: Any) -> Recipe:
    """The table of a module that has one of this name."""
    recipe: Recipe = outputs.table.recipe
    return recipe


def table_figure(
    name: str,
    unit: str,
    meaning: str,
    *,
    row: str = "",
    unit_of: str = "",
    table: Callable[[Any], Recipe] = of_table,
) -> Any:
    """A read-out that is one figure of the table.

    Parameters
    ----------
    name, unit, meaning : str
        Of the read-out.
    row : str
        The table's row; of the read-out's name, if not given.
    unit_of : str
        The input of whose picture it has the unit, in place of `unit`.
    table : callable
        Gives the table of the outputs.
    """

    def method(self: Module, outputs: Any) -> Step:
        return Step.of(figure, table(outputs), name=row or name)

    method.__doc__ = meaning
    return readout(unit, name=name, unit_of=unit_of)(method)
