"""The query that collects what is kept of a state: pictures, curves and figures."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from typing import ClassVar

from app.editor.error_text import error_text
from app.editor.evaluation.queries import Passing, Query
from app.editor.snapshots.all_figures import all_figures
from app.editor.snapshots.kept_state import KeptResults, Source
from app.editor.tradeoff.side_work import SideWork
from app.editor.viewers.pixels.kept_picture import KeptPicture
from app.editor.viewers.pixels.picture_query import PictureQuery
from app.editor.viewers.plot.plot_export import Data
from core.chain.engine import Plan
from core.errors import Cancelled, ImagechainError


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
