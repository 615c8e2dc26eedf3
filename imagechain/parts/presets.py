"""Built-in lenses, detectors, cameras and light, each with its source."""

from __future__ import annotations

from typing import Any

from app.run.preset_files import shipped_presets
from core.errors import NetworkError
from core.names import close, shown
from core.network.file import read_network
from core.network.macro import declared_node
from imagechain.parts.module_part import Part, file_values
from imagechain.parts.plain_errors import plain_errors
from nodes.library import standard_library


def presets() -> dict[str, str]:
    """Titles of the shipped presets, by name."""
    return {one.path.stem: one.title for one in shipped_presets(standard_library())}


@plain_errors
def preset(name: str, **values: Any) -> Part:
    """Make a lens, a detector, a camera or light, to add to a chain as one node.

    Parameters
    ----------
    name : str
        One of `presets()`.
    **values
        Values of the parameters that the preset offers.

    Raises
    ------
    ImagechainError
        If there is no such preset, or a value is not allowed.
    """
    library = standard_library()
    places = {one.path.stem: one.path for one in shipped_presets(library)}
    if name not in places:
        hint = close(name, places) or f"; there are {', '.join(places)}"
        raise NetworkError(f"there is no preset {shown(name)}{hint}")
    (node,) = read_network(places[name], library=library).nodes.values()
    declared = declared_node(node, library)
    assert declared is not None
    own = {
        parameter.name: str(places[name].parent / node.params[parameter.name])
        for parameter in declared.parameters
        if parameter.kind == "path" and parameter.name in node.params
    }
    params = {**node.params, **own, **file_values(declared, values)}
    return Part(node.module, params, None, node.id, node.macro)
