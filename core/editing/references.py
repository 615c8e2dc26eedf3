"""Where a network's other fields mention its nodes: `final`, and `published` figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from core.names import thaw


def renamed(extra: Mapping[str, Any], old: str, new: str) -> dict[str, Any]:
    """The fields with a node's new name."""
    fields = dict(extra)
    if _of(fields.get("final")) == old:
        fields["final"] = _moved(fields["final"], new)
    if any(_of(row.get("from")) == old for row in _rows(fields)):
        fields["published"] = [
            {**row, "from": _moved(row["from"], new)} if _of(row.get("from")) == old else row
            for row in thaw(fields["published"])
        ]
    return fields


def dropped(extra: Mapping[str, Any], gone: set[str]) -> dict[str, Any]:
    """The fields without entries that name these nodes."""
    fields = dict(extra)
    if _of(fields.get("final")) in gone:
        del fields["final"]
    if any(_of(row.get("from")) in gone for row in _rows(fields)):
        rows = thaw(fields["published"])
        fields["published"] = [row for row in rows if _of(row.get("from")) not in gone]
    return fields


def _rows(fields: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    rows = fields.get("published")
    if not isinstance(rows, tuple | list) or not all(isinstance(row, Mapping) for row in rows):
        return []  # of another form: left as it is
    return list(rows)


def _of(port: Any) -> str | None:
    return port.rpartition(".")[0] if isinstance(port, str) else None


def _moved(port: str, node: str) -> str:
    return f"{node}.{port.rpartition('.')[2]}"
