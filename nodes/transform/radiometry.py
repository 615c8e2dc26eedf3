"""To Radiance and To Temperature: band radiance of temperatures, and the reverse."""

from typing import Any

import numpy as np

from core.arrays import Array
from core.chain.step_lineage import LevelChange, picture_step
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Recipe, Step, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.physics.radiometry import spectra
from nodes.shared.context_defaults import (
    band_warning,
    given_band,
    is_radiance,
    is_temperature,
    watts_factor,
)
from nodes.shared.module_ports import CutOff, CutOn, ImageOutput
from nodes.shared.steps import AboutMean, mean_of

_BLOCK_SAMPLES = 1 << 16

Surface = dict[str, Any]
"""How surfaces radiate: emissivity, unless an image of it comes in, what is reflected, band."""


def radiance_change(
    work: Work, mean: float, *shares: float, unit: str, **surface: Any
) -> LevelChange:
    kelvin = float(spectra.in_kelvin(np.asarray(mean), unit=unit))
    slope = _slope(kelvin, *shares, **surface)
    per_unit = float(np.diff(spectra.in_kelvin(np.array([0.0, 1.0]), unit=unit))[0])
    made = spectra.grey_radiance(temperature_K=kelvin, **_with_share(surface, *shares))
    return LevelChange(slope * per_unit, mean, float(made))


def temperature_change(
    work: Work, mean: float, *shares: float, factor: float, **surface: Any
) -> LevelChange:
    made = spectra.grey_temperature(radiance=mean * factor, **_with_share(surface, *shares))
    kelvin = float(made)
    return LevelChange(factor / _slope(kelvin, *shares, **surface), mean, kelvin)


def _with_share(surface: Surface, *shares: Any) -> Surface:
    return {**surface, "emissivity": shares[0]} if shares else surface


def _slope(kelvin: float, *shares: float, surroundings_K: float | None, **surface: Any) -> float:
    grey = _with_share(surface, *shares)
    return float(spectra.grey_radiance_slope(temperature_K=kelvin, **grey))


def _means(images: tuple[Recipe, ...]) -> tuple[Step, ...]:
    return tuple(Step.of(mean_of, image) for image in images)


@picture_step(
    linear=lambda *images, **how: AboutMean(Step.of(radiance_change, *_means(images), **how))
)
@pointwise
def radiance_of_temperature(
    work: Work, image: Array, *emissivities: Array, unit: str, **surface: Any
) -> Array:
    def convert(samples: Array, how: Surface) -> Array:
        kelvin = spectra.in_kelvin(samples, unit=unit)
        return spectra.grey_radiance(temperature_K=kelvin, **how)

    return _by_rows(work, image, emissivities, surface, convert)


@picture_step(
    linear=lambda *images, **how: AboutMean(Step.of(temperature_change, *_means(images), **how))
)
@pointwise
def temperature_of_radiance(
    work: Work, image: Array, *emissivities: Array, factor: float, **surface: Any
) -> Array:
    """Temperatures, in kelvin, of band radiance; `factor` makes W/m²/sr of it."""

    def convert(samples: Array, how: Surface) -> Array:
        return spectra.grey_temperature(radiance=factor * samples.astype(np.float64), **how)

    return _by_rows(work, image, emissivities, surface, convert)


def _by_rows(
    work: Work, image: Array, emissivities: tuple[Array, ...], surface: Surface, convert: Any
) -> Array:
    made = np.empty(image.shape, work.policy.dtype)
    height = max(1, _BLOCK_SAMPLES // image.shape[1])

    def one(top: int) -> None:
        rows = slice(top, top + height)
        shares = (emissivity[rows] for emissivity in emissivities)
        made[rows] = convert(image[rows], _with_share(surface, *shares))

    work.for_each(one, range(0, image.shape[0], height))
    return made


class Radiometry(Module):
    emissivity: float = param(
        1.0, "emissivity of all samples, if no emissivity image is connected", (0, 1), above=True
    )
    surroundings_K: float | None = param(
        None,
        "temperature of the reflected surroundings; empty: nothing is reflected",
        (0, 1e4),
        slider=(200, 320),
    )
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None

    panel = (
        Section("Surfaces", "emissivity surroundings_K"),
        Section("Band", "cut_on_um cut_off_um"),
    )

    def surface(self, image: Image) -> Surface:
        band = given_band(self.cut_on_um, self.cut_off_um, image.band_um, empty=False)
        names = ("emissivity", "surroundings_K", "cut_on_um", "cut_off_um")
        values = (self.emissivity, self.surroundings_K, *band)
        return dict(zip(names, values, strict=True))

    def shares(self, image: Image, emissivity: Image | None) -> tuple[Recipe, ...]:
        if emissivity is None:
            return ()
        if emissivity.shape != image.shape:
            raise DataError(
                f"the emissivity image has {emissivity.columns} × {emissivity.rows} samples and "
                f"the picture {image.columns} × {image.rows}: both must have the same size"
            )
        return (emissivity.recipe,)

    band = band_warning


class ToRadiance(Radiometry, key="to_radiance", title="To Radiance", group="Transform"):
    """Convert a picture of temperatures to radiance, by Planck's law in the band.

    The radiance is ε·L(T) + (1 − ε)·L(surroundings); without surroundings nothing is reflected. The
    picture's unit, set on Read Image, must be a temperature (K, °C, °F, mK): digital numbers and
    radiance are refused. An image of emissivities can replace the single value. Sources:
    Planck's and Kirchhoff's laws; Holst 2000, Common Sense Approach to Thermal Imaging.
    """

    formulas = (
        Formula(
            r"L=\varepsilon\,L_B(T)+(1-\varepsilon)\,L_B(T_s)",
            where="ε: emissivity; T: temperature of the picture, K; T_s: temperature of the "
            "surroundings",
        ),
        Formula(
            r"L_B(T)=\int_{\lambda_1}^{\lambda_2}\frac{2hc^2}{\lambda^5}\;\frac{d\lambda}{e^{"
            r"hc/(\lambda kT)}-1}",
            where="λ₁, λ₂: the band",
        ),
    )

    def run(self, image: Image, here: NodeContext, emissivity: Image | None = None) -> ImageOutput:
        if not is_temperature(image.unit):
            what = (
                "already one of radiance" if is_radiance(image.unit) else "not one of temperature"
            )
            known = f"the picture's unit, {image.unit!r:.40}, is {what}"
            raise DataError(
                (known if image.unit.strip() else "the picture has no unit")
                + ": To Radiance needs K, °C, °F or mK; set the unit on Read Image"
            )
        surface, unit = self.surface(image), image.unit.strip()
        inputs = image.recipe, *self.shares(image, emissivity)
        made = here.step(radiance_of_temperature, *inputs, unit=unit, **surface)
        band = surface["cut_on_um"], surface["cut_off_um"]
        return ImageOutput(image.with_recipe(made, unit="W/m²/sr", band_um=band))


class ToTemperature(Radiometry, key="to_temperature", title="To Temperature", group="Transform"):
    """Convert a picture of band radiance to temperatures in kelvin.

    This is the inverse of To Radiance: T is the temperature at which Planck's law gives the
    radiance (L − (1 − ε)·L(surroundings))/ε in the band. With an emissivity of 1, the result is the
    apparent, or brightness, temperature. The picture's unit must be band radiance in watts
    (W/m²/sr, mW/cm²/sr, …): temperatures, digital numbers, photons and spectral radiance are
    refused. An image of emissivities can replace the single value. Sources: as for To Radiance.
    """

    formulas = (
        Formula(
            r"T=L_B^{-1}\left(\frac{L-(1-\varepsilon)\,L_B(T_s)}{\varepsilon}\right)",
            where="L: radiance of the picture, W/m²/sr; ε: emissivity; T_s: temperature of the "
            "surroundings; L_B: Planck's law in the band",
        ),
    )

    def run(self, image: Image, here: NodeContext, emissivity: Image | None = None) -> ImageOutput:
        surface = self.surface(image)
        factor = watts_factor(
            image.unit,
            temperature="already a temperature",
            needed="To Temperature needs radiance in W/m²/sr; set the unit on Read Image",
        )
        inputs = image.recipe, *self.shares(image, emissivity)
        made = here.step(temperature_of_radiance, *inputs, factor=factor, **surface)
        band = surface["cut_on_um"], surface["cut_off_um"]
        return ImageOutput(image.with_recipe(made, unit="K", band_um=band))
