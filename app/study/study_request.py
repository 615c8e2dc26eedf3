"""A study: what it varies, checked before it starts, and how it is carried out."""

import contextlib
import csv
import glob
import io
import itertools
import math
import os
import re
import string
import threading
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from app.run import overrides
from app.run.option_values import Save, assignment, study_path
from app.run.saving import check_suffix, is_cube, region_of
from app.run.terminal import Stopped, exact, too_late, version
from app.study import study_rows
from app.study.worker_processes import cluster_rows, process_rows
from app.tradeoff.tradeoff_results import Figure, chosen_figures, with_value
from core import errors
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.evaluation.work import Policy
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter
from core.network.network import Network
from core.network.validation import check_network, plain_network
from core.records import replace
from nodes.files import file_format, table_cells
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
        raise errors.UsageError(f"--points {points}: works only with --sample latin")
    if sample in (GRID, LATIN):
        drawn = sample == LATIN
        axes = tuple(_axis(*each, network, library, drawn=drawn) for each in vary.items())
        if sample == GRID:
            return axes, grid_points(axes)
        if points is None or not axes:
            raise errors.UsageError(
                "--sample latin: also give --points N, the number of points, and --vary "
                "NODE.PARAM=FROM:TO, the range"
            )
        return latin_points(axes, points, network.seed)
    if vary:
        raise errors.UsageError(
            f"--vary {next(iter(vary)):.80}: works only with --sample grid or latin; the points "
            f"come from {sample:.120}"
        )
    if not file_format.CSV.matches(Path(sample)):
        raise errors.UsageError(
            f"--sample {sample:.120}: write grid, latin, or the name of a .csv file"
        )
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
    name = errors.shown_path(str(path))
    if path.exists() and not path.is_file():  # a pipe would be waited for
        raise errors.FileError(f"cannot read {name}: it is not a regular file")
    try:
        if (length := path.stat().st_size) > _MOST_BYTES:
            raise errors.FileError(
                f"{name}: too large, {length} bytes; allowed: at most {_MOST_BYTES}"
            )
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise errors.FileError(f"cannot read {name}: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise errors.FileError(f"{name}: not UTF-8 text") from error
    lines = [line for line in csv.reader(io.StringIO(text)) if any(cell.strip() for cell in line)]
    if len(lines) < 2:
        raise errors.FileError(
            f"{name}: fewer than two lines. The first line must name the parameters as NODE.PARAM, "
            "and each further line must give one point"
        )
    heads = [table_cells.plain_cell(head.strip()) for head in lines[0]]
    labels = [head.partition(" (")[0] for head in heads]
    if len(set(labels)) < len(labels):
        raise errors.FileError(f"{name}: two columns have the same name")
    _check_number(len(lines) - 1)
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(heads):
            raise errors.FileError(
                f"{name}: line {number} has {errors.several(len(line), 'cell')}, but the first "
                f"line has {len(heads)}"
            )
    axes, columns = [], []
    for place, (label, head) in enumerate(zip(labels, heads, strict=True)):
        node, parameter = _target(name, label, network, library)
        axis = overrides.Variation(node, parameter, given=label)
        if head not in (label, axis.title):
            unit = axis.unit or "none"
            raise errors.FileError(f"{name}: column {head}: the parameter's unit is {unit}")
        cells = enumerate((table_cells.plain_cell(line[place].strip()) for line in lines[1:]), 2)
        values = [_read(axis, cell, f"{name}: line {number}") for number, cell in cells]
        columns.append([overrides.from_here(value, parameter, path.parent) for value in values])
        axes.append(_of_files(replace(axis, values=tuple(dict.fromkeys(columns[-1])))))
    return tuple(axes), list(zip(*columns, strict=True))


def _check_number(count: int) -> None:
    if not 1 <= count <= MOST_POINTS:
        raise errors.UsageError(f"the study would have {count} points; allowed: 1 to {MOST_POINTS}")


def _read(axis: overrides.Variation, cell: str, where: str) -> Any:
    try:
        return overrides.first_taken(cell, partial(overrides.taken_value, axis.parameter))
    except errors.ParameterError as error:
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
            raise errors.UsageError(f"{overrides.OPTION} {label}: there are no values")
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
        raise errors.UsageError(f"{OVER} {setting.port}: {allowed}")
    matching = glob.glob(setting.text, recursive=True)  # noqa: PTH207, as Path's needs a folder
    names = [name for name in matching if Path(name).is_file()]
    if not names:
        raise errors.FileError(
            f"{OVER} {setting.port}={errors.shown(setting.text)}: no file matches"
        )
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
    with errors.placed(node):
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
    memory_bytes: int | None = None,
    read: Sequence[Path] = (),
    output: Path | None = None,
    summaries: Sequence[Path] = (),
) -> study_rows.Study:
    """A study of every file with every sampled point, checked before it starts."""
    if output is not None:
        study_rows.check_installed(output)
    overs = [files_axis(text, network, library=library) for text in over]
    drawn, inner_points = sampled(network, vary or {}, sample, points, library=library)
    axes = (*overs, *drawn)
    if not axes:
        raise errors.UsageError(
            f"nothing is varied: give {overrides.OPTION} NODE.PARAM=VALUES, {OVER} or --sample FILE"
        )
    places = [(axis.node, axis.parameter.name) for axis in axes]
    for number, axis in enumerate(axes):
        if places.index(places[number]) < number:
            raise errors.UsageError(f"{axis.text} is varied twice: vary another parameter")
    across = grid_points(overs)
    if len(across) * len(inner_points) > MOST_POINTS:
        raise errors.UsageError(
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
    setting = study_rows.Setting(
        network, folder.absolute(), *what, policy or Policy(), version(), memory_bytes
    )
    files = file_names(saves, axes, every) if saves else []
    study = study_rows.Study(name, setting, library, axes, every, files)
    listed_in = [Path(sample)] if file_format.CSV.matches(Path(sample)) else []
    study.check_places([*filter(None, [output]), *summaries], [*read, *listed_in])
    return study


def _with_unit(figure: Figure, plan: Plan) -> Figure:
    planned = plan.nodes.get(figure.node)
    if figure.is_total or planned is None or planned.module is None:
        return figure
    return replace(figure, unit=planned.units[figure.name])


def _check_saves(saves: Sequence[Save], plan: Plan, network: Network, library: Library) -> None:
    for save in saves:
        node, _, port = network.port_names.get(save.port, save.port).rpartition(".")
        if node not in network.nodes:
            hint = overrides.near(save.node, network.nodes)
            raise errors.UsageError(
                f"{save.shown}: the network has no node {errors.shown(save.node)}{hint}"
            )
        module = library.get(network.nodes[node].module)
        ports = [] if module is None else [output.name for output in declaration(module).outputs]
        if port not in ports:
            hint = overrides.near(port, ports)
            raise errors.UsageError(
                f"{save.shown}: {node} has no output {errors.shown(port)}{hint}"
            )
        try:
            value = plan.output(save.port)
        except errors.ImagechainError:
            continue  # the rows say why
        path = Path(save.text)
        if is_cube(value, path):
            raise errors.UsageError(
                f"{save.shown}: a study writes pictures (.tif, .exr or .npy), not cubes"
            )
        check_suffix(save.port, value, path)
        if not isinstance(value, Image):
            region_of(save, value)


# The files of ``--save NODE.PORT=PATTERN``: a name for each point of a study.

POINT, SCENE = "point", "scene"


def _filled(pattern: str, values: Mapping[str, Any], points: int) -> str:
    """A pattern with its fields filled, such as ``{point}`` or ``{NODE.PARAM:.2f}``."""
    text = ""
    for literal, name, spec, conversion in string.Formatter().parse(pattern):
        text += literal
        if name is None:
            continue
        if name not in values:
            hint = errors.close(name, values) or f"; its fields: {', '.join(values)}"
            raise ValueError(f"the study has no field {errors.shown(name)}{hint}")
        if conversion:
            raise ValueError("only a number format may follow a field's name")
        if re.search("[0-9]{4}", spec or ""):
            raise ValueError(
                f"{{{name}:{spec:.20}}}: width and digits of a number format must be at most 999"
            )
        # Zeros lead a point's number where it has no format.
        form = spec or (f"0{len(str(points))}d" if name == POINT else "")
        value = values[name]
        try:
            word = format(value, form) if form else "empty" if value is None else exact(value)
        except (ValueError, TypeError) as error:
            raise ValueError(f"{{{name}:{form}}}: {error}") from error
        if not word or word in (".", "..") or any(c in word for c in ("/", "\\", "\0")):
            raise ValueError(f"{name} = {errors.shown(word)} cannot be part of a file name")
        text += word
    return text


def file_names(
    saves: Sequence[Save], axes: Sequence[overrides.Variation], points: Sequence[study_rows.Point]
) -> list[tuple[str, ...]]:
    """The files of each point, one for each pattern, from the current folder on."""
    taken: dict[str, int] = {}
    names = []
    for number, point in enumerate(points, 1):
        values = _fields(axes, point, number)
        row = []
        for save in saves:
            try:
                name = os.path.abspath(_filled(save.text, values, len(points)))  # noqa: PTH100
            except ValueError as error:
                raise errors.UsageError(f"{save.shown}: {error}") from error
            if other := taken.get(name):
                whose = f"points {other} and {number}" if other != number else f"point {number}"
                fields = ", ".join(f"{{{field}}}" for field in values)
                raise errors.UsageError(
                    f"{save.shown}: two files of {whose} would both be named {errors.shown(name)}. "
                    f"Use more of the fields {fields} in the file name"
                )
            taken[name] = number
            row.append(name)
        names.append(tuple(row))
    return names


def _fields(
    axes: Sequence[overrides.Variation], point: study_rows.Point, number: int
) -> dict[str, Any]:
    fields: dict[str, Any] = {POINT: number}
    stems = {}
    for axis, value in zip(axes, point, strict=True):
        fields[axis.text] = Path(value).stem if axis.is_files else value
        if axis.is_files:
            stems[axis.text.rpartition(".")[0]] = fields[axis.text]
    return {**fields, **stems, **({SCENE: next(iter(stems.values()))} if len(stems) == 1 else {})}


ALONE_S = 0.5
"""How long one process computes before it is known what the rest of the study takes."""
_WORTH_S = 4.0  # of one process: less is done sooner than others have begun
Reached = Callable[[int], None]


def carry_out(
    study: study_rows.Study,
    *,
    jobs: int = 0,
    scheduler: Any = "",
    output: Path | None = None,
    fresh: bool = False,
    reached: Reached | None = None,
    cancel: threading.Event | None = None,
    summaries: Sequence[Path] = (),
) -> study_rows.StudyRows:
    """Compute the points that the journal beside `output` lacks, then write the files.

    `jobs` are processes of this machine; 0: all cores once the rest is worth it. A `scheduler`, the
    address of a Dask scheduler or a client of one, takes their place.
    """
    made = partial(_made, study, jobs, scheduler, cancel)
    if output is None:
        result = _collected(study, made, {}, reached)
        _summarise(result, summaries)
        return result
    with study_rows.Journal(output, study.key, len(study.points), fresh=fresh) as journal:
        for row in [*journal.rows.values()]:
            files = study.files[row.place] if study.files and not row.error else ()
            if not all(Path(file).exists() for file in files):
                del journal.rows[row.place]  # made anew: a later line of the same point holds
        try:
            result = _collected(study, made, journal.rows, reached, journal.add)
        except (Stopped, errors.Cancelled) as error:
            raise errors.Suspended(_kept("stopped", journal, study)) from error
        except errors.ImagechainError as error:
            error.message = _kept(error.message, journal, study)
            raise
        too_late(cancel)
        study_rows.write_columns(result.columns(), output, study.name)
        _summarise(result, summaries)
        journal.remove()
    return result


def _summarise(result: study_rows.StudyRows, summaries: Sequence[Path]) -> None:
    for path in summaries:
        from app.study.study_drawing import write_summary  # only where there is one

        write_summary(result, path)


def _collected(
    study: study_rows.Study,
    made: Callable[[Mapping[int, study_rows.Row]], Generator[list[study_rows.Row]]],
    rows: dict[int, study_rows.Row],
    reached: Reached | None,
    keep: Callable[[list[study_rows.Row]], object] = lambda _: None,
) -> study_rows.StudyRows:
    """All rows, of which some may be there; the others are added, and kept as they come."""
    reached = reached or (lambda _: None)
    reached(len(rows))
    start, start_s = time.monotonic(), 0.0
    with contextlib.closing(made(rows)) as batches:
        for batch in batches:
            if not (batch or start_s):
                start_s = time.monotonic() - start
            keep(batch)
            rows.update((row.place, row) for row in batch)
            reached(len(rows))
    return study_rows.StudyRows(
        study, tuple(rows[place] for place in range(len(study.points))), start_s
    )


def run_study(
    network: Network,
    *,
    jobs: int = 0,
    scheduler: Any = "",
    output: str | None = None,
    summaries: Sequence[Path] = (),
    fresh: bool = False,
    name: str = "",
    folder: Path = Path(),
    **asked: Any,
) -> study_rows.StudyRows:
    """A study as the command carries it out; what is `asked` is as for `make_study`."""
    library = standard_library()
    plain = plain_network(network, library=library)
    check_network(plain, library=library)
    path = None if output is None else study_path("--output", output)
    warning = study_rows.check_scheduler(scheduler)
    places: dict[str, Any] = {"folder": folder, "output": path, "summaries": summaries}
    study = make_study(plain, name=plain.name or name, library=library, **places, **asked)
    if warning:
        warnings.warn(warning, UserWarning, stacklevel=2)
    return carry_out(
        study, jobs=jobs, scheduler=scheduler, output=path, summaries=summaries, fresh=fresh
    )


def _made(
    study: study_rows.Study,
    jobs: int,
    scheduler: Any,
    cancel: threading.Event | None,
    done: Mapping[int, study_rows.Row],
) -> Generator[list[study_rows.Row]]:
    """The rows that are not done: by this process, or by others as soon as that is worth it."""
    order = [place for place in study.order if place not in done]
    files = study.files or [()] * len(study.points)
    tasks = [(place, study.points[place], files[place]) for place in order]
    if tasks and (scheduler or jobs > 1):
        yield from _by_others(study, scheduler, tasks, jobs, cancel)
        return
    several = jobs == 0 and Policy().workers > 1
    took: list[float] = []
    start = time.monotonic()
    maker = None
    for number, task in enumerate(tasks, 1):
        maker = maker or study_rows.RowMaker(study.setting, study.library)
        if cancel is not None and cancel.is_set():
            raise errors.Cancelled("stopped on request")
        row = maker.row(task, cancel)
        took.append(row.seconds)
        yield [row]
        if several and time.monotonic() > start + ALONE_S:
            several = False
            usual = took[1:] or took  # the first one makes what the others share
            if sum(usual) / len(usual) * (len(tasks) - number) > _WORTH_S:
                del maker  # and what it has kept
                yield from _by_others(study, "", tasks[number:], Policy().workers, cancel)
                return


def _by_others(
    study: study_rows.Study,
    scheduler: Any,
    tasks: list[study_rows.Task],
    jobs: int,
    cancel: threading.Event | None,
) -> Generator[list[study_rows.Row]]:
    # The engine's threads beside those of the other processes would be in their way.
    policy, threads = study.setting.policy, 1 if scheduler else max(1, Policy().workers // jobs)
    setting = replace(study.setting, policy=replace(policy, threads=policy.threads or threads))
    if scheduler:
        return cluster_rows(setting, study.key, tasks, scheduler, cancel)
    return process_rows(setting, tasks, jobs, cancel)


def _kept(why: str, journal: study_rows.Journal, study: study_rows.Study) -> str:
    return (
        f"{why}; {len(journal.rows)} of {len(study.points)} points done and saved in "
        f"{journal.path}. Give the same command again to resume"
    )
