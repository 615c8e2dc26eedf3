"""Interpolate: other numbers of samples over the same field, as a frame grabber takes them."""

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.noise_power import NoisePower, Operator
from core.chain.step_lineage import Array, Axis, Linear, PlaceDependent, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import Region, Seen, by_region
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, param
from core.physics.sampling.detector_sampling import (
    interpolation_mtf,
    interpolation_ptf,
    resampling_response,
    takes_the_later,
)
from core.records import dataclass
from core.transfer.factors import Edges, Factor, Grid, Law
from nodes.shared.module_ports import ImageOutput, NewHeight, NewWidth, separable

Vector = NDArray[np.float64]
Size = tuple[int, int]
Further = list[tuple[NDArray[np.intp], NDArray[np.float64]]]
Taps = tuple[NDArray[np.intp], Further]
_BLOCK_SAMPLES = 1 << 18  # 512² are done sooner in one block than by two threads


class Interpolate(Module, key="interpolate", title="Interpolate", group="Transform"):
    """Resample the picture to another size over the same field of view.

    Sample centres lie half an interval from the frame's edges. Beyond the edges, a picture from
    Back Transform continues as Init & Trans defines: a mirrored frame is mirrored, and a periodic
    frame wraps round. Any other picture, or one cropped after Back Transform, continues with its
    outermost samples. Nothing is filtered: a smaller picture aliases, as in a frame grabber. Order
    0 takes the nearest sample (the later of two equally near samples), order 1 is bilinear, and
    order 3 is cubic convolution. With an unchanged size, the picture does not change. Sources:
    Tantalo 1996, sections 5.1 and 5.2 (bilinear); Keys 1981 (cubic, a = −1/2).
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
class InterpolationMTF(PlaceDependent):
    """Interpolation's MTF: the new samples lie at several places between the old ones."""

    def mean_over(self, law: Law, frequency: Vector, share: float) -> Vector:
        """Modulus of the mean over the new samples within the share."""
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

    def interpolated(waves: Array) -> Array:
        total = waves[base]
        for index, weight in further:
            total = total + weight[:, np.newaxis] * (waves[index] - waves[base])
        return total

    return interpolated
