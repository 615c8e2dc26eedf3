"""The steps of Reflected Light: radiance of reflectances, in one band or several."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.results import TableData, TableRow
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks, pointwise
from core.evaluation.region import Region
from core.evaluation.work import Work
from core.lineage.linear_change import Linear
from core.lineage.step_lineage import picture_step
from core.modules.caution import Caution
from core.noise.noise_power import NoisePower
from core.physics.atmosphere.sun_and_sky import Sunlight, relative_air_mass
from core.spectrum.band_stack import BandStack, Row, Rows, stacked

Array = NDArray[Any]
_ABOVE_ONE = 1e-6  # by which a reflectance of 1 may be rounded


@dataclass(frozen=True)
class Lit(Linear):
    """Every sample times the radiance of a white surface."""

    white: float

    @property
    def gain(self) -> float:
        """That radiance."""
        return self.white

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        """Multiplied by it."""
        return power.scaled(self.white)


def _lit(image: Recipe, *, white: float) -> Lit:
    return Lit(white)


@picture_step(linear=_lit)
@pointwise
def reflected(work: Work, image: Array, *, white: float) -> Array:
    """Radiance of reflectances; `white` is that of a surface that reflects everything."""
    least = float(image.min())
    if not least >= 0.0:
        raise DataError(f"reflectance: the least of the samples is {least:g}, and has to be 0 to 1")
    return np.multiply(image, work.policy.dtype.type(white), dtype=work.policy.dtype)


@dataclass(frozen=True)
class GreyBands(BandStack):
    """Bands of surfaces that reflect all wavelengths alike.

    Parameters
    ----------
    image : Recipe
        Makes the reflectances.
    white : tuple of float
        Radiance of a white surface in every band, W/m²/sr/µm.
    node : str, optional
        Node an error belongs to.
    """

    image: Recipe
    white: Row
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.image.key, self.white

    def sums(self, weights: Rows) -> Recipe:
        """The picture times a number for each sum."""
        return stacked(tuple(self.picture(row) for row in weights))

    def picture(self, weights: Row) -> Recipe:
        """The picture times a number."""
        return Step.of(
            reflected, self.image, node=self.node, white=float(np.dot(weights, self.white))
        )

    def means(self) -> Recipe:
        """Mean of the picture times that of each band."""
        return Step.of(_means, self.image, node=self.node, white=self.white)

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe:
        """Mean of the samples times the radiance of each band."""
        region = Region(row, column, rows, columns)
        return Step.of(_means_there, self.image, node=self.node, white=self.white, region=region)


@in_blocks()
@ends_lineage
def _means(work: Work, image: Array, *, white: Row) -> Array:
    return np.asarray(float(np.mean(image, dtype=np.float64)) * np.array(white))


@in_blocks()
@ends_lineage
def _means_there(work: Work, image: Array, *, white: Row, region: Region) -> Array:
    return np.asarray(float(np.mean(region.cut(image), dtype=np.float64)) * np.array(white))


@in_blocks()
@ends_lineage
def bright_caution(work: Work, image: Array, *, share: float) -> Caution | None:
    """Reflectances above 1; `share` is what one unit of the samples is of 1."""
    most = float(image.max()) * share
    if most <= 1.0 + _ABOVE_ONE:
        return None
    looks = "; they look like percent" if share == 1.0 and float(np.mean(image)) > 1.0 else ""
    return Caution(
        f"reflectances go up to {most:.4g}, more than a matt surface reflects{looks}",
        "give the unit of the samples on Read Image, % or 1, or a scale",
    )


@ends_lineage
def light_table(work: Work, *, light: Sunlight, band_um: tuple[float, float]) -> TableData:
    """Figures of the light in the band."""
    total = light.over_band(*band_um)
    rows = (
        TableRow("irradiance", total, "W/m²", "sun and sky on a horizontal surface"),
        TableRow("white_radiance", total / math.pi, "W/m²/sr", "of a surface that reflects all"),
        TableRow(
            "air_mass",
            relative_air_mass(elevation_deg=light.elevation_deg),
            "",
            "the sun's way through the air, over that from the zenith",
        ),
    )
    return TableData(rows)
