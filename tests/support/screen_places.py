"""Which pixel of the screen meets a node, a port or a wire of the canvas, or a module's name."""

from PySide6.QtCore import QPointF

from app.editor.canvas.canvas_style import HEAD, NARROWEST
from app.editor.canvas.content import hit


def place_of_node(canvas, name):
    """In a node's middle."""
    return _on_screen(canvas, canvas.content.nodes[name].frame().center())


def place_of_head(canvas, name):
    """On a node's title."""
    return _on_screen(canvas, canvas.content.nodes[name].pos() + QPointF(NARROWEST, HEAD) / 2)


def place_of_port(canvas, name, port, side):
    """In a port's middle."""
    return _on_screen(canvas, canvas.content.nodes[name].ports[side, port].centre())


def place_of_wire(canvas, link):
    """Where a press meets the wire and nothing before it; else in its middle."""
    wire = canvas.content.wires[link]
    line = wire.line()
    middle = len(line) // 2
    points = sorted(line, key=lambda point: abs(line.index(point) - middle))
    for point in points:
        seen = canvas.view.scene_point(canvas.view.pixel(point))
        if hit(canvas.content, seen, canvas.view.zoom).wire is wire:
            return _on_screen(canvas, point)
    return _on_screen(canvas, line[middle])


def place_of_module(library_view, key):
    """In a module's middle in the library, scrolled into view."""
    tree = library_view.tree
    item = tree.modules[key]
    tree.scrollToItem(item)
    return tree.viewport().mapToGlobal(tree.visualItemRect(item).center())


def _on_screen(canvas, point):
    return canvas.view.viewport().mapToGlobal(canvas.view.pixel(point))
