"""What a module with an OTF delivers: both halves of the spectrum, and the OTF to look at."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from core.chain.wires import Magnitude, Phase, Transfer
from core.transfer.factors import Factor
from nodes.shared.module_ports import Apply


class OtfOutputs(NamedTuple):
    """Both halves of the spectrum, and the OTF's modulus and phase."""

    magnitude: Magnitude
    phase: Phase
    mtf: Transfer
    ptf: Transfer


def otf_outputs(
    apply: Apply,
    magnitude: Magnitude,
    phase: Phase | None,
    *,
    blur: Sequence[Factor],
    shift: Sequence[Factor] = (),
    label: str,
) -> OtfOutputs:
    """The spectrum times the OTF, or the OTF alone; a phase that is not linked begins here."""
    if phase is None:
        phase = Phase(None, magnitude.grid, magnitude.edges)
    mtf = magnitude.transfer("mtf", tuple(blur), label)
    ptf = magnitude.transfer("ptf", tuple(shift), label)
    if apply == "filter_only":
        return OtfOutputs(magnitude.only(*blur), phase.only(*shift), mtf, ptf)
    return OtfOutputs(magnitude.times(*blur), phase.plus(*shift), mtf, ptf)
