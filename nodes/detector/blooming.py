"""Blooming: full pixels spill charge along their column."""

import numpy as np

from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, param, warning
from core.physics.detector.readout import bloomed
from nodes.shared.module_ports import ImageOutput, OfPixels
from nodes.shared.steps import PictureRange, picture_range

_FAR = 10.0  # times the largest sample: a well beyond is probably in another unit


class Blooming(OfPixels, key="blooming", title="Blooming", group="Detector"):
    """Spill charge above the full well along the column.

    A full pixel passes its excess to the pixels above and below, half to each, until no pixel holds
    more than its full well. Charge that reaches the top or bottom edge leaves the detector. The
    anti-blooming drain removes its share of the excess first. The picture may be in any unit
    proportional to electrons. Put this module after Sample Pixels or Combine Pixels and before
    Focal Plane. Before Focal Plane, the full well is a radiance: saturation_radiance in Focal
    Plane's table. Predicted MTFs and budgets ignore blooming. Sources: Janesick 2001, Scientific
    Charge-Coupled Devices, chapter 4; Levine and Peres 2009, Potential Analysis 30, 1.
    """

    formulas = (
        Formula(
            r"L'_r=L_r-a\max(L_r-w,0)+\frac{u_{r-1}-2u_r+u_{r+1}}{2}\leq w",
            where="w: full_well; a: share of the excess that the anti-blooming drain removes; "
            "u ≥ 0: charge that each row passes on, just enough to leave no pixel above w",
        ),
    )

    full_well: float | None = param(
        None,
        "sample value of a full pixel, in the picture's unit: W/m²/sr before Focal Plane, "
        "not electrons; empty: no blooming",
        (1e-12, 1e12),
        slider=(1, 1e5),
    )
    anti_blooming_percent: float = param(
        0.0, "share of the excess that the anti-blooming drain removes", (0, 100)
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.full_well is None:
            return ImageOutput(image)
        how = {"full_well": self.full_well, "drained": self.anti_blooming_percent / 100.0}
        return ImageOutput(image.with_recipe(here.step(spilled, image.recipe, **how)))

    @warning
    def well(self, image: Image) -> Recipe | None:
        """The full well is far above the picture's largest sample."""
        if self.full_well is None:
            return None
        seen = Step.of(picture_range, image.recipe)
        return Step.of(well_caution, seen, full_well=self.full_well, unit=image.unit)


def well_caution(work: Work, seen: PictureRange, *, full_well: float, unit: str) -> Caution | None:
    if full_well <= _FAR * max(seen.high, 0.0):
        return None
    return Caution(
        f"nothing blooms: full_well = {full_well:g}, but the picture's largest sample is "
        f"{seen.high:.3g} {unit}".rstrip(),
        "give full_well in the picture's unit: before Focal Plane, use saturation_radiance from "
        "Focal Plane's table",
    )


@in_blocks()
@picture_step()
def spilled(work: Work, picture: Array, **how: float) -> Array:
    """Columns with an overfull pixel are taken out, each in one piece, and put back."""
    slabs, made = work.row_slabs(picture), work.empty(picture.shape)
    over = np.zeros(picture.shape[1], bool)
    for rows in slabs:
        work.check()
        over |= (picture[rows] > how["full_well"]).any(axis=0)
    places = np.flatnonzero(over)
    columns: Array = work.empty((len(places), len(picture)))
    for rows in slabs:
        work.check()
        made[rows] = picture[rows]
        columns[:, rows] = picture[rows][:, places].T

    def one(place: int) -> None:
        columns[place] = bloomed(charge=columns[place], **how)

    work.for_each(one, range(len(places)))
    for rows in slabs:
        made[rows, places] = columns[:, rows].T
    return np.asarray(made)
