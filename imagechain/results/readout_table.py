"""Read-outs of a result, by node and name, with their units and meanings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from app.run.evaluation import Evaluation
from app.run.readout_tables import columns, jsonable, number_text, without_rounding
from core.errors import ParameterError
from core.names import close, shown
from imagechain.parts.plain_errors import needed, plain_errors, table

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class ReadoutRow:
    """One read-out; `value` is None if it has none."""

    node: str
    name: str
    value: Any
    unit: str
    meaning: str


class ReadoutTable(Mapping[str, Mapping[str, Any]]):
    """Read-outs as ``readouts[NODE][NAME]``; `rows` also has their units and meanings."""

    def __init__(self, rows: tuple[ReadoutRow, ...], nodes: tuple[str, ...]) -> None:
        self.rows = rows
        self._nodes: dict[str, dict[str, Any]] = {node: {} for node in nodes}
        for row in rows:
            self._nodes[row.node][row.name] = row.value

    @plain_errors
    def __getitem__(self, node: str) -> Mapping[str, Any]:
        if node not in self._nodes:
            raise KeyError(
                f"there is no node {shown(node)} with read-outs{close(node, self._nodes)}"
            )
        return dict(self._nodes[node])

    def __iter__(self) -> Iterator[str]:
        return iter(self._nodes)

    def __len__(self) -> int:
        return len(self._nodes)

    @plain_errors
    def row(self, name: str) -> ReadoutRow:
        """The read-out ``NODE.NAME`` with its unit and meaning.

        Raises
        ------
        ParameterError
            If there is no such read-out.
        """
        names = [f"{row.node}.{row.name}" for row in self.rows]
        if name not in names:
            raise ParameterError(
                "read-out", name, f"the chain has no such read-out{close(name, names)}"
            )
        return self.rows[names.index(name)]

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Read-outs by node and name, as plain values; infinite values are strings."""
        plain: dict[str, dict[str, Any]] = jsonable(self._nodes)
        return plain

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`: value, unit and meaning by node and read-out.

        Raises
        ------
        UsageError
            If pandas is not installed.
        """
        pandas = needed("pandas", "tables as DataFrames")
        index = pandas.MultiIndex.from_tuples(
            [(row.node, row.name) for row in self.rows], names=["node", "readout"]
        )
        cells = {
            name: pandas.Series(
                [getattr(row, name) for row in self.rows], index=index, dtype=object
            )
            for name in ("value", "unit", "meaning")
        }
        frame: DataFrame = pandas.DataFrame(cells, index=index)
        return frame

    def _texts(self) -> list[tuple[str, str, str, str]]:
        return [
            (row.node, row.name, number_text(without_rounding(row.value, row.unit)), row.unit)
            for row in self.rows
        ]

    def __repr__(self) -> str:
        rows = [row for row in self._texts() if row[2] != "-"]
        return columns(rows, right=(2,)) or "no read-outs"

    def _repr_html_(self) -> str:
        return table(("node", "read-out", "value", "unit"), self._texts(), right=2)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


def readout_table(evaluation: Evaluation) -> ReadoutTable:
    """The read-outs of an evaluation."""
    rows = []
    for node, values in evaluation.readouts.items():
        planned = evaluation.plan.nodes[node]
        for readout in planned.declaration.readouts:
            if readout.name in values:
                value, unit = values[readout.name], planned.unit(readout)
                rows.append(ReadoutRow(node, readout.name, value, unit, readout.meaning))
    return ReadoutTable(tuple(rows), tuple(evaluation.readouts))
