"""Computing a study's points: one row for each, with its figures or the reason why not."""

import os
import threading
import time
from pathlib import Path
from typing import Any, NamedTuple

from app.run.option_values import Save
from app.run.output import source_images
from app.run.saving import save_value
from app.tradeoff.tradeoff_results import Figure, PointEvaluator
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.errors import Cancelled, FileError, ImagechainError, in_line
from core.evaluation.recipes import content_key
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from core.machine import store_bytes
from core.modules.declaration import Library, declaration
from core.network.network import Network, Node
from core.records import dataclass
from nodes.files.formats import check_finite

KEPT_BYTES = 256_000_000
"""How much computed values may take in a process: neighbouring points share little more."""
Task = tuple[int, tuple[Any, ...], tuple[str, ...]]
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
    saves: tuple[Save, ...]  # the ports whose pictures are saved
    policy: Policy  # precision, tolerance and threads
    version: str  # of the program
    # how much computed values may take on a machine; `KEPT_BYTES` in each process, if not given
    memory_bytes: int | None = None


class RowMaker:
    """Makes the rows of a study over a store of its own; `share` processes share the memory."""

    def __init__(self, setting: Setting, library: Library, share: int = 1) -> None:
        self.setting = setting
        kept = setting.memory_bytes
        if kept is None:
            kept = min(KEPT_BYTES * share, store_bytes())
        self._engine = Engine(library, Store(kept // share))
        plan = self._engine.plan(setting.network, folder=setting.folder)
        self._evaluator = PointEvaluator(self._engine, plan, setting.targets, setting.figures)
        self._checked: dict[str, ImagechainError | None] = {}

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
            images = [value.recipe for value in saved if isinstance(value, Image)]
            warnings = self._evaluator.warnings_of(plan, work, images)
        except Cancelled:
            raise
        except ImagechainError as error:
            reasons.append(str(error))
        except MemoryError:
            reasons.append("not enough memory")
        except Exception as error:  # one point's fault is not the study's
            reasons.append(f"internal error: {type(error).__name__}: {error}")
        if reasons and cancel is not None and cancel.is_set():
            # A stop may have become any error, as numpy makes an ImportError of one.
            raise Cancelled("stopped on request")
        took = float(f"{time.perf_counter() - start:.4g}")
        why = in_line("; ".join(dict.fromkeys(reasons)))
        return Row(place, figures, key, took, why, tuple(map(in_line, warnings)))

    def _save(self, plan: Plan, work: Work, save: Save, file: Path) -> None:
        value = plan.output(save.port)
        try:
            region = save.region(value.rows, value.columns) if isinstance(value, Image) else None
            file.parent.mkdir(parents=True, exist_ok=True)
            save_value(value, file, work, port=save.port, region=region)
        except OSError as error:
            raise FileError(f"cannot write {file}: {error.strerror or error}") from error
        except ImagechainError as error:
            raise error.at(save.node) from error

    def _check_sources(self, plan: Plan, work: Work) -> None:
        """Refuse samples that are not finite, of every picture once that has been read."""
        for port in source_images(plan):
            recipe = plan.output(port).recipe
            if recipe.key not in self._checked:
                if recipe.key not in work.log.computed and not work.has(recipe):
                    continue
                self._checked[recipe.key] = _fault(work.value(recipe), port)
            fault = self._checked[recipe.key]
            if fault is not None:
                raise fault


def network_key(network: Network, setting: Setting, library: Library) -> str:
    """Content key of what is computed; layout and names do not count."""
    links = tuple(str(link) for link in network.links)
    what = setting.version, network.seed, setting.policy.key, links, tuple(network.nodes)
    study = content_key("study", *what)
    nodes = network.nodes.values()
    return content_key(study, *(_node_key(node, library, setting.folder) for node in nodes))


def _node_key(node: Node, library: Library, folder: Path) -> str:
    stamps = tuple(file_stamp(file) for file in input_paths(node, library, folder))
    what = node.id, node.module, node.params, node.disabled, node.noise, node.final
    return content_key(*what, stamps)


def input_paths(node: Node, library: Library, folder: Path) -> list[Path]:
    module = library.get(node.module)
    if module is None or declaration(module).sink:
        return []
    paths = (one.name for one in declaration(module).parameters if one.kind == "path")
    values = [node.params.get(name) for name in paths]
    return [folder / value for value in values if isinstance(value, str) and value]


def file_stamp(file: Path) -> tuple[int, int] | None:
    """Size and time of the last change; None where the file cannot be looked at."""
    try:
        status = os.stat(file)  # noqa: PTH116, as Path's raises for a name that is too long
    except (OSError, ValueError):
        return None
    return status.st_size, status.st_mtime_ns


def _fault(samples: Any, port: str) -> ImagechainError | None:
    try:
        check_finite(samples, port)
    except ImagechainError as error:
        return error.at(port.rpartition(".")[0])
    return None
