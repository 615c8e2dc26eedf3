"""Frame Transfer Smear: columns collect light while they move under the picture."""

from __future__ import annotations

from typing import Literal

import numpy as np

from core.chain.step_lineage import Array, LineOperator, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Formula, NodeContext, param, readout
from core.physics.detector.readout import smear, smear_mtf
from core.records import dataclass
from core.transfer.factors import Factor, Grid, Law, Separable
from nodes.shared.module_ports import ImageOutput, OfPixels
from nodes.shared.steps import stepped

_BLOCK = 256  # rows


class FrameTransferSmear(
    OfPixels, key="frame_transfer_smear", title="Frame Transfer Smear", group="Detector"
):
    """Smear bright objects along their columns, as a frame-transfer CCD without a shutter does.

    A charge packet spends one line transfer time in every row that it passes. After the exposure,
    the packet passes the rows between its pixel and the storage area; before the exposure, it
    passed the other rows. If the detector is cleared just before the exposure, set `passed` to the
    side of the storage area. Put this module after Sample Pixels or Combine Pixels and before Focal
    Plane, which then adds the shot noise of the smear. Source: Janesick 2001, Scientific
    Charge-Coupled Devices, chapter 1.
    """

    formulas = (
        Formula(
            r"L'_r=L_r+\frac{t_l}{t}\sum_{k\neq r}L_k",
            where="r: a row; k: the other rows of the column that `passed` selects; t_l: "
            "line_transfer_time_s; t: integration_time_s",
        ),
    )

    line_transfer_time_s: float = param(0.0, "time to transfer one line", (0, 1), slider=(0, 1e-5))
    integration_time_s: float = param(
        0.01,
        "exposure time; enter integration_time_s of Focal Plane",
        (1e-9, 1e6),
        slider=(1e-4, 0.05),
    )
    passed: Literal["both", "above", "below"] = param(
        "both",
        "illuminated rows that a charge packet passes: on both sides of its pixel, only above "
        "or only below",
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        change = self._change(image)
        if not change.ratio:
            return ImageOutput(image)
        seconds = image.exposure_s or self.integration_time_s
        step = here.step(smeared, image.recipe, change=change)
        return ImageOutput(stepped(image, step, gain=change.gain, exposure_s=seconds))

    def _change(self, image: Image) -> Smearing:
        sides = [self.passed in ("both", side) for side in ("above", "below")]
        return Smearing(
            "y", image.rows, self.line_transfer_time_s / self.integration_time_s, *sides
        )

    @readout("%")
    def smear_percent(self, image: Image) -> float:
        """Mean smear over the rows of a uniform picture, relative to the signal."""
        return 100.0 * (self._change(image).gain - 1.0)


@dataclass(frozen=True)
class Smearing(LineOperator):
    rows: int
    ratio: float
    above: bool
    below: bool

    @property
    def gain(self) -> float:
        return 1.0 + 0.5 * (self.above + self.below) * self.ratio * (self.rows - 1)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        how = {"rows": self.rows, "ratio": self.ratio, "sides": self.above + self.below}
        law = Law.of(smear_mtf, interval_mrad=before.interval_y_mrad, **how)
        return (Separable(None, law, label="Smear", node=node),)

    def applied(self, lines: Array) -> Array:
        return self.added(lines, np.zeros(lines.shape[1]), lines.sum(axis=0)) + lines

    def added(self, rows: Array, passed: Array, total: Array) -> Array:
        sides: dict[str, bool] = {"above": self.above, "below": self.below}
        return smear(charge=rows, passed=passed, total=total, ratio=self.ratio, **sides)


@in_blocks()
@picture_step(linear=lambda *_, change: change)
def smeared(work: Work, picture: Array, *, change: Smearing) -> Array:
    """The columns' sums in a first pass over the rows, what each row passes in a second."""
    made: Array = work.empty(picture.shape)
    passed, total = np.zeros((2, picture.shape[1]))
    for sums in (total, passed):
        for start in range(0, len(picture), _BLOCK):
            work.check()
            rows = picture[start : start + _BLOCK]
            if sums is passed:
                made[start : start + _BLOCK] = rows + change.added(rows, passed, total)
            np.add(sums, rows.sum(axis=0, dtype=np.float64), out=sums)
    return made
