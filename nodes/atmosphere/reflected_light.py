"""Reflected Light: what surfaces reflect of sun and sky."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np

from core.chain.wires import Image, Table
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step
from core.modules.caution import Caution
from core.modules.declaration import Module, NodeContext, warning
from core.modules.formula import Formula
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.physics.atmosphere.sun_and_sky import Sunlight
from core.spectrum.band_stack import AttenuatedBands, BandStack
from nodes.atmosphere.reflected_steps import GreyBands, bright_caution, light_table, reflected
from nodes.files.wavelength_table import read_wavelengths
from nodes.shared.common_parameters import CutOff, CutOn
from nodes.shared.shared_warnings import Band, is_radiance, is_temperature
from nodes.shared.table_figures import table_figure

_SHARES = {"": 1.0, "1": 1.0, "-": 1.0, "reflectance": 1.0, "albedo": 1.0, "%": 0.01}
_BRIGHTEST = 1e30  # W/m²/µm


class LightOutputs(NamedTuple):
    """The radiance, and the light."""

    image: Image
    table: Table


class ReflectedLight(Module, key="reflected_light", title="Reflected Light", group="Atmosphere"):
    """Make radiance of a picture of reflectances, lit by sun and sky.

    Matt and horizontal surfaces: L = ρ·(E_sun·e^(−τm)·sin h + π·L_sky)/π, integrated over the band;
    h is the sun's elevation, τ the air's optical depth from the zenith and m the air mass. E_sun is
    a number, a CSV by wavelength, or that of a black body of 5800 K, 1388 W/m² in all. The sky is a
    radiance that is the same all over. The picture's unit has to be one of reflectance (1, %,
    reflectance, albedo), as Read Image has it. A reflectance holds for all wavelengths; with
    `bands` above 1 the radiance comes in as many bands, and a cube of reflectances in its own.
    Atmospheric Path is the way from the surface to the camera. Sources: Lambert 1760; Kasten and
    Young 1989 (air mass); nominal solar radius of the IAU, 2015.
    """

    formulas = (
        Formula(
            r"L=\frac{\rho}{\pi}\left(E_\odot\,e^{-\tau m}\,\sin h+\pi L_{sky}\right)",
            where="ρ: reflectance; E☉: the Sun's irradiance in the band above the air, W/m²; τ: "
            "optical depth from the zenith; m: air mass; h: elevation of the Sun; L_sky: "
            "radiance of the sky, W/m²/sr",
        ),
        Formula(
            r"m=\frac{1}{\sin h+0.50572\,(h+6.07995)^{-1.6364}}",
            where="h in degrees where it stands in the power (Kasten and Young)",
        ),
    )

    solar_irradiance: Annotated[
        float | None,
        Param("sun above the air, facing it; empty: 5800 K", unit="W/m²/µm", low=0, high=1e12,
              slider=(0, 2500)),
    ] = None  # fmt: skip
    path: Annotated[
        Path | None, Param("CSV of µm and W/m²/µm in place of the number, or empty")
    ] = None
    sun_elevation_deg: Annotated[
        float, Param("sun above the horizon", unit="deg", low=0, high=90)
    ] = 45.0
    optical_depth: Annotated[
        float, Param("of the air in the sun's way, from the zenith", low=0, high=1e3, slider=(0, 2))
    ] = 0.0
    sky: Annotated[
        float,
        Param("radiance of the sky", unit="W/m²/sr/µm", low=0, high=1e12, slider=(0, 200)),
    ] = 0.0
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None
    bands: Annotated[
        int, Param("bands in which the radiance comes", low=1, high=10000, slider=(1, 60))
    ] = 1

    panel = (
        Section("Sun", ("solar_irradiance", "path", "sun_elevation_deg", "optical_depth")),
        Section("Sky", ("sky",)),
        Section("Band", ("cut_on_um", "cut_off_um", "bands")),
    )

    def run(self, image: Image, here: NodeContext) -> LightOutputs:
        """Plan the radiance of each sample."""
        share, light, node = _share(image.unit), self._light(here), here.node
        if image.bands is not None:
            made = self._of_cube(image, image.bands, light, share, node)
        else:
            made = self._of_picture(image, self.band_of(image), light, share, node)
        table = Step.of(light_table, node=node, light=light, band_um=made.band_um)
        return LightOutputs(made, Table(table))

    def _of_picture(
        self, image: Image, band: Band, light: Sunlight, share: float, node: str
    ) -> Image:
        """The radiance of surfaces that reflect all wavelengths alike."""
        low, high = band
        if self.bands == 1:
            white = share * light.over_band(low, high) / math.pi
            made: Recipe = Step.of(reflected, image.recipe, node=node, white=white)
            return image.with_recipe(made, unit="W/m²/sr", band_um=band)
        ends = np.linspace(low, high, self.bands + 1).tolist()
        centres = tuple((a + b) / 2.0 for a, b in pairwise(ends))
        widths = (float((high - low) / self.bands),) * self.bands
        stack = GreyBands(
            centres, widths, image.recipe, _white(light, centres, widths, share), node
        )
        made = stack.picture(stack.whole)
        return image.with_recipe(made, unit="W/m²/sr", band_um=band, bands=stack)

    def _of_cube(
        self, image: Image, bands: BandStack, light: Sunlight, share: float, node: str
    ) -> Image:
        """The radiance of a cube of reflectances, in its own bands."""
        centres, widths = bands.centres_um, bands.widths_um
        white = _white(light, centres, widths, share)
        none = (0.0,) * bands.count
        stack = AttenuatedBands(centres, widths, bands, white, none, node, density=True)
        made = stack.picture(stack.whole)
        return image.with_recipe(made, unit="W/m²/sr", band_um=stack.band_um, bands=stack)

    def _light(self, here: NodeContext) -> Sunlight:
        points: tuple[tuple[float, float], ...] = ()
        if self.path is not None:
            path = (here.folder / self.path).absolute()
            points = read_wavelengths(path, what="irradiance", low=0.0, high=_BRIGHTEST)
        return Sunlight(
            elevation_deg=self.sun_elevation_deg,
            irradiance=self.solar_irradiance,
            points=points,
            sky=self.sky,
            optical_depth=self.optical_depth,
        )

    def band_of(self, image: Image) -> Band:
        """The band here, else the image's.

        Raises
        ------
        ParameterError
            If no band is known, or it is empty.
        """
        of_image = image.band_um or (None, None)
        low = of_image[0] if self.cut_on_um is None else self.cut_on_um
        high = of_image[1] if self.cut_off_um is None else self.cut_off_um
        if low is None or high is None:
            name = "cut_on_um" if low is None else "cut_off_um"
            raise ParameterError(
                name, None, "the image does not say its band: give it here", unit="µm"
            )
        if not low < high:
            raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}", unit="µm")
        return low, high

    @warning
    def unused(self, image: Image, given: frozenset[str]) -> Caution | None:
        """A number beside a file, or a band beside those of a cube."""
        if self.path is not None and self.solar_irradiance is not None:
            return Caution(
                f"solar_irradiance = {self.solar_irradiance:g} W/m²/µm is not used: path names a "
                "file of it",
                "leave one of both empty",
            )
        own = sorted({"bands", "cut_on_um", "cut_off_um"} & given)
        own = [name for name in own if getattr(self, name) not in (None, 1)]
        if image.bands is None or not own:
            return None
        return Caution(
            f"{', '.join(own)} is not used: the picture comes in {image.bands.count} bands",
            "choose bands and wavelengths on Read Image",
        )

    @warning
    def brightness(self, image: Image) -> Recipe | None:
        """Reflectances above 1."""
        share = _SHARES.get(image.unit.strip().lower())
        if share is None or image.bands is not None:
            return None
        return Step.of(bright_caution, image.recipe, share=share)

    air_mass = table_figure(
        "air_mass", "", "The sun's way through the air, over that from the zenith."
    )
    irradiance = table_figure(
        "irradiance", "W/m²", "Sun and sky on a horizontal surface in the band."
    )


def _white(
    light: Sunlight, centres: tuple[float, ...], widths: tuple[float, ...], share: float
) -> tuple[float, ...]:
    """Mean radiance of a white surface in every band, W/m²/sr/µm; `share` of it."""
    white = []
    for centre, width in zip(centres, widths, strict=True):
        low, high = centre - width / 2.0, centre + width / 2.0
        mean = light.over_band(low, high) / width if low < high else light.on_surface(centre)
        white.append(share * float(mean) / math.pi)
    return tuple(white)


def _share(unit: str) -> float:
    """What one unit of a picture's samples is of a reflectance of 1."""
    share = _SHARES.get(unit.strip().lower())
    if share is None:
        what = "no reflectance"
        if is_radiance(unit):
            what = "radiance already"
        elif is_temperature(unit):
            what = "a temperature"
        raise DataError(
            f"the picture, in {unit!r:.40}, is {what}: Reflected Light takes 1, %, reflectance or "
            "albedo, the unit on Read Image"
        )
    return share
