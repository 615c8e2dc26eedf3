"""Compare Images: how far a picture is from a reference, and the MTF between them."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np

from core import kernels
from core.arrays import Array, Vector
from core.chain.wires import Curve, CurveData, Image, Series, Table, TableData
from core.errors import DataError
from core.evaluation.recipes import Recipe, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, param
from core.transfer.factors import Edges, Grid
from core.transfer.mirrored import MeanFree, mirrored_spectrum
from core.transfer.periodic import periodic_spectrum
from nodes.input_output.sample_unit import blocks
from nodes.shared.module_ports import TableFigures
from nodes.shared.steps import difference


class CompareOutputs(NamedTuple):
    table: Table
    difference: Image
    curve: Curve


class CompareImages(Module, key="compare_images", title="Compare Images", group="Analysis"):
    """Measure the difference between a picture and a reference of the same size.

    The read-outs are the root mean square, largest and mean differences, and the peak
    signal-to-noise ratio (PSNR). The PSNR's peak is the reference's maximum minus its minimum. The
    MTF ratio is the modulus of the picture's spectrum divided by the modulus of the reference's
    spectrum, along both frequency axes. Averaged in rings, the ratio is the square root of the
    ratio of the power spectra. Frequencies at which the reference contains only rounding errors are
    left out. For a frame filtered with mirrored edges, set `edges` to `reflect`; the ratio is then
    the MTF itself.
    """

    formulas = (
        Formula(
            r"\mathrm{RMSE}=\sqrt{\frac{1}{N}\sum_i(a_i-b_i)^2},\quad\mathrm{PSNR}=20\,\lg\frac{"
            r"\max b-\min b}{\mathrm{RMSE}}",
            where="a: the picture; b: the reference",
        ),
        Formula(
            r"R(f)=\frac{|\mathcal{F}(a)|}{|\mathcal{F}(b)|}",
            where="R: MTF ratio; in rings, the square root of the ratio of the power spectra",
        ),
    )

    average: Literal["axes", "radial"] = param(
        "axes", "MTF ratio along both frequency axes, or averaged in rings"
    )
    edges: Edges = param(
        "reflect",
        "how the frame continues beyond its edges: mirrored, or repeated as in a plain FFT",
    )

    def run(self, image: Image, reference: Image, here: NodeContext) -> CompareOutputs:
        if image.shape != reference.shape:
            raise DataError(
                f"the image is {image.columns} × {image.rows} samples and the reference "
                f"{reference.columns} × {reference.rows}: both must have the same size"
            )
        pair = (image.recipe, reference.recipe)
        table = here.step(compared, *pair, unit=image.unit)
        less = here.step(difference, *pair)
        return CompareOutputs(
            Table(table), image.with_recipe(less), Curve(self._ratio(image, reference, here))
        )

    def _ratio(self, image: Image, reference: Image, here: NodeContext) -> Recipe:
        known = image.interval_x_mrad is not None and image.interval_y_mrad is not None
        grid = image.grid() if known else Grid(image.rows, image.columns, 1.0, 1.0)
        settings: dict[str, Any] = {
            "grid": grid,
            "edges": self.edges,
            "unit": "cyc/mrad" if known else "cycles/sample",
        }
        if self.average == "axes":
            return here.step(axes_ratio, image.recipe, reference.recipe, **settings)
        transform = mirrored_spectrum if self.edges == "reflect" else periodic_spectrum
        spectra = [here.step(transform, picture.recipe) for picture in (image, reference)]
        return here.step(radial_ratio, *spectra, **settings)

    figures = TableFigures(
        ("rmse", "", "Root mean square difference, in the image's unit."),
        ("max_error", "", "Largest difference, in the image's unit."),
        ("psnr_dB", "dB", "Peak signal-to-noise ratio; left out if the pictures are equal or the "
         "reference is constant."),
        ("mean_difference", "", "Mean of image minus reference, in the image's unit."),
    )  # fmt: skip


@in_blocks()
def compared(work: Work, image: Array, reference: Array, *, unit: str) -> TableData:
    largest, sums = 0.0, []
    for a, b in zip(blocks(image, work.check), blocks(reference, work.check), strict=True):
        difference = a - b
        largest = max(largest, float(np.max(np.abs(difference))))
        sums.append(float(np.sum(difference)))
    squares = 0.0
    if largest > 0.0:
        # Relative to the largest: squares of huge or tiny differences leave the range of numbers.
        pairs = zip(blocks(image, work.check), blocks(reference, work.check), strict=True)
        squares = math.fsum(float(np.sum(((a - b) / largest) ** 2)) for a, b in pairs)
    rmse = largest * math.sqrt(squares / image.size)
    peak = float(reference.max()) - float(reference.min())
    psnr_dB = 20.0 * math.log10(peak / rmse) if rmse > 0.0 and peak > 0.0 else None
    mean = math.fsum(sums) / image.size
    return CompareImages.figures.table(
        ("rmse", rmse, unit, "root mean square difference"),
        ("max_error", largest, unit, "largest difference"),
        ("psnr_dB", psnr_dB),
        ("mean_difference", mean, unit, "mean of image minus reference"),
    )


_BLOCK_SAMPLES = 1 << 18
# Times the rounding of the samples: where the reference has less, the ratio would be noise.
_ABOVE_ROUNDING = 100.0


@in_blocks()  # numpy averages the rows as they come
def axes_ratio(
    work: Work, image: Array, reference: Array, *, grid: Grid, edges: Edges, unit: str
) -> CurveData:
    """|spectrum of image| / |spectrum of reference| on the axes ξ and η.

    On an axis the spectrum is that of the picture averaged across it, a 1-D transform. `edges`
    as in Init & Trans; `unit` is that of the grid's frequencies.
    """
    mirrored = edges == "reflect"
    across, along = grid.axes(edges)
    along = along if mirrored else np.abs(along[: grid.rows // 2 + 1])
    largest = max(abs(float(reference.max())), abs(float(reference.min())))
    series = []
    for name, axis, frequency in (("horizontal", 0, across), ("vertical", 1, along)):
        work.check()
        above, below = (
            _modulus(np.mean(picture, axis=axis, dtype=np.float64), mirrored)
            for picture in (image, reference)
        )
        seen = below > _rounding(reference.dtype) * largest * math.sqrt(len(frequency))
        series.append(Series(name, frequency[seen], above[seen] / below[seen]))
    return _curves(series, unit)


def radial_ratio(
    work: Work, image: MeanFree, reference: MeanFree, *, grid: Grid, edges: Edges, unit: str
) -> CurveData:
    """Root of the ratio of powers in rings, at their mean frequency by the reference's power."""
    mirrored = edges == "reflect"
    spacing = max(grid.frequency_interval_x, grid.frequency_interval_y) / (2 if mirrored else 1)
    rings = int(min(grid.nyquist_x, grid.nyquist_y) / spacing) + 1
    above, below, moment, count = (np.zeros(rings) for _ in range(4))
    xi, eta = grid.axes(edges)
    weight = np.ones(len(xi))
    if not mirrored:
        weight[1 : (grid.columns + 1) // 2] = 2.0  # a half spectrum's column and its twin
    step = max(1, _BLOCK_SAMPLES // len(xi))
    for start in range(0, len(eta), step):
        work.check()
        rows = slice(start, start + step)
        rho = np.hypot(xi, eta[rows, np.newaxis])
        ring = np.rint(rho / spacing).astype(np.intp)
        inside = ring < rings
        ring, rho = ring[inside], rho[inside]
        powers = [_power(picture[0][rows]) * weight for picture in (image, reference)]
        power_above, power_below = (power[inside] for power in powers)
        above += np.bincount(ring, power_above, rings)
        below += np.bincount(ring, power_below, rings)
        moment += np.bincount(ring, power_below * rho, rings)
        count += np.bincount(ring, np.broadcast_to(weight, inside.shape)[inside], rings)
    # Unnormalised DCTs have twice the size of an FFT along each axis.
    size = grid.rows * grid.columns * (4.0 if mirrored else 1.0)
    values, mean = reference
    above[0] += (image[1] * size) ** 2
    below[0] += (mean * size) ** 2
    level = mean**2 + float(np.sum(below)) / size**2
    floor = _rounding(values.real.dtype) ** 2 * level * size
    seen = below > floor * count
    ratio = np.sqrt(above[seen] / below[seen])
    return _curves([Series("radial", moment[seen] / below[seen], ratio)], unit)


def _modulus(profile: Vector, mirrored: bool) -> Vector:
    transform = kernels.dct(profile, type=2) if mirrored else kernels.rfft(profile)
    return np.asarray(np.abs(transform), np.float64)


def _power(values: Array) -> Vector:
    real = values.real.astype(np.float64) ** 2
    return real + values.imag.astype(np.float64) ** 2 if np.iscomplexobj(values) else real


def _rounding(dtype: np.dtype[Any]) -> float:
    return _ABOVE_ROUNDING * float(np.finfo(dtype).eps)


def _curves(series: list[Series], unit: str) -> CurveData:
    return CurveData("MTF ratio", f"frequency ({unit})", "MTF ratio", tuple(series))
