"""A state of the network that is kept: the network, and what was shown of it."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from app.editor.declared_text import error_text, label_of
from app.editor.docks.tradeoff_view import SideWork
from app.editor.evaluation.queries import Passing, Query
from app.editor.viewers.pixels.picture_layers import KeptPicture
from app.editor.viewers.pixels.picture_query import PictureQuery
from app.editor.viewers.plot.figures_strip import NONE, figure_text
from app.editor.viewers.plot.plot_export import Data
from app.run.readout_tables import number_text, without_rounding
from core.chain.engine import Plan
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work
from core.network.network import Network

MOST_CURVES = 8
"""Of a plot turned to many angles, the curves of the last ones are kept."""


@dataclass(frozen=True)
class NodeFigure:
    """One read-out of a node.

    Parameters
    ----------
    node, name : str
        The node's id, and the read-out's name in files.
    caption : str
        The read-out's name in words.
    value : object
        A number, a text or a truth value; None where there is none.
    unit, meaning : str
        As declared.
    """

    node: str
    name: str
    caption: str
    value: Any
    unit: str
    meaning: str


def all_figures(passing: Passing, work: Work) -> tuple[NodeFigure, ...]:
    """The read-outs of all nodes in the network's order; of those that fail, none."""
    figures: list[NodeFigure] = []
    for name, planned in passing.plan.nodes.items():
        if planned.error is not None or planned.node.disabled:
            continue
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        if not declared:
            continue
        try:
            values = passing.engine.readouts(passing.plan, name, work)
        except Cancelled:
            raise
        except ImagechainError:  # the node's badge has it
            continue
        for key, value in values.items():
            readout = declared[key]
            figures.append(
                NodeFigure(name, key, label_of(key), value, planned.unit(readout), readout.meaning)
            )
    return tuple(figures)


@dataclass(frozen=True)
class AllFiguresQuery(Query):
    """The figures of the network as it stands, once edits pause."""

    waits: ClassVar[bool] = True

    def key(self, plan: Plan) -> Hashable:
        """What the nodes make their figures of."""
        return tuple(
            (
                name,
                repr(planned.module),
                planned.node.disabled,
                planned.error is None,
                tuple(getattr(value, "key", None) for value in planned.inputs.values()),
                tuple(getattr(value, "key", None) for value in planned.outputs.values()),
            )
            for name, planned in plan.nodes.items()
        )

    def answer(self, passing: Passing) -> tuple[NodeFigure, ...]:
        """The figures."""
        return all_figures(passing, SideWork(passing.work))


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


@dataclass(frozen=True)
class KeepQuery(Query):
    """What is computed of a kept state, whatever the network has become meanwhile.

    It waits for all that is shown, and stops for whatever comes: no pass is slower for it. What
    has been shown is in the store already, and only referred to; what has to be computed is not
    left there, where the next edit needs the room.

    Parameters
    ----------
    source : Source
        The state.
    ports : tuple of str
        Pictures to keep, as ``NODE.PORT``.
    curves : tuple of Query
        Queries of the plot viewer.
    figures : bool
        Whether to keep all figures.
    """

    waits: ClassVar[bool] = True

    source: Source
    ports: tuple[str, ...] = ()
    curves: tuple[Query, ...] = ()
    figures: bool = False

    def key(self, plan: Plan) -> Hashable:  # noqa: ARG002 - it is of another state
        """The question: its answer never changes."""
        return self

    def answer(self, passing: Passing) -> KeptResults:
        """What is kept; a picture or curve that fails is left out, with the reason."""
        source = self.source
        plan = source.plan
        if plan is None and passing.plan.network is source.network:
            plan = passing.plan
        if plan is None:
            plan = passing.engine.plan(source.network, folder=source.folder)
        of_state = replace(passing, plan=plan, work=SideWork(passing.work), reduced=1)
        pictures: dict[str, KeptPicture] = {}
        curves: dict[Query, Data | None] = {}
        missing: dict[str, str] = {}
        for port in self.ports:
            try:
                pictures[port] = PictureQuery(port).kept_picture(of_state)
            except Cancelled:
                raise
            except ImagechainError as error:
                missing[port] = error_text(error)
        for query in self.curves:
            try:
                curves[query] = query.answer(of_state)
            except Cancelled:
                raise
            except ImagechainError:  # the plot then has the present curves alone
                curves[query] = None
        figures = all_figures(of_state, of_state.work) if self.figures else None
        known = replace(source, plan=plan)
        return KeptResults(known, pictures, curves, figures, missing)


def changed_figures(
    kept: Iterable[NodeFigure], now: Iterable[NodeFigure]
) -> tuple[tuple[str, ...], int]:
    """A line for each figure that is another one now, and how many there are in all.

    What six digits do not show is no difference.
    """
    before = {(figure.node, figure.name): figure for figure in kept}
    after = {(figure.node, figure.name): figure for figure in now}
    lines, count = [], 0
    for key in dict.fromkeys((*after, *before)):
        one, other = before.get(key), after.get(key)
        figure = other or one
        assert figure is not None
        texts = [_digits(one), _digits(other)]
        count += any(texts)
        if texts[0] != texts[1]:
            shown = [_shown(each) for each in (one, other)]
            if shown[0] == shown[1]:
                shown = [text or NONE for text in texts]
            lines.append(f"{figure.node} {figure.caption}: {shown[0]} → {shown[1]}")
    return tuple(lines), count


def _digits(figure: NodeFigure | None) -> str:
    """The value in six digits with its unit; empty where there is none."""
    if figure is None or figure.value is None:
        return ""
    value = without_rounding(figure.value, figure.unit)
    return f"{number_text(value)} {figure.unit}".rstrip()


def _shown(figure: NodeFigure | None) -> str:
    if figure is None or isinstance(figure.value, bool):
        return NONE if figure is None else number_text(figure.value)
    return figure_text(figure.value, figure.unit)
