"""Pictures that are zoomed and moved together."""

from __future__ import annotations

import weakref

from app.editor.viewers.picture.picture_canvas import PictureCanvas


class ZoomLinks:
    """The pictures that show the same part as one does, as shares of their sizes.

    Links are mutual but not passed on from one to the next, and hold no picture.
    """

    def __init__(self, canvas: PictureCanvas) -> None:
        self._canvas = canvas
        self._linked: weakref.WeakSet[ZoomLinks] = weakref.WeakSet()

    def link(self, other: ZoomLinks, on: bool) -> None:
        """Link to another, or end the link."""
        for one, two in ((self, other), (other, self)):
            (one._linked.add if on else one._linked.discard)(two)
        if on:
            self._canvas.set_zoom(other._canvas.zoom)

    def has(self, other: ZoomLinks) -> bool:
        """Whether the other one is linked."""
        return other in self._linked

    def apply_zoom(self) -> None:
        """Zoom the others to the part that is seen now."""
        for other in list(self._linked):
            other._canvas.set_zoom(self._canvas.zoom)
