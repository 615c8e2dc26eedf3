"""Dual Gain: two read-outs of one scene joined, for more dynamic range (HDR)."""

import math
from typing import Any, NamedTuple

import numpy as np

from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image, Table
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, param, readout, warning
from core.physics.detector.focal_plane_array import low_gain_share
from nodes.shared.module_ports import figure
from nodes.shared.steps import PictureRange, picture_range

_NEAR = 0.05  # of the factor


class DualGainOutputs(NamedTuple):
    image: Image
    low_share: Image


class DualGain(Module, key="dual_gain", title="Dual Gain", group="Detector"):
    """Combine two read-outs of one scene: high gain for dark areas, low gain for bright areas.

    Use this module for pixels that are read at two gains, or for HDR from a long and a short
    exposure. Give each read-out its own Focal Plane, with `units` = electrons. Pixels of `image`
    come from `high` up to `switch_level`, and from `low` above this level. For two gains of one
    exposure, enter the same seed on both Focal Planes, so that they share shot noise and fixed
    pattern. For two exposures, set `low_factor` to the ratio of the exposure times. Connect both
    tables to get the combined dynamic range, and a warning if `low_factor` does not match the
    tables. Focal Plane warns if the high gain clips; this is expected. Noise budgets and figures of
    merit use the noise of `high`, which is the noise of the picture up to `switch_level`. Source:
    EMVA 1288 release 4.0 (dynamic range: saturation over dark noise), applied to the two read-outs.
    """

    formulas = (
        Formula(
            r"L'=(1-w)\,L_h+w\,k\,L_l,\quad w=\mathrm{clip}\left(\frac{L_h-s(1-b)}{s\,b},0,1"
            r"\right)",
            where="s: switch_level; b: blend_percent as a fraction (0: a sharp switch at s); k: "
            "low_factor",
        ),
        Formula(
            r"D=D_h+20\lg\frac{L_{sat,l}}{L_{sat,h}}",
            where="D_h: dynamic_range_dB of `high`; L_sat: saturation_radiance of each read-out",
        ),
    )

    switch_level: float | None = param(
        None,
        "sample value of high above which low is used, in the picture's unit; empty: "
        "low is never used",
        (1e-12, 1e12),
        slider=(1, 1e5),
    )
    blend_percent: float = param(
        0.0,
        "width of the transition below switch_level, as a share of switch_level",
        (0, 100),
        unit="%",
    )
    low_factor: float = param(
        1.0,
        "factor that scales low to the level of high: ratio of the exposure times, or of "
        "the gains in DN",
        (1e-6, 1e6),
        slider=(1, 64),
    )

    def run(
        self,
        high: Image,
        low: Image,
        here: NodeContext,
        high_table: Table | None = None,
        low_table: Table | None = None,
    ) -> DualGainOutputs:
        for what, one, other in (
            ("size", f"{high.columns} × {high.rows}", f"{low.columns} × {low.rows}"),
            ("unit", high.unit or "none", low.unit or "none"),
        ):
            if one != other:
                raise DataError(
                    f"high and low must have the same {what}: high has {one} and low has {other}"
                )
        how: dict[str, Any] = {"level": self.switch_level, "blend": self.blend_percent / 100.0}
        share = here.step(share_of_low, high.recipe, **how)
        shown = high.with_recipe(share, unit="")
        if self.switch_level is None:
            return DualGainOutputs(high, shown)
        step = here.step(joined, high.recipe, low.recipe, share, factor=self.low_factor)
        return DualGainOutputs(high.with_recipe(step), shown)

    @warning
    def switch(self, high: Image, low: Image) -> Recipe | None:
        """The switch level is never reached, or lies below the picture's mean."""
        if self.switch_level is None:
            return None
        seen = [Step.of(picture_range, one.recipe) for one in (high, low)]
        return Step.of(switch_caution, *seen, level=self.switch_level, factor=self.low_factor)

    @warning
    def factor(
        self, high: Image, high_table: Table | None = None, low_table: Table | None = None
    ) -> Recipe | None:
        """low_factor does not scale the low gain to the level of the high gain."""
        if self.switch_level is None or high_table is None or low_table is None:
            return None
        per = "gain_e_per_dn" if high.unit == "DN" else None
        figures = [
            Step.of(figure, table.recipe, name=name)
            for name in ("signal_e", *([per] if per else []))
            for table in (high_table, low_table)
        ]
        return Step.of(factor_caution, *figures, factor=self.low_factor, unit=high.unit)

    @readout("%")
    def low_percent(self, outputs: DualGainOutputs) -> Recipe:
        """Share of the picture that is taken from the low gain."""
        return Step.of(percent_of, outputs.low_share.recipe)

    @readout("dB", name="dynamic_range_dB")
    def joined_range(
        self, high_table: Table | None = None, low_table: Table | None = None
    ) -> Recipe | None:
        """Dynamic range: saturation of low over dark noise of high; needs both tables."""
        if high_table is None or low_table is None:
            return None
        own = Step.of(figure, high_table.recipe, name="dynamic_range_dB")
        ends = (
            Step.of(figure, table.recipe, name="saturation_radiance")
            for table in (high_table, low_table)
        )
        return Step.of(joined_decibels, own, *ends)


def joined_decibels(
    work: Work, own_dB: float | None, high: float | None, low: float | None
) -> float | None:
    if own_dB is None or not high or not low:
        return None
    return own_dB + 20.0 * math.log10(low / high)


def factor_caution(
    work: Work, signal: float, of_low: float, *gains: float, factor: float, unit: str
) -> Caution | None:
    """By the electrons of both read-outs; a radiance needs no factor."""
    right = 1.0
    if unit in ("e-", "DN") and signal and of_low:
        right = signal / of_low
    if gains:
        right *= gains[1] / gains[0]
    if abs(factor - right) <= _NEAR * right:
        return None
    return Caution(
        f"the picture jumps at switch_level: low_factor = {factor:g}, but the tables give a "
        f"signal ratio (high over low) of {right:.4g}",
        f"set low_factor to {right:.4g}",
    )


def switch_caution(
    work: Work, high: PictureRange, low: PictureRange, *, level: float, factor: float
) -> Caution | None:
    mean = max(high.mean, factor * low.mean)  # that of high may be clipped
    if mean > level:
        return Caution(
            "budgets and figures of merit use the noise of high, but a pixel at the picture's mean "
            f"is taken from low: the mean is {mean:.4g}, above switch_level = {level:g}",
            "connect budgets and figures of merit to the read-out that you want to assess",
        )
    if high.high <= level < factor * low.high:
        return Caution(
            "low is never used, although low is brighter than high: high reaches only "
            f"{high.high:.4g}, below switch_level = {level:g}",
            "set switch_level below the saturation of high",
        )
    return None


@ends_lineage
@pointwise
def share_of_low(work: Work, high: Array, *, level: float | None, blend: float) -> Array:
    if level is None:
        return np.zeros_like(high)
    share = low_gain_share(high=high, switch_level=level, blend=blend)
    return np.asarray(share, high.dtype)


@in_blocks()
def percent_of(work: Work, share: Array) -> float:
    return 100.0 * float(np.mean(share, dtype=np.float64))


@picture_step()
@pointwise
def joined(work: Work, high: Array, low: Array, share: Array, *, factor: float) -> Array:
    """Of `high` to the bit where nothing is of `low`."""
    made: Array = np.multiply(low, low.dtype.type(factor))
    made -= high
    made *= share
    made += high
    return made
