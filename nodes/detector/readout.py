"""What reading a detector does to a picture: blooming, trails, smear, lag and rolling shutter."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from core.arrays import Array
from core.chain.step_lineage import LineOperator, picture_step
from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Region, Seen, Step, by_region, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, param, readout, warning
from core.physics.detector import readout as physics
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.records import dataclass
from core.transfer.factors import Edges, Factor, Grid, Law, Separable
from nodes.shared.context_defaults import is_radiance, pitch_in_samples
from nodes.shared.module_ports import BeforeDigits, ImageOutput, OfPixels, passed_factors, separable
from nodes.shared.steps import PictureRange, picture_range, stepped
from nodes.transform.resampling import within_frame

_AROUND = np.arange(1 - physics.REACH, physics.REACH + 1)
_SKEWED_ROWS = 64  # rows


class RollingShutter(
    BeforeDigits, key="rolling_shutter", title="Rolling Shutter", group="Detector"
):
    """Skew and stretch the picture: lines are exposed in turn while the image moves.

    The top line is exposed first. Velocities refer to the image on the detector, in pixels per
    second. Put this module before Sample Pixels or Combine Pixels: all samples of a line of pixels
    are exposed together. Put modules that add noise after Rolling Shutter. A windowed sinc
    interpolates between samples. Detail above 70 % of the samples' Nyquist frequency loses
    contrast, and sharp edges show ringing. Beyond its edges, the frame is extended as in
    Interpolate. Use Relative Motion MTF for the blur within one exposure. Predicted MTFs and
    budgets assume an image at rest. Source: Liang, Chang and Chen 2008, IEEE Transactions on Image
    Processing 17, 1323.
    """

    formulas = (
        Formula(
            r"L'(x,y)=L\left(x-v_xt_ln,\;y-v_yt_ln\right)",
            where="x, y: pixels to the right and down; n: line number, 0 at the top; v: image "
            "velocity; t_l: line_time_s",
        ),
    )

    image_velocity_x: float = param(
        0.0, "velocity of the image to the right", (-1e6, 1e6), unit="px/s", slider=(-5000, 5000)
    )
    image_velocity_y: float = param(
        0.0, "velocity of the image downwards", (-1e6, 1e6), unit="px/s", slider=(-5000, 5000)
    )
    line_time_s: float = param(2e-5, "time from one line to the next", (0, 1), slider=(0, 1e-4))

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        steps = [self.line_time_s * v for v in (self.image_velocity_x, self.image_velocity_y)]
        if steps == [0.0, 0.0]:
            return ImageOutput(image)
        x, y = (max(1.0, pitch_in_samples(axis, image) or 1.0) for axis in ("x", "y"))
        how = {"step_x": steps[0] * x, "step_y": steps[1] * y, "line": y, "edges": image.edges}
        step = here.step(skewed, image.recipe, shape=image.shape, **how)
        return ImageOutput(stepped(image, step))

    @warning
    def away(self, image: Image) -> Caution | None:
        """The image leaves the frame before the last line is exposed."""
        for axis, samples in (("x", image.columns), ("y", image.rows)):
            velocity = getattr(self, f"image_velocity_{axis}")
            moved = abs(velocity) * self.line_time_s * self._lines(image)
            pixels = samples / max(1.0, pitch_in_samples(axis, image) or 1.0)
            if moved >= pixels:
                return Caution(
                    "the image leaves the frame before the last line is exposed: it moves "
                    f"{moved:.4g} pixels along {axis} in a frame of {pixels:.4g} pixels",
                    f"check image_velocity_{axis} = {velocity:g} px/s and line_time_s = "
                    f"{self.line_time_s:g} s",
                )
        return None

    @readout("px")
    def skew_px(self, image: Image) -> float:
        """Shift of the last line to the right, relative to the first."""
        return self.image_velocity_x * self.line_time_s * self._lines(image)

    def _lines(self, image: Image) -> float:
        return float((image.rows - 0.5) // max(1.0, pitch_in_samples("y", image) or 1.0))


@picture_step()
@by_region(lambda _, *, shape, **__: shape, lambda region, shape: region.rows / shape[0])
def skewed(
    work: Work,
    region: Region,
    picture: Seen,
    *,
    shape: tuple[int, int],
    step_x: float,
    step_y: float,
    line: float,
    edges: Edges | None,
) -> Array:
    rows, columns = shape
    here = np.arange(region.top, region.bottom)
    lines = (here + 0.5) // line
    base, along = _taps(here - step_y * lines)
    above = within_frame(base[:, np.newaxis] + _AROUND, rows, edges)
    left, across = _taps(-step_x * lines)
    wanted = np.unique(above)
    runs = np.split(wanted, np.flatnonzero(np.diff(wanted) > 1) + 1)
    parts = [picture(Region(int(run[0]), 0, len(run), columns)) for run in runs]
    source = parts[0] if len(parts) == 1 else np.concatenate(parts)
    places = np.searchsorted(wanted, above)
    made: Array = np.empty((region.rows, region.columns), work.policy.dtype)

    def block(start: int) -> None:
        for row in range(start, min(start + _SKEWED_ROWS, len(made))):
            seen = _weighted(source[places[row]], along[row])
            beyond = np.arange(_AROUND[0], columns + physics.REACH) + left[row]
            seen = seen[within_frame(beyond, columns, edges)]
            whole = _weighted(sliding_window_view(seen, columns), across[row])
            made[row] = whole[region.slices[1]]

    work.for_each(block, range(0, len(made), _SKEWED_ROWS))
    return made


def _taps(places: Array) -> tuple[Array, Array]:
    base = np.floor(places)
    return base.astype(np.int64), physics.sinc_weights(fraction=places - base)


def _weighted(lines: Array, weights: Array) -> Array:
    total = np.zeros(lines.shape[1])
    for line, weight in zip(lines, weights, strict=True):
        if weight:
            total += weight * line
    return total


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
        columns[place] = physics.bloomed(charge=columns[place], **how)

    work.for_each(one, range(len(places)))
    for rows in slabs:
        made[rows, places] = columns[:, rows].T
    return np.asarray(made)


_BLOCK_SAMPLES = 1 << 18


class ChargeTrails(OfPixels, key="charge_trails", title="Charge Trails", group="Detector"):
    """Add the trails of incomplete charge transfer, which grow with distance from the amplifier.

    In each transfer, a share of the charge stays behind and joins the next packet. Charge is
    shifted along the columns into the serial register, which is then read pixel by pixel. A pixel
    that is n transfers away from the amplifier loses about n·(1 − efficiency) of its charge to its
    trail. Charge that trails out of the picture is lost. Use either this module or Charge Transfer
    MTF, which blurs all pixels equally. Put this module after Sample Pixels or Combine Pixels.
    Predicted MTFs hold for the middle pixel. Source: Janesick 2001, Scientific Charge-Coupled
    Devices, chapter 5.
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
        return physics.trail_length(transfers=self.transfers, efficiency=self.efficiency)

    def applied(self, lines: Array, nearest: int = 0, skip: int = 0) -> Array:
        """Of lines that begin `nearest` pixels from the end of the picture at the amplifier."""
        step = -1 if self.far else 1
        how = {"nearest": self.extra + nearest, "skip": skip, "length": self.length}
        return physics.trailed(charge=lines[::step], efficiency=self.efficiency, **how)[::step]

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


_SMEARED_ROWS = 256  # rows


class FrameTransferSmear(
    OfPixels, key="frame_transfer_smear", title="Frame Transfer Smear", group="Detector"
):
    """Smear bright objects along their columns, as a frame-transfer CCD without a shutter does.

    A charge packet spends one line transfer time in every row that it passes through. After the
    exposure, the packet passes the rows between its pixel and the storage area; before the
    exposure, it passed the other rows. If the detector is cleared just before the exposure, set
    `passed` to the side of the storage area. Put this module after Sample Pixels or Combine Pixels
    and before Focal Plane, which then adds the shot noise of the smear. Source: Janesick 2001,
    Scientific Charge-Coupled Devices, chapter 1.
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
        law = Law.of(physics.smear_mtf, interval_mrad=before.interval_y_mrad, **how)
        return (Separable(None, law, label="Smear", node=node),)

    def applied(self, lines: Array) -> Array:
        return self.added(lines, np.zeros(lines.shape[1]), lines.sum(axis=0)) + lines

    def added(self, rows: Array, passed: Array, total: Array) -> Array:
        sides: dict[str, bool] = {"above": self.above, "below": self.below}
        return physics.smear(charge=rows, passed=passed, total=total, ratio=self.ratio, **sides)


@in_blocks()
@picture_step(linear=lambda *_, change: change)
def smeared(work: Work, picture: Array, *, change: Smearing) -> Array:
    """The columns' sums in a first pass over the rows, what each row passes in a second."""
    made: Array = work.empty(picture.shape)
    passed, total = np.zeros((2, picture.shape[1]))
    for sums in (total, passed):
        for start in range(0, len(picture), _SMEARED_ROWS):
            work.check()
            rows = picture[start : start + _SMEARED_ROWS]
            if sums is passed:
                made[start : start + _SMEARED_ROWS] = rows + change.added(rows, passed, total)
            np.add(sums, rows.sum(axis=0, dtype=np.float64), out=sums)
    return made


class Persistence(BeforeDigits, key="persistence", title="Persistence", group="Detector"):
    """Add image lag: a remnant of an earlier exposure that decays with two time constants.

    Connect the picture of the earlier exposure to `earlier`; both pictures must have the same size
    and unit. The shares fast_percent and slow_percent refer to the end of the earlier exposure.
    Budgets treat the lag as a fixed pattern. Source: Smith, Zavodny, Rahmer and Bonati 2008,
    Proceedings of SPIE 7021, 70210J (infrared detectors).
    """

    formulas = (
        Formula(
            r"L'=L+L_e\left(a_1e^{-t/\tau_1}+a_2e^{-t/\tau_2}\right)",
            where=(
                "L_e: the earlier picture; a, τ: share and time constant (1: fast, 2: slow); "
                "t: delay_s"
            ),
        ),
    )

    fast_percent: float = param(
        0.0, "share of the earlier picture that decays fast", (0, 100), slider=(0, 5)
    )
    fast_time_constant_s: float = param(
        1.0, "time constant of the fast share", (1e-9, 1e9), slider=(0.1, 60)
    )
    slow_percent: float = param(
        0.0, "share of the earlier picture that decays slowly", (0, 100), slider=(0, 5)
    )
    slow_time_constant_s: float = param(
        100.0, "time constant of the slow share", (1e-9, 1e9), slider=(1, 3600)
    )
    delay_s: float = param(0.0, "time since the earlier exposure", (0, 1e9), slider=(0, 600))

    def check(self) -> None:
        if self.fast_percent + self.slow_percent > 100.0 + 1e-9:  # rounding
            allowed = (
                f"slow_percent plus fast_percent ({self.fast_percent:g} %) must not exceed 100 %"
            )
            raise ParameterError("slow_percent", self.slow_percent, allowed)

    def run(self, image: Image, earlier: Image, here: NodeContext) -> ImageOutput:
        if image.shape != earlier.shape:
            raise DataError(
                f"the earlier picture has {earlier.columns} × {earlier.rows} samples and the image "
                f"has {image.columns} × {image.rows}: both must have the same size"
            )
        units = image.unit.strip(), earlier.unit.strip()
        if units[0] != units[1] and not all(map(is_radiance, units)):
            raise DataError(
                f"the earlier picture is in {units[1]!r:.40} and the image is in {units[0]!r:.40}: "
                "both must have the same unit"
            )
        if not self._share():
            return ImageOutput(image)
        lagging = here.step(with_lag, image.recipe, earlier.recipe, share=self._share())
        return ImageOutput(image.with_recipe(lagging))

    def _share(self) -> float:
        return physics.persistence(
            shares=(self.fast_percent / 100.0, self.slow_percent / 100.0),
            time_constants_s=(self.fast_time_constant_s, self.slow_time_constant_s),
            delay_s=self.delay_s,
        )

    @readout("%")
    def lag_percent(self) -> float:
        """Share of the earlier picture that remains."""
        return 100.0 * self._share()


@picture_step(noise=lambda at, *_, **__: [at.known("persistence")])
@pointwise
def with_lag(work: Work, picture: Array, earlier: Array, *, share: float) -> Array:
    return np.asarray(picture + earlier * earlier.dtype.type(share))
