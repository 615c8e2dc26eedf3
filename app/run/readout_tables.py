"""Text for the terminal: read-outs in columns."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral, Real
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from core.errors import printable, several

if TYPE_CHECKING:
    from app.run.evaluation import Evaluation
    from core.modules.parameters import Caution

MOST_WARNINGS = 5
"""How many kinds of warnings are shown of many points."""
_NUMBER = re.compile(r"(?<!\w)\d[\d.]*(e[+-]?\d+)?")
_ROUNDING = 1e-15
_SIZES = {  # from, up to, the unit in which that is written
    "K": ((1e-9, 0.2, 1e-3, "mK"),),
    "s": ((1e-9, 1e-3, 1e-6, "µs"), (1e-3, 1.0, 1e-3, "ms")),
    "e-": ((1e4, 1e6, 1e3, "ke-"), (1e6, 1e15, 1e6, "Me-")),
    "Hz": ((1e4, 1e6, 1e3, "kHz"), (1e6, 1e15, 1e6, "MHz")),
    "mm": ((1e3, 1e6, 1e3, "m"),),
    "m": ((1e-9, 1e-3, 1e-6, "µm"), (1e-3, 0.1, 1e-3, "mm"), (1e4, 1e12, 1e3, "km")),
}
_IN_LINE = str.maketrans("\t\n\r", "   ")


def number_text(value: Any) -> str:
    """A figure in up to six digits, as people read it."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if _is_real(value):
        return f"{float(value):.6g}"
    return str(value)


def exact(value: Any) -> str:
    """A value in full, as tables have it; nothing where there is none."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(float(value)) if isinstance(value, float) else str(value)


def sized(value: Any, unit: str) -> tuple[Any, str]:
    """A value in the size of its unit that data sheets use (25 mK, 4 ms, 7 Me-), in four digits."""
    if isinstance(value, int | float) and value:
        for least, beyond, size, written in _SIZES.get(unit, ()):
            if least <= abs(value) < beyond:
                return four_digits(value / size), written
    return four_digits(value), unit if value is not None else ""


def four_digits(value: Any) -> Any:
    """The value in four digits: a data sheet gives no more."""
    return float(f"{value:.4g}") if _is_real(value) else value


def _is_real(value: Any) -> bool:
    """Whether it is a floating-point number, of numpy's types too, which need not be loaded."""
    return isinstance(value, Real) and not isinstance(value, Integral)


def with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def without_rounding(value: Any, unit: str) -> Any:
    """The value; of ratios and radians, 0 for what rounding leaves of 0."""
    if unit in ("", "rad") and _is_real(value):
        return 0.0 if abs(float(value)) < _ROUNDING else value
    return value


def jsonable(value: Any) -> Any:
    if hasattr(value, "tolist"):  # of numpy
        value = value.tolist()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, Mapping):
        return {str(name): jsonable(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(item) for item in value]
    return value.as_posix() if isinstance(value, PurePath) else value


def json_text(value: Any, indent: int = 2) -> str:
    text = json.dumps(jsonable(value), indent=indent, ensure_ascii=False, allow_nan=False)
    return printable(text) + "\n"


def readout_rows(evaluation: Evaluation) -> list[tuple[str, str, str, str]]:
    rows = []
    for node, values in evaluation.readouts.items():
        planned = evaluation.plan.nodes[node]
        units = {readout.name: planned.unit(readout) for readout in planned.declaration.readouts}
        for name, value in values.items():
            if value is not None:
                unit = units[name]
                rows.append((node, name, number_text(without_rounding(value, unit)), unit))
    return rows


def warning_lines(warnings: Iterable[Caution]) -> list[str]:
    return [printable(f"warning: {warning}") for warning in warnings]


def warned_points(points: Sequence[Sequence[str]]) -> list[str]:
    """How many points have warnings, and what these say; texts with other numbers count as one."""
    first: dict[str, str] = {}
    counts: Counter[str] = Counter()
    for warnings in points:
        kinds = {_NUMBER.sub("0", line): line for line in reversed(warnings)}
        counts.update(kinds.keys())
        first = {**kinds, **first}
    if not first:
        return []
    count = sum(map(bool, points))
    lines = [f"{count} of {several(len(points), 'point')} with warnings:"]
    for kind, number in counts.most_common(MOST_WARNINGS):
        lines.append(printable(f"warning: {first[kind]} ({number} point{'s' * (number > 1)})"))
    if len(counts) > MOST_WARNINGS:
        lines.append(f"and {len(counts) - MOST_WARNINGS} more")
    return lines


def columns(rows: Iterable[Sequence[str]], *, right: Sequence[int] = ()) -> str:
    """Rows with their cells in line; the columns in `right` end together."""
    rows = [[printable(cell).translate(_IN_LINE) for cell in row] for row in rows]
    if not rows:
        return ""
    widths = [max(len(row[index]) for row in rows) for index in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            cell.rjust(width) if index in right else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)
