"""Which illustration stands on which panel."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from app.editor.panels.illustrations.camera_illustration import CameraIllustration
from app.editor.panels.illustrations.electronics_illustration import ElectronicsIllustration
from app.editor.panels.illustrations.exit_pupil_illustration import ExitPupilIllustration
from app.editor.panels.illustrations.illustration import Illustration
from app.editor.panels.illustrations.periodic_noise_illustration import PeriodicNoiseIllustration
from app.editor.panels.illustrations.sampling_illustration import InitTransIllustration
from app.editor.panels.illustrations.thumbnail_illustration import ThumbnailIllustration
from app.editor.panels.illustrations.transfer_illustration import (
    PhaseIllustration,
    TransferIllustration,
)


def illustration_for(module: str) -> type[Illustration] | None:
    """The class of a module's illustration, by the module's key; None where there is none."""
    return _ILLUSTRATIONS.get(module)


_MTF_MODULES = (
    "atmosphere_mtf",
    "exit_pupil_mtf",
    "gaussian_mtf",
    "crosstrack_mtf",
    "alongtrack_mtf",
    "relative_motion_mtf",
    "jitter_mtf",
    "vibration_mtf",
    "detector_mtf",
    "charge_eff_mtf",
)
_ILLUSTRATIONS: Mapping[str, type[Illustration]] = MappingProxyType(
    {
        **dict.fromkeys(_MTF_MODULES, TransferIllustration),
        "charge_eff_phase": PhaseIllustration,
        "read_image": ThumbnailIllustration,
        "test_scene": ThumbnailIllustration,
        "periodic_noise": PeriodicNoiseIllustration,
        "init_trans": InitTransIllustration,
        "exit_pupil": ExitPupilIllustration,
        "electronics_noise": ElectronicsIllustration,
        "camera_geometry": CameraIllustration,
    }
)
