"""Outputs that several modules share, and the bases of MTF and PTF modules."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from core.chain.probe import TransferAt
from core.chain.wires import Image, Magnitude, Phase, Transfer
from core.modules.declaration import Module, readout
from core.modules.parameters import Param
from core.transfer.factors import Factor

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


class MtfModule(Module):
    """Base of modules that multiply a magnitude by an MTF."""

    apply: Apply = "multiply"

    def mtf_outputs(self, magnitude: Magnitude, *factors: Factor) -> MtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = Transfer(magnitude.grid, "mtf", factors, label=self.title)
        if self.apply == "filter_only":
            return MtfOutputs(magnitude.only(*factors), transfer)
        return MtfOutputs(magnitude.times(*factors), transfer)

    @readout()
    def mtf_at_nyquist_x(self, outputs: MtfOutputs) -> TransferAt:
        """MTF at the image's Nyquist frequency across."""
        return TransferAt(outputs.mtf, outputs.mtf.grid.nyquist_x, 0.0)

    @readout()
    def mtf_at_nyquist_y(self, outputs: MtfOutputs) -> TransferAt:
        """MTF at the image's Nyquist frequency along."""
        return TransferAt(outputs.mtf, 0.0, outputs.mtf.grid.nyquist_y)


class PtfModule(Module):
    """Base of modules that add a PTF to a phase."""

    apply: Apply = "multiply"

    def ptf_outputs(self, phase: Phase, *factors: Factor) -> PtfOutputs:
        """Outputs for these factors; none of them is the identity, whose key passes through."""
        transfer = Transfer(phase.grid, "ptf", factors, label=self.title)
        if self.apply == "filter_only":
            return PtfOutputs(phase.only(*factors), transfer)
        return PtfOutputs(phase.plus(*factors), transfer)

    @readout("rad")
    def ptf_at_nyquist_x(self, outputs: PtfOutputs) -> TransferAt:
        """PTF at the image's Nyquist frequency across."""
        return TransferAt(outputs.ptf, outputs.ptf.grid.nyquist_x, 0.0)
