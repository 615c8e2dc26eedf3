"""A hand on the region that a picture shows, and what is seen and stored of it."""

from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest


class PictureHand:
    """Presses and drags on a picture, at edges between samples: 0 is the picture's own first."""

    def __init__(self, viewer):
        self.viewer = viewer
        self.view = viewer.canvas.viewport()

    def at(self, column, row):
        canvas = self.viewer.canvas
        scene = canvas.view.mapViewToScene(QPointF(column - 0.5, row - 0.5))
        return canvas.mapFromScene(scene)

    def press(self, place, button=Qt.MouseButton.LeftButton):
        self.move(place)
        QTest.mousePress(self.view, button, Qt.KeyboardModifier.NoModifier, self.at(*place))

    def move(self, place):
        QTest.qWait(12)  # pyqtgraph drops what comes faster
        QTest.mouseMove(self.view, self.at(*place))

    def release(self, place):
        QTest.mouseRelease(
            self.view, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, self.at(*place)
        )

    def drag(self, start, end):
        self.press(start)
        middle = tuple((one + other) / 2 for one, other in zip(start, end, strict=True))
        for place in (middle, end):
            self.move(place)
        self.release(end)


def stored(bench, node="measured"):
    params = bench.session.network.nodes[node].params
    names = ("region_x", "region_y", "region_width", "region_height")
    return tuple(params.get(name) for name in names)


def framed(viewer):
    """Edges of the frame that is seen, counted from the picture's first edge; None unseen."""
    frame = viewer.region.frame
    return frame.region if frame.isVisible() else None


def undo_steps(bench):
    return bench.session.document.position
