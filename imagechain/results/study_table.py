"""The rows of a study: its points, figures and errors by column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from app.run.readout_tables import columns, number_text, warned_points
from app.study.study_request import StudyRows
from core.errors import ParameterError
from core.names import close, shown
from imagechain.parts.plain_errors import block, needed, plain_errors, png, table

if TYPE_CHECKING:
    from pandas import DataFrame

_SHOWN = 20  # rows of a notebook's table


class StudyTable(Mapping[str, list[Any]]):
    """Columns by name, as ``rows["electronics.snr"]``: a value for each point, in order.

    The columns are the varied parameters, the figures, ``point``, ``key`` (of what was computed),
    ``seconds``, ``error`` (empty if nothing is missing) and ``warnings``. `units` has each column's
    unit.
    """

    def __init__(self, rows: StudyRows) -> None:
        self._rows = rows
        self._columns = {column.name: list(column.values) for column in rows.columns()}
        self.units: dict[str, str] = {column.name: column.unit for column in rows.columns()}

    @plain_errors
    def __getitem__(self, name: str) -> list[Any]:
        if name not in self._columns:
            known = close(name, self._columns) or f"; it has {', '.join(self._columns)}"
            raise ParameterError("column", name, f"the study has no such column{known}")
        return list(self._columns[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def failed(self) -> dict[int, str]:
        """Errors of the failed points, by number of the point."""
        return {row.place + 1: row.error for row in self._rows.failed}

    @property
    def warnings(self) -> dict[int, tuple[str, ...]]:
        """Warnings of the nodes, by number of the point; only points with warnings."""
        return {row.place + 1: row.warnings for row in self._rows.rows if row.warnings}

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`, with units in the column names.

        Raises
        ------
        UsageError
            If pandas is not installed.
        """
        pandas = needed("pandas", "tables as DataFrames")
        frame: DataFrame = pandas.DataFrame(
            {column.head: column.typed for column in self._rows.columns()}
        )
        return frame

    def _texts(self, most: int) -> list[list[str]]:
        rows = zip(*self._columns.values(), strict=True)
        return [[_word(cell) for cell in row] for row, _ in zip(rows, range(most), strict=False)]

    def __repr__(self) -> str:
        heads = [column.head for column in self._rows.columns()]
        count = len(self._rows.rows)
        more = f"\nand {count - _SHOWN} more" if count > _SHOWN else ""
        ends = [f"{shown(str(count))} points", *self._warned()]
        return columns([heads, *self._texts(_SHOWN)]) + more + "\n" + "\n".join(ends)

    def _warned(self) -> list[str]:
        return warned_points([row.warnings for row in self._rows.rows])

    def _repr_html_(self) -> str:
        from app.study.study_drawing import study_png

        heads = [column.head for column in self._rows.columns()]
        count = "\n".join([f"{len(self._rows.rows)} points", *self._warned()])
        picture = png(study_png(self._rows), alt="figures of the study")
        return block(picture, table(heads, self._texts(_SHOWN), caption=count))


def _word(value: Any) -> str:
    if isinstance(value, float):
        return number_text(value)
    return "" if value is None else str(value)
