"""Small pictures at the top of panels, which follow what is edited: which stands on which panel."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from app.editor.panels.illustrations.camera_illustration import CameraIllustration
from app.editor.panels.illustrations.electronics_illustration import ElectronicsIllustration
from app.editor.panels.illustrations.exit_pupil_illustration import ExitPupilIllustration
from app.editor.panels.illustrations.focal_plane_illustration import FocalPlaneIllustration
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.panels.illustrations.path_illustration import PathIllustration
from app.editor.panels.illustrations.periodic_noise_illustration import PeriodicNoiseIllustration
from app.editor.panels.illustrations.response_illustration import ResponseIllustration
from app.editor.panels.illustrations.sampling_illustration import InitTransIllustration
from app.editor.panels.illustrations.thumbnail_illustration import ThumbnailIllustration
from app.editor.panels.illustrations.transfer_illustration import (
    PhaseIllustration,
    TransferIllustration,
)
from core.modules.declaration import Declaration
from core.network.network import MACRO

_BY_WORD: Mapping[str, type[Illustration]] = MappingProxyType(
    {
        "picture": ThumbnailIllustration,
        "sampling": InitTransIllustration,
        "pupil": ExitPupilIllustration,
        "detectivity": ElectronicsIllustration,
        "electrons": FocalPlaneIllustration,
        "response": ResponseIllustration,
        "air": PathIllustration,
        "sinusoid": PeriodicNoiseIllustration,
        "ground_sampling": CameraIllustration,
    }
)


def illustration_for(declaration: Declaration) -> type[Illustration] | None:
    """The class of a module's illustration; None where there is nothing to be drawn.

    The one that the declaration names, else the curve of its `mtf` output, else of its `ptf`.

    Raises
    ------
    KeyError
        The declaration names none that there is.
    """
    if declaration.key == MACRO:
        return None
    if declaration.illustration:
        return _BY_WORD[declaration.illustration]
    if declaration.output("mtf") is not None:
        return TransferIllustration
    return PhaseIllustration if declaration.output("ptf") is not None else None
