"""Pictures that viewers show, ready to be measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.editor.viewers.picture.image_viewer import ImageViewer
from core.chain.wires import Image
from core.errors import UsageError


@dataclass(frozen=True, eq=False)
class ViewerPicture:
    """A picture of a viewer: its samples, and what is known of them."""

    name: str
    samples: Any
    unit: str
    interval_x_mrad: float | None
    interval_y_mrad: float | None
    taken: str


def picture_of(number: int, viewer: ImageViewer) -> ViewerPicture:
    """What a viewer shows.

    Raises
    ------
    UsageError
        It shows no picture in space, or a preview of one.
    """
    picture, port = viewer.picture, viewer.choices.port
    if picture is None or port is None:
        raise UsageError(f"viewer {number} shows no picture")
    value = picture.value
    if not isinstance(value, Image) or picture.facts.kind != "picture":
        raise UsageError(f"viewer {number} shows {port}, which is no picture of a scene")
    if picture.reduced > 1:
        raise UsageError(f"viewer {number} shows a preview still: wait for the picture itself")
    if viewer.choices.mapping == "spectrum" or viewer.choices.mode == "difference":
        raise UsageError(f"viewer {number} shows a spectrum or a difference: show the picture")
    wavelengths = picture.facts.wavelengths_um
    taken = f"the band at {wavelengths[0]:.4g} µm" if wavelengths else ""
    return ViewerPicture(
        f"viewer {number}: {port}", np.asarray(picture.samples), picture.facts.unit,
        value.interval_x_mrad, value.interval_y_mrad, taken,
    )  # fmt: skip


def shown_in(viewers: Mapping[int, ImageViewer]) -> list[int]:
    """Numbers of the viewers that show something."""
    return [number for number, viewer in sorted(viewers.items()) if viewer.picture is not None]
