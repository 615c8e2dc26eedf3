"""A study: what it varies, checked before it starts, and how it is carried out."""

import contextlib
import csv
import glob
import io
import itertools
import math
import re
import threading
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

from app.run import overrides
from app.run.option_values import Save, assignment, study_path
from app.run.saving import check_suffix, is_cube, region_of
from app.run.staging import Staging, check_folder
from app.run.terminal import Stopped, too_late, version
from app.study import study_rows
from app.study.worker_processes import cluster_rows, process_rows
from app.tradeoff.tradeoff_results import Figure, chosen_figures, nodes_after, with_value
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.errors import (
    Cancelled,
    FileError,
    ImagechainError,
    ParameterError,
    Suspended,
    UsageError,
    placed,
    several,
    shown,
    shown_path,
)
from core.evaluation.recipes import content_key
from core.evaluation.work import Policy
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter
from core.network.network import Network
from core.network.validation import check_network, plain_network
from core.records import dataclass, replace
from nodes.files.file_format import CSV
from nodes.files.table_cells import plain_cell
from nodes.library import standard_library

# The points: a value for each axis.

MOST_POINTS = 1_000_000
_MOST_BYTES = 1 << 27  # of a list: a hundred for each point; its cells take ten times as much
GRID, LATIN = "grid", "latin"
Values = str | Sequence[Any]


def sampled(
    network: Network,
    vary: Mapping[str, Values],
    sample: str,
    points: int | None,
    *,
    library: Library,
) -> tuple[tuple[overrides.Variation, ...], Sequence[study_rows.Point]]:
    if points is not None and sample != LATIN:
        raise UsageError(f"--points {points}: works only with --sample latin")
    if sample in (GRID, LATIN):
        drawn = sample == LATIN
        axes = tuple(_axis(*each, network, library, drawn=drawn) for each in vary.items())
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


def grid_points(axes: Sequence[overrides.Variation]) -> tuple[study_rows.Point, ...]:
    """Every value of an axis with every value of the others; the last axis moves first."""
    _check_number(math.prod(len(axis.values) for axis in axes))
    return tuple(itertools.product(*(axis.values for axis in axes)))


def latin_points(
    axes: Sequence[overrides.Variation], count: int, seed: int
) -> tuple[tuple[overrides.Variation, ...], list[study_rows.Point]]:
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
    pairs = zip(axes, columns, strict=True)
    drawn = tuple(replace(axis, values=tuple(dict.fromkeys(column))) for axis, column in pairs)
    return drawn, list(zip(*columns, strict=True))


def listed_points(
    path: Path, network: Network, *, library: Library
) -> tuple[tuple[overrides.Variation, ...], list[study_rows.Point]]:
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
            f"{name}: fewer than two lines. The first line must name the parameters as NODE.PARAM, "
            "and each further line must give one point"
        )
    heads = [plain_cell(head.strip()) for head in lines[0]]
    labels = [head.partition(" (")[0] for head in heads]
    if len(set(labels)) < len(labels):
        raise FileError(f"{name}: two columns have the same name")
    _check_number(len(lines) - 1)
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(heads):
            raise FileError(
                f"{name}: line {number} has {several(len(line), 'cell')}, but the first "
                f"line has {len(heads)}"
            )
    axes, columns = [], []
    for place, (label, head) in enumerate(zip(labels, heads, strict=True)):
        node, parameter = _target(name, label, network, library)
        axis = overrides.Variation(node, parameter, given=label)
        if head not in (label, axis.title):
            unit = axis.unit or "none"
            raise FileError(f"{name}: column {head}: the parameter's unit is {unit}")
        cells = enumerate((plain_cell(line[place].strip()) for line in lines[1:]), 2)
        values = [_read(axis, cell, f"{name}: line {number}") for number, cell in cells]
        columns.append([overrides.from_here(value, parameter, path.parent) for value in values])
        axes.append(_of_files(replace(axis, values=tuple(dict.fromkeys(columns[-1])))))
    return tuple(axes), list(zip(*columns, strict=True))


def order_of(
    axes: Sequence[overrides.Variation], points: Sequence[study_rows.Point], network: Network
) -> list[int]:
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
        raise UsageError(f"the study would have {count} points; allowed: 1 to {MOST_POINTS}")


def _read(axis: overrides.Variation, cell: str, where: str) -> Any:
    try:
        return overrides.first_taken(cell, partial(overrides.taken_value, axis.parameter))
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
) -> overrides.Variation:
    if isinstance(values, str):
        text = f"{label}={values}"
        axis = overrides.variation(text, network, library=library, most=MOST_VALUES, drawn=drawn)
        for value in axis.span or axis.values:
            _allowed(axis.parameter, value, axis.node)
    else:
        node, parameter = _target(overrides.OPTION, label, network, library)
        items = (value.item() if isinstance(value, np.generic) else value for value in values)
        taken = (overrides.from_here(_allowed(parameter, item, node), parameter) for item in items)
        axis = overrides.Variation(node, parameter, tuple(dict.fromkeys(taken)))
        if not axis.values:
            raise UsageError(f"{overrides.OPTION} {label}: there are no values")
    return _of_files(replace(axis, given=label))


def _target(option: str, label: str, network: Network, library: Library) -> tuple[str, Parameter]:
    inner = overrides.behind(assignment(option, f"{label}=", "NODE.PARAM"), network)
    return inner.node, overrides.one_value(option, inner, network, library)


def files_axis(text: str, network: Network, *, library: Library) -> overrides.Variation:
    """The files that match ``--over NODE.PARAM=PATTERN``, 2 before 10."""
    setting = assignment(OVER, text, _OVER_FORM)
    inner = overrides.behind(setting, network)
    parameter = overrides.one_value(OVER, inner, network, library)
    if parameter.kind != "path":
        allowed = f"the parameter is {parameter.allowed()}, not a file name"
        raise UsageError(f"{OVER} {setting.port}: {allowed}")
    matching = glob.glob(setting.text, recursive=True)  # noqa: PTH207, as Path's needs a folder
    names = [name for name in matching if Path(name).is_file()]
    if not names:
        raise FileError(f"{OVER} {setting.port}={shown(setting.text)}: no file matches")
    names.sort(key=natural)
    by_value = {Path(name).absolute().as_posix(): Path(name).as_posix() for name in names}
    return overrides.Variation(
        inner.node, parameter, tuple(by_value), given=setting.port, names=by_value
    )


def natural(name: str) -> tuple[tuple[int, int, str], ...]:
    """A key that sorts names as people do: 2 before 10."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return tuple((0, int(p), p) if "0" <= p[0] <= "9" else (1, 0, p) for p in parts)


def _allowed(parameter: Parameter, value: Any, node: str) -> Any:
    with placed(node):
        return overrides.taken_value(parameter, value)


def _of_files(axis: overrides.Variation) -> overrides.Variation:
    if axis.parameter.kind != "path":
        return axis
    here = Path().absolute()
    files = [Path(value) for value in axis.values if value]
    names = {
        file.as_posix(): (file.relative_to(here) if file.is_relative_to(here) else file).as_posix()
        for file in files
    }
    return replace(axis, names=names)


@dataclass(frozen=True)
class Study:
    name: str  # of the network
    setting: study_rows.Setting  # what all points have in common
    library: Library  # the modules
    axes: tuple[overrides.Variation, ...]  # what varies
    points: tuple[study_rows.Point, ...]  # A value for each axis
    files: list[tuple[str, ...]]  # the saved pictures, by point

    @property
    def figures(self) -> tuple[Figure, ...]:
        return self.setting.figures

    @cached_property
    def order(self) -> list[int]:
        return order_of(self.axes, self.points, self.setting.network)

    @property
    def inputs(self) -> list[Path]:
        nodes, folder = self.setting.network.nodes.values(), self.setting.folder
        own = [
            file for node in nodes for file in study_rows.input_paths(node, self.library, folder)
        ]
        return [*own, *(Path(v) for axis in self.axes for v in axis.values if v in axis.names)]

    @cached_property
    def key(self) -> str:
        """Content key: of two studies with one key all rows are the same."""
        return content_key(
            study_rows.network_key(self.setting.network, self.setting, self.library),
            tuple(axis.text for axis in self.axes),
            self.points,
            tuple((figure.text, figure.unit, figure.by_default) for figure in self.figures),
            tuple((save.port, save.bounds) for save in self.setting.saves),
            tuple(self.files),
            tuple(study_rows.file_stamp(file) for file in self.inputs),
        )

    def check_places(self, outputs: Sequence[Path], read: Sequence[Path] = ()) -> None:
        inputs = [*read, *self.inputs]
        with Staging(None, inputs) as staging:
            for path in outputs:
                staging.claim(path)
                staging.check(path.with_name(path.name + study_rows.SUFFIX))
            for folder in dict.fromkeys(Path(name).parent for row in self.files for name in row):
                check_folder(folder)
            taken = {str(path.absolute()) for path in (*outputs, *inputs)}
            taken |= {str(path.absolute()) + study_rows.SUFFIX for path in outputs}
            for row in self.files:
                for save, name in zip(self.setting.saves, row, strict=True):
                    if name in taken:
                        raise UsageError(f"{save.shown}: {shown(name)} is already a file "
                                         "of this study; choose another name")  # fmt: skip


@dataclass(frozen=True)
class StudyRows:
    study: Study  # what was wanted
    rows: tuple[study_rows.Row, ...]  # by point
    start_s: float = 0.0  # what the start of workers took, which is no row's

    @property
    def failed(self) -> list[study_rows.Row]:
        return [row for row in self.rows if row.error]

    def columns(self) -> list[study_rows.Column]:
        """The rows as a table, without the default figures that have no value at any point."""
        study = self.study
        columns = [study_rows.Column("point", "", [row.place + 1 for row in self.rows])]
        for number, axis in enumerate(study.axes):
            values = [axis.shown(study.points[row.place][number]) for row in self.rows]
            columns.append(study_rows.Column(axis.text, axis.unit, values))
        for number, figure in enumerate(study.figures):
            values = [row.figures[number] for row in self.rows]
            if not figure.by_default or any(value is not None for value in values):
                columns.append(study_rows.Column(figure.text, figure.unit, values))
        columns.append(study_rows.Column("key", "", [row.key for row in self.rows]))
        columns.append(study_rows.Column("seconds", "s", [row.seconds for row in self.rows]))
        columns.append(study_rows.Column("error", "", [row.error for row in self.rows]))
        columns.append(
            study_rows.Column("warnings", "", ["; ".join(row.warnings) for row in self.rows])
        )
        return columns


def make_study(
    network: Network,
    *,
    name: str,
    folder: Path,
    library: Library,
    vary: Mapping[str, Values] | None = None,
    over: Sequence[str] = (),
    sample: str = GRID,
    points: int | None = None,
    figures: Sequence[str] = (),
    saves: Sequence[Save] = (),
    policy: Policy | None = None,
    read: Sequence[Path] = (),
    output: Path | None = None,
    summaries: Sequence[Path] = (),
) -> Study:
    """A study of every file with every sampled point, checked before it starts."""
    if output is not None:
        study_rows.check_installed(output)
    overs = [files_axis(text, network, library=library) for text in over]
    drawn, inner_points = sampled(network, vary or {}, sample, points, library=library)
    axes = (*overs, *drawn)
    if not axes:
        raise UsageError(
            f"nothing is varied: give {overrides.OPTION} NODE.PARAM=VALUES, {OVER} or --sample FILE"
        )
    places = [(axis.node, axis.parameter.name) for axis in axes]
    for number, axis in enumerate(axes):
        if places.index(places[number]) < number:
            raise UsageError(f"{axis.text} is varied twice: vary another parameter")
    across = grid_points(overs)
    if len(across) * len(inner_points) > MOST_POINTS:
        raise UsageError(
            f"the study would have {len(across)} × {len(inner_points)} points; at most "
            f"{MOST_POINTS} are allowed"
        )
    every = tuple((*outer, *inner) for outer, inner in itertools.product(across, inner_points))
    chosen = () if saves and not figures else chosen_figures(figures, network, library)
    engine, varied = Engine(library), network
    for (node, parameter), value in zip(places, every[0], strict=True):
        varied = with_value(varied, engine, node, parameter, value)
    first = engine.plan(varied, folder=folder)
    _check_saves(saves, first, network, library)
    units = tuple(_with_unit(figure, first) for figure in chosen)
    what = tuple(places), units, tuple(saves)
    setting = study_rows.Setting(network, folder.absolute(), *what, policy or Policy(), version())
    files = study_rows.file_names(saves, axes, every) if saves else []
    study = Study(name, setting, library, axes, every, files)
    listed_in = [Path(sample)] if CSV.matches(Path(sample)) else []
    study.check_places([*filter(None, [output]), *summaries], [*read, *listed_in])
    return study


def _with_unit(figure: Figure, plan: Plan) -> Figure:
    planned = plan.nodes.get(figure.node)
    if figure.is_total or planned is None or planned.module is None:
        return figure
    readouts = {readout.name: readout for readout in planned.declaration.readouts}
    return replace(figure, unit=planned.unit(readouts[figure.name]))


def _check_saves(saves: Sequence[Save], plan: Plan, network: Network, library: Library) -> None:
    for save in saves:
        node, _, port = network.port_names.get(save.port, save.port).rpartition(".")
        if node not in network.nodes:
            hint = overrides.near(save.node, network.nodes)
            raise UsageError(f"{save.shown}: the network has no node {shown(save.node)}{hint}")
        module = library.get(network.nodes[node].module)
        ports = [] if module is None else [output.name for output in declaration(module).outputs]
        if port not in ports:
            raise UsageError(
                f"{save.shown}: {node} has no output {shown(port)}{overrides.near(port, ports)}"
            )
        try:
            value = plan.output(save.port)
        except ImagechainError:
            continue  # the rows say why
        path = Path(save.text)
        if is_cube(value, path):
            raise UsageError(
                f"{save.shown}: a study writes pictures (.tif, .exr or .npy), not cubes"
            )
        check_suffix(save.port, value, path)
        if not isinstance(value, Image):
            region_of(save, value)


ALONE_S = 0.5
"""How long one process computes before it is known what the rest of the study takes."""
_WORTH_S = 4.0  # of one process: less is done sooner than others have begun
Reached = Callable[[int], None]
Summarise = Callable[[StudyRows], object]


def carry_out(
    study: Study,
    workers: study_rows.Workers,
    *,
    output: Path | None = None,
    fresh: bool = False,
    reached: Reached | None = None,
    cancel: threading.Event | None = None,
    summarise: Summarise = lambda _: None,
) -> StudyRows:
    """Compute the points that the journal beside `output` lacks, then write the files."""
    workers.check()
    if output is None:
        result = _collected(study, workers, {}, cancel, reached)
        summarise(result)
        return result
    with study_rows.Journal(output, study.key, len(study.points), fresh=fresh) as journal:
        for row in [*journal.rows.values()]:
            files = study.files[row.place] if study.files and not row.error else ()
            if not all(Path(file).exists() for file in files):
                del journal.rows[row.place]  # made anew: a later line of the same point holds
        try:
            result = _collected(study, workers, journal.rows, cancel, reached, journal.add)
        except (Stopped, Cancelled) as error:
            raise Suspended(_kept("stopped", journal, study)) from error
        except ImagechainError as error:
            error.message = _kept(error.message, journal, study)
            raise
        too_late(cancel)
        study_rows.write_columns(result.columns(), output, study.name)
        summarise(result)
        journal.remove()
    return result


def _collected(
    study: Study,
    workers: study_rows.Workers,
    rows: dict[int, study_rows.Row],
    cancel: threading.Event | None,
    reached: Reached | None,
    keep: Callable[[list[study_rows.Row]], object] = lambda _: None,
) -> StudyRows:
    """All rows, of which some may be there; the others are added, and kept as they come."""
    reached = reached or (lambda _: None)
    reached(len(rows))
    start, start_s = time.monotonic(), 0.0
    with contextlib.closing(_made(study, workers, rows, cancel)) as batches:
        for made in batches:
            if not (made or start_s):
                start_s = time.monotonic() - start
            keep(made)
            rows.update((row.place, row) for row in made)
            reached(len(rows))
    return StudyRows(study, tuple(rows[place] for place in range(len(study.points))), start_s)


def run_study(
    network: Network,
    workers: study_rows.Workers,
    *,
    output: str | None = None,
    summaries: Sequence[Path] = (),
    summarise: Summarise = lambda _: None,
    fresh: bool = False,
    name: str = "",
    folder: Path = Path(),
    **asked: Any,
) -> StudyRows:
    """A study as the command carries it out; what is `asked` is as for `make_study`."""
    library = standard_library()
    plain = plain_network(network, library=library)
    check_network(plain, library=library)
    path = None if output is None else study_path("--output", output)
    places: dict[str, Any] = {"folder": folder, "output": path, "summaries": summaries}
    study = make_study(plain, name=plain.name or name, library=library, **places, **asked)
    if workers.warning:
        warnings.warn(workers.warning, UserWarning, stacklevel=2)
    return carry_out(study, workers, output=path, summarise=summarise, fresh=fresh)


def _made(
    study: Study,
    workers: study_rows.Workers,
    done: Mapping[int, study_rows.Row],
    cancel: threading.Event | None,
) -> Generator[list[study_rows.Row]]:
    """The rows that are not done: by this process, or by others as soon as that is worth it."""
    order = [place for place in study.order if place not in done]
    files = study.files or [()] * len(study.points)
    tasks = [(place, study.points[place], files[place]) for place in order]
    if tasks and (workers.scheduler or workers.jobs > 1):
        yield from _by_others(study, workers, tasks, workers.jobs, cancel)
        return
    several = workers.jobs == 0 and Policy().workers > 1
    took: list[float] = []
    start = time.monotonic()
    maker = None
    for number, task in enumerate(tasks, 1):
        maker = maker or study_rows.RowMaker(
            _setting(study, workers, study.setting.policy), study.library
        )
        if cancel is not None and cancel.is_set():
            raise Cancelled("stopped on request")
        row = maker.row(task, cancel)
        took.append(row.seconds)
        yield [row]
        if several and time.monotonic() > start + ALONE_S:
            several = False
            usual = took[1:] or took  # the first one makes what the others share
            if sum(usual) / len(usual) * (len(tasks) - number) > _WORTH_S:
                del maker  # and what it has kept
                yield from _by_others(study, workers, tasks[number:], Policy().workers, cancel)
                return


def _by_others(
    study: Study,
    workers: study_rows.Workers,
    tasks: list[study_rows.Task],
    jobs: int,
    cancel: threading.Event | None,
) -> Generator[list[study_rows.Row]]:
    policy, scheduler = study.setting.policy, workers.scheduler
    if not scheduler:
        # The engine's threads beside those of the other processes would be in their way.
        threads = policy.threads or max(1, Policy().workers // jobs)
        setting = _setting(study, workers, replace(policy, threads=threads))
        return process_rows(setting, tasks, jobs, cancel)
    setting = _setting(study, workers, replace(policy, threads=policy.threads or 1))
    return cluster_rows(setting, study.key, tasks, scheduler, cancel)


def _setting(study: Study, workers: study_rows.Workers, policy: Policy) -> study_rows.Setting:
    return replace(study.setting, policy=policy, memory_bytes=workers.memory_bytes)


def _kept(why: str, journal: study_rows.Journal, study: Study) -> str:
    return (
        f"{why}; {len(journal.rows)} of {len(study.points)} points done and saved in "
        f"{journal.path}. Give the same command again to resume"
    )
