"""Outputs that several modules share, and the bases of MTF and PTF modules."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from core.chain.probe import TransferAt
from core.chain.wires import Context, Image, Magnitude, Phase, Transfer
from core.modules.declaration import Module, readout
from core.modules.parameters import Param
from core.transfer.factors import Factor
from nodes.shared.nyquist_readouts import NyquistReadouts, at_nyquist, at_pixel_nyquist

Apply = Annotated[
    Literal["multiply", "filter_only"],
    Param("multiply the input by the transfer function, or pass on the transfer function alone"),
]


class ImageOutput(NamedTuple):
    """One image."""

    image: Image


class MtfOutputs(NamedTuple):
    """What every MTF module gives."""

    magnitude: Magnitude
    mtf: Transfer


class PtfOutputs(NamedTuple):
    """What every PTF module gives."""

    phase: Phase
    ptf: Transfer


class MtfModule(NyquistReadouts):
    """Base of modules that multiply a magnitude by an MTF."""

    apply: Apply = "multiply"

    def mtf_outputs(self, magnitude: Magnitude, *factors: Factor) -> MtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = magnitude.transfer("mtf", factors, self.title)
        if self.apply == "filter_only":
            return MtfOutputs(magnitude.only(*factors), transfer)
        return MtfOutputs(magnitude.times(*factors), transfer)


class PtfModule(Module):
    """Base of modules that add a PTF to a phase."""

    apply: Apply = "multiply"

    def ptf_outputs(self, phase: Phase, *factors: Factor) -> PtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = phase.transfer("ptf", factors, self.title)
        if self.apply == "filter_only":
            return PtfOutputs(phase.only(*factors), transfer)
        return PtfOutputs(phase.plus(*factors), transfer)

    @readout("rad")
    def ptf_at_nyquist_x(self, outputs: PtfOutputs) -> TransferAt | None:
        """PTF at the Nyquist frequency of the image's samples across."""
        return at_nyquist(outputs.ptf, "x")

    @readout("rad")
    def ptf_at_pixel_nyquist_x(self, context: Context, outputs: PtfOutputs) -> TransferAt | None:
        """PTF at the pixels' Nyquist frequency across, half a cycle per pitch of the detector."""
        return at_pixel_nyquist(outputs.ptf, context, "x")
