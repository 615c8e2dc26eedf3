"""The rows of a study: how they are made, kept in a journal, and written as a file."""

import contextlib
import hashlib
import importlib.util
import io
import json
import math
import os
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np

from app.run import option_values, overrides, saving, terminal, transfer_chain
from app.run.staging import Staging, check_folder, input_paths
from app.tradeoff.tradeoff_results import Figure, PointEvaluator, nodes_after
from core import errors
from core.atomic import atomic_file, is_held, take, write_bytes, write_text
from core.chain import engine, wires
from core.evaluation.recipes import Store, content_key
from core.evaluation.work import Policy, Work
from core.machine import store_bytes
from core.modules.declaration import Library, declaration
from core.network.network import Network, Node
from core.records import dataclass
from nodes.files import formats, table_cells
from nodes.files.file_format import NETCDF, PARQUET

KEPT_BYTES = 256_000_000
"""How much computed values may take in a process: neighbouring points share little more."""
Point = tuple[Any, ...]
"""A value for each axis."""
Task = tuple[int, Point, tuple[str, ...]]
"""A point's place, its values, and the files that it saves."""


class Row(NamedTuple):
    place: int  # of the point, from 0 on
    figures: tuple[float | None, ...]  # numbers, or None where there is none
    key: str  # content key of what was computed: network, values, stamps of its files, version
    seconds: float  # what it took
    error: str = ""  # why a figure or a file is not there; empty where nothing is missing
    warnings: tuple[str, ...] = ()  # what its nodes warn of


@dataclass(frozen=True)
class Setting:
    network: Network  # macros written out
    folder: Path  # what file names in it are relative to
    targets: tuple[tuple[str, str], ...]  # what is varied
    figures: tuple[Figure, ...]  # the figures of each point
    saves: tuple[option_values.Save, ...]  # the ports whose pictures are saved
    policy: Policy  # precision, tolerance and threads
    version: str  # of the program
    memory_bytes: int | None = None  # of computed values, if not `KEPT_BYTES` in each process


WITH_TLS = ("tls://", "wss://")
_INNER = (*WITH_TLS, "inproc://")  # what nobody else can read, or answer in our place


def check_scheduler(scheduler: Any) -> str:
    """That others can run code on the workers of a scheduler; empty where they cannot.

    Refused is what is no address: a client of it would go on trying in the background.
    """
    if not scheduler:
        return ""
    if not isinstance(scheduler, str):
        return _without_tls(scheduler.scheduler.address)
    what = f"--scheduler {scheduler:.120}"
    if not has_dask():
        raise errors.UsageError(
            f"{what} needs the packages dask and distributed: {errors.how_to_install('study')}"
        )
    from distributed import Security
    from distributed.comm.addressing import parse_host_port
    from distributed.comm.registry import backends

    protocol, parted, place = scheduler.rpartition("://")
    try:
        host, port = parse_host_port(place)
        sound = bool(host) and 0 < port < 65536 and (not parted or protocol in backends)
    except ValueError:
        sound = False
    if not sound:
        known = ", ".join(sorted(backends))
        raise errors.UsageError(
            f"{what}: write HOST:PORT or PROTOCOL://HOST:PORT; protocols are {known}"
        )
    made: Any = Security
    if scheduler.startswith(WITH_TLS) and made().tls_client_cert is None:
        raise errors.UsageError(
            f"{what}: Dask's settings have no TLS client certificate. Set "
            "distributed.comm.tls.ca-file, .client.cert and .client.key to the files with "
            "which the scheduler was started"
        )
    return _without_tls(scheduler)


def _without_tls(address: str) -> str:
    if not address or address.startswith(_INNER):
        return ""
    return (
        f"the scheduler {errors.shown(address)} has no TLS: anyone who can reach its port can "
        f"run code as the workers' user. Start the scheduler and its workers with "
        "--tls-ca-file, --tls-cert, --tls-key, and give the study the same files in Dask's "
        "settings"
    )


def has_dask() -> bool:
    return all(importlib.util.find_spec(name) is not None for name in ("dask", "distributed"))


class RowMaker:
    """Makes the rows of a study over a store of its own; `share` processes share the memory."""

    def __init__(self, setting: Setting, library: Library, share: int = 1) -> None:
        self.setting = setting
        kept = setting.memory_bytes
        if kept is None:
            kept = min(KEPT_BYTES * share, store_bytes())
        self._engine = engine.Engine(library, Store(kept // share))
        plan = self._engine.plan(setting.network, folder=setting.folder)
        self._evaluator = PointEvaluator(self._engine, plan, setting.targets, setting.figures)
        self._checked: dict[str, errors.ImagechainError | None] = {}

    def row(self, task: Task, cancel: threading.Event | None = None) -> Row:
        place, values, files = task
        start = time.perf_counter()
        reasons: list[str] = []
        figures: tuple[float | None, ...] = (None,) * len(self.setting.figures)
        key = ""
        warnings: tuple[str, ...] = ()
        try:
            plan = self._evaluator.planned(values)
            warnings = self._evaluator.warnings_of(plan)
            key = network_key(plan.network, self.setting, self._engine.library)
            work = self._engine.work(self.setting.policy, cancel=cancel)
            result = self._evaluator.figures_of(plan, work)
            reasons += [
                result.reasons[figure.text]
                for figure in self.setting.figures
                if figure.text in result.reasons
                and not (figure.by_default and figure.text in result.absent)
            ]
            self._check_sources(plan, work)
            figures = tuple(result.figures.get(figure.text) for figure in self.setting.figures)
            for save, file in zip(self.setting.saves, files, strict=True):
                self._save(plan, work, save, Path(file))
            saved = [plan.output(save.port) for save in self.setting.saves]
            images = [value.recipe for value in saved if isinstance(value, wires.Image)]
            warnings = self._evaluator.warnings_of(plan, work, images)
        except errors.Cancelled:
            raise
        except errors.ImagechainError as error:
            reasons.append(str(error))
        except MemoryError:
            reasons.append("not enough memory")
        except Exception as error:  # one point's fault is not the study's
            reasons.append(f"internal error: {type(error).__name__}: {error}")
        if reasons and cancel is not None and cancel.is_set():
            # A stop may have become any error, as numpy makes an ImportError of one.
            raise errors.Cancelled("stopped on request")
        took = float(f"{time.perf_counter() - start:.4g}")
        why = errors.in_line("; ".join(dict.fromkeys(reasons)))
        return Row(place, figures, key, took, why, tuple(map(errors.in_line, warnings)))

    def _save(self, plan: engine.Plan, work: Work, save: option_values.Save, file: Path) -> None:
        value = plan.output(save.port)
        with errors.placed(save.node), errors.writing(file):
            region = saving.region_of(save, value)
            file.parent.mkdir(parents=True, exist_ok=True)
            saving.save_value(value, file, work, port=save.port, region=region)

    def _check_sources(self, plan: engine.Plan, work: Work) -> None:
        """Refuse samples that are not finite, of every picture once that has been read."""
        for port in transfer_chain.source_images(plan):
            recipe = plan.output(port).recipe
            if recipe.key not in self._checked:
                if recipe.key not in work.log.computed and not work.has(recipe):
                    continue
                samples, self._checked[recipe.key] = work.value(recipe), None
                try:
                    formats.check_finite(samples, port)
                except errors.ImagechainError as error:
                    self._checked[recipe.key] = error.at(port.rpartition(".")[0])
            fault = self._checked[recipe.key]
            if fault is not None:
                raise fault


def network_key(network: Network, setting: Setting, library: Library) -> str:
    """Content key of what is computed; layout and names do not count."""
    links = tuple(str(link) for link in network.links)
    what = setting.version, network.seed, setting.policy.key, links, tuple(network.nodes)
    study = content_key("study", *what)
    nodes = network.nodes.values()

    def key(node: Node) -> str:
        declared = declaration(library[node.module])
        stamps = tuple(map(file_stamp, input_paths(node, declared, setting.folder)))
        what = node.id, node.module, node.params, node.disabled, node.noise, node.final
        return content_key(*what, stamps)

    return content_key(study, *map(key, nodes))


def file_stamp(file: Path) -> tuple[int, int] | None:
    """Size and time of the last change; None where the file cannot be looked at."""
    try:
        status = os.stat(file)  # noqa: PTH116, as Path's raises for a name that is too long
    except (OSError, ValueError):
        return None
    return status.st_size, status.st_mtime_ns


FORMAT, VERSION = "imagechain-study", 1
SUFFIX = ".journal"
_FLUSH_S = 1.0  # a power cut costs no more than the rows of so long
_DIGITS = 16


class Journal:
    """One line for each row that is done, with a checksum; a torn last line is cut off.

    A lock keeps two studies from writing one output; `fresh` discards an earlier study's rows.
    """

    def __init__(self, output: Path, key: str, points: int, *, fresh: bool = False) -> None:
        self.path = output.with_name(output.name + SUFFIX)
        self.rows: dict[int, Row] = {}
        self._head = {"format": FORMAT, "version": VERSION, "study": key, "points": points}
        self._output, self._fresh = output, fresh
        self._open = contextlib.ExitStack()
        self._end, self._flushed = 0, time.monotonic()

    def __enter__(self) -> Self:
        lock_path = self._output.with_name(f".{self.path.name}.lock")
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        with self._open as opened:
            with errors.writing(self.path):
                if (let_go := take(lock_path)) is not None:
                    opened.callback(let_go)
                elif is_held(lock_path):
                    raise errors.FileError(
                        f"cannot write {self._output}: another study is writing this file"
                    )
                self._file = os.open(self.path, flags, 0o666)
                opened.callback(os.close, self._file)
                self._read(b"" if self._fresh else self.path.read_bytes())
                self._cut()
            if self._end == 0:
                self._write(_line(self._head))
            self._open = opened.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        with self._open, contextlib.suppress(OSError):
            os.fsync(self._file)

    def add(self, rows: Iterable[Row]) -> None:
        """Keep rows; each is whole in the file, or not there."""
        rows = list(rows)
        self._write(b"".join(map(_line, rows)))
        self.rows.update((row.place, row) for row in rows)
        if time.monotonic() > self._flushed + _FLUSH_S:
            os.fsync(self._file)
            self._flushed = time.monotonic()

    def remove(self) -> None:
        with contextlib.suppress(OSError):
            self.path.unlink(missing_ok=True)

    def _read(self, content: bytes) -> None:
        lines = list(_whole_lines(content))
        head = lines[0][1] if lines else None
        # Nothing counts of a file of which not even the first line is whole.
        torn = not lines and _line(self._head).startswith(content)
        if not torn and (not isinstance(head, dict) or head.get("format") != FORMAT):
            raise errors.UsageError(
                f"{self.path}: not the journal of a study; --fresh discards this file"
            )
        if lines and head != self._head:
            raise errors.UsageError(
                f"{self._output}: another study, or this study with other inputs, was started "
                f"there and is not finished ({errors.several(len(lines) - 1, 'row')} in "
                f"{self.path.name}); --fresh discards these rows"
            )
        for self._end, entry in lines:
            if isinstance(entry, list) and len(entry) == len(Row._fields):
                row = Row(*entry)
                row = row._replace(figures=tuple(row.figures), warnings=tuple(row.warnings))
                self.rows[row.place] = row

    def _write(self, data: bytes) -> None:
        try:
            with errors.writing(self.path):
                written = 0
                while written < len(data):
                    written += os.write(self._file, data[written:])
        except errors.FileError:
            with contextlib.suppress(OSError):
                self._cut()
            raise
        self._end += len(data)

    def _cut(self) -> None:
        os.ftruncate(self._file, self._end)
        os.lseek(self._file, self._end, os.SEEK_SET)


def _line(entry: Any) -> bytes:
    text = json.dumps(entry, separators=(",", ":"))
    return f"{_checksum(text)} {text}\n".encode("ascii")


def _whole_lines(content: bytes) -> Iterator[tuple[int, Any]]:
    """The entries of lines that are as they were written, each with where it ends."""
    end = 0
    for line in content.split(b"\n")[:-1]:  # of bytes, splitlines parts at a damaged \r, too
        end += len(line) + 1
        try:
            checksum, _, text = line.decode("ascii").partition(" ")
            if checksum == _checksum(text):
                yield end, json.loads(text)
        except ValueError:
            continue


def _checksum(text: str) -> str:
    return hashlib.blake2b(text.encode(), digest_size=_DIGITS // 2).hexdigest()


# The rows of a study as a file: CSV, Parquet or netCDF.

_NEEDED = {PARQUET: ("pyarrow",), NETCDF: ("xarray", "h5netcdf", "h5py")}


@dataclass(frozen=True)
class Column:
    name: str
    unit: str
    values: Sequence[Any]  # numbers, truth values, texts or None

    @property
    def head(self) -> str:
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def kind(self) -> type:
        """The type that all values have, but for None; text where they differ."""
        kinds = {type(value) for value in self.values if value is not None}
        if kinds <= {int, float} and kinds:
            return float if float in kinds else int
        return kinds.pop() if len(kinds) == 1 else (str if kinds else float)

    @property
    def typed(self) -> list[Any]:
        kind = self.kind
        make = terminal.exact if kind is str else kind
        return [None if value is None else make(value) for value in self.values]


def check_installed(path: Path) -> None:
    for file_format, packages in _NEEDED.items():
        missing = [name for name in packages if importlib.util.find_spec(name) is None]
        if file_format.matches(path) and missing:
            raise errors.UsageError(
                f"--output {path} needs {' and '.join(missing)}: "
                f"{errors.how_to_install('study')}; .csv needs no other package"
            )


def write_columns(columns: Sequence[Column], path: Path, title: str) -> None:
    """Write columns in the format of the path's suffix: the whole file, or none."""
    if PARQUET.matches(path):
        _write_parquet(columns, path, title)
    elif NETCDF.matches(path):
        _write_netcdf(columns, path, title)
    else:
        write_text(path, errors.printable(csv_of(columns)))


def csv_of(columns: Sequence[Column]) -> str:
    return table_cells.csv_columns((c.head, map(terminal.exact, c.values)) for c in columns)


def _write_parquet(columns: Sequence[Column], path: Path, title: str) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    kinds = {int: pa.int64(), float: pa.float64(), bool: pa.bool_(), str: pa.string()}
    units = [{"unit": c.unit} if c.unit else None for c in columns]
    pairs = zip(columns, units, strict=True)
    fields = [pa.field(c.head, kinds[c.kind], metadata=unit) for c, unit in pairs]
    schema = pa.schema(fields, metadata={"title": title})
    arrays = [pa.array(c.typed, kinds[c.kind]) for c in columns]
    with atomic_file(path) as temporary:
        pq.write_table(pa.Table.from_arrays(arrays, schema=schema), temporary)


def _write_netcdf(columns: Sequence[Column], path: Path, title: str) -> None:
    import xarray as xr

    variables = {}
    for column in columns:
        attributes = {"units": column.unit} if column.unit else {}
        # netCDF has no slash in names; that of a macro's inner node becomes a colon.
        name = column.name.replace("/", ":")
        variables[name] = ("row", _array(column), attributes)
    data = xr.Dataset(variables, attrs={"title": title})
    content = io.BytesIO()  # HDF5 ends the whole process where a file of its own cannot be written
    data.to_netcdf(content, engine="h5netcdf")
    write_bytes(path, content.getvalue())


def _array(column: Column) -> Any:
    kind = column.kind
    if kind is str:
        return np.array(["" if v is None else v for v in column.typed], dtype=object)
    if None in column.values:
        return np.array([math.nan if v is None else float(v) for v in column.values])
    return np.array(column.values, dtype=kind)


# A study, and its rows as a table.


def order_of(
    axes: Sequence[overrides.Variation], points: Sequence[Point], network: Network
) -> list[int]:
    """The places in the order that repeats least: what few nodes hang on moves first."""
    touched = [len(nodes_after(network, axis.node)) for axis in axes]
    outwards = sorted(range(len(axes)), key=lambda place: -touched[place])
    ranks = [{value: rank for rank, value in enumerate(axis.values)} for axis in axes]

    def rank(place: int) -> tuple[int, ...]:
        point = points[place]
        return tuple(ranks[axis][point[axis]] for axis in outwards)

    return sorted(range(len(points)), key=rank)


@dataclass(frozen=True)
class Study:
    name: str  # of the network
    setting: Setting  # what all points have in common
    library: Library  # the modules
    axes: tuple[overrides.Variation, ...]  # what varies
    points: tuple[Point, ...]  # A value for each axis
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
        declared = [(node, declaration(self.library[node.module])) for node in nodes]
        own = [file for each in declared for file in input_paths(*each, folder)]
        return [*own, *(Path(v) for axis in self.axes for v in axis.values if v in axis.names)]

    @cached_property
    def key(self) -> str:
        """Content key: of two studies with one key all rows are the same."""
        return content_key(
            network_key(self.setting.network, self.setting, self.library),
            tuple(axis.text for axis in self.axes),
            self.points,
            tuple((figure.text, figure.unit, figure.by_default) for figure in self.figures),
            tuple((save.port, save.bounds) for save in self.setting.saves),
            tuple(self.files),
            tuple(file_stamp(file) for file in self.inputs),
        )

    def check_places(self, outputs: Sequence[Path], read: Sequence[Path] = ()) -> None:
        inputs = [*read, *self.inputs]
        with Staging(None, inputs) as staging:
            for path in outputs:
                staging.claim(path)
                staging.check(path.with_name(path.name + SUFFIX))
            for folder in dict.fromkeys(Path(name).parent for row in self.files for name in row):
                check_folder(folder)
            taken = {str(path.absolute()) for path in (*outputs, *inputs)}
            taken |= {str(path.absolute()) + SUFFIX for path in outputs}
            for row in self.files:
                for save, name in zip(self.setting.saves, row, strict=True):
                    if name in taken:
                        raise errors.UsageError(
                            f"{save.shown}: {errors.shown(name)} is already a file "
                            "of this study; choose another name"
                        )


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
