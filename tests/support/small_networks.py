"""Shipped networks at a size that tests can afford."""

from pathlib import Path

from core.network.file import load_network
from nodes.library import standard_library

SHIPPED = Path(__file__).parents[2] / "networks"
PUPIL_LENGTHS = ("size_x", "size_y", "radius", "obscuration_radius", "slit_width")


def small_network(title, rows, columns, edges=None):
    """A shipped network with scenes of so many samples, and other edges where they are given."""
    document = load_network(SHIPPED / f"{title}.json", library=standard_library())
    changes = {"test_scene": {"width": columns, "height": rows}}
    if edges is not None:
        changes["init_trans"] = {"edges": edges}
    if title == "microbolometer":  # whose correction averages noisy frames, port by port
        changes["camera"] = {"pixels_x": columns, "pixels_y": rows}
    for name, node in document.nodes.items():
        new = changes.get(node.module, {})
        if node.module == "exit_pupil":
            lengths = (length for length in PUPIL_LENGTHS if length in node.params)
            new = {length: type(node.params[length])(node.params[length] / 8) for length in lengths}
        for parameter, value in new.items():
            document = document.with_parameter(name, parameter, value)
    return document
