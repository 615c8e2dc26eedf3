"""MTF at both Nyquist frequencies: of the samples that are computed, and of the pixels."""

from __future__ import annotations

from typing import Any

from core.chain.probe import TransferAt
from core.chain.wires import Context, Transfer
from core.modules.declaration import Module, readout
from core.physics.sampling.detector_sampling import ifov_mrad


def at_nyquist(transfer: Transfer, axis: str) -> TransferAt | None:
    """At the Nyquist frequency of the image's samples; None of a function with its own."""
    if transfer.own is not None:
        return None
    if axis == "x":
        return TransferAt(transfer, transfer.grid.nyquist_x, 0.0)
    return TransferAt(transfer, 0.0, transfer.grid.nyquist_y)


def at_pixel_nyquist(transfer: Transfer, context: Context, axis: str) -> TransferAt | None:
    """At half a cycle per pitch of the detector, None where that or the focal length is not known.

    It is a figure of the camera: where the image's samples are coarser than the pixels, it lies
    beyond what the image has.
    """
    pitch_um = context.detector_x_um if axis == "x" else context.detector_y_um
    if not pitch_um or not context.focal_length_mm or transfer.own is not None:
        return None
    nyquist = 0.5 / ifov_mrad(pitch_um=pitch_um, focal_length_mm=context.focal_length_mm, fill=1.0)
    return TransferAt(transfer, nyquist, 0.0) if axis == "x" else TransferAt(transfer, 0.0, nyquist)


class NyquistReadouts(Module):
    """Base of modules with an MTF: what it is at both Nyquist frequencies."""

    @readout()
    def mtf_at_nyquist_x(self, outputs: Any) -> TransferAt | None:
        """MTF at the Nyquist frequency of the image's samples across."""
        return at_nyquist(outputs.mtf, "x")

    @readout()
    def mtf_at_nyquist_y(self, outputs: Any) -> TransferAt | None:
        """MTF at the Nyquist frequency of the image's samples along."""
        return at_nyquist(outputs.mtf, "y")

    @readout()
    def mtf_at_pixel_nyquist_x(self, context: Context, outputs: Any) -> TransferAt | None:
        """MTF at the pixels' Nyquist frequency across, half a cycle per pitch of the detector."""
        return at_pixel_nyquist(outputs.mtf, context, "x")

    @readout()
    def mtf_at_pixel_nyquist_y(self, context: Context, outputs: Any) -> TransferAt | None:
        """MTF at the pixels' Nyquist frequency along, half a cycle per pitch of the detector."""
        return at_pixel_nyquist(outputs.mtf, context, "y")
