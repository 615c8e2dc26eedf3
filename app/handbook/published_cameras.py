"""Published cameras: the read-outs of their networks beside the figures of data sheets and papers.

A network of `networks/published` has `published` as every network may (see `published_rows`), and
`inputs`: a list of objects with `of`, names of parameters, and `where`, the source of their values.
A value that no source gives has `until` NODE.READOUT=VALUE, the figure it was solved from, and
`reason`: whether it is plausible. `where` then says solved.
"""

from collections.abc import Mapping
from typing import Any

from app.report.drawing.picture_drawing import number, short
from app.run.shipped import published_networks
from core.chain.engine import Engine, Plan
from core.errors import thaw
from core.evaluation.work import Policy
from core.network.file import load_network
from core.records import dataclass

_NO_SOURCE = ("any value", "assumed", "solved")


@dataclass(frozen=True)
class PublishedFigure:
    """A published figure, ours, and by how much they may differ."""

    text: str
    unit: str
    value: float
    ours: float
    within: float
    reason: str
    where: str

    @property
    def percent(self) -> float:
        """How much more ours is, in per cent of the published value."""
        return 100.0 * (self.ours - self.value) / self.value

    @property
    def difference(self) -> str:
        return f"{round(self.percent, 1) + 0.0:+.1f} %".replace("-", "−")

    @property
    def accepted(self) -> str:
        return f"± {short(100.0 * self.within / self.value, 2)} %"

    @property
    def published(self) -> str:
        return f"{number(self.value)} {self.unit}".strip()

    @property
    def computed(self) -> str:
        """To four digits, or as many as are published."""
        digits = len(f"{self.value:g}".replace(".", "").lstrip("0"))
        return f"{short(self.ours, max(4, digits))} {self.unit}".strip()


@dataclass(frozen=True)
class Inputs:
    """Values of a network's parameters, and where they come from."""

    where: str
    values: tuple[tuple[str, str], ...]  # names, and values with their units
    until: str = ""
    reason: str = ""

    @property
    def published(self) -> bool:
        return not self.where.startswith(_NO_SOURCE)


@dataclass(frozen=True)
class PublishedCamera:
    name: str
    title: str
    text: str
    figures: tuple[PublishedFigure, ...]
    inputs: tuple[Inputs, ...]

    @property
    def largest(self) -> PublishedFigure:
        """The figure that differs most."""
        return max(self.figures, key=lambda figure: abs(figure.percent))

    @property
    def sources(self) -> tuple[str, ...]:
        """What is cited, in the order of the inputs, then of the figures."""
        cited = [entry.where for entry in self.inputs if entry.published]
        return tuple(dict.fromkeys(cited + [figure.where for figure in self.figures]))

    def values_of(self, source: str) -> tuple[tuple[str, str], ...]:
        return tuple(pair for each in self.inputs if each.where == source for pair in each.values)


def published_camera(name: str, engine: Engine) -> PublishedCamera:
    """Open the camera's network, and compute its published figures."""
    path = published_networks()[name]
    network = load_network(path, library=engine.library)
    plan, work = engine.plan(network, folder=path.parent), engine.work(Policy())

    def figure(entry: Mapping[str, Any]) -> PublishedFigure:
        node, _, readout = entry["from"].partition(".")
        ours = float(engine.readouts(plan, node, work)[readout])
        texts = entry["value"], ours, entry["within"], entry["reason"], entry["where"]
        return PublishedFigure(entry["figure"], entry["unit"], *texts)

    def inputs(entry: Mapping[str, Any]) -> Inputs:
        values = tuple((port, _value(plan, port)) for port in entry["of"])
        return Inputs(entry["where"], values, entry.get("until", ""), entry.get("reason", ""))

    facts = thaw(network.extra)
    made = tuple(map(figure, facts["published"])), tuple(map(inputs, facts["inputs"]))
    return PublishedCamera(name, network.name, network.description, *made)


def _value(plan: Plan, port: str) -> str:
    """A parameter's value with its unit."""
    node, _, name = port.partition(".")
    planned = plan.nodes[node]
    parameter = next(each for each in planned.declaration.parameters if each.name == name)
    return f"{number(getattr(planned.module, name))} {parameter.param.unit}".strip()
