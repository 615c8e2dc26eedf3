"""Neutral Filter: a glass that takes the same share of every sample."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from imagechain.plug_in import (
    Image,
    ImageOutput,
    Linear,
    Module,
    NodeContext,
    NoisePower,
    Param,
    Recipe,
    Step,
    Work,
    picture_step,
    pointwise,
    readout,
)

Array = NDArray[Any]


@dataclass(frozen=True)
class Dimmed(Linear):
    """What the filter does to levels and noise that were there before."""

    transmission: float

    @property
    def gain(self) -> float:
        """Of a uniform picture."""
        return self.transmission

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        """Dimmed as the picture is."""
        return power.scaled(self.transmission)


def _dimmed(image: Recipe, *, transmission: float) -> Dimmed:
    return Dimmed(transmission)


@picture_step(linear=_dimmed)
@pointwise
def dimmed(work: Work, image: Array, *, transmission: float) -> Array:
    """The picture times a transmission."""
    return np.multiply(image, work.policy.dtype.type(transmission), dtype=work.policy.dtype)


class NeutralFilter(
    Module, key="imagechain_glare.neutral_filter", title="Neutral Filter", group="Filters"
):
    """Dim the picture by a filter's optical density.

    L' = L·10^(−D). Source: the definition of optical density.
    """

    optical_density: Annotated[float, Param("optical density", low=0, high=10, slider=(0, 4))] = 0.3

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        """Plan the dimming."""
        if not self.optical_density:
            return ImageOutput(image)
        made = Step.of(dimmed, image.recipe, node=here.node, transmission=self._transmission)
        return ImageOutput(image.with_recipe(made))

    @property
    def _transmission(self) -> float:
        return float(10.0**-self.optical_density)

    @readout("%")
    def transmission(self) -> float:
        """Share of the light that is let through."""
        return 100.0 * self._transmission


MODULES = (NeutralFilter,)
