"""What the MTF and PTF modules of charge transfer share."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from core.chain.wires import Context
from core.modules.declaration import Module
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from nodes.shared.context_defaults import pixel_mrad


class ChargeTransfer(Module):
    """Parameters of incomplete charge transfer along the read-out direction (x)."""

    detectors_per_line: Annotated[
        int, Param("number of transfers", low=0, high=10**9, slider=(1, 4096))
    ] = 640
    efficiency: Annotated[
        float, Param("fraction of the charge that each transfer passes on", low=0, high=1)
    ] = 0.99999
    model: Annotated[
        Literal["exact", "published", "leading"],
        Param("the exact product over all transfers (eqs. 4.57-4.58), or its leading term"),
    ] = "exact"
    nyquist: Annotated[
        Literal["image", "detector"],
        Param("distance between charge packets: one image sample, or one detector pitch"),
    ] = "image"

    panel = (
        Section("", ("apply",)),
        Section("Charge transfer", ("detectors_per_line", "efficiency", "model", "nyquist")),
    )

    def neutral(self) -> bool:
        return self.detectors_per_line == 0 or self.efficiency == 1.0

    def law(self) -> dict[str, Any]:
        return {
            "transfers": self.detectors_per_line,
            "efficiency": self.efficiency,
            "model": self.model,
        }

    def phase_per_frequency(self, context: Context) -> float:
        """2π times the packets' distance in mrad: w per cycle/mrad."""
        image = self.nyquist == "image"
        return 2 * math.pi * (context.grid.interval_x_mrad if image else pixel_mrad("x", context))
