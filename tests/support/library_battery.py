"""One module at a time in a small network, and what must hold for any."""

import math
from typing import Any

import numpy as np

from battery_settings import SENSOR, SMALL_PUPIL
from core.chain.engine import Engine, Plan
from core.chain.wires import Context, CurveData, TableData
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.modules.declaration import declaration
from core.network.network import Network
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
DECLARED = {key: declaration(module) for key, module in LIBRARY.items()}

FREQUENCY_OUTPUTS = ("mtf", "ptf")
FILTERS = [k for k, d in DECLARED.items() if any(d.output(name) for name in FREQUENCY_OUTPUTS)]
APPLIED = [k for k in FILTERS if DECLARED[k].parameter("apply")]

SCENE = {"kind": "dormitory", "width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1}
BASE: dict[str, tuple[str, dict[str, Any]]] = {
    "scene": ("test_scene", SCENE),
    "edge": ("test_scene", {**SCENE, "kind": "slanted_edge", "width": 48, "height": 40}),
    "other": ("test_scene", {**SCENE, "kind": "sine"}),
    "init": ("init_trans", SENSOR),
    "pupil": ("exit_pupil", SMALL_PUPIL),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 1}),
    "lag": ("charge_eff_phase", {"efficiency": 0.99}),
    "kelvin": ("to_temperature", {}),
    "share": ("focal_plane", {"integration_time_s": 1e-5, "full_well_e": 3e6}),
}
BASE_LINKS = (
    ("scene.image", "init.image"),
    ("scene.image", "kelvin.image"),
    ("scene.image", "share.image"),
    ("init.context", "share.context"),
    ("init.context", "blur.context"),
    ("init.magnitude", "blur.magnitude"),
    ("init.context", "lag.context"),
    ("init.phase", "lag.phase"),
)
SOURCES = {
    "image": "scene.image", "context": "init.context", "magnitude": "blur.magnitude",
    "phase": "lag.phase", "pupil": "pupil.pupil", "transfer": "blur.mtf",
    "table": "share.table",
}  # fmt: skip
# What a module can make nothing of is not what it is tried with.
OWN_SOURCES = {
    ("measured_mtf", "image"): "edge.image",
    ("to_radiance", "image"): "kelvin.image",
    ("reflected_light", "image"): "share.saturated",  # 0 and 1, without a unit
    ("to_radiance", "emissivity"): None,
    ("to_temperature", "emissivity"): None,
}


def network(key: str, params: dict[str, Any], pupil: dict[str, Any] | None = None) -> Network:
    """The module under test as node `it`, its inputs linked by their type."""
    nodes = {**BASE, "it": (key, params)}
    if pupil is not None:
        nodes["pupil"] = ("exit_pupil", {**SMALL_PUPIL, **pupil})
    links = list(BASE_LINKS)
    for port in DECLARED[key].inputs:
        source = "other.image" if port.name == "reference" else SOURCES[port.types[0]]
        source = OWN_SOURCES.get((key, port.name), source)
        if source is not None:
            links.append((source, f"it.{port.name}"))
    return linked_network(nodes, links, seed=1996)


def planned(key, params, folder, pupil=None) -> Plan:
    plan = Engine(LIBRARY).plan(network(key, params, pupil), folder=folder)
    for node in plan.nodes.values():
        if node.error is not None:
            raise node.error
    return plan


def double():
    return Engine(LIBRARY).work(Policy(precision="double"))


def assert_clear(error: ImagechainError, node: str | None) -> None:
    assert error.exit_code == 2
    assert error.node == node
    assert "\n" not in str(error)


def finite(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.size > 0 and bool(np.isfinite(value).all())
    if isinstance(value, CurveData):
        return all(finite(s.x) and finite(s.y) and len(s.x) == len(s.y) for s in value.series)
    if isinstance(value, TableData):
        return all(finite(row.value) for row in value.rows)
    if isinstance(value, float):
        return math.isfinite(value)
    return isinstance(value, int | str | Context | None)
