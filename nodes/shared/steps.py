"""Steps that several modules take."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from core.arrays import Array
from core.chain.band_stack import BandStack, SteppedBands
from core.chain.noise_power import NoisePower
from core.chain.random_fields import at_frame
from core.chain.step_lineage import AtStep, Filtering, Linear, Noise, picture_step
from core.chain.wires import Image
from core.evaluation import recipes
from core.evaluation.work import Work
from core.physics.detector.readout import quantize, rounding_variances
from core.records import dataclass, field
from core.transfer.factors import Grid
from core.transfer.scan_lines import filter_lines

_STILL = 1e-4  # of a step; rounding errors of a picture with less noise stay what they are


def stepped(image: Image, step: recipes.Step, *, gain: float = 1.0, **changes: Any) -> Image:
    """A picture behind a linear step, and each of its bands behind the same."""
    bands: BandStack | None = image.bands
    if bands is not None:
        bands = SteppedBands.of(bands, step, gain=gain)
    return image.with_recipe(step, bands=bands, **changes)


@recipes.ends_lineage
@recipes.pointwise
def difference(work: Work, picture: Array, other: Array) -> Array:
    return np.subtract(picture, other, dtype=work.policy.dtype)


@recipes.in_blocks()
@recipes.ends_lineage
def even(work: Work, *, shape: tuple[int, int], value: float) -> Array:
    picture: Array = work.empty(shape)
    picture.fill(value)
    return picture


def number(work: Work, *, value: float) -> float:
    return value


@recipes.in_blocks()
def mean_of(work: Work, samples: Array) -> float:
    return float(np.mean(samples, dtype=np.float64))


@dataclass(frozen=True)
class PictureRange:
    mean: float
    low: float
    high: float


@recipes.in_blocks()
def picture_range(work: Work, image: Array) -> PictureRange:
    return PictureRange(
        float(np.mean(image, dtype=np.float64)), float(np.min(image)), float(np.max(image))
    )


@dataclass(frozen=True)
class Scaled(Linear):
    """Every sample times a number; an offset is in no difference."""

    factor: float
    reflectance: float | None = None  # of a sample of 1 before it, where it is light on surfaces

    @property
    def gain(self) -> float:
        return self.factor

    @property
    def of_reflectance(self) -> float | None:
        return self.reflectance

    @property
    def by_sample(self) -> bool:
        return True

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.scaled(self.factor)


@dataclass(frozen=True)
class AboutMean(Linear):
    """A change that is linear in small differences, with a gain that depends on the picture.

    That `of_air` is before the camera. Noise may be left as it is: beside a mean that is clipped
    there are samples that are not.
    """

    change: recipes.Recipe
    of_air: bool = False
    scales_noise: bool = True

    @property
    def before_camera(self) -> bool:
        return self.of_air

    @property
    def level(self) -> recipes.Recipe:
        return self.change

    @property
    def by_sample(self) -> bool:
        return True

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.scaled(work.value(self.change).gain) if self.scales_noise else power


@dataclass(frozen=True)
class Carried(Linear):
    """New noise and noise that stays, each times a factor; None: the step itself adds the rest."""

    temporal: float = 1.0
    fixed: float | None = 1.0

    def carried(self, work: Work, power: NoisePower, *, temporal: bool) -> NoisePower | None:
        factor = self.temporal if temporal else self.fixed
        if factor is None or factor == 1.0:
            return None if factor is None else power
        return power.scaled(factor)


@dataclass(frozen=True, eq=False)
class OverFrames(recipes.Recipe):
    """What a function makes of several frames of a picture, in turn; none is kept.

    It is called as ``function(frames, *others)``. A sequence leaves it as it is: it is taken once.
    """

    function: Callable[..., Any]
    picture: recipes.Recipe
    frames: int
    start: int = 0
    others: tuple[recipes.Recipe, ...] = ()
    node: str | None = field(default=None, compare=False)
    words: str = field(default="", compare=False)

    def _content(self) -> tuple[object, ...]:
        others = tuple(one.key for one in self.others)
        return self.function, self.picture.key, self.frames, self.start, others

    @property
    def in_words(self) -> str:
        return self.words

    @property
    def inputs(self) -> tuple[recipes.Recipe, ...]:
        return (at_frame(self.picture, self.start), *self.others)

    @property
    def needs(self) -> tuple[recipes.Recipe, ...]:
        """The next frame too, which shares with the first all that stays from frame to frame."""
        return (*self.inputs, at_frame(self.picture, self.start + 1))

    def compute(self, work: Work) -> Any:
        others = [work.value(one) for one in self.others]
        numbers = range(self.start, self.start + self.frames)

        def frames() -> Iterator[Array]:
            for picture in work.one_by_one(at_frame(self.picture, number) for number in numbers):
                work.check()
                yield picture

        return self.function(frames(), *others)


@picture_step(linear=lambda *_, **how: Filtering(**how))
@recipes.by_region(
    lambda _, *, grid, **__: grid.shape, lambda region, shape: region.rows / shape[0]
)
def filtered_lines(
    work: Work, region: recipes.Region, picture: recipes.Seen, *, grid: Grid, label: str, **how: Any
) -> Array:
    wanted = recipes.Region(region.top, 0, region.rows, grid.columns)
    lines = filter_lines(work, picture(wanted), grid=grid, **how)
    return np.ascontiguousarray(lines[:, region.slices[1]])


def rounding_noises(at: AtStep, step: float) -> list[Noise]:
    """Rounding errors: temporal as far as temporal noise changes them, else fixed."""
    stirring = sum(noise.power.variance for noise in at.before if noise.temporal)
    if stirring < (_STILL * step) ** 2:
        return [at.known("quantization")]
    temporal, fixed = rounding_variances(step=step, noise_variance=stirring)
    return [at.white("quantization", temporal), at.white("quantization", fixed, temporal=False)]


@recipes.in_blocks()
def _rounding(
    at: AtStep, picture: recipes.Recipe, limits: recipes.Recipe | tuple[float, float], *, bits: int
) -> list[Noise]:
    low, high = at.work.value(limits) if isinstance(limits, recipes.Recipe) else limits
    return rounding_noises(at, (high - low) / (2.0**bits - 1.0)) if high > low else []


@picture_step(noise=_rounding, looks_at=("limits",))
@recipes.pointwise
def quantized(work: Work, picture: Array, limits: tuple[float, float], *, bits: int) -> Array:
    """Nearest of 2^bits levels between the limits."""
    low, high = limits
    return quantize(picture, bits=bits, low=low, high=high, for_each=work.for_each)
