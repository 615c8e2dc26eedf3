"""Modules whose arithmetic is plain, for tests of the engine."""

from typing import Annotated, Literal, NamedTuple

import numpy as np

from core.chain.back_transformed import back_transform, combine_pixels
from core.chain.wires import Context, Image, Magnitude, Phase, Transfer
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout
from core.modules.parameters import Param
from core.transfer.factors import Law, Separable


class ImageOut(NamedTuple):
    image: Image


class TwoOut(NamedTuple):
    image: Image
    noise: Image


class InitOut(NamedTuple):
    context: Context
    magnitude: Magnitude
    phase: Phase


class MtfOut(NamedTuple):
    magnitude: Magnitude
    mtf: Transfer


def ramp(work: Work, *, rows: int, columns: int, level: float) -> np.ndarray:
    return (np.arange(rows * columns, dtype=work.policy.dtype) + level).reshape(rows, columns)


def scaled(work: Work, image: np.ndarray, *, factor: float) -> np.ndarray:
    if factor == 13:
        raise DataError("thirteen brings bad luck")
    return np.asarray(image * image.dtype.type(factor))


def added(work: Work, image: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.asarray(image + other)


def mean_of(work: Work, image: np.ndarray) -> float:
    return float(image.mean())


def gaussian(frequency: np.ndarray, sigma: float) -> np.ndarray:
    if sigma > 100:
        raise ParameterError("sigma", sigma, "at most 100")
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


class Maker(Module, key="maker", title="Maker", group="Test"):
    """Make a ramp."""

    level: Annotated[float, Param("lowest sample")] = 0.0
    columns: Annotated[int, Param("size", low=1)] = 6

    def run(self, here: NodeContext) -> ImageOut:
        if self.level == -13:
            raise ParameterError("level", self.level, "anything but -13")
        rows = 4
        recipe = Step.of(ramp, node=here.node, rows=rows, columns=self.columns, level=self.level)
        return ImageOut(Image(recipe, rows, self.columns, 1.0, 1.0))


class Scale(Module, key="scale", title="Scale", group="Test"):
    """Multiply."""

    factor: Annotated[float, Param("factor")] = 2.0
    mode: Annotated[Literal["plain", "shown"], Param("no matter")] = "plain"

    def run(self, image: Image, here: NodeContext) -> TwoOut:
        if self.factor == 1:
            return TwoOut(image, image)
        recipe = Step.of(scaled, image.recipe, node=here.node, factor=self.factor)
        noise = Step.of(added, recipe, image.recipe, node=here.node)
        return TwoOut(image.with_recipe(recipe), image.with_recipe(noise))

    @readout()
    def mean(self, outputs: TwoOut) -> Step:
        """Mean of the picture."""
        return Step.of(mean_of, outputs.image.recipe)

    @readout()
    def mean_in(self, image: Image) -> Step:
        """Mean of what comes in."""
        return Step.of(mean_of, image.recipe)


class Sum(Module, key="sum", title="Sum", group="Test"):
    """Add two pictures, or one to itself."""

    def run(self, image: Image, other: Image | None = None) -> ImageOut:
        second = other if other is not None else image
        return ImageOut(image.with_recipe(Step.of(added, image.recipe, second.recipe)))


class Init(Module, key="init", title="Init", group="Test"):
    """To the spectrum."""

    def run(self, image: Image) -> InitOut:
        grid = image.grid()
        context = Context(grid, "reflect", "line", None, None, None, None, None, 1.0, 1.0, 0.0, 0.0)
        return InitOut(context, Magnitude(image, grid), Phase(image, grid))


class Blur(Module, key="blur", title="Blur", group="Test"):
    """Gaussian."""

    sigma: Annotated[float, Param("width", low=0)] = 1.0

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOut:
        law = Law.of(gaussian, sigma=self.sigma)
        factors = (Separable(law, law, node=here.node),) if self.sigma else ()
        return MtfOut(magnitude.times(*factors), Transfer(context.grid, "mtf", factors))


class Back(Module, key="back", title="Back", group="Test"):
    """To the picture."""

    def run(self, magnitude: Magnitude, phase: Phase, here: NodeContext) -> ImageOut:
        return ImageOut(back_transform(magnitude, phase, node=here.node))


class Bin(Module, key="bin", title="Bin", group="Test"):
    """Two by two."""

    def run(self, image: Image, here: NodeContext) -> ImageOut:
        return ImageOut(combine_pixels(image, factor_x=2, factor_y=2, node=here.node))


MODULES: tuple[type[Module], ...] = (Maker, Scale, Sum, Init, Blur, Back, Bin)
LIBRARY: dict[str, type[Module]] = {module.key: module for module in MODULES}
