"""The number of a frame, for what changes from frame to frame by a law and not by fresh draws."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FrameNumber:
    """Stands among a step's or a law's parameters; a sequence puts each frame's own in its place.

    Parameters
    ----------
    frame : int
        The frame; a single picture is frame 0, those before it are negative.
    """

    frame: int = 0
