"""Carrying a study out: in this process, by several of this machine, or by a Dask cluster."""

import contextlib
import importlib.util
import threading
import time
import warnings
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import Any

from app.run.option_values import study_path, summary_path
from app.run.shipped import find_network
from app.run.terminal import Stopped, too_late
from app.study.study_request import Study, StudyRows, make_study
from app.study.study_rows import Journal, Row, RowMaker, Setting, Task, write_columns
from app.study.worker_processes import check_address, cluster_rows, process_rows
from core.errors import Cancelled, ImagechainError, Suspended, UsageError, how_to_install, shown
from core.evaluation.work import Policy
from core.network.file import load_network
from core.network.network import Network
from core.network.validation import check_network, plain_network
from core.records import dataclass, replace
from nodes.library import standard_library

ALONE_S = 0.5
"""How long one process computes before it is known what the rest of the study takes."""
_WORTH_S = 4.0  # of one process: less is done sooner than others have begun
TLS = ("--tls-ca-file", "--tls-cert", "--tls-key")
Reached = Callable[[int], None]
_INNER = ("tls://", "wss://", "inproc://")  # what nobody else can read, or answer in our place


@dataclass(frozen=True)
class Workers:
    # processes of this machine; 0 for all cores, as soon as the rest of the study is worth it
    jobs: int = 0
    scheduler: Any = ""  # the address of a Dask scheduler, or a client of one, in their place
    memory_bytes: int | None = None  # how much computed values may take on a machine

    def check(self) -> None:
        if not isinstance(self.scheduler, str):
            return
        if self.scheduler and not has_dask():
            what = f"--scheduler {self.scheduler:.120}"
            raise UsageError(
                f"{what}: dask and distributed are not installed: {how_to_install('study')}"
            )
        if self.scheduler:
            check_address(self.scheduler)

    @property
    def warning(self) -> str:
        """That others can run code on the workers; empty where they cannot."""
        address = self.scheduler
        if not isinstance(address, str):
            address = address.scheduler.address
        if not address or address.startswith(_INNER):
            return ""
        return (
            f"the scheduler {shown(address)} has no TLS: anyone who can reach its port can "
            f"run code as the workers' user. Start the scheduler and its workers with "
            f"{', '.join(TLS)}, and give the study the same files in Dask's settings"
        )


def has_dask() -> bool:
    return all(importlib.util.find_spec(name) is not None for name in ("dask", "distributed"))


def carry_out(
    study: Study,
    workers: Workers,
    *,
    output: Path | None = None,
    fresh: bool = False,
    reached: Reached | None = None,
    cancel: threading.Event | None = None,
    summaries: Sequence[Path] = (),
) -> StudyRows:
    """Compute the points that the journal beside `output` lacks, then write the files."""
    workers.check()
    if output is None:
        result = _collected(study, workers, {}, cancel, reached)
        _summarise(result, summaries)
        return result
    with Journal(output, study.key, len(study.points), fresh=fresh) as journal:
        for row in [row for row in journal.rows.values() if _lost(study, row)]:
            del journal.rows[row.place]  # made anew: a later line of the same point holds
        try:
            result = _collected(study, workers, journal.rows, cancel, reached, journal.add)
        except (Stopped, Cancelled) as error:
            raise Suspended(_kept("stopped", journal, study)) from error
        except ImagechainError as error:
            error.message = _kept(error.message, journal, study)
            raise
        too_late(cancel)
        write_columns(result.columns(), output, study.name)
        _summarise(result, summaries)
        journal.remove()
    return result


def _collected(
    study: Study,
    workers: Workers,
    rows: dict[int, Row],
    cancel: threading.Event | None,
    reached: Reached | None,
    keep: Callable[[list[Row]], object] = lambda _: None,
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


def _summarise(result: StudyRows, pages: Sequence[Path]) -> None:
    for page in pages:
        from app.study.study_drawing import write_summary  # which takes matplotlib to load

        write_summary(result, page)


def run_study(
    network: Network | str,
    workers: Workers,
    *,
    folder: Path = Path(),
    output: str | None = None,
    summaries: Sequence[str] = (),
    fresh: bool = False,
    **asked: Any,
) -> StudyRows:
    """A study as the command carries it out; what is `asked` is as for `make_study`."""
    library = standard_library()
    name, read = "", []
    if not isinstance(network, Network):
        found = find_network(network)
        name, folder, read = found.name, found.folder, [found.path]
        network = load_network(found.path, library=library)
    plain = plain_network(network, library=library)
    check_network(plain, library=library)
    path = None if output is None else study_path("--output", output)
    pages = [summary_path("--summary", page) for page in summaries]
    study = make_study(
        plain, name=plain.name or name, folder=folder, library=library, read=read, output=path,
        summaries=pages, **asked,
    )  # fmt: skip
    if workers.warning:
        warnings.warn(workers.warning, UserWarning, stacklevel=2)
    return carry_out(study, workers, output=path, summaries=pages, fresh=fresh)


def _made(
    study: Study, workers: Workers, done: Mapping[int, Row], cancel: threading.Event | None
) -> Generator[list[Row]]:
    """The rows that are not done: by this process, or by others as soon as that is worth it."""
    order = [place for place in study.order if place not in done]
    files = study.files or [()] * len(study.points)
    tasks = [(place, study.points[place], files[place]) for place in order]
    if tasks and (workers.scheduler or workers.jobs > 1):
        yield from _by_others(study, workers, tasks, workers.jobs, cancel)
        return
    several = workers.jobs == 0 and _cores() > 1
    took: list[float] = []
    start = time.monotonic()
    maker = None
    for number, task in enumerate(tasks, 1):
        maker = maker or RowMaker(_setting(study, workers, study.setting.policy), study.library)
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
                yield from _by_others(study, workers, tasks[number:], _cores(), cancel)
                return


def _by_others(
    study: Study, workers: Workers, tasks: list[Task], jobs: int, cancel: threading.Event | None
) -> Generator[list[Row]]:
    policy, scheduler = study.setting.policy, workers.scheduler
    if not scheduler:
        # The engine's threads beside those of the other processes would be in their way.
        threads = policy.threads or max(1, _cores() // jobs)
        setting = _setting(study, workers, replace(policy, threads=threads))
        return process_rows(setting, tasks, jobs, cancel)
    setting = _setting(study, workers, replace(policy, threads=policy.threads or 1))
    return cluster_rows(setting, study.key, tasks, scheduler, cancel)


def _setting(study: Study, workers: Workers, policy: Policy) -> Setting:
    return replace(study.setting, policy=policy, memory_bytes=workers.memory_bytes)


def _lost(study: Study, row: Row) -> bool:
    files = study.files[row.place] if study.files and not row.error else ()
    return not all(Path(file).exists() for file in files)


def _kept(why: str, journal: Journal, study: Study) -> str:
    return (
        f"{why}; {len(journal.rows)} of {len(study.points)} points done and saved in "
        f"{journal.path}: give the same command again to resume"
    )


def _cores() -> int:
    return Policy().workers
