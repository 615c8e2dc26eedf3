"""Showing what is most useful of a network that has just been opened: its picture first.

Of a network with an analysis node that has figures, the control panel of the first such node is
opened, and its first curve plotted. Else no node is selected, and the chain's transfer functions
are plotted.
"""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QObject

from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.window.viewer_docks import ViewerDocks
from app.run.output import ANALYSIS, find_output, source_images
from core.chain.engine import Plan
from core.chain.wires import Curve, Image, Table
from core.errors import ImagechainError

DIFFERENCE = "difference"  # the output of what a node's picture differs in from the usual


@dataclass(frozen=True)
class FirstLook:
    """Ports and a node to look at.

    Parameters
    ----------
    node : str or None
        The node whose panel is opened.
    curve : str or None
        What is plotted; None for the chain's transfer functions.
    pictures : tuple of str
        What the image viewers show: as many as there are, up to two.
    front : int
        Number of the viewer in front.
    """

    node: str | None
    curve: str | None
    pictures: tuple[str, ...]
    front: int = 1


def first_look(plan: Plan) -> FirstLook:
    """The node with figures, its curve; the final picture, and beside it the input picture.

    In front of the input picture's place comes the difference that this node makes, if it makes
    one: it is what cannot be seen by comparing the two.
    """
    node = node_with_figures(plan)
    outputs = plan.nodes[node].outputs if node is not None else {}
    curves = [f"{node}.{name}" for name, value in outputs.items() if isinstance(value, Curve)]
    pictures = first_ports(plan)
    if pictures and isinstance(outputs.get(DIFFERENCE), Image):
        return FirstLook(node, (*curves, None)[0], (pictures[0], f"{node}.{DIFFERENCE}"), 2)
    return FirstLook(node, (*curves, None)[0], pictures)


def node_with_figures(plan: Plan) -> str | None:
    """The first analysis node, in the network's order, that has a table of figures; None for none.

    Slices of transfer functions have none: the curves of the chain show the same.
    """
    for name, planned in plan.nodes.items():
        if planned.module is None or planned.declaration.group != ANALYSIS:
            continue
        if any(isinstance(value, Table) for value in planned.outputs.values()):
            return name
    return None


def first_ports(plan: Plan) -> tuple[str, ...]:
    """The final picture and the input picture it is to be compared with; as many as there are."""
    try:
        final = find_output(plan).port
    except ImagechainError:
        final = None
    sources = [port for port in source_images(plan) if port != final]
    return tuple(port for port in (final, *sources[:1]) if port is not None)


class FirstViews(QObject):
    """Follows what is opened.

    The picture is looked at as soon as the network is planned, before anything is computed. What
    stands beside it comes with the end of that pass: a viewer of its own takes 0.1 s to make, in
    which the picture would wait.
    """

    def __init__(self, session: Session, evaluator: Evaluator, viewers: ViewerDocks) -> None:
        super().__init__(viewers)
        self._session = session
        self._evaluator = evaluator
        self._viewers = viewers
        self._due = False
        self._beside: FirstLook | None = None
        session.opened.connect(self._opened)
        evaluator.planned.connect(self._planned)
        evaluator.pass_done.connect(self._pass_done)

    def _opened(self) -> None:
        self._due = True
        self._beside = None

    def _planned(self, _plan: object) -> None:
        plan = self._evaluator.plan
        if not self._due or plan is None or not plan.network.nodes:
            return  # an empty network waits for its first nodes
        self._due = False
        self._beside = look = first_look(plan)
        if look.pictures:
            self._viewers.look_at(1, look.pictures[0])
        if look.front > 1:
            self._look_beside()

    def _pass_done(self, done: object) -> None:
        if self._due:
            self._planned(done)
        elif self._beside is not None:
            self._viewers.images[1].canvas.viewport().repaint()  # before the others are made
            self._look_beside()

    def _look_beside(self) -> None:
        look, self._beside = self._beside, None
        if look is None:
            return
        viewers = self._viewers
        shown = viewers.images.get(2)
        if len(look.pictures) > 1 and (shown is None or shown.choices.port is None):
            viewers.look_at(2, look.pictures[1])
            viewers.docks[look.front].raise_()
        if look.curve is not None:
            viewers.plot.look_at(look.curve)
        if look.node is not None and not self._session.selection:
            self._session.select([look.node])
