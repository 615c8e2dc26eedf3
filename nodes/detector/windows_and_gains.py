"""Read-out Window and Dual Gain: part of the detector is read, or all of it twice."""

import math
from typing import Any, NamedTuple

import numpy as np

from core.arrays import Array, Vector
from core.chain.noise_power import NoisePower
from core.chain.step_lineage import Axis, Linear, picture_step
from core.chain.wires import Image, Table
from core.errors import DataError, ParameterError
from core.evaluation.recipes import (
    Recipe,
    Region,
    Seen,
    Step,
    by_region,
    ends_lineage,
    in_blocks,
    pointwise,
)
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.physics.detector.focal_plane_array import low_gain_share
from core.records import dataclass
from core.transfer.factors import Grid
from nodes.shared.module_ports import ImageOutput, figure
from nodes.shared.steps import PictureRange, picture_range


class ReadWindow(Module, key="read_window", title="Read-out Window", group="Detector"):
    """Read a window of the detector, the region of interest (ROI), and drop all other pixels.

    An empty offset centres the window. Put this module after Focal Plane or Microbolometer: the
    pixels keep their noise and their fixed pattern, whatever the window. Transfer functions, NETD
    and SNR do not change. Fewer rows are read faster: `frame_rate_Hz` is the highest rate of a
    detector that reads row by row, with an overhead for each frame. Source: EMVA 1288 release 4.0,
    section 2 (region of interest); the frame rate follows from the row time on the data sheet.
    """

    formulas = (
        Formula(
            r"f=\frac{1}{n_r\,t_r+t_0}",
            where="n_r: rows of the window; t_r: row_time_us; t₀: overhead_us",
        ),
    )

    columns: int | None = param(
        None, "width of the window; empty: all columns", (1, 65536), unit="px", slider=(16, 2048)
    )
    rows: int | None = param(
        None, "height of the window; empty: all rows", (1, 65536), unit="px", slider=(16, 2048)
    )
    left: int | None = param(
        None,
        "columns to the left of the window; empty: centred",
        (0, 65535),
        unit="px",
        slider=(0, 2048),
        zero_is_empty=False,
    )
    top: int | None = param(
        None,
        "rows above the window; empty: centred",
        (0, 65535),
        unit="px",
        slider=(0, 2048),
        zero_is_empty=False,
    )
    row_time_us: float | None = param(
        None, "time to read one row", (1e-6, 1e9), unit="µs", slider=(1, 100)
    )
    overhead_us: float = param(
        0.0,
        "time that each frame takes in addition to reading its rows",
        (0, 1e9),
        unit="µs",
        slider=(0, 1000),
    )

    panel = (
        Section("Window", "columns rows left top"),
        Section("Frame rate", "row_time_us overhead_us"),
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        rows, columns = self.rows or image.rows, self.columns or image.columns
        window = Region(self._place("y", image), self._place("x", image), rows, columns)
        if window.shape == image.shape:
            return ImageOutput(image)
        step = here.step(windowed, image.recipe, window=window, old=image.shape)
        made = image.with_recipe(step, rows=window.rows, columns=window.columns)
        return ImageOutput(made)

    def _place(self, axis: Axis, image: Image) -> int:
        size, own, first, what = (
            (image.columns, self.columns, self.left, "columns")
            if axis == "x"
            else (image.rows, self.rows, self.top, "rows")
        )
        wanted = own or size
        if wanted > size:
            allowed = f"at most {size}, the number of {what} in the picture"
            raise ParameterError(what, wanted, allowed)
        start = (size - wanted) // 2 if first is None else first
        if start + wanted > size:
            name = "left" if axis == "x" else "top"
            allowed = (
                f"at most {size - wanted}, so that the window lies within the picture's "
                f"{size} {what}"
            )
            raise ParameterError(name, start, allowed)
        return start

    @readout("Hz", name="frame_rate_Hz")
    def frame_rate(self, outputs: ImageOutput) -> float | None:
        """Highest frame rate of this window; left out if row_time_us is empty."""
        if self.row_time_us is None:
            return None
        return 1e6 / (outputs.image.rows * self.row_time_us + self.overhead_us)


@dataclass(frozen=True)
class Windowed(Linear):
    window: Region
    old: tuple[int, int]

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        return Grid(*self.old, grid.interval_x_mrad, grid.interval_y_mrad)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.cropped(*self.window.slices)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        return row[self.window.slices[1 if axis == "x" else 0]]


@picture_step(linear=lambda _, **how: Windowed(**how))
@by_region(lambda _, *, window, **__: window.shape)
def windowed(
    work: Work, region: Region, picture: Seen, *, window: Region, old: tuple[int, int]
) -> Array:
    wanted = Region(window.top + region.top, window.left + region.left, *region.shape)
    return np.ascontiguousarray(picture(wanted))


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
        "sample value in the `high` picture, in its unit, above which the `low` picture is used; "
        "empty: `low` is never used",
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
