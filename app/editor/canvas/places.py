"""Which pixel of the view meets a port or a wire."""

from __future__ import annotations

from PySide6.QtCore import QPoint

from app.editor.canvas.hands.surface import Surface
from app.editor.canvas.items.faces import Side
from core.network.network import Link


def pixel_of_port(surface: Surface, name: str, port: str, side: Side) -> QPoint:
    """The pixel at a port's middle.

    Raises
    ------
    KeyError
        If there is no such port.
    """
    return surface.view.pixel(surface.content.nodes[name].ports[side, port].centre())


def pixel_of_wire(surface: Surface, link: Link) -> QPoint:
    """A pixel where a press meets the wire and nothing before it; else its middle.

    Raises
    ------
    KeyError
        If there is no such wire.
    """
    wire = surface.content.wires[link]
    line = wire.line()
    middle = len(line) // 2
    points = sorted(line, key=lambda point: abs(line.index(point) - middle))
    for point in points:
        pixel = surface.view.pixel(point)
        if surface.hit(surface.view.scene_point(pixel)).wire is wire:
            return pixel
    return surface.view.pixel(line[middle])
