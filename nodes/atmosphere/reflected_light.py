"""Reflected Light: what surfaces reflect of sun and sky."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.arrays import Array
from core.chain.band_stack import AttenuatedBands, BandStack, Row
from core.chain.step_lineage import picture_step
from core.chain.wires import Image, Table, TableData
from core.errors import DataError
from core.evaluation.recipes import Recipe, Region, Step, in_blocks, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, Module, NodeContext, Section, param, warning
from core.physics.atmosphere.air_path import Sunlight, relative_air_mass
from core.records import dataclass, field
from nodes.files.curve_tables import read_wavelengths
from nodes.shared.context_defaults import Band, given_band, is_radiance, is_temperature
from nodes.shared.module_ports import CutOff, CutOn, PictureTable, TableFigures
from nodes.shared.steps import Scaled

_SHARES = {"": 1.0, "1": 1.0, "-": 1.0, "reflectance": 1.0, "albedo": 1.0, "%": 0.01}
_BRIGHTEST = 1e30  # W/m²/µm
_MOONLIT_LUX = 0.005  # below it there is starlight alone
_AIRGLOW_UM = 0.8  # beyond it the night sky is brighter than the stars


class ReflectedLight(Module, key="reflected_light", title="Reflected Light", group="Atmosphere"):
    """Convert a picture of reflectances to radiance under sun and sky.

    For horizontal Lambertian surfaces: L = ρ·(E_sun·e^(−τm)·sin h + π·L_sky)/π, integrated over the
    band. h is the sun's elevation, τ the zenith optical depth of the air, and m the air mass. E_sun
    is the standard solar spectrum (ASTM G173, extended beyond 4 µm by a black body) or a black body
    of 5800 K (1388 W/m² in total, 16 % too low at 1.6 µm), as set by `sun`. The number in
    `solar_irradiance` or the CSV file in `path` replaces this spectrum.
    The sky has the same radiance in all directions. The picture's unit, set on Read Image, must be
    1, %, reflectance or albedo. A picture with one band has the same reflectance at all
    wavelengths. With `bands` above 1, the radiance has that many bands; a cube of reflectances
    keeps its own bands. Add Atmospheric Path for the path from the surface to the camera.

    `illuminance_lux` scales sun and sky to give this illuminance on the ground: 100 000 lx in
    sunlight, 1000 under an overcast sky, 0.1 at full moon, 0.01 at quarter moon, 0.001 in
    starlight. Scaling does not change the shape of the spectrum. Moonlight has nearly the spectrum
    of sunlight. Starlight does not: airglow makes the night sky a thousand times brighter at 1.6 µm
    than at 0.4 µm. For starlight, give the spectrum of the night sky in `path`.

    Sources: Lambert 1760; Kasten and Young 1989 (air mass); ASTM G173-03 (Gueymard 2004, Solar
    Energy 76, 423); nominal solar radius of the IAU, 2015 (black body); CIE 018:2019, V(λ); RCA
    1974, Electro-Optics Handbook (illuminance); Ellis et al. 2011 (airglow).
    """

    formulas = (
        Formula(
            r"L=\frac{\rho}{\pi}\left(E_\odot\,e^{-\tau m}\,\sin h+\pi L_{sky}\right)",
            where="ρ: reflectance; E☉: solar irradiance in the band above the atmosphere, W/m²; τ: "
            "zenith optical depth; m: air mass; h: elevation of the Sun; L_sky: "
            "radiance of the sky, W/m²/sr",
        ),
        Formula(
            r"m=\frac{1}{\sin h+0.50572\,(h+6.07995)^{-1.6364}}",
            where="h in degrees in the power term (Kasten and Young)",
        ),
        Formula(
            r"L'=L\;\frac{E_v}{683\int V(\lambda)\,E(\lambda)\,d\lambda}",
            where="E_v: illuminance_lux; V: photopic luminous efficiency; E: irradiance "
            "on the ground, W/m²/µm",
            when="illuminance_lux is given",
        ),
    )

    sun: Literal["standard", "black_body"] = param(
        "standard",
        "solar spectrum above the atmosphere: the standard ASTM G173, or a black body of 5800 K",
    )
    solar_irradiance: float | None = param(
        None,
        "solar irradiance above the atmosphere at normal incidence, used instead of the spectrum; "
        "empty: from `sun`",
        (0, 1e12),
        unit="W/m²/µm",
        slider=(0, 2500),
        zero_is_empty=False,
    )
    path: Path | None = param(
        None,
        "CSV of wavelength (µm) and solar irradiance (W/m²/µm), used instead of "
        "`sun` and solar_irradiance; empty: no file",
    )
    sun_elevation_deg: float = param(45.0, "elevation of the sun above the horizon", (0, 90))
    optical_depth: float = param(
        0.0, "zenith optical depth of the air, for sunlight", (0, 1e3), slider=(0, 2)
    )
    sky: float = param(
        0.0,
        "spectral radiance of the sky, equal in all directions",
        (0, 1e12),
        unit="W/m²/sr/µm",
        slider=(0, 200),
    )
    illuminance_lux: float | None = param(
        None,
        "illuminance on the ground to which sun and sky are scaled; empty: no scaling",
        (0, 1e9),
        above=True,
        slider=(0.001, 100000),
        zero_is_empty=False,
    )
    cut_on_um: CutOn = None
    cut_off_um: CutOff = None
    bands: int = param(
        1, "number of bands into which the radiance is divided", (1, 10000), slider=(1, 60)
    )

    panel = (
        Section("Sun", "sun solar_irradiance path sun_elevation_deg optical_depth"),
        Section("Sky", "sky"),
        Section("Illuminance", "illuminance_lux"),
        Section("Band", "cut_on_um cut_off_um bands"),
    )

    def run(self, image: Image, here: NodeContext) -> PictureTable:
        share, light = _share(image.unit), self._light(here)
        if image.bands is not None:
            made = self._of_cube(image, image.bands, light, share, here)
        else:
            band = given_band(self.cut_on_um, self.cut_off_um, image.band_um, empty=False)
            made = self._of_picture(image, band, light, share, here)
        table = here.step(light_table, light=light, band_um=made.band_um)
        return PictureTable(made, Table(table))

    def _of_picture(
        self, image: Image, band: Band, light: Sunlight, share: float, here: NodeContext
    ) -> Image:
        low, high = band
        if self.bands == 1:
            white = share * light.over_band(low, high) / math.pi
            made: Recipe = here.step(reflected, image.recipe, white=white, reflectance=share)
            return image.with_recipe(made, unit="W/m²/sr", band_um=band)
        ends = np.linspace(low, high, self.bands + 1).tolist()
        centres = tuple((a + b) / 2.0 for a, b in pairwise(ends))
        widths = (float((high - low) / self.bands),) * self.bands
        white_of = _white(light, centres, widths, share)
        stack = GreyBands(centres, widths, image.recipe, white_of, share, here.node)
        made = stack.picture(stack.whole)
        return image.with_recipe(made, unit="W/m²/sr", band_um=band, bands=stack)

    def _of_cube(
        self, image: Image, bands: BandStack, light: Sunlight, share: float, here: NodeContext
    ) -> Image:
        centres, widths = bands.centres_um, bands.widths_um
        white = _white(light, centres, widths, share)
        none = (0.0,) * bands.count
        stack = AttenuatedBands(centres, widths, bands, white, none, here.node, density=True)
        made = stack.picture(stack.whole)
        return image.with_recipe(made, unit="W/m²/sr", band_um=stack.band_um, bands=stack)

    def _light(self, here: NodeContext) -> Sunlight:
        points: tuple[tuple[float, float], ...] = ()
        if self.path is not None:
            path = here.folder / self.path
            points = read_wavelengths(path, what="irradiance", low=0.0, high=_BRIGHTEST)
        return Sunlight(
            elevation_deg=self.sun_elevation_deg,
            irradiance=self.solar_irradiance,
            points=points,
            standard=self.sun == "standard",
            sky=self.sky,
            optical_depth=self.optical_depth,
            illuminance_lux=self.illuminance_lux,
        )

    @warning
    def unused(self, image: Image, given: frozenset[str]) -> Caution | None:
        """A parameter has no effect: the file or the cube's own bands are used instead."""
        if self.path is not None and self.solar_irradiance is not None:
            return Caution(
                f"solar_irradiance = {self.solar_irradiance:g} W/m²/µm is not used: the "
                "irradiance comes from the file in path",
                "leave solar_irradiance or path empty",
            )
        own = sorted({"bands", "cut_on_um", "cut_off_um"} & given)
        own = [name for name in own if getattr(self, name) not in (None, 1)]
        if image.bands is None or not own:
            return None
        return Caution(
            f"the picture already has {image.bands.count} bands, which replace {', '.join(own)}",
            "choose bands and wavelengths on Read Image",
        )

    @warning
    def starlight(self, outputs: PictureTable) -> Caution | None:
        """The illuminance is as low as in starlight, but the spectrum is sunlight's."""
        lux, band = self.illuminance_lux, outputs.image.band_um
        if lux is None or lux >= _MOONLIT_LUX or self.path is not None:
            return None
        if band is None or band[1] <= _AIRGLOW_UM:
            return None
        return Caution(
            f"the simulated light beyond {_AIRGLOW_UM:g} µm is too weak, because at {lux:g} lx "
            "(starlight) airglow is stronger there than scaled sunlight",
            "give a spectrum of the night sky as path",
        )

    @warning
    def brightness(self, image: Image) -> Recipe | None:
        """Some reflectances are above 1."""
        share = _SHARES.get(image.unit.strip().lower())
        if share is None or image.bands is not None:
            return None
        return Step.of(bright_caution, image.recipe, share=share)

    figures = TableFigures(
        ("air_mass", "", "Air mass: the Sun's path through the air, relative to a vertical path."),
        (
            "irradiance",
            "W/m²",
            "Irradiance from sun and sky on a horizontal surface, within the band.",
        ),
        ("illuminance", "lx", "Illuminance on a horizontal surface."),
    )


def _white(light: Sunlight, centres: Row, widths: Row, share: float) -> Row:
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
        what = "a temperature" if is_temperature(unit) else "not a reflectance"
        what = "already radiance" if is_radiance(unit) else what
        raise DataError(
            f"the picture, in {unit!r:.40}, is {what}: Reflected Light needs a reflectance; set "
            "the unit on Read Image to 1, %, reflectance or albedo"
        )
    return share


_ABOVE_ONE = 1e-6  # by which a reflectance of 1 may be rounded


@picture_step(linear=lambda _, white, reflectance: Scaled(white, reflectance))
@pointwise
def reflected(work: Work, image: Array, *, white: float, reflectance: float) -> Array:
    """Radiance of reflectances; `white` is that of a sample of 1, whose reflectance is told."""
    least = float(image.min())
    if not least >= 0.0:
        raise DataError(
            f"reflectance: the smallest sample is {least:g}; samples must not be negative"
        )
    return np.multiply(image, work.policy.dtype.type(white), dtype=work.policy.dtype)


@dataclass(frozen=True)
class GreyBands(BandStack):
    """Bands of grey surfaces: `reflectance` of a sample of 1, `white` its W/m²/sr/µm in each."""

    image: Recipe
    white: Row
    reflectance: float
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.image.key, self.white, self.reflectance

    def picture(self, weights: Row) -> Recipe:
        how: Any = {"white": float(np.dot(weights, self.white)), "reflectance": self.reflectance}
        return Step.of(reflected, self.image, node=self.node, **how)

    def means(self) -> Recipe:
        return Step.of(_means, self.image, node=self.node, white=self.white)

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe:
        region = Region(row, column, rows, columns)
        return Step.of(_means, self.image, node=self.node, white=self.white, region=region)


@in_blocks()
def _means(work: Work, image: Array, *, white: Row, region: Region | None = None) -> Array:
    samples = image if region is None else region.cut(image)
    return np.asarray(float(np.mean(samples, dtype=np.float64)) * np.array(white))


@in_blocks()
def bright_caution(work: Work, image: Array, *, share: float) -> Caution | None:
    """Reflectances above 1; `share` is what one unit of the samples is of 1."""
    most = float(image.max()) * share
    if most <= 1.0 + _ABOVE_ONE:
        return None
    looks = "; they look like percentages" if share == 1.0 and float(np.mean(image)) > 1.0 else ""
    return Caution(
        f"samples reach a reflectance of {most:.4g}, but a matt surface reflects at most 1{looks}",
        "on Read Image, set the unit of the samples (% or 1) or a scale",
    )


def light_table(work: Work, *, light: Sunlight, band_um: tuple[float, float]) -> TableData:
    total = light.over_band(*band_um)
    lux = light.unscaled_lux if light.illuminance_lux is None else light.illuminance_lux
    return ReflectedLight.figures.table(
        ("irradiance", total),
        ("white_radiance", total / math.pi, "W/m²/sr", "radiance of a surface of reflectance 1"),
        ("illuminance", lux),
        ("air_mass", relative_air_mass(elevation_deg=light.elevation_deg)),
    )
