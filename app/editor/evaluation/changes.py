"""What an edit changes; planning with nodes held back from it, and with smaller pictures.

Nodes without Auto-Generate stay as they were generated last. Smaller pictures are for a first look
while edits come: behind each source of pictures stands a mean of blocks of samples. What later
parameters count in samples is counted in those blocks; all that is given in mrad, cycles/mrad or
seconds stays.
"""

import math
from collections.abc import Callable, Collection, Hashable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from core.chain.engine import Engine, Plan, PlannedNode
from core.chain.wires import Image, Magnitude, Phase
from core.network.network import Link, Network, Node
from core.physics.detector.readout import dwell_time_s
from core.records import dataclass, replace

Change = frozenset[tuple[str, str] | str | Link] | None
"""Parameters by node, nodes, links and "seed"; the same edit again is equal to it."""


def edited(before: Network | None, after: Network) -> Change:
    """What differs between two networks; None where there was none before."""
    if before is None:
        return None
    changes: set[tuple[str, str] | str | Link] = {*(set(before.links) ^ set(after.links))}
    for name in {*before.nodes, *after.nodes}:
        old, new = before.nodes.get(name), after.nodes.get(name)
        if old is new:
            continue
        if old is None or new is None or (old.auto, old.disabled) != (new.auto, new.disabled):
            changes.add(name)
        else:
            names = {*old.params, *new.params}
            changes |= {(name, p) for p in names if old.params.get(p) != new.params.get(p)}
    if before.seed != after.seed:
        changes.add("seed")
    return frozenset(changes)


def computes_alike(before: Network, after: Network) -> bool:
    return (
        before.links == after.links
        and before.seed == after.seed
        and before.extra == after.extra
        and len(before.nodes) == len(after.nodes)
        and all(after.nodes.get(name) is node for name, node in before.nodes.items())
    )


@dataclass(frozen=True)
class Planned:
    """A network as shown, and as if all were generated; `stale` nodes would give other values."""

    shown: Plan
    fresh: Plan
    stale: frozenset[str] = frozenset()


def plan_held(
    engine: Engine, network: Network, folder: Path, last: Planned | None, *, generate: bool
) -> Planned:
    """Plan a network; unless all is generated, or was just opened, held nodes stay as they were."""
    before = last.fresh if last is not None else None
    fresh = engine.plan(network, folder=folder, previous=before)
    if generate or last is None:
        return Planned(fresh, fresh)
    held = {
        name: planned
        for name, planned in last.shown.nodes.items()
        if planned.error is None and name in network.nodes and network.nodes[name].auto is False
    }
    if not held:
        return Planned(fresh, fresh)
    shown = engine.plan(network, folder=folder, previous=last.shown, held=held)
    stale = frozenset(name for name in held if content(held[name]) != content(fresh.nodes[name]))
    return Planned(shown, fresh, stale)


def content(planned: PlannedNode) -> tuple[Hashable, ...]:
    """What a node makes its outputs and read-outs of, and what it gives."""
    return (
        _keys(planned.outputs),
        _keys(planned.inputs),
        repr(planned.module),
        planned.node.disabled,
        planned.error is None,
    )


def _keys(values: Any) -> tuple[tuple[str, str | None], ...]:
    return tuple((name, getattr(value, "key", None)) for name, value in sorted(values.items()))


# Parameters that modules count in samples, for pictures that have fewer of them.

Ratio = tuple[int, int]
"""How many times fewer samples a picture has across and along."""

Count = Callable[[PlannedNode, Ratio], Mapping[str, Any] | None]
"""Gives the parameters to change; None: none."""


def _size(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Interpolate: a part of a sample more or less only changes the interval."""
    module: Any = planned.module
    sizes = {"width": (module.width, ratio[0]), "height": (module.height, ratio[1])}
    return {name: max(1, round(size / by)) for name, (size, by) in sizes.items() if size}


def _factor(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Anti-alias Filter: the nearest whole number of samples."""
    module: Any = planned.module
    return {"factor": max(1, round(module.factor / _mean(ratio)))}


def _width(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Poisson Noise: the weights of the local mean keep their width in mrad."""
    module: Any = planned.module
    return {"width_px": module.width_px / _mean(ratio)}


def _probe(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Examine Image: the block that has the sample."""
    module: Any = planned.module
    if module.probe_x is None:
        return None
    return {"probe_x": module.probe_x // ratio[0], "probe_y": module.probe_y // ratio[1]}


def _transfers(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Charge transfer between samples: as many as give the same loss at low frequencies.

    With w = 2π·xi·Δ, −ln MTF = N(1−ε)(1 − cos w) starts as w², the phase as w, or by eq. 4.58 as
    w³.
    """
    module: Any = planned.module
    if module.nyquist != "image":
        return None
    power = 2
    if planned.node.module == "charge_eff_phase":
        power = 3 if module.model == "published" else 1
    return {"detectors_per_line": round(module.detectors_per_line / ratio[0] ** power)}


def _dwell(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:  # noqa: ARG001
    """Electronics & Noise: a detector dwells no longer because the preview's samples are larger."""
    module: Any = planned.module
    context = planned.inputs["context"]
    velocity = module.scan_velocity(context)
    if module.time_constant_s is not None or velocity == 0:
        return None
    interval = context.grid.interval_x_mrad
    time = dwell_time_s(interval_mrad=interval, scan_velocity_mrad_per_s=velocity)
    return {"time_constant_s": time}


def _pattern(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any] | None:
    """Periodic Noise: the first sample is the middle of a block, further into the picture."""
    module: Any = planned.module
    image = planned.inputs["image"]
    if image.interval_x_mrad is None or image.interval_y_mrad is None:
        return None
    x, y = (ratio[0] - 1) / 2 * image.interval_x_mrad, (ratio[1] - 1) / 2 * image.interval_y_mrad

    def moved(phase_deg: float, xi: float, eta: float) -> float:
        return phase_deg + 360.0 * math.fmod(xi * x + eta * y, 1.0)

    return {
        "phase_deg": moved(module.phase_deg, module.xi, module.eta),
        "modulation_phase_deg": moved(
            module.modulation_phase_deg, module.modulation_xi, module.modulation_eta
        ),
    }


def _camera(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """Camera Geometry: the same field of the same scene, both in fewer and larger samples."""
    module: Any = planned.module
    image = planned.inputs["image"]
    camera, (x_m, y_m) = module.camera(image), module.intervals_m(image)
    columns, rows = max(1, camera.columns // ratio[0]), max(1, camera.rows // ratio[1])
    across, along = camera.columns / columns, camera.rows / rows
    focal_length_mm = module.focal_length_mm or 1.0
    changed = {
        "ground_interval_m": x_m * image.columns / (image.columns // ratio[0]),
        "ground_interval_y_m": y_m * image.rows / (image.rows // ratio[1]),
        "columns": columns,
        "rows": rows,
        "fov_x_deg": None,
        "focal_length_mm": focal_length_mm,
        "pitch_x_um": camera.step_x_mrad * across * focal_length_mm,
        "pitch_y_um": camera.step_y_mrad * along * focal_length_mm,
    }
    if camera.kind != "framing":
        changed["velocity_m_per_s"] = camera.line_spacing_m * along
        changed["line_rate_Hz"] = 1.0
    return changed


def _mean(ratio: Ratio) -> float:
    return math.sqrt(ratio[0] * ratio[1])


IN_SAMPLES: Mapping[str, Count] = MappingProxyType(
    {
        "interpolate": _size,
        "anti_alias": _factor,
        "poisson_noise": _width,
        "examine_image": _probe,
        "charge_eff_mtf": _transfers,
        "charge_eff_phase": _transfers,
        "electronics_noise": _dwell,
        "periodic_noise": _pattern,
        "camera_geometry": _camera,
    }
)


SMALLEST = 16
"""No side of a picture gets fewer samples."""
BINNING = "combine_pixels"
_DRAWN_ALIKE = ("slanted_edge", "four_bar", "sine", "two_panel", "uniform")
_DRAWN_NEARLY = ("dormitory", "airfield", "siemens_star")


def reduced_network(plan: Plan, factor: int, *, edited: Collection[str] = ()) -> Network | None:
    """The network with pictures smaller by `factor` along each side; None where it cannot be.

    A picture whose pixels are combined later is reduced by what is left of the factor then. A test
    scene among the nodes that are `edited` is drawn at the reduced size, as to draw it at full size
    each time would leave nothing to gain. Others were drawn already.
    """
    network, nodes = plan.network, dict[str, Node]()
    ratios: dict[tuple[str, str], Ratio] = {}  # by how much the picture on an output is reduced
    binned: dict[tuple[str, str], str] = {}  # the node behind an output that combines its samples
    for name in network.order():
        planned = plan.nodes[name]
        node = nodes[name] = planned.node
        if planned.error is not None:
            continue
        ends = [(link.source, link.output) for link in network.links_into(name)]
        coming = {ratios[end] for end in ends if end in ratios}
        if len(coming) > 1:
            return None
        if coming:
            ratio = coming.pop()
            if not node.disabled:
                if node.module == "noise_file" and ratio != (1, 1):
                    return None
                params, ratio = _counted(planned, ratio)
                nodes[name] = node if params is None else _with(node, params)
            for port, value in planned.outputs.items():
                if isinstance(value, Image | Magnitude | Phase):
                    ratios[name, port] = ratio
            continue
        images = [(p, value) for p, value in planned.outputs.items() if isinstance(value, Image)]
        for port, value in images:
            if min(value.rows, value.columns) < factor * SMALLEST:
                return None
            ratios[name, port] = (factor, factor)
            if _draws_itself_smaller(planned, factor, edited):
                size = {"width": value.columns // factor, "height": value.rows // factor}
                nodes[name] = _with(node, size)
                continue
            binning = f"{name} reduced"
            while binning in nodes or binning in plan.nodes:
                binning += "_"
            nodes[binning] = Node(binning, BINNING, {"factor_x": factor, "factor_y": factor})
            binned[name, port] = binning
    links = []
    for link in network.links:
        behind = binned.get((link.source, link.output))
        links.append(link if behind is None else replace(link, source=behind, output="image"))
    links += [Link(*port, name, "image") for port, name in binned.items()]
    return replace(network, nodes=nodes, links=tuple(links), layout={}) if ratios else None


def _counted(planned: PlannedNode, ratio: Ratio) -> tuple[Mapping[str, Any] | None, Ratio]:
    if ratio == (1, 1):
        return None, ratio
    key = planned.node.module
    if key == "combine_pixels":
        return _combined(planned, ratio)
    if key == "sample_pixels":
        return _sampled(planned, ratio), (1, 1)
    count = IN_SAMPLES.get(key)
    return (count(planned, ratio) if count is not None else None), ratio


def _combined(planned: PlannedNode, ratio: Ratio) -> tuple[Mapping[str, Any], Ratio]:
    """What the pictures are reduced by need not be combined any more."""
    module: Any = planned.module
    x, y = math.gcd(module.factor_x, ratio[0]), math.gcd(module.factor_y, ratio[1])
    left = {"factor_x": module.factor_x // x, "factor_y": module.factor_y // y}
    return left, (ratio[0] // x, ratio[1] // y)


def _sampled(planned: PlannedNode, ratio: Ratio) -> Mapping[str, Any]:
    """As many pixels as ever, of fewer samples each; by the pitch they follow by themselves."""
    module: Any = planned.module
    factors = {"factor_x": (module.factor_x, ratio[0]), "factor_y": (module.factor_y, ratio[1])}
    return {name: factor / by for name, (factor, by) in factors.items() if factor}


def _draws_itself_smaller(planned: PlannedNode, factor: int, edited: Collection[str]) -> bool:
    """Whether a test scene is drawn at the reduced size: as good as blocks' means, or nearly."""
    module: Any = planned.module
    if planned.node.module != "test_scene" or module.width % factor or module.height % factor:
        return False
    near = module.kind in _DRAWN_NEARLY and planned.node.id in edited
    return module.kind in _DRAWN_ALIKE or near


def _with(node: Node, params: Mapping[str, Any]) -> Node:
    return replace(node, params={**node.params, **params})


def with_same_nodes(network: Network, before: Network) -> Network:
    """The network with the very nodes of an earlier one where they are equal: planned once."""
    nodes = {
        name: before.nodes[name] if before.nodes.get(name) == node else node
        for name, node in network.nodes.items()
    }
    return replace(network, nodes=nodes)
