"""A state of the network that is kept: the network, and references to what was shown of it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path

import numpy as np

from app.editor.evaluation.queries import Query
from app.editor.snapshots.all_figures import NodeFigure
from app.editor.viewers.pixels.kept_picture import KeptPicture
from app.editor.viewers.plot.plot_export import Data
from core.chain.engine import Plan
from core.network.network import Network

MOST_CURVES = 8
"""Of a plot turned to many angles, the curves of the last ones are kept."""


@dataclass(frozen=True, eq=False)
class Source:
    """What the results of a state are made of: the network as it was computed, and its plan.

    `plan` is None where that was not known yet when the state was kept. A plan is of recipes, and
    holds no arrays.
    """

    network: Network
    folder: Path
    plan: Plan | None = None


@dataclass(frozen=True, eq=False)
class KeptResults:
    """What was computed of a state.

    Parameters
    ----------
    source : Source
        What it is of.
    pictures : mapping of str to KeptPicture
        By ``NODE.PORT``.
    curves : mapping of Query to data
        What the plot viewer shows for each of its queries; None where there is nothing.
    figures : tuple of NodeFigure, or None
        All figures; None until they are computed.
    missing : mapping of str to str
        Why there is no picture, by port.
    """

    source: Source
    pictures: Mapping[str, KeptPicture] = field(default_factory=dict)
    curves: Mapping[Query, Data | None] = field(default_factory=dict)
    figures: tuple[NodeFigure, ...] | None = None
    missing: Mapping[str, str] = field(default_factory=dict)

    def joined(self, more: KeptResults) -> KeptResults:
        """With what was computed later; of curves the last few."""
        curves = {**self.curves, **more.curves}
        return KeptResults(
            more.source,
            {**self.pictures, **more.pictures},
            dict(list(curves.items())[-MOST_CURVES:]),
            self.figures if more.figures is None else more.figures,
            {**self.missing, **more.missing},
        )

    def with_pictures(self, ports: Collection[str]) -> KeptResults:
        """With no other pictures than these."""
        pictures = {port: kept for port, kept in self.pictures.items() if port in ports}
        return replace(self, pictures=pictures)


@dataclass(frozen=True, eq=False)
class KeptState:
    """One snapshot.

    Parameters
    ----------
    number : int
        Its own in the document.
    name : str
        The user's name for it.
    taken : datetime
        When it was kept, by the clock here.
    network : Network
        The document as it was.
    nodes : Network
        The same with all nodes that the window shows.
    results : KeptResults
        What was computed of it.
    """

    number: int
    name: str
    taken: datetime
    network: Network
    nodes: Network
    results: KeptResults

    @property
    def time(self) -> str:
        """When it was kept, for people."""
        return f"{self.taken:%H:%M:%S}"


def held_bytes(states: Iterable[KeptState]) -> int:
    """Bytes of the samples that these states hold; what they share counts once."""
    arrays = {
        id(array): array
        for state in states
        for picture in state.results.pictures.values()
        for array in (_owner(picture.samples),)
    }
    return sum(int(array.nbytes) for array in arrays.values())


def _owner(array: np.ndarray) -> np.ndarray:
    """The array whose memory it is."""
    while isinstance(array.base, np.ndarray):
        array = array.base
    return array


def bounded(
    states: tuple[KeptState, ...],
    capacity_bytes: int,
    chosen: int | None,
    shown: Collection[str] = (),
) -> tuple[tuple[KeptState, ...], tuple[str, ...]]:
    """The states within so many bytes, and the names of those of which pictures are dropped.

    The oldest lose theirs first; the one that is compared with comes last, and keeps those of the
    ports that are `shown`.
    """
    dropped: list[str] = []
    kept = list(states)
    places = sorted(range(len(states)), key=lambda place: states[place].number == chosen)
    for place in places:
        if held_bytes(kept) <= capacity_bytes:
            break
        state = states[place]
        less = state.results.with_pictures(shown if state.number == chosen else ())
        if len(less.pictures) < len(state.results.pictures):
            kept[place] = replace(state, results=less)
            dropped.append(state.name)
    return tuple(kept), tuple(dropped)
