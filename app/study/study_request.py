"""A study as it is to be carried out: all that its rows depend on, checked before it starts."""

from __future__ import annotations

import itertools
import os
import re
import string
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from app.run.option_values import Save
from app.run.overrides import listed
from app.run.process import version
from app.run.saving import check_suffix, is_cube
from app.run.staging import Staging, check_folder
from app.study.point_rows import Row, Setting, file_stamp, input_paths, network_key
from app.study.study_journal import SUFFIX, Column, check_installed
from app.study.study_points import (
    MOST_POINTS,
    OVER,
    Point,
    Values,
    files_axis,
    grid_points,
    order_of,
    sampled,
)
from app.tradeoff.tradeoff_figures import Figure, chosen_figures
from app.tradeoff.tradeoff_results import with_value
from app.tradeoff.values import OPTION, Variation
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.errors import ImagechainError, UsageError
from core.evaluation.policy import Policy
from core.evaluation.recipes import content_key
from core.modules.declaration import Library, declaration
from core.names import close, shown
from core.network.network import Network
from nodes.files.common.file_format import CSV

# The files of ``--save NODE.PORT=PATTERN``: a name for each point of a study.

POINT, SCENE = "point", "scene"


class _FileName(string.Formatter):
    """Fills a pattern's fields, such as ``{point}`` or ``{NODE.PARAM:.2f}``."""

    def __init__(self, points: int) -> None:
        self._digits = len(str(points))  # zeros lead a point's number where it has no format

    def get_field(self, field_name: str, _: Any, kwargs: Mapping[str, Any]) -> tuple[Any, str]:
        if field_name not in kwargs:
            hint = close(field_name, kwargs) or f"; there are {', '.join(kwargs)}"
            raise ValueError(f"the study has no field {shown(field_name)}{hint}")
        return (field_name, kwargs[field_name]), field_name

    def convert_field(self, value: Any, conversion: Any) -> Any:
        if conversion:
            raise ValueError("only a number format may follow a field's name")
        return value

    def format_field(self, value: Any, format_spec: str) -> str:
        name, value = value
        if re.search("[0-9]{4}", format_spec):
            raise ValueError(f"{{{name}:{format_spec:.20}}}: at most 999 characters or digits")
        form = format_spec or (f"0{self._digits}d" if name == POINT else "")
        try:
            word = format(value, form) if form else _plain_word(value)
        except (ValueError, TypeError) as error:
            raise ValueError(f"{{{name}:{form}}}: {error}") from error
        if not word or word in (".", "..") or any(c in word for c in ("/", "\\", "\0")):
            raise ValueError(f"{name} = {shown(word)} cannot be part of a file name")
        return word


def file_names(
    saves: Sequence[Save], axes: Sequence[Variation], points: Sequence[Point]
) -> list[tuple[str, ...]]:
    """The files of each point, one for each pattern, from the current folder on."""
    formatter = _FileName(len(points))
    taken: dict[str, int] = {}
    names = []
    for number, point in enumerate(points, 1):
        values = _fields(axes, point, number)
        row = []
        for save in saves:
            try:
                name = os.path.abspath(formatter.vformat(save.text, (), values))  # noqa: PTH100
            except ValueError as error:
                raise UsageError(f"{save.shown}: {error}") from error
            if other := taken.get(name):
                whose = f"points {other} and {number}" if other != number else f"point {number}"
                fields = ", ".join(f"{{{field}}}" for field in values)
                raise UsageError(
                    f"{save.shown}: two files of {whose} would be {shown(name)}; "
                    f"name more of {fields}"
                )
            taken[name] = number
            row.append(name)
        names.append(tuple(row))
    return names


def folders(names: Iterable[tuple[str, ...]]) -> list[Path]:
    return list(dict.fromkeys(Path(name).parent for row in names for name in row))


def _fields(axes: Sequence[Variation], point: Point, number: int) -> dict[str, Any]:
    fields: dict[str, Any] = {POINT: number}
    stems = {}
    for axis, value in zip(axes, point, strict=True):
        fields[axis.text] = Path(value).stem if axis.is_files else value
        if axis.is_files:
            stems[axis.text.rpartition(".")[0]] = fields[axis.text]
    return {**fields, **stems, **({SCENE: next(iter(stems.values()))} if len(stems) == 1 else {})}


def _plain_word(value: Any) -> str:
    if value is None:
        return "empty"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(value)
    return str(value)


@dataclass(frozen=True)
class Study:
    name: str  # of the network
    network: Network  # macros written out, changes made
    folder: Path  # what file names in it are relative to
    library: Library  # the modules
    axes: tuple[Variation, ...]  # what varies
    points: tuple[Point, ...]  # A value for each axis
    figures: tuple[Figure, ...]  # the figures of each point, in the units that they have
    saves: tuple[Save, ...]  # the pictures of each point; their texts are patterns
    files: list[tuple[str, ...]]  # their files, by point
    policy: Policy  # precision, tolerance and threads

    @cached_property
    def order(self) -> list[int]:
        return order_of(self.axes, self.points, self.network)

    @property
    def inputs(self) -> list[Path]:
        nodes = self.network.nodes.values()
        own = [file for node in nodes for file in input_paths(node, self.library, self.folder)]
        return [*own, *(Path(v) for axis in self.axes for v in axis.values if v in axis.names)]

    def setting(self, policy: Policy | None = None) -> Setting:
        return Setting(
            self.network,
            self.folder.absolute(),
            tuple((axis.node, axis.parameter.name) for axis in self.axes),
            self.figures,
            self.saves,
            policy or self.policy,
            version(),
        )

    @cached_property
    def key(self) -> str:
        """Content key: of two studies with one key all rows are the same."""
        setting = self.setting()
        return content_key(
            network_key(self.network, setting, self.library),
            tuple(axis.text for axis in self.axes),
            self.points,
            tuple((figure.text, figure.unit, figure.by_default) for figure in self.figures),
            tuple((save.port, save.bounds) for save in self.saves),
            tuple(self.files),
            tuple(file_stamp(file) for file in self.inputs),
        )

    def check_places(self, outputs: Sequence[Path], read: Sequence[Path] = ()) -> None:
        inputs = [*read, *self.inputs]
        with Staging(None, inputs) as staging:
            for path in outputs:
                staging.claim(path)
                staging.check(path.with_name(path.name + SUFFIX))
            for folder in folders(self.files):
                check_folder(folder)
            taken = {str(path.absolute()) for path in (*outputs, *inputs)}
            taken |= {str(path.absolute()) + SUFFIX for path in outputs}
            for row in self.files:
                for save, name in zip(self.saves, row, strict=True):
                    if name in taken:
                        raise UsageError(f"{save.shown}: {shown(name)} is already a file "
                                         "of this study")  # fmt: skip


@dataclass(frozen=True)
class StudyRows:
    study: Study  # what was wanted
    rows: tuple[Row, ...]  # by point
    start_s: float = 0.0  # what the start of workers took, which is no row's

    @property
    def failed(self) -> list[Row]:
        return [row for row in self.rows if row.error]

    def columns(self) -> list[Column]:
        """The rows as a table, without the default figures that have no value at any point."""
        study = self.study
        columns = [Column("point", "", [row.place + 1 for row in self.rows])]
        for number, axis in enumerate(study.axes):
            values = [axis.shown(study.points[row.place][number]) for row in self.rows]
            columns.append(Column(axis.text, axis.unit, values))
        for number, figure in enumerate(study.figures):
            values = [row.figures[number] for row in self.rows]
            if not figure.by_default or any(value is not None for value in values):
                columns.append(Column(figure.text, figure.unit, values))
        columns.append(Column("key", "", [row.key for row in self.rows]))
        columns.append(Column("seconds", "s", [row.seconds for row in self.rows]))
        columns.append(Column("error", "", [row.error for row in self.rows]))
        columns.append(Column("warnings", "", ["; ".join(row.warnings) for row in self.rows]))
        return columns


def make_study(
    network: Network,
    *,
    name: str,
    folder: Path,
    library: Library,
    vary: Mapping[str, Values],
    over: Sequence[str],
    sample: str,
    points: int | None,
    figures: Sequence[str],
    saves: Sequence[Save],
    policy: Policy,
    read: Sequence[Path] = (),
    output: Path | None = None,
    summaries: Sequence[Path] = (),
) -> Study:
    """A study of every file with every sampled point, checked before it starts."""
    if output is not None:
        check_installed(output)
    overs = [files_axis(text, network, library=library) for text in over]
    drawn, inner_points = sampled(network, vary, sample, points, library=library)
    axes = (*overs, *drawn)
    if not axes:
        raise UsageError(
            f"nothing is varied: give {OPTION} NODE.PARAM=VALUES, {OVER} or --sample FILE"
        )
    places = [(axis.node, axis.parameter.name) for axis in axes]
    for number, axis in enumerate(axes):
        if places.index(places[number]) < number:
            raise UsageError(f"{axis.text} is varied twice: vary another parameter")
    across = grid_points(overs)
    if len(across) * len(inner_points) > MOST_POINTS:
        raise UsageError(
            f"the study would have {len(across)} × {len(inner_points)} points, at most "
            f"{MOST_POINTS} are allowed"
        )
    every = tuple((*outer, *inner) for outer, inner in itertools.product(across, inner_points))
    chosen = () if saves and not figures else chosen_figures(figures, network, library)
    first = _first_plan(network, folder, library, places, every[0])
    _check_saves(saves, first, network, library)
    study = Study(
        name,
        network,
        folder,
        library,
        axes,
        every,
        tuple(_with_unit(figure, first) for figure in chosen),
        tuple(saves),
        file_names(saves, axes, every) if saves else [],
        policy,
    )
    listed_in = [Path(sample)] if CSV.matches(Path(sample)) else []
    study.check_places([*filter(None, [output]), *summaries], [*read, *listed_in])
    return study


def _first_plan(
    network: Network,
    folder: Path,
    library: Library,
    places: Sequence[tuple[str, str]],
    values: Sequence[Any],
) -> Plan:
    engine = Engine(library)
    for (node, parameter), value in zip(places, values, strict=True):
        network = with_value(network, engine, node, parameter, value)
    return engine.plan(network, folder=folder)


def _with_unit(figure: Figure, plan: Plan) -> Figure:
    planned = plan.nodes.get(figure.node)
    if figure.is_total or planned is None or planned.module is None:
        return figure
    readouts = {readout.name: readout for readout in planned.declaration.readouts}
    unit = planned.unit(readouts[figure.name])
    return replace(figure, unit=unit)


def _check_saves(saves: Sequence[Save], plan: Plan, network: Network, library: Library) -> None:
    for save in saves:
        node, _, port = network.port_names.get(save.port, save.port).rpartition(".")
        if node not in network.nodes:
            hint = close(save.node, network.nodes) or listed(network.nodes)
            raise UsageError(f"{save.shown}: the network has no node {shown(save.node)}{hint}")
        module = library.get(network.nodes[node].module)
        ports = [] if module is None else [output.name for output in declaration(module).outputs]
        if port not in ports:
            hint = close(port, ports) or listed(ports)
            raise UsageError(f"{save.shown}: {node} has no output {shown(port)}{hint}")
        try:
            value = plan.output(save.port)
        except ImagechainError:
            continue  # the rows say why
        path = Path(save.text)
        if is_cube(value, path):
            raise UsageError(
                f"{save.shown}: a study writes pictures, not cubes: .tif, .exr or .npy"
            )
        check_suffix(save.port, value, path)
        if save.bounds and not isinstance(value, Image):
            raise UsageError(f"{save.shown}: only an image has a region, not a {value.port_type}")
