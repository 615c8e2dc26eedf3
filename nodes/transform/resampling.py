"""Interpolate, Anti-alias Filter, Sample Pixels and Combine Pixels: a picture on other samples."""

import math
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array, Vector
from core.chain.back_transformed import BinMode, back_transform, combine_pixels, sample_pixels
from core.chain.noise_power import NoisePower, Operator
from core.chain.step_lineage import Axis, Linear, picture_step
from core.chain.wires import Image, Magnitude, Phase
from core.errors import ParameterError
from core.evaluation.recipes import Region, Seen, by_region
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.physics.detector.detector_mtf import aperture_mtf
from core.physics.optics.blur import gaussian_mtf, radial_tabulated_mtf, tabulated_mtf
from core.physics.sampling.detector_sampling import (
    block_mean_mtf,
    interpolation_mtf,
    interpolation_ptf,
    resampling_response,
    takes_the_later,
)
from core.records import dataclass
from core.transfer.factors import Edges, Factor, Grid, Law, Separable
from nodes.shared.context_defaults import apart, pitch_in_samples
from nodes.shared.module_ports import ImageOutput, NewHeight, NewWidth, passed_factors, separable

Size = tuple[int, int]
Further = list[tuple[NDArray[np.intp], NDArray[np.float64]]]
Taps = tuple[NDArray[np.intp], Further]
_BLOCK_SAMPLES = 1 << 18  # 512² are done sooner in one block than by two threads


class Interpolate(Module, key="interpolate", title="Interpolate", group="Transform"):
    """Resample the picture to another size over the same field of view.

    The centres of the outermost samples lie half a sampling interval inside the frame's edges.
    Beyond the edges, a picture from Back Transform continues as Init & Trans defines: a mirrored
    frame is mirrored, and a periodic frame wraps round. Any other picture, or one cropped after
    Back Transform, continues with its outermost samples. Nothing is filtered: a smaller picture
    aliases, as in a frame grabber. Order 0 takes the nearest sample (of two equally near samples,
    the one further right or down), order 1 is bilinear, and order 3 is cubic convolution. With an
    unchanged size, the picture does not change. Sources: Tantalo 1996, sections 5.1 and 5.2
    (bilinear); Keys 1981 (cubic, a = −1/2).
    """

    formulas = (
        Formula(
            r"L'(x)=\sum_j L_j\,w(x-j),\quad w(d)=1-|d|",
            where="x: position of a new sample, in old samples; the first new sample lies "
            "half a new interval from the edge; similarly for y",
            when="order 1, |d| < 1",
        ),
        Formula(r"w(d)=\frac{3}{2}|d|^3-\frac{5}{2}|d|^2+1", when="order 3, |d| ≤ 1"),
        Formula(r"w(d)=-\frac{1}{2}|d|^3+\frac{5}{2}|d|^2-4|d|+2", when="order 3, 1 < |d| < 2"),
    )

    width: NewWidth = None
    height: NewHeight = None
    order: Literal[0, 1, 3] = param(1, "0 nearest, 1 bilinear, 3 cubic")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        width, height = self.width or image.columns, self.height or image.rows
        if (height, width) == image.shape:
            return ImageOutput(image)
        how: Any = {"old": image.shape, "new": (height, width), "edges": image.edges}
        recipe = here.step(resampled, image.recipe, order=self.order, **how)
        x, y = image.interval_x_mrad, image.interval_y_mrad
        return ImageOutput(
            image.with_recipe(
                recipe,
                rows=height,
                columns=width,
                interval_x_mrad=None if x is None else x * image.columns / width,
                interval_y_mrad=None if y is None else y * image.rows / height,
            )
        )


@picture_step(linear=lambda _, **how: Resampling(**how))
@by_region(lambda _, *, new, **__: new)
def resampled(
    work: Work, region: Region, image: Seen, *, old: Size, new: Size, **how: Any
) -> Array:
    rows, columns = region.slices
    top, height, along = _needed(taps(old[0], new[0], **how), rows)
    left, width, across = columns.start, region.columns, None
    if old[1] != new[1]:
        left, width, across = _needed(taps(old[1], new[1], **how), columns)
    return _sampled(work, image(Region(top, left, height, width)), along, across)


def _sampled(work: Work, image: Array, along: Taps, across: Taps | None) -> Array:
    """Combine samples along first, then across, by blocks of rows."""
    (base, further), old_width = along, image.shape[1]
    width = old_width if across is None else len(across[0])
    result = np.empty((len(base), width), work.policy.dtype)

    def block(rows: slice) -> None:
        wanted = [(index[rows], weight[rows, np.newaxis]) for index, weight in further]
        lines = _combined(image, base[rows], wanted, axis=0)
        result[rows] = lines if across is None else _combined(lines, *across, axis=1)

    step = max(1, _BLOCK_SAMPLES // max(width, old_width))
    work.for_each(block, [slice(start, start + step) for start in range(0, len(base), step)])
    return result


def _needed(taps: Taps, wanted: slice) -> tuple[int, int, Taps]:
    """First sample and number of samples that some new ones need, and their taps counted so."""
    base, further = taps[0][wanted], [(index[wanted], weight[wanted]) for index, weight in taps[1]]
    first = min(int(index.min()) for index in (base, *(index for index, _ in further)))
    last = max(int(index.max()) for index in (base, *(index for index, _ in further)))
    moved = [(index - first, weight) for index, weight in further]
    return first, last - first + 1, (base - first, moved)


def _combined(image: Array, base: NDArray[np.intp], further: Further, axis: int) -> Array:
    """Samples at `base` and their weighted differences to those at the further indices."""
    near = np.take(image, base, axis=axis)
    total = near
    for index, weight in further:
        part = np.take(image, index, axis=axis)
        part -= near
        part *= weight.astype(image.dtype)
        total = np.add(total, part, out=part)
    return total


def taps(old: int, new: int, order: int, edges: Edges | None) -> Taps:
    """Where each of `new` samples is taken from along one axis, of `old` ones over the same field.

    First the index of the sample at or before each new one (order 0: the nearest), then what is
    added: weight·(sample at index − sample at base). Written as differences, a constant image stays
    constant to the last bit.
    """
    number = np.arange(new, dtype=np.int64)
    # Whole numbers of 1/(2·new) of a sample: exact, so that ties fall alike everywhere.
    doubled = (2 * number + 1) * old
    if order == 0:
        return (doubled // (2 * new)).astype(np.intp), []
    whole, rest = np.divmod(doubled - new, 2 * new)
    t = rest / (2 * new)

    def sample(offset: int) -> NDArray[np.intp]:
        return within_frame(whole + offset, old, edges)

    if order == 1:
        return sample(0), [(sample(1), t)]
    return sample(0), [
        (sample(-1), t * (-0.5 + t * (1.0 - 0.5 * t))),
        (sample(1), t * (0.5 + t * (2.0 - 1.5 * t))),
        (sample(2), t * t * (-0.5 + 0.5 * t)),
    ]


def within_frame(index: NDArray[np.int64], size: int, edges: Edges | None) -> NDArray[np.intp]:
    """The sample that stands for one beyond the frame's edges."""
    if edges is None:
        return np.asarray(np.clip(index, 0, size - 1), np.intp)
    if edges == "periodic":
        return np.asarray(index % size, np.intp)
    turned = index % (2 * size)
    return np.asarray(np.minimum(turned, 2 * size - 1 - turned), np.intp)


@dataclass(frozen=True)
class Resampling(Linear):
    old: Size
    new: Size
    order: int
    edges: Edges | None

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.old

    def grid_before(self, grid: Grid) -> Grid:
        rows, columns = self.old
        x = grid.interval_x_mrad * grid.columns / columns
        return Grid(rows, columns, x, grid.interval_y_mrad * grid.rows / rows)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """The mean over all samples, and its phase where they lie half-way between two."""
        axes: list[dict[str, Any] | None] = [
            {"interval_mrad": interval, "order": self.order, "old": old, "new": new}
            if old != new
            else None
            for interval, old, new in (
                (before.interval_x_mrad, before.columns, after.columns),
                (before.interval_y_mrad, before.rows, after.rows),
            )
        ]
        if axes == [None, None]:
            return ()
        moved = [
            axis
            if axis and takes_the_later(order=self.order, old=axis["old"], new=axis["new"])
            else None
            for axis in axes
        ]
        x, y = (None if axis is None else Law.of(interpolation_mtf, **axis) for axis in axes)
        named: dict[str, Any] = {"label": "Interpolation", "node": node}
        return (
            InterpolationMTF(x, y, **named),
            *separable(interpolation_ptf, x=moved[0], y=moved[1], part="ptf", **named),
        )

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        along, across = (
            interpolator(self.old[axis], self.new[axis], self.order, self.edges) for axis in (0, 1)
        )
        return power.resampled(self.new, along, across)

    def row(self, work: Work, row: Vector, axis: Axis) -> Vector:
        new = self.new[1 if axis == "x" else 0]
        if new == len(row):
            return row
        made = interpolator(len(row), new, self.order, self.edges)(row[:, np.newaxis])
        return np.asarray(made[:, 0], np.float64)


@dataclass(frozen=True)
class InterpolationMTF(Separable):
    """Interpolation's MTF: the new samples lie at several places between the old ones."""

    def mean_over(self, law: Law, frequency: Vector, share: float) -> Vector:
        """Modulus of the mean over the new samples in this share of an axis, about its middle."""
        how = dict(law.parameters)
        old, new = how["old"], how["new"]
        base, further = taps(old, new, how["order"], None)
        places = (np.arange(new) + 0.5) * old / new - 0.5
        # How much of each new sample lies within the share.
        away = np.abs(np.arange(new) + 0.5 - 0.5 * new)
        counted = np.clip(0.5 * max(1.0, share * new) + 0.5 - away, 0.0, 1.0)
        used = counted > 0.0
        return resampling_response(
            frequency=frequency * law.scale * how["interval_mrad"],
            places=places[used],
            base=base[used],
            further=[(index[used], weight[used]) for index, weight in further],
            share=counted[used],
        )


def interpolator(old: int, new: int, order: int, edges: Edges | None) -> Operator:
    base, further = taps(old, new, order, edges)
    columns = [(index, weight[:, np.newaxis]) for index, weight in further]
    return lambda waves: _combined(waves, base, columns, axis=0)


_LEAST = 1e-3


class SamplePixels(Module, key="sample_pixels", title="Sample Pixels", group="Transform"):
    """Keep one sample for each pixel, after Detector MTF has averaged over the pixel.

    Combine Pixels would average over the pixel again and leave only 0.64 of the contrast at
    Nyquist. The samples lie at the centres of the pixels, so the picture does not move. For even
    and non-integer ratios, the centres lie between samples. Between samples, the picture is
    evaluated as its Fourier sum: exact to rounding, with edges mirrored or periodic as in Back
    Transform. Nothing is filtered: content beyond the pixels' Nyquist frequency aliases, as in a
    camera. Incomplete pixels at the right and bottom edges of the frame are dropped. Source: Park,
    Schowengerdt and Kaczynski 1984, Applied Optics 23, 2572 (the average over the pixel and its
    sampling are two stages).
    """

    formulas = (
        Formula(
            r"L'_k=\frac{1}{N}\sum_{\xi}\mathcal{F}(\xi)\,e^{2\pi i\xi x_k},\quad x_k=\left(k+"
            r"\frac{1}{2}\right)r-\frac{1}{2}",
            where="x_k: middle of pixel k, in samples from the middle of the first sample, plus "
            "the offset; r: samples per pixel, any ratio",
        ),
    )

    factor_x: float | None = param(
        None,
        "samples per pixel, horizontally; empty: from the pitch of Init & Trans or Camera",
        (_LEAST, 65536),
        unit="samples",
        slider=(1, 16),
    )
    factor_y: float | None = param(
        None,
        "samples per pixel, vertically; empty: from the pitch of Init & Trans or Camera",
        (_LEAST, 65536),
        unit="samples",
        slider=(1, 16),
    )
    offset: float = param(
        0.0,
        "offset of the samples from the pixels' centres, to the right and down",
        (-1, 1),
        unit="pixels",
        slider=(-0.5, 0.5),
    )
    offset_y: float | None = param(
        None,
        "downward offset, if different; empty: equal to offset",
        (-1, 1),
        unit="pixels",
        slider=(-0.5, 0.5),
        zero_is_empty=False,
    )

    panel = (
        Section("Samples per pixel", "factor_x factor_y"),
        Section("Sampling phase", "offset offset_y"),
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        ratio_x, ratio_y = self._ratio("x", image), self._ratio("y", image)
        offset_y = self.offset if self.offset_y is None else self.offset_y
        if (ratio_x, ratio_y, self.offset, offset_y) == (1.0, 1.0, 0.0, 0.0):
            return ImageOutput(image)
        how: Any = {"ratio_x": ratio_x, "ratio_y": ratio_y}
        how |= {"offset_x": self.offset, "offset_y": offset_y}
        return ImageOutput(sample_pixels(image, **how, node=here.node))

    def _ratio(self, axis: str, image: Image) -> float:
        own: float | None = getattr(self, f"factor_{axis}")
        if own is not None:
            return own
        known = pitch_in_samples(axis, image)
        if known is None:
            allowed = "give pitch and focal length on Camera or Init & Trans, or a factor here"
            raise ParameterError(f"factor_{axis}", None, allowed, unit="samples")
        if not _LEAST <= known <= 65536:
            allowed = f"the pitch must give a factor from {_LEAST:g} to 65536"
            raise ParameterError(f"factor_{axis}", known, allowed, unit="samples")
        return known

    @warning
    def pitch(self, image: Image) -> Caution | None:
        """The samples per pixel disagree with the detector's pitch."""
        of_pitch = {f"factor_{axis}": pitch_in_samples(axis, image) for axis in "xy"}
        return apart(self, of_pitch, where="from the detector's pitch")

    @warning
    def no_average(self, image: Image) -> Caution | None:
        """The image is sampled at the pixels, but no stage averages it over the pixel area."""
        if detector_averages(image) or max(self._ratio("x", image), self._ratio("y", image)) <= 1:
            return None
        # A table on the way may have been measured through the pixels.
        passed = {law.function for factor in passed_factors(image) for law in factor.laws}
        measured = (
            "; ignore this warning if the table in MTF File already includes the pixel MTF, as "
            "tables from `imagechain measure` do"
            if not passed.isdisjoint((tabulated_mtf, radial_tabulated_mtf))
            else ""
        )
        return Caution(
            "the picture will be too sharp: there is no Detector MTF before this node, so "
            "nothing averages over the pixels and the samples are points",
            "put Detector MTF before Back Transform, or use Combine Pixels, which averages "
            f"over each pixel{measured}",
        )

    @readout("cyc/mrad")
    def nyquist_x(self, axis: str, outputs: ImageOutput) -> float | None:
        """Horizontal Nyquist frequency of the pixels."""
        image = outputs.image
        interval = image.interval_x_mrad if axis == "x" else image.interval_y_mrad
        return 0.5 / interval if interval else None


def detector_averages(image: Image) -> list[Separable]:
    """The factors of detectors' areas on the way to a picture, the last one first."""
    return [
        factor
        for factor in passed_factors(image)
        if isinstance(factor, Separable) and aperture_mtf in [law.function for law in factor.laws]
    ]


def width_mrad(average: Separable, axis: str) -> float:
    """How wide an average is along an axis; 0 where it is none."""
    law = average.x if axis == "x" else average.y
    width: float = 0.0 if law is None else dict(law.parameters)["effective_ifov_mrad"] * law.scale
    return width


_DIRECTIONS = {"x": "horizontally", "y": "vertically"}
_OF_A_PIXEL = 0.35  # of a block's width; a narrower average takes 5 % off at Nyquist, or less


class CombinePixels(Module, key="combine_pixels", title="Combine Pixels", group="Transform"):
    """Combine each block of samples into one pixel.

    Rows and columns left over at the bottom and right are dropped: 512 samples in blocks of 3 give
    170 pixels. Directly after Back Transform, if the factors divide the picture's size exactly, the
    module folds the spectrum instead of combining samples. The mean of a block represents the
    pixel's averaging over its area. After Detector MTF, which already averages over the pixel, use
    Sample Pixels instead. Source: Tantalo 1996, section 4.1, fig. 4.6.
    """

    formulas = (
        Formula(
            r"L'_{j,k}=\frac{1}{nm}\sum_{a=0}^{m-1}\sum_{b=0}^{n-1}L_{jm+a,\,kn+b}",
            where="n, m: factor_x and factor_y; for `sum`, 1/(nm) is left out",
        ),
        Formula(
            r"H(\xi)=\frac{\sin(\pi n\xi\Delta)}{n\,\sin(\pi\xi\Delta)}",
            where="H: transfer function of the block mean, before aliasing; Δ: sampling interval",
        ),
    )

    factor_x: int = param(2, "samples per pixel, horizontally", (1, 65536), slider=(1, 8))
    factor_y: int = param(1, "samples per pixel, vertically", (1, 65536))
    mode: BinMode = param("mean", "mean (radiance) or sum (counts) of each block")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.factor_x == 1 and self.factor_y == 1:
            return ImageOutput(image)
        return ImageOutput(combine_pixels(image, **self.values(), node=here.node))

    @warning
    def pixel_counted_twice(self, image: Image) -> Caution | None:
        """The pixel is averaged twice: by Detector MTF and by this node."""
        averages = detector_averages(image)
        for axis, interval, factor in (
            ("x", image.interval_x_mrad, self.factor_x),
            ("y", image.interval_y_mrad, self.factor_y),
        ):
            widths = [(width_mrad(average, axis), average) for average in averages]
            width, average = max(widths, key=lambda pair: pair[0], default=(0.0, None))
            if average is not None and width > 0 and interval is not None and factor > 1:
                detector = f"{average.label} ({average.node})"
                return _twice(detector, width, interval, factor, _DIRECTIONS[axis])
        return None


def _twice(
    detector: str, width_mrad: float, interval_mrad: float, factor: int, direction: str
) -> Caution:
    block = factor * interval_mrad
    left = block_mean_mtf(frequency=0.5 / block, interval_mrad=interval_mrad, samples=factor)
    if width_mrad < _OF_A_PIXEL * block:
        return Caution(
            f"the pixels do not match the detector: blocks of {factor} samples average over "
            f"{block:.4g} mrad {direction}, but {detector} averages over {width_mrad:.4g} "
            "mrad; both averages act on the picture",
            "use Sample Pixels with the detector's pitch on a scene sampled more finely; "
            "ignore this warning if the blocks represent the pixels, as in the 1996 networks",
        )
    return Caution(
        f"the pixel is averaged twice: over {width_mrad:.4g} mrad {direction} by {detector}, then "
        f"over {block:.4g} mrad by blocks of {factor} samples; the second average multiplies the "
        f"contrast at Nyquist by {float(left):.3g}",
        "use Sample Pixels instead of this node, or leave Detector MTF out; ignore this warning if "
        "both averages are intended, as in the 1996 networks",
    )


Kernel = Literal["box", "gaussian", "lanczos"]
_LOBES = 3
# Half contrast at the new Nyquist frequency, 1/(2·factor) cycles/sample.
_SIGMA_SAMPLES = math.sqrt(2.0 * math.log(2.0)) / math.pi


class AntiAlias(Module, key="anti_alias", title="Anti-alias Filter", group="Transform"):
    """Filter out frequencies that would alias in a picture decimated by `factor`.

    No sample is dropped. Use this filter before Interpolate decimates with order 0, if there is no
    Detector MTF. `box` is the mean of `factor` samples, centred for even factors too. `gaussian`
    halves the contrast at the new Nyquist frequency.
    `lanczos` is a sinc with its cutoff at the new Nyquist frequency and a three-lobe window. The
    frame is mirrored at its edges. A factor of 1 changes nothing. Sources: Tantalo 1996, section
    4.1; Duchon 1979 (Lanczos).
    """

    formulas = (
        Formula(
            r"H(f)=\frac{\sin(\pi nf)}{n\,\sin(\pi f)}",
            where="f: cycles per sample; n: factor",
            when="box, n odd",
        ),
        Formula(
            r"H(f)=2^{-(2nf)^2}",
            where="H is one half at the new Nyquist frequency, 1/(2n)",
            when="gaussian",
        ),
        Formula(
            r"h(x)\propto\mathrm{sinc}\left(\frac{x}{n}\right)\mathrm{sinc}\left(\frac{x}{3n}"
            r"\right),\quad|x|<3n",
            where="h: weight of the sample at distance x",
            when="lanczos",
        ),
    )

    kernel: Kernel = param("box", "shape of the low-pass filter")
    factor: int = param(
        1, "factor of the later decimation", (1, 1024), unit="samples", slider=(1, 8)
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.factor == 1:
            return ImageOutput(image)
        grid = Grid(image.rows, image.columns, 1.0, 1.0)  # frequencies in cycles/sample
        law, bound = self._law()
        factors = separable(law, x=bound, y=bound, label=self.title, node=here.node)
        magnitude = Magnitude(image, grid).times(*factors)
        filtered = back_transform(magnitude, Phase(image, grid), node=here.node)
        return ImageOutput(image.with_recipe(filtered.recipe))

    def _law(self) -> tuple[Callable[..., Any], dict[str, Any]]:
        if self.kernel == "box":
            return block_mean_mtf, {"interval_mrad": 1.0, "samples": self.factor}
        if self.kernel == "lanczos":
            return lanczos_mtf, {"factor": self.factor}
        return gaussian_mtf, {"sigma_mrad": self.factor * _SIGMA_SAMPLES}  # samples

    @readout("cyc/mrad")
    def new_nyquist_x(self, axis: str, image: Image) -> float | None:
        """Horizontal Nyquist frequency after the later decimation."""
        interval = image.interval_x_mrad if axis == "x" else image.interval_y_mrad
        return None if interval is None else 0.5 / interval / self.factor


def lanczos_mtf(*, frequency: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Transfer function of sinc(k/n)·sinc(k/(3n)), |k| < 3n, of sum 1; f in cycles/sample.

    Notes
    -----
    Source: Duchon 1979, Lanczos filtering in one and two dimensions.
    """
    k = np.arange(1, _LOBES * factor)
    weights = np.sinc(k / factor) * np.sinc(k / (_LOBES * factor))
    total, at_zero = np.ones(np.shape(frequency)), 1.0
    for lag, weight in zip(k, weights, strict=True):
        total += 2.0 * weight * np.cos(2.0 * np.pi * lag * frequency)
        at_zero += 2.0 * weight  # in the same order, so that the ratio at zero is 1 exactly
    return total / at_zero
