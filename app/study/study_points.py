"""The points of a study, and the order in which they are computed."""

from __future__ import annotations

import csv
import glob
import io
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from app.run.option_values import assignment
from app.run.overrides import behind, first_taken, from_here
from app.tradeoff.tradeoff_figures import nodes_after
from app.tradeoff.values import OPTION, Variation, one_value, taken_value, variation
from core.errors import FileError, ParameterError, UsageError
from core.modules.declaration import Library
from core.modules.parameters import Parameter
from core.names import shown, shown_path
from core.network.network import Network
from nodes.files.common.file_format import CSV
from nodes.files.common.table_cells import plain_cell

MOST_POINTS = 1_000_000
_MOST_BYTES = 1 << 27  # of a list: a hundred for each point; its cells take ten times as much
Point = tuple[Any, ...]
"""A value for each axis."""


GRID, LATIN = "grid", "latin"
Values = str | Sequence[Any]


def sampled(
    network: Network,
    vary: Mapping[str, Values],
    sample: str,
    points: int | None,
    *,
    library: Library,
) -> tuple[tuple[Variation, ...], Sequence[Point]]:
    if points is not None and sample != LATIN:
        raise UsageError(f"--points {points}: works only with --sample latin")
    if sample in (GRID, LATIN):
        axes = tuple(
            _axis(label, values, network, library, drawn=sample == LATIN)
            for label, values in vary.items()
        )
        if sample == GRID:
            return axes, grid_points(axes)
        if points is None or not axes:
            raise UsageError(
                "--sample latin: also give --points N, the number of points, and --vary "
                "NODE.PARAM=FROM:TO, the range"
            )
        return latin_points(axes, points, network.seed)
    if vary:
        raise UsageError(
            f"--vary {next(iter(vary)):.80}: works only with --sample grid or latin; the points "
            f"come from {sample:.120}"
        )
    if not CSV.matches(Path(sample)):
        raise UsageError(f"--sample {sample:.120}: write grid, latin, or the name of a .csv file")
    return listed_points(Path(sample), network, library=library)


def grid_points(axes: Sequence[Variation]) -> tuple[Point, ...]:
    """Every value of an axis with every value of the others; the last axis moves first."""
    _check_number(math.prod(len(axis.values) for axis in axes))
    return tuple(itertools.product(*(axis.values for axis in axes)))


def latin_points(
    axes: Sequence[Variation], count: int, seed: int
) -> tuple[tuple[Variation, ...], list[Point]]:
    """A Latin hypercube: of `count` equal parts of each range, every part is taken once.

    Within its part a value is drawn uniformly (McKay, Beckman and Conover 1979). The axes come back
    with the values that have been drawn.
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
) -> tuple[tuple[Variation, ...], list[Point]]:
    """The points of a CSV file, a row each; a unit behind a name must be that of the parameter."""
    name = shown_path(str(path))
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise FileError(f"cannot read {name}: it is not a regular file")
    try:
        if (length := path.stat().st_size) > _MOST_BYTES:
            raise FileError(f"{name}: {length} bytes are too many; allowed: at most {_MOST_BYTES}")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise FileError(f"cannot read {name}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{name}: not UTF-8 text") from error
    lines = [line for line in csv.reader(io.StringIO(text)) if any(cell.strip() for cell in line)]
    if len(lines) < 2:
        raise FileError(
            f"{name}: it must have a first line of names NODE.PARAM, and one line for each point"
        )
    heads = [plain_cell(head.strip()) for head in lines[0]]
    labels = [head.partition(" (")[0] for head in heads]
    if len(set(labels)) < len(labels):
        raise FileError(f"{name}: two columns have the same name")
    _check_number(len(lines) - 1)
    columns: list[list[Any]] = [[] for _ in labels]
    axes = []
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(heads):
            raise FileError(
                f"{name}: line {number} has {len(line)} cells, but the first line has {len(heads)}"
            )
        for column, cell in zip(columns, line, strict=True):
            column.append(plain_cell(cell.strip()))
    for place, (label, head) in enumerate(zip(labels, heads, strict=True)):
        node, parameter = _target(name, label, network, library=library)
        axis = Variation(node, parameter, given=label)
        if head not in (label, axis.title):
            unit = axis.unit or "none"
            raise FileError(f"{name}: column {head}: the unit must be the parameter's, {unit}")
        columns[place] = [
            from_here(_read(axis, cell, f"{name}: line {number}"), parameter, path.parent)
            for number, cell in enumerate(columns[place], 2)
        ]
        axes.append(_of_files(replace(axis, values=tuple(dict.fromkeys(columns[place])))))
    return tuple(axes), list(zip(*columns, strict=True))


def order_of(axes: Sequence[Variation], points: Sequence[Point], network: Network) -> list[int]:
    """The places in the order that repeats least: what few nodes hang on moves first."""
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


def _read(axis: Variation, cell: str, where: str) -> Any:
    try:
        return first_taken(cell, partial(taken_value, axis.parameter))
    except ParameterError as error:
        refused = error.at(axis.node)
        refused.message = f"{where}: {refused.message}"
        raise refused from error


# What a study varies: parameters over values or ranges, and files that match a pattern.

OVER = "--over"
MOST_VALUES = 1_000_000
_OVER_FORM = "NODE.PARAM=PATTERN, such as scene.path='scenes/*.img'"


def _axis(
    label: str, values: Values, network: Network, library: Library, *, drawn: bool
) -> Variation:
    if isinstance(values, str):
        text = f"{label}={values}"
        axis = variation(text, network, library=library, most=MOST_VALUES, drawn=drawn)
        for value in axis.span or axis.values:
            _allowed(axis.parameter, value, axis.node)
    else:
        node, parameter = _target(OPTION, label, network, library=library)
        items = (value.item() if isinstance(value, np.generic) else value for value in values)
        taken = (from_here(_allowed(parameter, item, node), parameter) for item in items)
        axis = Variation(node, parameter, tuple(dict.fromkeys(taken)))
        if not axis.values:
            raise UsageError(f"{OPTION} {label}: there are no values")
    return _of_files(replace(axis, given=label))


def _target(
    option: str, label: str, network: Network, *, library: Library
) -> tuple[str, Parameter]:
    inner = behind(assignment(option, f"{label}=", "NODE.PARAM"), network)
    return inner.node, one_value(option, inner, network, library)


def files_axis(text: str, network: Network, *, library: Library) -> Variation:
    """The files that match ``--over NODE.PARAM=PATTERN``, 2 before 10."""
    setting = assignment(OVER, text, _OVER_FORM)
    inner = behind(setting, network)
    parameter = one_value(OVER, inner, network, library)
    if parameter.kind != "path":
        raise UsageError(f"{OVER} {setting.port}: it takes {parameter.allowed()}, not a file name")
    matching = glob.glob(setting.text, recursive=True)  # noqa: PTH207, as Path's needs a folder
    names = [name for name in matching if Path(name).is_file()]
    if not names:
        raise FileError(f"{OVER} {setting.port}={shown(setting.text)}: no file matches")
    names.sort(key=natural)
    by_value = {Path(name).absolute().as_posix(): Path(name).as_posix() for name in names}
    return Variation(inner.node, parameter, tuple(by_value), given=setting.port, names=by_value)


def natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """A key that sorts names as people do: 2 before 10."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return tuple((0, int(p), p) if "0" <= p[0] <= "9" else (1, 0, p) for p in parts)


def _allowed(parameter: Parameter, value: Any, node: str) -> Any:
    try:
        return taken_value(parameter, value)
    except ParameterError as error:
        raise error.at(node) from error


def _of_files(axis: Variation) -> Variation:
    if axis.parameter.kind != "path":
        return axis
    here = Path().absolute()
    files = [Path(value) for value in axis.values if value]
    names = {
        file.as_posix(): (file.relative_to(here) if file.is_relative_to(here) else file).as_posix()
        for file in files
    }
    return replace(axis, names=names)
