"""Images that come out of a chain: the spectrum, the product of its factors, one inverse."""

from functools import cached_property
from typing import Any, Literal

import numpy as np

from core.arrays import Array, Vector
from core.chain import step_lineage
from core.chain.band_stack import (
    BandStack,
    FilteredSum,
    Row,
    SteppedBands,
    WavelengthRank,
    spectral_of,
    weighted_factors,
)
from core.chain.noise_power import NoisePower
from core.chain.wires import Image, Magnitude, Phase
from core.errors import DataError
from core.evaluation.recipes import Recipe, Region, Step, in_parts
from core.evaluation.work import Work
from core.records import dataclass, field, replace
from core.transfer import periodic
from core.transfer.factors import Edges, Factor, Grid, Product, Skipped, spend
from core.transfer.mirrored import MeanFree, mirrored_filter, mirrored_spectrum
from core.transfer.planar_blocks import known_planes

BinMode = Literal["mean", "sum"]


def back_transform(magnitude: Magnitude, phase: Phase, *, node: str | None = None) -> Image:
    """The image of a magnitude and a phase, which may stem from different images."""
    if magnitude.grid.shape != phase.grid.shape:
        raise DataError(
            f"magnitude has {magnitude.grid.columns} × {magnitude.grid.rows} samples and phase "
            f"has {phase.grid.columns} × {phase.grid.rows}: both must have the same size"
        )
    grid = magnitude.grid
    like = magnitude.image or phase.image
    recipe = Delivered(magnitude, phase, node=node)
    bands = _bands_of(recipe)
    if bands is not None:
        recipe = replace(recipe, weights=bands.whole)
    interval = grid.interval_x_mrad, grid.interval_y_mrad
    made = Image(recipe, *grid.shape, *interval, unit="", edges=recipe.edges, bands=bands)
    if like is None:
        return made
    carried = ("unit", "band_um", "camera", "pixel_mrad", "air", "responses", "vignetting")
    return replace(made, **{name: getattr(like, name) for name in carried})


def _bands_of(recipe: "Delivered") -> "DeliveredBands | None":
    before = recipe.magnitude.image.bands if recipe.magnitude.image is not None else None
    return None if before is None or not recipe.one_source else DeliveredBands.of(recipe)


@dataclass(frozen=True, eq=False)
class Delivered(Recipe):
    """Pixels of a filtered image, blocks of them combined if a factor is above 1.

    With `sampled` it is taken at the places of pixels alone, and no factor is above 1. With
    `weights` it is that sum of its bands, each filtered at its own wavelength.
    """

    magnitude: Magnitude
    phase: Phase
    factor_x: int = 1
    factor_y: int = 1
    mode: BinMode = "mean"
    node: str | None = field(default=None, compare=False)
    sampled: step_lineage.PixelSamples | None = None
    weights: Row | None = None

    def _content(self) -> tuple[object, ...]:
        how = () if self.sampled is None else (self.sampled,)
        if self.weights is not None:
            how = (*how, self.bands.key, self.weights)
        return self.magnitude.key, self.phase.key, self.factor_x, self.factor_y, self.mode, *how

    @property
    def plain(self) -> bool:
        """Whether it is the whole filtered image, sample by sample."""
        return self.factor_x == self.factor_y == 1 and self.sampled is None

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        return (*self._pictures, *self.bound)

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """The picture's spectrum in its place, and the stored planar factors."""
        product = Product(self._factors)
        sources = self._spectra if self.one_source else self._pictures
        return (*self.bound, *known_planes(product, self.magnitude.grid, self.edges), *sources)

    def first(self, work: Work) -> tuple[Recipe, ...]:
        """The same, without the picture where its spectrum is in the store."""
        if self.one_source and all(work.has(one) for one in self._spectra):
            return self.bound
        return (*self.bound, *self._pictures)

    @property
    def _pictures(self) -> tuple[Recipe, ...]:
        if self.weights is not None:
            return self.filtered_sum.recipes
        wires = (self.magnitude, self.phase)
        return tuple(wire.image.recipe for wire in wires if wire.image is not None)

    @property
    def bound(self) -> tuple[Recipe, ...]:
        return tuple(one for factor in self._factors for law in factor.laws for one in law.inputs)

    @property
    def bands(self) -> BandStack:
        assert self.magnitude.image is not None
        assert self.magnitude.image.bands is not None
        return self.magnitude.image.bands

    @cached_property
    def filtered_sum(self) -> FilteredSum:
        """The sum of bands behind the factors that depend on wavelength."""
        assert self.weights is not None
        factors = spectral_of((*self.magnitude.factors, *self._phase_factors()))[0]
        grid = self.magnitude.grid
        return FilteredSum(self.bands, self.weights, factors, grid, self.edges, self.node)

    @property
    def _factors(self) -> tuple[Factor, ...]:
        """Those that act on the whole picture alike."""
        factors = (*self.magnitude.factors, *self._phase_factors())
        return factors if self.weights is None else spectral_of(factors)[1]

    @cached_property
    def _spectra(self) -> tuple[Recipe, ...]:
        """Of the picture that magnitude and phase stem from, or of sums of its bands."""
        if self.weights is not None:
            return self.filtered_sum.recipes
        assert self.magnitude.image is not None
        transform = mirrored_spectrum if self.mirrored else periodic.periodic_spectrum
        return (Step.of(transform, self.magnitude.image.recipe, node=self.node),)

    @property
    def lineage(self) -> step_lineage.Lineage | None:
        """The picture filtered and its pixels combined, where magnitude and phase are of one."""
        if self.magnitude.image is None or not self.one_source:
            return None
        return step_lineage.Lineage(self._source, Delivery(self))

    @property
    def _source(self) -> Recipe:
        assert self.magnitude.image is not None
        if self.weights is not None:
            return self.bands.picture(self.weights)
        return self.magnitude.image.recipe

    @property
    def mirrored(self) -> bool:
        return self.one_source and self.magnitude.edges == "reflect"

    @property
    def edges(self) -> Edges:
        return "reflect" if self.mirrored else "periodic"

    @property
    def one_source(self) -> bool:
        a, b = self.magnitude, self.phase
        return (
            a.image is not None
            and b.image is not None
            and a.image.key == b.image.key
            and a.edges == b.edges
        )

    @property
    def in_parts(self) -> bool:
        """Half of the inverse transform serves a region as well."""
        return self.sampled is None or self.sampled.folds

    @property
    def by_rows(self) -> bool:
        """Half of the inverse transform is the whole picture's: blocks would repeat it."""
        return False

    @property
    def in_blocks(self) -> bool:
        """A frame of one source, by passes over rows and columns."""
        bands = self.weights is None or not self._is_split or self.filtered_sum.in_blocks
        return self.one_source and bands and (self.sampled is None or self.sampled.folds)

    def share(self, region: Region, shape: tuple[int, int]) -> float:
        """All of the first half; of the second the columns if mirrored, else the rows."""
        part = region.columns / shape[1] if self.mirrored else region.rows / shape[0]
        return 0.5 + 0.5 * part

    def compute_part(self, work: Work, region: Region) -> Array:
        return self.compute(work, region)

    def compute(self, work: Work, region: Region | None = None) -> Array:
        factors, _ = self.spent(work)
        if not self.one_source:
            return self._filtered(work, self._crossed(work), factors, region)
        if not factors and self.plain and not self._is_split:
            samples = work.part(self._source, region) if region else work.value(self._source)
            return np.asarray(samples, work.policy.dtype)
        if self.weights is None:
            return self._filtered(work, work.value(self._spectra[0]), factors, region)
        total: Array | None = None
        for spectrum, own in self.filtered_sum.spectra(work):
            made = self._filtered(work, spectrum, (*own, *factors), region)
            total = made if total is None else np.add(total, made, out=total)
        assert total is not None
        return total

    @property
    def _is_split(self) -> bool:
        return self.weights is not None and bool(self.filtered_sum.factors)

    def _filtered(
        self,
        work: Work,
        spectrum: MeanFree,
        factors: tuple[Factor, ...],
        region: Region | None = None,
    ) -> Array:
        grid, product = self.magnitude.grid, Product(factors)
        apply = mirrored_filter if self.mirrored else periodic.periodic_filter
        work.check()
        sampled = self.sampled
        if sampled is not None and not sampled.folds:
            x, y = sampled.places
            if not sampled.on_samples:
                return periodic.sampled_filter(work, spectrum, product, grid, sampled.edges, x, y)
            whole = apply(work, spectrum, product, grid)
            return whole[np.ix_(np.rint(y).astype(np.intp), np.rint(x).astype(np.intp))]
        factors_xy = self.factor_x, self.factor_y
        if sampled is not None:
            factors_xy = round(sampled.ratio_x), round(sampled.ratio_y)
        average = sampled is None
        result = apply(work, spectrum, product, grid, *factors_xy, region, average=average)
        if self.mode == "sum":
            result *= result.dtype.type(self.factor_x * self.factor_y)
        return result

    def spent(self, work: Work) -> tuple[tuple[Factor, ...], tuple[Skipped, ...]]:
        """Factors that count within the error budget, and those left out."""
        xi, eta = self.magnitude.grid.axes(self.edges)
        rank = self.rank(work)
        return spend(work, self._factors, xi, eta, spent=0.0 if rank is None else rank.bound)

    def rank(self, work: Work) -> WavelengthRank | None:
        """The wavelengths that stand for those of all bands, where these are filtered apart."""
        return work.value(self.filtered_sum.wavelengths) if self._is_split else None

    def _phase_factors(self) -> tuple[Factor, ...]:
        """PTFs as functions of the magnitude's frequencies, sample by sample of the spectrum."""
        a, b = self.magnitude.grid, self.phase.grid
        ratios = a.interval_x_mrad / b.interval_x_mrad, a.interval_y_mrad / b.interval_y_mrad
        if ratios == (1.0, 1.0):
            return self.phase.factors
        return tuple(factor.rescaled(*ratios) for factor in self.phase.factors)

    def _crossed(self, work: Work) -> MeanFree:
        a, b = self.magnitude.image, self.phase.image
        return periodic.crossed_spectrum(
            work,
            None if a is None else work.value(a.recipe),
            None if b is None else work.value(b.recipe),
            self.magnitude.grid,
        )


@dataclass(frozen=True)
class DeliveredBands(BandStack):
    """Bands behind a back transform: each sum of them is filtered as one picture."""

    delivered: Delivered

    @classmethod
    def of(cls, delivered: Delivered) -> "DeliveredBands":
        before, plain = delivered.bands, replace(delivered, weights=None)
        return cls(before.centres_um, before.widths_um, plain, density=before.density)

    @property
    def in_blocks(self) -> bool:
        return self.delivered.bands.in_blocks and self.picture(self.whole).in_blocks

    def _content(self) -> tuple[object, ...]:
        return self.delivered.bands.key, self.delivered.key

    def picture(self, weights: Row) -> Recipe:
        return replace(self.delivered, weights=weights)

    def means(self) -> Recipe:
        """Means of the bands before: no transfer function changes them."""
        return self.delivered.bands.means()


def combine_pixels(
    image: Image, *, factor_x: int, factor_y: int, mode: BinMode = "mean", node: str | None = None
) -> Image:
    """Mean or sum of blocks of `factor_y` × `factor_x` samples; what is left over is cropped.

    Straight after a back transform, and where the factors divide the size, the spectrum is folded
    and a smaller inverse transform taken; otherwise the pixels are combined.
    """
    if factor_x > image.columns or factor_y > image.rows:
        raise DataError(
            f"blocks of {factor_x} × {factor_y} do not fit an image of "
            f"{image.columns} × {image.rows} samples"
        )
    recipe, bands = image.recipe, image.bands
    whole = image.columns % factor_x == 0 and image.rows % factor_y == 0
    if isinstance(recipe, Delivered) and whole and recipe.plain:
        delivered = replace(recipe, factor_x=factor_x, factor_y=factor_y, mode=mode)
        combined: Recipe = delivered
        if bands is not None:
            bands = _bands_of(delivered)
    else:
        how = {"factor_x": factor_x, "factor_y": factor_y, "mode": mode, "old": image.shape}
        combined = step = Step.of(block_combine, recipe, node=node, **how)
        if bands is not None:
            gain = factor_x * factor_y if mode == "sum" else 1.0
            bands = SteppedBands.of(bands, step, gain=gain, blocks=(factor_y, factor_x))
    x, y = image.interval_x_mrad, image.interval_y_mrad
    return image.with_recipe(
        combined,
        rows=image.rows // factor_y,
        columns=image.columns // factor_x,
        interval_x_mrad=None if x is None else x * factor_x,
        interval_y_mrad=None if y is None else y * factor_y,
        edges=image.edges if whole else None,  # a frame that is cropped goes on otherwise
        bands=bands,
    )


def sample_pixels(
    image: Image,
    *,
    ratio_x: float,
    ratio_y: float,
    offset_x: float = 0.0,
    offset_y: float = 0.0,
    node: str | None = None,
) -> Image:
    """One sample for each pixel of `ratio_y` × `ratio_x` samples, which need not be whole numbers.

    Straight after a back transform the filtered spectrum itself is taken there; of any other image
    the samples' own, mirrored at the frame's edges or periodic as that image has them.
    """
    recipe = image.recipe
    edges: Edges = image.edges or "reflect"
    pixels = step_lineage.PixelSamples(image.shape, ratio_x, ratio_y, offset_x, offset_y, edges)
    x, y = image.interval_x_mrad, image.interval_y_mrad
    if not (isinstance(recipe, Delivered) and recipe.plain and recipe.edges == edges):
        # Anti-alias Filter mirrors its frame, and leaves a periodic one periodic for what follows.
        grid = Grid(*image.shape, x or 1.0, y or 1.0)
        magnitude, phase = Magnitude(image, grid, edges), Phase(image, grid, edges)
        recipe = Delivered(magnitude, phase, node=node)
        if image.bands is not None:
            recipe = replace(recipe, weights=image.bands.whole)
    recipe = replace(recipe, sampled=pixels)
    bands = None if recipe.weights is None else _bands_of(recipe)
    rows, columns = pixels.new
    whole = all(
        abs(new * ratio - old) <= 1e-6 * ratio
        for new, ratio, old in zip(pixels.new, (ratio_y, ratio_x), image.shape, strict=True)
    )
    return image.with_recipe(
        recipe,
        rows=rows,
        columns=columns,
        interval_x_mrad=None if x is None else x * ratio_x,
        interval_y_mrad=None if y is None else y * ratio_y,
        edges=image.edges if whole and not (offset_x or offset_y) else None,
        bands=bands,
    )


def _combined_part(
    work: Work, region: Region, image: Recipe, *, factor_x: int, factor_y: int, **how: Any
) -> Array:
    wanted = Region(
        region.top * factor_y,
        region.left * factor_x,
        region.rows * factor_y,
        region.columns * factor_x,
    )
    blocks = work.part(image, wanted)
    return block_combine(work, blocks, factor_x=factor_x, factor_y=factor_y, **how)


@step_lineage.picture_step(linear=lambda _, **how: step_lineage.Blocks(**how))
@in_parts(_combined_part)
def block_combine(
    work: Work,
    image: Array,
    *,
    factor_x: int,
    factor_y: int,
    mode: str,
    old: tuple[int, int],  # noqa: ARG001  (of the whole image, for its lineage)
) -> Array:
    """Mean or sum of whole blocks, sums in double."""
    rows, columns = image.shape[0] // factor_y, image.shape[1] // factor_x
    total = np.zeros((rows, columns))
    for y in range(factor_y):
        for x in range(factor_x):
            work.check()
            total += image[y : rows * factor_y : factor_y, x : columns * factor_x : factor_x]
    if mode == "mean":
        total /= factor_x * factor_y
    return total.astype(work.policy.dtype)


# What becomes of a picture in a filtered image: its factors, and its pixels' means, in one.


@dataclass(frozen=True)
class Delivery(step_lineage.Linear):
    """What a delivered image's factors and pixel means do, in one."""

    recipe: Delivered

    @property
    def _filtering(self) -> step_lineage.Filtering:
        magnitude, phase = self.recipe.magnitude, self.recipe.phase
        factors: tuple[Factor, ...] = (*magnitude.factors, *phase.factors)
        if self.recipe.weights is not None:
            factors = weighted_factors(factors, self.recipe.bands, self.recipe.weights)
        return step_lineage.Filtering(factors, magnitude.grid, self.recipe.edges)

    @property
    def _pixels(self) -> step_lineage.Pixels:
        recipe = self.recipe
        if recipe.sampled is not None:
            return recipe.sampled
        return step_lineage.Blocks(
            recipe.factor_x, recipe.factor_y, recipe.mode, recipe.magnitude.grid.shape
        )

    @property
    def gain(self) -> float:
        return self._pixels.gain

    @property
    def combines_pixels(self) -> bool:
        return not self.recipe.plain

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:  # noqa: ARG002
        return self.recipe.magnitude.grid.shape

    def grid_before(self, grid: Grid) -> Grid:
        """That of the spectrum, in the unit of the image's."""
        before = self.recipe.magnitude.grid
        ratios = self._ratios(grid)
        if ratios is None:
            return before
        x, y = before.interval_x_mrad * ratios[0], before.interval_y_mrad * ratios[1]
        return replace(before, interval_x_mrad=x, interval_y_mrad=y)

    def transfer(self, before: Grid, after: Grid, node: str | None) -> tuple[Factor, ...]:
        """All factors, those of the phase last, and the pixel means."""
        factors = self._filtering.factors
        ratios = self._ratios(after)
        if ratios is not None:
            factors = tuple(factor.rescaled(*ratios) for factor in factors)
        return (*factors, *self._pixels.transfer(before, after, node))

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return self._pixels.noise(work, self._filtering.noise(work, power))

    def row(self, work: Work, row: Vector, axis: step_lineage.Axis) -> Vector:
        return self._pixels.row(work, self._filtering.row(work, row, axis), axis)

    def _ratios(self, grid: Grid) -> tuple[float, float] | None:
        """Intervals of the image over the spectrum's; None where these are in the same unit.

        A spectrum's frequencies may be in units of its own, such as cycles a sample.
        """
        before, (across, along) = self.recipe.magnitude.grid, self._pixels.samples
        x = grid.interval_x_mrad / (before.interval_x_mrad * across)
        y = grid.interval_y_mrad / (before.interval_y_mrad * along)
        return (x, y) if max(abs(x - 1.0), abs(y - 1.0)) > 1e-9 else None
