"""The steps of the first tour: they build the shipped network `first_steps`, part by part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from core.editing.operations import (
    Add,
    Operation,
    Placed,
    Rewire,
    Together,
    fresh_name,
    set_parameter,
)
from core.network.network import Link, Network, Node

Part = Literal["library", "canvas", "panels"]


@dataclass(frozen=True)
class TourStep:
    """What is to be done, and where.

    Parameters
    ----------
    text : str
        One sentence.
    part : "library", "canvas" or "panels"
        The part of the window concerned.
    nodes : tuple of str
        Nodes of the model that are to be there afterwards.
    values : tuple of str
        Parameters of the last node, one of which is to be set.
    """

    text: str
    part: Part
    nodes: tuple[str, ...]
    values: tuple[str, ...] = ()


STEPS = (
    TourStep("Double-click Test Scene in the library to add a scene.", "library", ("scene",)),
    TourStep(
        "Add Init & Trans the same way; it needs a wire, dragged from the scene's image.",
        "canvas",
        ("init",),
    ),
    TourStep(
        "Add a Gaussian MTF; it needs wires from context and magnitude of Init & Trans.",
        "canvas",
        ("blur",),
    ),
    TourStep(
        "Add Back Transform; it needs wires from the blur's magnitude and Init & Trans' phase.",
        "canvas",
        ("back",),
    ),
    TourStep(
        "Add Examine Image; it needs a wire from the image of Back Transform.",
        "canvas",
        ("picture",),
    ),
    TourStep(
        "Move σ x of the Gaussian MTF in its control panel, and watch the picture blur.",
        "panels",
        ("blur",),
        ("sigma_x_mrad", "sigma_y_mrad"),
    ),
)


class TourModel:
    """Compares a network with the model that is being built, whatever its nodes are called.

    Parameters
    ----------
    model : Network
        The network to be built.
    """

    def __init__(self, model: Network) -> None:
        self._model = model

    def name(self, network: Network, role: str) -> str | None:
        """The node of a network that is there for one of the model; None where none is."""
        module = self._model.nodes[role].module
        return next((name for name, node in network.nodes.items() if node.module == module), None)

    def is_done(self, network: Network, number: int) -> bool:
        """Whether a network has all of a step, with what it is wired to."""
        step = STEPS[number]
        sources = [link.source for link in self._model.links if link.target in step.nodes]
        there = all(self.name(network, role) for role in (*step.nodes, *sources))
        return there and not self._missing(network, step, step.nodes)

    def operation(self, network: Network, number: int) -> Operation | None:
        """What is still to be done of a step, and of those before it; None where nothing is."""
        roles = dict.fromkeys(role for step in STEPS[: number + 1] for role in step.nodes)
        missing = self._missing(network, STEPS[number], tuple(roles))
        return Together(missing, f"Tour, step {number + 1}") if missing else None

    def _missing(self, network: Network, step: TourStep, roles: Sequence[str]) -> list[Operation]:
        """What these nodes of the model, their links and the step's values still need."""
        parts: list[Operation] = []
        names, placed = self._placed(network, roles)
        if placed:
            parts.append(Add(placed))
        links = self._links(network, roles, names)
        if links:
            parts.append(Rewire(links))
        return [*parts, *self._values(network, step, names)]

    def _placed(
        self, network: Network, roles: Sequence[str]
    ) -> tuple[dict[str, str], tuple[Placed, ...]]:
        """The network's nodes by those of the model, and what is to be added."""
        names, placed = {}, []
        for role in self._model.nodes:
            name = self.name(network, role)
            if name is None and role in roles:
                name = fresh_name(role, network.nodes)  # one of another module may have it
                module = self._model.nodes[role]
                values = {v for step in STEPS for v in step.values if role in step.nodes}
                params = {key: v for key, v in module.params.items() if key not in values}
                placed.append(Placed(Node(name, module.module, params), self._model.layout[role]))
            if name is not None:
                names[role] = name
        return names, tuple(placed)

    def _links(
        self, network: Network, roles: Sequence[str], names: dict[str, str]
    ) -> tuple[Link, ...]:
        """Links of the model into these nodes that the network lacks."""
        wanted = (
            Link(names[link.source], link.output, names[link.target], link.input)
            for link in self._model.links
            if link.target in roles and link.source in names
        )
        return tuple(link for link in wanted if link not in network.links)

    def _values(self, network: Network, step: TourStep, names: dict[str, str]) -> list[Operation]:
        """The model's values, unless one has been set."""
        role = step.nodes[-1]
        node = network.nodes.get(names.get(role, ""))
        if not step.values or (node is not None and any(v in node.params for v in step.values)):
            return []
        params = self._model.nodes[role].params
        return [set_parameter(names[role], value, params[value]) for value in step.values]
