"""The points of a study, and the order in which they are computed."""

from __future__ import annotations

import csv
import io
import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from app.options.overrides import from_here, readings
from app.study.study_axes import Axis, allowed, of_files, target
from app.tradeoff.tradeoff_figures import nodes_after
from core.errors import FileError, ParameterError, UsageError
from core.modules.library_type import Library
from core.modules.parameters import plain
from core.names import shown_path
from core.network.network import Network
from nodes.files.common.table_cells import plain_cell

MOST_POINTS = 1_000_000
_MOST_BYTES = 1 << 27  # of a list: a hundred for each point; its cells take ten times as much
Point = tuple[Any, ...]
"""A value for each axis."""


def grid_points(axes: Sequence[Axis]) -> tuple[Point, ...]:
    """Every value of an axis with every value of the others; the last axis moves first.

    Raises
    ------
    UsageError
        If there are too many.
    """
    _check_number(math.prod(len(axis.values) for axis in axes))
    return tuple(itertools.product(*(axis.values for axis in axes)))


def latin_points(
    axes: Sequence[Axis], count: int, seed: int
) -> tuple[tuple[Axis, ...], list[Point]]:
    """A Latin hypercube: of `count` equal parts of each range, every part is taken once.

    Within its part a value is drawn uniformly (McKay, Beckman and Conover 1979).

    Returns
    -------
    axes, points
        The axes with the values that have been drawn, and the points.
    """
    _check_number(count)
    random = np.random.Generator(np.random.Philox(seed))
    columns = []
    for axis in axes:
        shares = (random.permutation(count) + random.random(count)) / count
        columns.append(axis.drawn([min(float(share), np.nextafter(1.0, 0.0)) for share in shares]))
    drawn = tuple(
        replace(axis, values=tuple(dict.fromkeys(column)))
        for axis, column in zip(axes, columns, strict=True)
    )
    return drawn, list(zip(*columns, strict=True))


def listed_points(
    path: Path, network: Network, *, library: Library
) -> tuple[tuple[Axis, ...], list[Point]]:
    """The points of a CSV file: columns named ``NODE.PARAM``, a row for each point.

    A unit in parentheses behind the name must be the parameter's own.

    Raises
    ------
    FileError, UsageError, ParameterError
        Naming file, line and column of what cannot be used.
    """
    name = shown_path(str(path))
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise FileError(f"cannot read {name}: it is no regular file")
    try:
        if (length := path.stat().st_size) > _MOST_BYTES:
            raise FileError(f"{name}: a list of {length} bytes; allowed: {_MOST_BYTES}")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise FileError(f"cannot read {name}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{name}: it is no text in UTF-8") from error
    lines = [line for line in csv.reader(io.StringIO(text)) if any(cell.strip() for cell in line)]
    if len(lines) < 2:
        raise FileError(f"{name}: a line of names NODE.PARAM and one for each point must be there")
    heads = [plain_cell(head.strip()) for head in lines[0]]
    labels = [head.partition(" (")[0] for head in heads]
    if len(set(labels)) < len(labels):
        raise FileError(f"{name}: two columns have one name")
    _check_number(len(lines) - 1)
    columns: list[list[Any]] = [[] for _ in labels]
    axes = []
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(heads):
            raise FileError(f"{name}: line {number} has {len(line)} cells, the first {len(heads)}")
        for column, cell in zip(columns, line, strict=True):
            column.append(plain_cell(cell.strip()))
    for place, (label, head) in enumerate(zip(labels, heads, strict=True)):
        node, parameter = target(name, label, network, library=library)
        axis = Axis(label, node, parameter)
        if head not in (label, f"{label} ({axis.unit})"):
            unit = axis.unit or "none"
            raise FileError(f"{name}: column {head}: the parameter's own unit is {unit}")
        columns[place] = [
            from_here(_read(axis, cell, f"{name}: line {number}"), parameter, path.parent)
            for number, cell in enumerate(columns[place], 2)
        ]
        axes.append(of_files(replace(axis, values=tuple(dict.fromkeys(columns[place])))))
    return tuple(axes), list(zip(*columns, strict=True))


def order_of(axes: Sequence[Axis], points: Sequence[Point], network: Network) -> list[int]:
    """The points' places in the order that repeats least: what is deepest in the chain moves first.

    A parameter on which few nodes hang leaves the most of the chain as it was.
    """
    touched = [len(nodes_after(network, axis.node)) for axis in axes]
    outwards = sorted(range(len(axes)), key=lambda place: -touched[place])
    ranks = [{value: rank for rank, value in enumerate(axis.values)} for axis in axes]

    def rank(place: int) -> tuple[int, ...]:
        point = points[place]
        return tuple(ranks[axis][point[axis]] for axis in outwards)

    return sorted(range(len(points)), key=rank)


def _check_number(count: int) -> None:
    if not 1 <= count <= MOST_POINTS:
        raise UsageError(
            f"the study would have {count} points: from 1 to {MOST_POINTS} are allowed"
        )


def _read(axis: Axis, cell: str, where: str) -> Any:
    """The value of a cell: as JSON or a number where the parameter takes that, else as text."""
    first: ParameterError | None = None
    for reading in readings(cell):
        try:
            allowed(axis.parameter, reading, axis.node)
        except ParameterError as error:
            first = first or error
        else:
            return plain(axis.parameter.coerce(reading))
    assert first is not None
    first.message = f"{where}: {first.message}"
    raise first
