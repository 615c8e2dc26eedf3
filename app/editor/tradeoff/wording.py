"""What the dock calls figures, and which it shows at first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from app.editor.declared_text import label_of
from app.run.responses import SYSTEM, TOTAL
from app.tradeoff.tradeoff_figures import SENSORS, Figure, makes_pixels
from core.network.network import Network

_PLACES: Mapping[str, str] = MappingProxyType(
    {
        "mtf_nyquist_x": "MTF ξ, samples' Nyquist",
        "mtf_nyquist_y": "MTF η, samples' Nyquist",
        "mtf_half_nyquist_x": "MTF ξ, ½ samples' Nyquist",
        "mtf_half_nyquist_y": "MTF η, ½ samples' Nyquist",
        "mtf_pixel_nyquist_x": "MTF ξ, pixels' Nyquist",
        "mtf_pixel_nyquist_y": "MTF η, pixels' Nyquist",
        "mtf_half_pixel_nyquist_x": "MTF ξ, ½ pixels' Nyquist",
        "mtf_half_pixel_nyquist_y": "MTF η, ½ pixels' Nyquist",
    }
)
_FIRST = ("netd_system_K", "netd_K", "snr")
_RANGES = ("mrtd_x_K", "detection_range_km", "ttp_range_km")
_MOST_FIRST = 2


def title_of(figure: Figure, shown: Sequence[Figure] = ()) -> str:
    """Name and unit; with its node where others are called alike."""
    if figure.is_total:
        return _PLACES[figure.name] + (", with electronics" if figure.node == SYSTEM else "")
    unit = f" ({figure.unit})" if figure.unit else ""
    alike = [other for other in shown if other.name == figure.name and other.node != figure.node]
    return f"{label_of(figure.name)}{unit}" + (f", {figure.node}" if alike else "")


def listed_titles(every: Sequence[Figure]) -> list[str]:
    """As the list of all figures has them: without their units."""
    nodes: dict[str, set[str]] = {}
    for figure in every:
        nodes.setdefault(figure.name, set()).add(figure.node)
    one_each = {name: min(having) for name, having in nodes.items()}
    other = {name: max(having) for name, having in nodes.items()}
    titles = []
    for figure in every:  # two of a name are enough to see whether others are called alike
        ends = (one_each[figure.name], other[figure.name])
        alike = [replace(figure, node=node) for node in ends]
        titles.append(title_of(replace(figure, unit=""), alike))
    return titles


def renamed(text: str, old: str, new: str) -> str:
    """A figure's name, ``NODE.NAME``, once a node is called otherwise."""
    node, _, name = text.rpartition(".")
    return f"{new}.{name}" if node == old else text


def in_order(known: Mapping[str, Figure], network: Network) -> dict[str, Figure]:
    """The figures as they are listed: what is looked for most comes first."""

    def place(figure: Figure) -> int:
        if figure.is_total:
            return 1 if figure.node == TOTAL else 2
        return 0 if network.nodes[figure.node].module in SENSORS else 3

    return {figure.text: figure for figure in sorted(known.values(), key=place)}


def first_figures(
    network: Network, known: Mapping[str, Figure], analysis: str = ""
) -> frozenset[str]:
    """What is shown until the person chooses: NETD, SNR and the MTF at the pixels' Nyquist.

    Where a network makes no pixels, it is the MTF at the samples' Nyquist.

    They do not hang on the parameters of an analysis node: where one of these is varied, it is
    that node's own figures.
    """
    own = [figure.text for figure in known.values() if analysis and figure.node == analysis]
    if own:
        ranges = [name for name in own if name.rpartition(".")[2] in _RANGES]
        return frozenset(ranges or own[:_MOST_FIRST])
    electronics = [node.id for node in network.nodes.values() if node.module in SENSORS]
    names = [f"{electronics[-1]}.{name}" for name in _FIRST] if electronics else []
    of_pixels = "pixel_" if makes_pixels(network) else ""
    names += [f"{TOTAL}.mtf_{of_pixels}nyquist_x"]
    if not electronics:
        names += [f"{TOTAL}.mtf_half_{of_pixels}nyquist_x"]
    known_names = [name for name in names if name in known]
    return frozenset(known_names or list(known)[:_MOST_FIRST])
