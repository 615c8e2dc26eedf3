"""One fit of the network as it stands to a picture, as work beside the window."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from app.editor.docks.measure_worker import Pictures, ViewerPicture
from app.editor.number_text import FreeNumber
from core.errors import UsageError
from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.modules.declaration import Library
from core.network.network import Network

if TYPE_CHECKING:
    from app.fit.edge_fit import EdgesAt
    from app.fit.fit_result import FitResult
    from app.fit.free_parameter import FreeParameter
    from app.fit.patch import Patch
    from app.fit.picture_fit import FittedPictures

_HELD_BYTES = 1 << 28
_PAUSE_S = 0.05  # between edges that are shown while values change


@dataclass(frozen=True)
class FitTask:
    network: Network  # its macros written out
    library: Library
    folder: Path
    numbers: tuple[FreeNumber, ...]  # those that are free
    pictures: Pictures
    known_scene: bool = False  # whether the network's source is the scene of the picture


class DrawnEdge(NamedTuple):
    """An edge's samples by their distance from it, and the chain's spread there, from 0 to 1."""

    name: str
    distance: Any
    sample: Any
    spread: Any


class FittedNumber(NamedTuple):
    """A parameter as fitted; both numbers are None where the picture does not determine it."""

    number: FreeNumber
    value: float | None
    sigma: float | None


class FitOutcome(NamedTuple):
    numbers: tuple[FittedNumber, ...]
    chi2_per_degree: float
    degrees: int
    warnings: tuple[str, ...]
    notes: tuple[str, ...]
    edges: tuple[DrawnEdge, ...]


Watch = Callable[[tuple[DrawnEdge, ...]], None]


class CheckedWork(Work):
    """An evaluation that stops when a check of the caller's raises."""

    def __init__(self, policy: Policy, store: Store, check: Callable[[], None]) -> None:
        super().__init__(policy, store)
        self._check = check

    def check(self) -> None:
        self._check()


def fit_to_picture(
    task: FitTask, check: Callable[[], None], report: Callable[[str], None], watch: Watch
) -> FitOutcome:
    # Imported where it is used: the window opens without it.
    from app.fit.picture_fit import fit_known_scene, fit_pictures
    from core.chain.engine import Engine
    from core.network.validation import check_network

    check_network(task.network, library=task.library)
    free = limited_parameters(task)
    engine = Engine(task.library, Store(_HELD_BYTES))
    plan = engine.plan(task.network, folder=task.folder)
    work = CheckedWork(Policy(), engine.store, check)
    report("picture")
    pictures = _pictures(task.pictures)
    check()
    if not task.known_scene:
        seen = _Paced(check, watch)
        result = fit_pictures(
            engine, plan, work, free=free, pictures=pictures, report=report, watch=seen
        )
        return _outcome(task, result)
    result = fit_known_scene(engine, plan, work, free=free, pictures=pictures, report=report)
    return _outcome(task, result)


def limited_parameters(task: FitTask) -> tuple[FreeParameter, ...]:
    from app.fit.free_parameter import free_parameters

    if not task.numbers:
        raise UsageError(
            "no parameter is free: right-click a number on a panel and choose Free for a fit"
        )
    ports = [one.port for one in task.numbers]
    free = free_parameters(ports, task.network, task.library, option="")
    limited = []
    for one, parameter in zip(task.numbers, free, strict=True):
        low = parameter.low if one.low is None else one.low
        high = parameter.high if one.high is None else one.high
        if not low < high:
            raise UsageError(f"{one.port}: the low limit, {low:g}, must lie below {high:g}")
        limited.append(replace(parameter, low=low, high=high))
    return tuple(limited)


class _Paced:
    def __init__(self, check: Callable[[], None], watch: Watch) -> None:
        self._check, self._watch = check, watch
        self._next = 0.0

    def __call__(self, patches: tuple[Patch, ...], edges: EdgesAt) -> None:
        self._check()
        now = time.monotonic()
        if now >= self._next:
            self._next = now + _PAUSE_S
            self._watch(drawn_edges(patches, edges))


def drawn_edges(patches: tuple[Patch, ...], edges: EdgesAt) -> tuple[DrawnEdge, ...]:
    drawn = []
    for row, patch in enumerate(patches):
        count = len(patch.value)
        weight = edges.weight[row, :count]
        spread = edges.spread[row, :count].copy()
        with np.errstate(all="ignore"):
            rest = edges.residual[row, :count] / weight / edges.step[row]
        drawn.append(
            DrawnEdge(patch.name, edges.distance[row, :count].copy(), spread + rest, spread)
        )
    return tuple(drawn)


def _pictures(pictures: Pictures) -> FittedPictures:
    from app.fit.picture_fit import FittedPictures, TakenWith, read_pictures
    from app.measure.picture_loading import BandsError

    if not isinstance(pictures, ViewerPicture):
        try:
            return read_pictures(pictures)
        except BandsError as error:
            raise UsageError(
                f"{error.what}: show one of them in a viewer and fit to that"
            ) from error
    taken = TakenWith(
        pictures.name, pictures.interval_x_mrad, pictures.interval_y_mrad, pictures.band_um
    )
    samples = (np.asarray(pictures.samples, np.float64),)
    return FittedPictures((pictures.name,), samples, taken=(taken,))


def _outcome(task: FitTask, result: FitResult) -> FitOutcome:
    fit = result.fit
    numbers = tuple(
        FittedNumber(number, one.value, one.sigma)
        for number, one in zip(task.numbers, result.parameters, strict=True)
    )
    noise = (result.noise,) if isinstance(result.noise, str) and result.noise else ()
    edges = () if fit.edges is None else drawn_edges(fit.patches, fit.edges)
    return FitOutcome(
        numbers,
        result.chi2_per_degree,
        fit.misfit.degrees,
        result.warnings,
        (*result.notes, *noise),
        edges,
    )
