"""Charge Trails: incomplete charge transfer, pixel by pixel."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np

from core.chain.step_lineage import Array, LineOperator, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import Region, Seen, by_region
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, param, readout, warning
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.physics.detector.readout import trail_length, trailed
from core.records import dataclass
from core.transfer.factors import Factor, Grid, Separable
from nodes.shared.module_ports import ImageOutput, OfPixels, passed_factors, separable
from nodes.shared.steps import stepped

_BLOCK_SAMPLES = 1 << 18


class ChargeTrails(OfPixels, key="charge_trails", title="Charge Trails", group="Detector"):
    """Add the trails of incomplete charge transfer, which grow with distance from the amplifier.

    In each transfer, a share of the charge stays behind and joins the next packet. Charge is
    shifted along the columns into the serial register, which is then read pixel by pixel. A pixel
    n transfers from the amplifier loses about n·(1 − efficiency) of its charge to its trail. Charge
    that trails out of the picture is lost. Use either this module or Charge Transfer MTF, which
    blurs all pixels equally. Put this module after Sample Pixels or Combine Pixels. Predicted MTFs
    hold for the middle pixel. Source: Janesick 2001, Scientific Charge-Coupled Devices, chapter 5.
    """

    formulas = (
        Formula(
            r"L'_t=\sum_{k\geq0}\binom{n+k-1}{k}\,\varepsilon^n(1-\varepsilon)^k\,L_{t-k},\quad "
            r"n=t-k+1+m",
            where="t: pixels from the amplifier, counted from 0; ε: efficiency; m: extra "
            "transfers; the sum is applied along columns, then along rows",
        ),
    )

    serial_efficiency: float = param(
        1.0, "serial charge transfer efficiency, per transfer along a row", (0.5, 1)
    )
    parallel_efficiency: float = param(
        1.0, "parallel charge transfer efficiency, per transfer along a column", (0.5, 1)
    )
    amplifier: Literal["bottom_left", "bottom_right", "top_left", "top_right"] = param(
        "bottom_left", "corner where the amplifier is"
    )
    extra_serial: int = param(
        0, "extra transfers along a row, outside the picture", (0, 10**6), slider=(0, 4096)
    )
    extra_parallel: int = param(
        0, "extra transfers along a column, outside the picture", (0, 10**6), slider=(0, 4096)
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        for change in self._changes(image):
            if change.efficiency < 1.0:
                step = here.step(with_trails, image.recipe, change=change)
                image = stepped(image, step, gain=change.gain)
        return ImageOutput(image)

    def _changes(self, image: Image) -> tuple[Trails, Trails]:
        far_y, far_x = (side in self.amplifier for side in ("bottom", "right"))
        return (
            Trails("y", self.parallel_efficiency, self.extra_parallel, image.rows, far_y),
            Trails("x", self.serial_efficiency, self.extra_serial, image.columns, far_x),
        )

    @warning
    def twice(self, image: Image) -> Caution | None:
        """Incomplete charge transfer along the rows has already blurred the picture."""
        for factor in passed_factors(image) if self.serial_efficiency < 1.0 else ():
            along = factor.x if isinstance(factor, Separable) else None
            if along is not None and "efficiency" in dict(along.parameters):
                return Caution(
                    "incomplete charge transfer along the rows is applied twice, here and on "
                    f"{factor.node}",
                    f"delete this node or {factor.node}, or set the efficiency of one of these "
                    "two nodes to 1",
                )
        return None

    @readout("%")
    def trail_percent(self, image: Image) -> float:
        """Share of charge that the pixel farthest from the amplifier loses to its trails."""
        return 100.0 * (1.0 - math.prod(c.efficiency**c.transfers for c in self._changes(image)))


@dataclass(frozen=True)
class Trails(LineOperator):
    efficiency: float
    extra: int
    pixels: int
    far: bool  # whether the amplifier is at the end of the axis

    @property
    def transfers(self) -> int:
        return self.extra + self.pixels

    @property
    def gain(self) -> float:
        return float(self.applied(np.ones((self.pixels, 1))).mean())

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        law = {"efficiency": self.efficiency, "transfers": self.extra + 0.5 * (self.pixels + 1)}
        interval = before.interval_x_mrad if self.axis == "x" else before.interval_y_mrad
        how: dict[str, Any] = {
            self.axis: law,
            f"scale_{self.axis}": 2.0 * math.pi * (-interval if self.far else interval),
            "argument": "phase_per_transfer",
            "label": "Charge trails",
            "node": node,
        }
        ptf = separable(charge_transfer_ptf, part="ptf", **how)
        return (*separable(charge_transfer_mtf, **how), *ptf)

    @property
    def length(self) -> int:
        return trail_length(transfers=self.transfers, efficiency=self.efficiency)

    def applied(self, lines: Array, nearest: int = 0, skip: int = 0) -> Array:
        """Of lines that begin `nearest` pixels from the end of the picture at the amplifier."""
        step = -1 if self.far else 1
        how = {"nearest": self.extra + nearest, "skip": skip, "length": self.length}
        return trailed(charge=lines[::step], efficiency=self.efficiency, **how)[::step]

    def needed(self, region: Region) -> tuple[Region, int, int]:
        """The region and what trails into it; pixels up to the amplifier; those that trail."""
        down = self.axis == "y"
        first, size = (region.top, region.rows) if down else (region.left, region.columns)
        nearest = self.pixels - first - size if self.far else first
        skip = min(self.length, nearest)
        first, size = first if self.far else first - skip, size + skip
        if down:
            return Region(first, region.left, size, region.columns), nearest - skip, skip
        return Region(region.top, first, region.rows, size), nearest - skip, skip


@picture_step(linear=lambda *_, change: change)
@by_region(lambda picture, **_: picture.shape)
def with_trails(work: Work, region: Region, picture: Seen, *, change: Trails) -> Array:
    """By blocks of rows, which lie in one piece."""
    given = change.needed(region)[0]
    charge = picture(given)
    made: Array = np.empty(region.shape, work.policy.dtype)
    rows = max(1, _BLOCK_SAMPLES // given.columns)

    def block(top: int) -> None:
        here = Region(top, region.left, min(rows, region.bottom - top), region.columns)
        needed, *before = change.needed(here)
        lines, read = charge[needed.seen_from(given)], made[here.seen_from(region)]
        if change.axis == "x":
            lines, read = lines.T, read.T
        read[:] = change.applied(lines, *before)

    work.for_each(block, range(region.top, region.bottom, rows))
    return made
