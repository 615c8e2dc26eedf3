"""Spatial Blur: a chain's blur by convolution in space, to compare with the Fourier way."""

from __future__ import annotations

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core import kernels
from core.arrays import Array, Vector
from core.chain.back_transformed import back_transform
from core.chain.step_lineage import Filtering, picture_step
from core.chain.wires import Curve, CurveData, Image, Magnitude, Phase, Series, Table, TableData
from core.errors import DataError, require_finite
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.machine import is_on_disk
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.records import dataclass
from core.transfer.factors import Edges, Factor, Grid, Product
from nodes.shared.context_defaults import one_source
from nodes.shared.module_ports import TableFigures
from nodes.transform.resampling import within_frame

MOST_MULTIPLICATIONS = 1e12  # about a quarter of an hour


class SpatialOutputs(NamedTuple):
    image: Image
    curve: Curve
    table: Table


class SpatialBlur(Module, key="spatial_blur", title="Spatial Blur", group="Analysis"):
    """Blur a picture by convolution with the impulse response, in place of Back Transform.

    The inputs are the same as for Back Transform. The impulse response is the inverse transform of
    all collected MTFs and PTFs. A separable response is applied in one pass along x and one along
    y; any other response is applied as a two-dimensional kernel. Complete kernels give the same
    result as Back Transform, except for rounding. A truncated kernel has an error of at most
    `error_bound` times the scene's largest deviation from its mean. The bound is the sum of the
    moduli of the kernel values that are cut off. The picture's mean does not change. If a transfer
    function has not fallen to zero at Nyquist, its kernel rings and cannot be both short and
    precise.

    Two passes are faster than Fourier filtering only with short kernels on small frames: up to ±16
    samples on 128 × 128, and up to ±4 on 512 × 512. Two-dimensional kernels are always slower
    (`imagechain bench`, table spatial). Source: NVSIM's method (Horger 1993) as in Tantalo 1996,
    section 2.1.4.
    """

    formulas = (
        Formula(
            r"L'(x,y)=\sum_{u,v}h(u,v)\,L(x-u,\,y-v),\quad h=\mathcal{F}^{-1}\left\{\prod_k M_k"
            r"\,e^{i\theta_k}\right\}",
            where="h: impulse response of all stages",
        ),
        Formula(
            r"|\Delta L|\leq\sum_{cut}|h|\;\max|L-\overline{L}|",
            where="upper bound on the error from truncated kernels: `error_bound`",
        ),
    )

    truncation: Truncation = param(
        "half_width",
        "where kernels are truncated: at half_width_px, where the error reaches `error`, or "
        "at the frame's size",
    )
    half_width_px: int = param(
        16, "kernel samples kept on each side of the centre", (0, 65536), slider=(0, 64)
    )
    error: float = param(
        0.001,
        "largest error allowed, as a fraction of the scene's largest deviation from its mean",
        (0, 1),
    )

    panel = (
        Section("Kernels", "truncation"),
        Section("", "half_width_px", shown_when=("truncation", ("half_width",))),
        Section("", "error", shown_when=("truncation", ("error",))),
    )

    def run(self, magnitude: Magnitude, phase: Phase, here: NodeContext) -> SpatialOutputs:
        source = one_source(
            magnitude, phase, wanted="scene to convolve", refusal="Spatial Blur cannot combine"
        )
        factors = (*magnitude.factors, *phase.factors)
        how: Any = {"factors": factors, "grid": magnitude.grid, "edges": magnitude.edges}
        kernels = here.step(impulse_responses, **how, **self.values())
        plane = bool(Product(factors).planar)
        picture = here.step(blurred, source.recipe, kernels, edges=magnitude.edges, plane=plane)
        return SpatialOutputs(
            back_transform(magnitude, phase).with_recipe(picture),
            Curve(here.step(response, kernels, grid=magnitude.grid)),
            Table(here.step(kernel_table, kernels)),
        )

    figures = TableFigures(
        ("taps", "", "Multiplications per sample."),
        ("error_bound", "", "Upper bound on the error from truncated kernels, as a fraction of "
         "the scene's largest deviation from its mean."),
    )  # fmt: skip


def _convolution(image: Recipe, kernels: Recipe, *, edges: Edges, plane: bool) -> Filtering:
    assert isinstance(kernels, Step)
    how = dict(kernels.parameters)
    return Filtering(how["factors"], how["grid"], edges)


@in_blocks(lambda plane, **_: not plane)  # which is cut from a kernel of the frame's size
@picture_step(linear=_convolution)
def blurred(work: Work, image: Array, kernels: Kernels, *, edges: Edges, plane: bool) -> Array:
    """The frame convolved; `plane`: by a kernel in two dimensions among others."""
    if kernels.taps * image.size > MOST_MULTIPLICATIONS:
        raise DataError(
            f"{kernels.taps:,} taps on {image.size:,} samples would take too long (the limit is "
            f"{MOST_MULTIPLICATIONS:g} multiplications): lower half_width_px, or allow a larger "
            "error"
        )
    # Its mean is taken off before, and put back after.
    mean = float(np.mean(image, dtype=np.float64))
    values: Array = np.subtract(image, mean, out=work.empty(image.shape), dtype=work.policy.dtype)
    for kernel in kernels.passes:
        values = _one_pass(work, values, kernel, edges)
    require_finite(values)
    values += values.dtype.type(mean * kernels.at_zero)
    return values


def response(_: Work, kernels: Kernels, *, grid: Grid) -> CurveData:
    series = []
    for kernel in kernels.passes:
        high, wide = kernel.taps.shape
        name = "plane, " if min(high, wide) > 1 else ""
        if wide > 1 or high == 1:
            lags = _lags(wide, kernel.before_x, grid.interval_x_mrad)
            series.append(Series(f"{name}horizontal", lags, kernel.taps[kernel.before_y]))
        if high > 1:
            lags = _lags(high, kernel.before_y, grid.interval_y_mrad)
            series.append(Series(f"{name}vertical", lags, kernel.taps[:, kernel.before_x]))
    if not series:  # nothing blurs
        series.append(Series("horizontal", np.zeros(1), np.ones(1)))
    return CurveData("Impulse response", "lag (mrad)", "weight", tuple(series))


def _lags(size: int, before: int, interval_mrad: float) -> NDArray[np.float64]:
    return np.asarray((np.arange(size) - before) * interval_mrad, np.float64)


def kernel_table(_: Work, kernels: Kernels) -> TableData:
    planes = [kernel for kernel in kernels.passes if min(kernel.taps.shape) > 1]
    lines = [kernel for kernel in kernels.passes if min(kernel.taps.shape) == 1]
    across = sum(kernel.taps.size for kernel in lines if kernel.taps.shape[0] == 1)
    along = sum(kernel.taps.size for kernel in lines if kernel.taps.shape[0] > 1)
    return SpatialBlur.figures.table(
        ("taps", kernels.taps),
        ("taps_x", across, "", "multiplications per sample in the pass along x"),
        ("taps_y", along, "", "multiplications per sample in the pass along y"),
        ("taps_plane", sum(k.taps.size for k in planes), "",
         "multiplications per sample with the two-dimensional kernel"),
        ("error_bound", kernels.error_bound),
    )  # fmt: skip


BLOCK_SAMPLES = 1 << 14


def _one_pass(work: Work, image: Array, kernel: Kernel, edges: Edges) -> Array:
    """Sum over taps of tap × frame moved by the tap's lag; blocks of rows, or of columns."""
    (rows, columns), (high, wide) = image.shape, kernel.taps.shape
    # A tap before lag 0 takes samples from after: the frame goes on by as many there.
    down = within_frame(np.arange(kernel.before_y + 1 - high, rows + kernel.before_y), rows, edges)
    across = np.arange(kernel.before_x + 1 - wide, columns + kernel.before_x)
    across = within_frame(across, columns, edges)
    result: Array = work.empty(image.shape, image.dtype)
    taps = kernel.taps[::-1, ::-1].astype(image.dtype)

    def one(block: tuple[slice, slice]) -> None:
        y, x = block
        part = image[:, x] if wide == 1 else image
        part = part[down[y.start : y.stop + high - 1]]
        if wide > 1:
            part = np.take(part, across[x.start : x.stop + wide - 1], axis=1)
        size = y.stop - y.start, x.stop - x.start
        total, product = np.zeros(size, image.dtype), np.empty(size, image.dtype)
        for row in range(high):
            work.check()
            for column in range(wide):
                moved = part[row : row + size[0], column : column + size[1]]
                total += np.multiply(moved, taps[row, column], out=product)
        result[block] = total

    along = high > wide
    step = BLOCK_SAMPLES // (rows if along else columns)
    if is_on_disk(result):  # as wide as memory has it: of a column each row is a page to be read
        assert work.blocks is not None
        step = work.blocks.disk.slab_rows(rows if along else columns, result.itemsize)
    work.for_each(one, _blocks(rows, columns, step, along=along))
    return result


def _blocks(rows: int, columns: int, step: int, *, along: bool) -> list[tuple[slice, slice]]:
    if along:  # whole columns, for the frame to be extended once
        step = max(16, step)
        starts = range(0, columns, step)
        return [(slice(0, rows), slice(x, min(x + step, columns))) for x in starts]
    step = max(1, step)
    return [(slice(y, min(y + step, rows)), slice(0, columns)) for y in range(0, rows, step)]


# Impulse responses of a chain's transfer function, cut short with a bound on what that costs.

Truncation = Literal["half_width", "error", "none"]


@dataclass(frozen=True)
class Kernel:
    """One pass: its taps, where lag 0 is, and sums of the moduli of those cut off, and of all."""

    taps: Vector
    before_y: int
    before_x: int
    dropped: float
    whole: float


@dataclass(frozen=True)
class Kernels:
    passes: tuple[Kernel, ...]
    at_zero: float

    @property
    def taps(self) -> int:
        return sum(kernel.taps.size for kernel in self.passes)

    @property
    def error_bound(self) -> float:
        """Largest error over the scene's largest deviation; a loss goes through other passes."""
        total = 0.0
        for place, kernel in enumerate(self.passes):
            before = math.prod(other.whole - other.dropped for other in self.passes[:place])
            after = math.prod(other.whole for other in self.passes[place + 1 :])
            total += kernel.dropped * before * after
        return total


def impulse_responses(
    work: Work, *, factors: tuple[Factor, ...], grid: Grid, edges: Edges, error: float, **cut: Any
) -> Kernels:
    """Kernels with which a convolution is the multiplication by these factors.

    Separable factors give a row and a column. Others give one kernel in two dimensions; it takes
    the separable ones in if it is not even in x and in y, since only an even kernel leaves a
    mirrored frame mirrored for the next pass.
    """
    product = Product(factors)
    period_y, period_x = _period(grid.rows, edges), _period(grid.columns, edges)
    xi = np.fft.rfftfreq(period_x, grid.interval_x_mrad)
    eta = np.fft.rfftfreq(period_y, grid.interval_y_mrad)
    has_x = any(factor.x is not None for factor in product.separable)
    has_y = any(factor.y is not None for factor in product.separable)
    whole: list[Array] = []
    if product.planar:
        alone = product.symmetric
        evaluate = product.plane if alone else product.total
        both = np.fft.fftfreq(period_y, grid.interval_y_mrad)
        plane = np.asarray(evaluate(work, xi, both), np.complex128)
        if period_y % 2 == 0:
            # At Nyquist a picture's spectrum has eta and −eta in one: the mean of both acts.
            middle = period_y // 2
            other = np.asarray(evaluate(work, xi, -both[middle : middle + 1]))
            plane[middle] = 0.5 * (plane[middle] + other[0])
        work.check()
        whole.append(kernels.irfft2(plane, s=(period_y, period_x), workers=work.policy.workers))
        has_x, has_y = has_x and alone, has_y and alone
    if has_x:
        whole.append(kernels.irfft(product.across(work, xi), n=period_x)[np.newaxis, :])
    if has_y:
        whole.append(kernels.irfft(product.along(work, eta), n=period_y)[:, np.newaxis])
    sums = [float(np.sum(np.abs(taps))) for taps in whole]
    passes = []
    for place, taps in enumerate(whole):
        others = math.prod(sums[:place] + sums[place + 1 :])
        allowed = error / (len(whole) * others)
        passes.append(_shortened(taps, sums[place], allowed, **cut))
    return Kernels(tuple(passes), product.at_zero(work))


def _period(size: int, edges: Edges) -> int:
    """Samples after which the frame repeats; one sample mirrored is still one value."""
    return 2 * size if edges == "reflect" else size


def _shortened(
    taps: Array, whole: float, allowed: float, truncation: Truncation, half_width_px: int
) -> Kernel:
    """The taps around lag 0 with that in the middle; `taps` have it first and wrap round."""
    lags = [np.arange(size) - size // 2 for size in taps.shape]
    taps = np.asarray(np.fft.fftshift(taps), np.float64)
    distance = np.maximum.outer(np.abs(lags[0]), np.abs(lags[1]))
    rings = np.bincount(distance.ravel(), np.abs(taps).ravel())
    # What lies beyond each half width, summed from the outside for small sums to stay precise.
    beyond = np.append(np.cumsum(rings[::-1])[::-1][1:], 0.0)
    reach = len(rings) - 1
    if truncation == "half_width":
        reach = min(reach, half_width_px)
    elif truncation == "error":
        reach = int(np.argmax(beyond <= allowed))
    inside_reach = [np.flatnonzero(np.abs(lag) <= reach) for lag in lags]
    inside = taps[
        inside_reach[0][0] : inside_reach[0][-1] + 1, inside_reach[1][0] : inside_reach[1][-1] + 1
    ]
    before_y, before_x = (-int(lag[k[0]]) for lag, k in zip(lags, inside_reach, strict=True))
    return Kernel(np.ascontiguousarray(inside), before_y, before_x, float(beyond[reach]), whole)
