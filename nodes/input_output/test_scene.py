"""Test Scene: radiometric targets and the built-in dormitory."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.band_stack import BandStack, Row
from core.chain.step_lineage import source_step
from core.chain.wires import Header, Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Formula, NodeContext, Section, param
from core.records import dataclass, field, replace
from nodes.files.picture_info import oversized
from nodes.input_output.sample_unit import DEFAULT_UNIT
from nodes.scenes import draw
from nodes.scenes.draw import DRAWN, GEOMETRY, Emissivity, Kind, Shares, Spectra
from nodes.scenes.scene_canvas import Canvas
from nodes.shared.context_defaults import interval_of
from nodes.shared.module_ports import ImageOutput, PicturePreview

Named = dict[str, Any]  # values of parameters
DRAWING = ("kind", "width", "height", "angle_deg", "frequency")
SOURCES = ("cut_on_um", "cut_off_um", "temperature_K", "delta_K")


class TestScene(PicturePreview, key="test_scene", title="Test Scene", group="Input and output"):
    """Draw a radiometric test scene.

    Planck's law converts temperatures and emissivities to band radiance. Edges are area-sampled, so
    they do not alias. The dormitory is a building front with windows, warm and cool areas, sky and
    ground. The airfield is seen from above and has straight roads, for use with Camera Geometry.

    `bands` divides the scene's band into spectral bands of equal width. Optics and atmosphere treat
    each spectral band at its own wavelength until a detector sums the bands. With `bands` above 0,
    surfaces have the spectra of grass, leaves, soil, water, asphalt, concrete, brick, paint and
    glass, coarsely sampled. Surfaces emit at their own temperature and reflect the sky. With
    `sun_elevation_deg`, surfaces also reflect sunlight, which lights scenes from 0.4 to 2.5 µm.
    Targets and their backgrounds are black bodies in all bands. With `emissivity` grey, every
    surface keeps a single emissivity; without sunlight, the bands then add up to the picture for
    `bands` = 0. If `quantity` is reflectance, the samples are surface reflectances, as input for
    Reflected Light. Shade and sky get the reflectance of a sunlit surface of the same brightness.
    If `quantity` is reflectance, targets have `target_reflectance` and their background has
    `background_reflectance`, at all wavelengths.
    """

    formulas = (
        Formula(
            r"L=\varepsilon\int_{\lambda_1}^{\lambda_2}\frac{2hc^2}{\lambda^5}\;\frac{d\lambda}{"
            r"e^{hc/(\lambda kT)}-1}",
            where="L: radiance of a sample, W/m²/sr; ε, T: emissivity and temperature of its "
            "surface, K; λ₁, λ₂: cut_on_um and cut_off_um; h, c, k: physical constants",
            when="emitted light",
        ),
        Formula(
            r"L=\overline{\rho}\;\frac{\Omega_\odot}{\pi}\,L_B(5800\,\mathrm{K})\,\sin h",
            where="ρ: reflectance; Ω☉/π: square of the ratio of the Sun's radius to its distance; "
            "L_B: radiance of a black body in the band; h: sun_elevation_deg",
            when="sunlight, if the scene has bands",
        ),
    )

    __test__ = False  # not a test class, whatever its name says

    kind: Kind = param("dormitory", "what to draw")
    width: int = param(512, "samples per row", (1, 65536), slider=(16, 2048))
    height: int = param(512, "samples per column", (1, 65536), slider=(16, 2048))
    fov_x_deg: float | None = param(30.0, "horizontal field of view", (0, 180), below=True)
    fov_y_deg: float | None = param(30.0, "vertical field of view", (0, 180), below=True)
    cut_on_um: float = param(8.0, "shortest wavelength", low=0, above=True)
    cut_off_um: float = param(12.0, "longest wavelength", low=0, above=True)
    bands: int = param(
        0, "number of spectral bands of equal width; 0: a single band", (0, 4096), slider=(0, 64)
    )
    emissivity: Emissivity = param(
        "spectra",
        "emissivity of the surfaces if bands is above 0: spectra of the materials, or grey",
    )
    quantity: Literal["radiance", "reflectance"] = param(
        "radiance", "quantity of the samples: radiance, or reflectance for Reflected Light"
    )
    background_reflectance: float = param(
        0.07, "reflectance of a target's background, used if quantity is reflectance", (0, 1)
    )
    target_reflectance: float = param(
        0.15, "reflectance of a target, used if quantity is reflectance", (0, 1)
    )
    sun_elevation_deg: float = param(
        0.0, "elevation of the sun (0: no sun), used if bands is above 0", (0, 90)
    )
    temperature_K: float = param(
        303.15, "background temperature", low=0, above=True, slider=(200, 400)
    )
    delta_K: float = param(
        10.0, "target temperature minus background temperature", slider=(-50, 50)
    )
    angle_deg: float = param(
        5.0,
        "direction of the edge's normal or of the sine wave, clockwise from horizontal",
        slider=(-90, 90),
    )
    frequency: float = param(
        16.0,
        "cycles per frame width (sine) or per shorter side (coarsest bars); number of spokes "
        "(star)",
        low=0,
        above=True,
    )

    panel = (
        Section("Scene", "kind width height"),
        Section("Samples", "quantity"),
        Section(
            "Reflectances of a target",
            "background_reflectance target_reflectance",
            shown_when=("quantity", ("reflectance",)),
        ),
        Section("Temperatures", "temperature_K delta_K"),
        Section("Pattern", "angle_deg", shown_when=("kind", ("slanted_edge", "sine"))),
        Section("", "frequency", shown_when=("kind", ("four_bar", "siemens_star", "sine"))),
        Section("Field of view", "fov_x_deg fov_y_deg"),
        Section("Band", "cut_on_um cut_off_um bands"),
        Section(
            "Spectral bands",
            "emissivity sun_elevation_deg",
            shown_when=("kind", ("dormitory", "airfield")),
        ),
    )

    def check(self) -> None:
        if self.cut_on_um >= self.cut_off_um:
            allowed = f"above cut_on_um = {self.cut_on_um:g}"
            raise ParameterError("cut_off_um", self.cut_off_um, allowed)
        if self.temperature_K + self.delta_K <= 0:
            allowed = f"above −temperature_K = −{self.temperature_K:g}"
            raise ParameterError("delta_K", self.delta_K, allowed)
        if self.quantity == "reflectance" and self.kind in DRAWN and not self.bands:
            allowed = f"1 or more for the {self.kind} if quantity = reflectance"
            raise ParameterError("bands", 0, allowed)

    def run(self, here: NodeContext) -> ImageOutput:
        x, y = self.fov_x_deg, self.fov_y_deg
        shares: tuple[Step, ...] = ()
        drawing = self._named(*DRAWING)
        if draw.in_two_steps(kind=self.kind, width=self.width, height=self.height):
            placed = self._named("kind", "width", "height", *GEOMETRY[self.kind])
            shares, drawing = (here.step(shares_drawn, **placed),), {"kind": self.kind}
        sources = self._named(*SOURCES) | self._reflectances()
        stack: SceneBands | None = None
        recipe: Recipe = here.step(drawn, *shares, **drawing, **sources)
        if self.bands:
            stack = self._stack(shares, drawing, sources, here)
            recipe = stack.picture(stack.whole)
        return ImageOutput(
            Image(
                recipe,
                self.height,
                self.width,
                interval_of("fov_x_deg", x, self.width),
                interval_of("fov_y_deg", y, self.height),
                unit="1" if self.quantity == "reflectance" else DEFAULT_UNIT,
                band_um=(self.cut_on_um, self.cut_off_um),
                header=Header(fov_x_deg=x, fov_y_deg=y),
                bands=stack,
            )
        )

    def _stack(
        self, shares: tuple[Step, ...], drawing: Named, sources: Named, here: NodeContext
    ) -> SceneBands:
        how = sources | self._named("bands", "emissivity", "sun_elevation_deg", "quantity")
        ends = {"cut_on_um": self.cut_on_um, "cut_off_um": self.cut_off_um}
        edges = draw.band_edges(**ends, bands=self.bands)
        return SceneBands(
            tuple(((edges[1:] + edges[:-1]) / 2.0).tolist()),
            tuple(np.diff(edges).tolist()),
            here.step(spectra_made, kind=self.kind, **how),
            shares,
            tuple(sorted(drawing.items())),
            here.node,
            density=self.quantity == "radiance",
        )

    def _reflectances(self) -> Named:
        """Levels of a target in reflectance; none in radiance, and of surfaces with spectra."""
        if self.quantity == "radiance" or self.kind in DRAWN:
            return {}
        return {"reflectances": (self.background_reflectance, self.target_reflectance)}

    def _named(self, *names: str) -> Named:
        values = self.values()
        return {name: values[name] for name in names}


def _canvas(work: Work, width: int, height: int, **how: Any) -> Canvas:
    """Of the evaluation's precision; refused where the machine has no room, as a file's picture."""
    on_disk = work.blocks is not None and work.blocks.disk.wants((height, width), work.policy.dtype)
    reason = "" if on_disk else oversized(height, width, np.dtype(work.policy.dtype))
    if reason:
        raise DataError(f"height × width: {reason}")
    return replace(Canvas(width, height, work.policy.dtype, work.for_each), **how)


def _pictured(
    work: Work,
    shares: tuple[Shares, ...],
    radiances: Mapping[str, float],
    *,
    width: int = 0,
    height: int = 0,
    **drawing: Any,
) -> NDArray[np.floating]:
    """By the shares of all surfaces, where these are known, else drawn at once."""
    if shares:
        return draw.show_radiances(shares[0], radiances)
    canvas = _canvas(work, width, height, empty=work.empty)
    return draw.draw_radiances(radiances, canvas, **drawing)


@in_blocks()  # a scene that is drawn in two steps is small
@source_step(area_means=True)
def drawn(work: Work, *shares: Shares, **values: Any) -> NDArray[np.floating]:
    places = {name: values.pop(name) for name in DRAWING if name in values}
    radiances = draw.scene_radiances(kind=places["kind"], **values)
    return _pictured(work, shares, radiances, **places)


def shares_drawn(work: Work, *, kind: str, width: int, height: int, **geometry: float) -> Shares:
    return draw.draw_shares(kind, _canvas(work, width, height), **geometry)


Parameters = tuple[tuple[str, Any], ...]


@dataclass(frozen=True)
class SceneBands(BandStack):
    """Bands of a test scene by their `spectra`; drawn anew for each sum where no `shares` are."""

    spectra: Recipe
    shares: tuple[Recipe, ...]
    drawing: Parameters
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.spectra.key, *(shares.key for shares in self.shares), self.drawing

    def picture(self, weights: Row) -> Recipe:
        how = {"weights": tuple(map(float, weights)), **dict(self.drawing)}
        return Step.of(sum_drawn, self.spectra, *self.shares, node=self.node, **how)

    def means(self) -> Recipe:
        how = dict(self.drawing)
        return Step.of(means_drawn, self.spectra, *self.shares, node=self.node, **how)


def spectra_made(_: Work, **values: Any) -> Spectra:
    return draw.scene_spectra(**values)


@in_blocks()  # small, too
@source_step(area_means=True)
def sum_drawn(
    work: Work, spectra: Spectra, *shares: Shares, weights: Row, **drawing: Any
) -> NDArray[np.floating]:
    return _pictured(work, shares, draw.weighted(spectra, weights), **drawing)


def means_drawn(
    work: Work, spectra: Spectra, *shares: Shares, width: int = 0, height: int = 0, **drawing: Any
) -> NDArray[np.float64]:
    if shares:
        return draw.shown_means(shares[0], spectra)
    canvas = _canvas(work, width, height, dtype=np.float64)
    return draw.drawn_means(spectra, canvas, **drawing)
