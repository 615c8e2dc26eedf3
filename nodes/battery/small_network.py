"""A small network around one module, its inputs linked by their types."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.chain.engine import Engine, Plan
from core.errors import NetworkError
from core.modules.declaration import Module, declaration
from core.modules.library_type import Library
from core.network.network import Link, Network, Node
from nodes.library import standard_library

IT = "it"
SENSOR = {
    "focal_length_mm": 50.0, "f_number": 2.0, "detector_x_um": 30.0, "detector_y_um": 30.0,
}  # fmt: skip
SCENE = {"width": 15, "height": 11, "fov_x_deg": 1.5, "fov_y_deg": 1.1}
BASE: Mapping[str, tuple[str, Mapping[str, Any]]] = {
    "scene": ("test_scene", SCENE),
    "init": ("init_trans", SENSOR),
    "pupil": ("exit_pupil", {"size_x": 32, "size_y": 32, "radius": 12}),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 1.0}),
    "lag": ("charge_eff_phase", {"efficiency": 0.99}),
}
BASE_LINKS = (
    ("scene", "image", "init", "image"),
    ("init", "context", "blur", "context"),
    ("init", "magnitude", "blur", "magnitude"),
    ("init", "context", "lag", "context"),
    ("init", "phase", "lag", "phase"),
)
SOURCES = {
    "image": ("scene", "image"),
    "context": ("init", "context"),
    "magnitude": ("blur", "magnitude"),
    "phase": ("lag", "phase"),
    "pupil": ("pupil", "pupil"),
    "transfer": ("blur", "mtf"),
}


def library_with(module: type[Module]) -> Library:
    """The standard library and this module, which takes the place of one of its key."""
    return {**standard_library(), module.key: module}


def network_of(
    module: type[Module], params: Mapping[str, Any], scene: Mapping[str, Any]
) -> Network:
    """The module as node ``it`` in a small network.

    Raises
    ------
    NetworkError
        For an input of a type that nothing here delivers.
    """
    nodes = {
        name: Node(name, key, {**values, **(scene if name == "scene" else {})})
        for name, (key, values) in BASE.items()
    }
    links = [Link(*ends) for ends in BASE_LINKS]
    for port in declaration(module).inputs:
        source = next((SOURCES[kind] for kind in port.types if kind in SOURCES), None)
        if source is not None:
            links.append(Link(*source, IT, port.name))
        elif port.required:
            kinds = " or ".join(port.types)
            raise NetworkError(f"nothing here delivers {kinds} for the input {port.name}", node=IT)
    nodes[IT] = Node(IT, module.key, dict(params))
    return Network(nodes=nodes, links=tuple(links), seed=1996)


def planned(
    module: type[Module], params: Mapping[str, Any], scene: Mapping[str, Any], folder: Path
) -> tuple[Engine, Plan]:
    """The network planned.

    Raises
    ------
    ImagechainError
        The first fault of a node.
    """
    engine = Engine(library_with(module))
    plan = engine.plan(network_of(module, params, scene), folder=folder)
    for node in plan.nodes.values():
        if node.error is not None:
            raise node.error
    return engine, plan
