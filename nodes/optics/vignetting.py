"""Light that falls off over the field, of the lens (Vignetting) and of pixels (Microlens Angle)."""

import math
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.arrays import Array
from core.chain.noise_power import NoisePower
from core.chain.step_lineage import Linear, picture_step
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.recipes import Region, Seen, Step, by_region
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.physics.optics.field import MOST_DEG, microlens_response, relative_illumination
from core.records import dataclass
from core.transfer.factors import Grid, Law
from nodes.files.curve_tables import read_heights
from nodes.shared.module_ports import ImageOutput
from nodes.shared.steps import stepped

_BRIGHTEST = 2.0  # times the axis: some wide lenses gain a little before they fall
_POINTS = 129
_BLOCK_SAMPLES = 1 << 18
_UNITS = {"field_deg": "deg", "height_mm": "mm", "half_diagonal": "half diagonals"}


class LightOverField(Module):
    """Base class of modules that multiply the picture by a function of the field angle."""

    @property
    def off(self) -> bool:
        raise NotImplementedError

    @readout("%")
    def corner_percent(self, outputs: ImageOutput) -> float:
        """Relative illumination at the corner of the picture."""
        return 100.0 if self.off else 100.0 * float(_profile(*_planned(outputs))[-1])

    @readout("%")
    def mean_percent(self, outputs: ImageOutput) -> float:
        """Mean relative illumination of the picture."""
        return 100.0 if self.off else 100.0 * _means(*_planned(outputs))[0]


class Vignetting(LightOverField, key="vignetting", title="Vignetting", group="Optics"):
    """Darken the picture with distance from the optical axis, which is at the picture's middle.

    `natural` applies cos⁴ of the field angle. The tangent of the angle is the distance from the
    middle in samples times the sampling interval, which is pitch/f for a picture from Camera.
    `measured` applies a measured curve of relative illumination: a CSV of height and value
    (`file`), or 1 + c₁h² + c₂h⁴ + … (`polynomial`). `against` selects the height axis: field angle,
    image height, or fraction of the picture's half diagonal. A lens maker's curve usually includes
    cos⁴; in that case, switch `natural` off. Put the module before Focal Plane, so that shot noise
    follows from the vignetted light. Transfer functions do not change. Signal and SNR use the mean
    over the field; NETD and `scene_K` refer to the scene before the vignetting. For a thermal
    picture with one band, Focal Plane converts radiance to photons at the brightness temperature
    that the picture had before the mean loss. A sample with half the mean light then gets 0.3 % too
    many photons (3.7 to 4.8 µm). This error does not occur with spectral pictures, or if
    `photon_weighting` is not scene. Source: Kingslake 1983, Optical System Design, chapter 6.
    """

    formulas = (
        Formula(
            r"L'=L\,\cos^4\theta\;V(h),\quad\tan\theta=\sqrt{x^2+y^2}",
            where="x, y: tangents of the angles from the picture's middle; V: the measured "
            "curve, or 1 if there is none; h: height in the unit of `against`",
        ),
    )

    natural: bool = param(True, "apply the natural fall-off, cos⁴ of the field angle")
    measured: Literal["none", "file", "polynomial"] = param(
        "none", "measured relative illumination"
    )
    against: Literal["field_deg", "height_mm", "half_diagonal"] = param(
        "field_deg",
        "heights of the curve: field angle, image height, or fraction of the half diagonal",
    )
    path: Path | None = param(None, "CSV file of height and relative illumination, 1 on the axis")
    coefficients: tuple[float, ...] = param((), "c₁, c₂, …: factors of h², h⁴, …", (-1e9, 1e9))
    focal_length_mm: float | None = param(
        None,
        "focal length, used if against is height_mm; empty: from Camera",
        low=0,
        slider=(10, 1000),
    )

    panel = (
        Section("", "natural measured"),
        Section("Curve", "against"),
        Section("", "path", shown_when=("measured", ("file",))),
        Section("", "coefficients", shown_when=("measured", ("polynomial",))),
        Section("", "focal_length_mm", shown_when=("against", ("height_mm",))),
    )

    def check(self) -> None:
        if self.measured == "file" and self.path is None:
            raise ParameterError(
                "path", None, "give a CSV file of height and relative illumination"
            )
        if self.measured == "polynomial" and not self.coefficients:
            raise ParameterError("coefficients", (), "at least one number, such as -0.3")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.off:
            return ImageOutput(image)
        grid, law = image.grid(), self.law(image, here)
        light = _profile(grid, law)
        if not 0.0 <= light.min() <= light.max() <= _BRIGHTEST:
            worst = float(light.min() if light.min() < 0.0 else light.max())
            allowed = (
                f"the relative illumination must stay between 0 and {_BRIGHTEST:g}, but it reaches "
                f"{worst:.3g} in the picture"
            )
            raise ParameterError("coefficients", self.coefficients, allowed)
        return ImageOutput(darkened(image, law, here))

    def law(self, image: Image, here: NodeContext) -> Law:
        bound: dict[str, Any] = {"natural": self.natural, "scale": None}
        if self.measured != "none" and self.against == "half_diagonal":
            bound["scale"] = 1.0 / corner(image.grid())
        elif self.measured != "none" and self.against == "height_mm":
            of_camera = None if image.camera is None else image.camera.focal_length_mm
            bound["scale"] = self.focal_length_mm or of_camera
            if bound["scale"] is None:
                raise ParameterError("focal_length_mm", None, "give a value here or on Camera")
        if self.measured == "polynomial":
            bound["coefficients"] = self.coefficients
        elif self.measured == "file":
            assert self.path is not None
            file, unit = here.folder / self.path, _UNITS[self.against]
            bound["heights"], bound["values"] = curve(file, unit, "relative illumination")
        return Law(relative_illumination, tuple(bound.items()))

    @warning
    def short_table(self, outputs: ImageOutput) -> Caution | None:
        """The curve in the file ends before the corner of the picture."""
        if self.measured != "file":
            return None
        grid, law = _planned(outputs)
        end, bound = corner(grid), dict(law.parameters)
        reached = np.degrees(np.arctan(end)) if bound["scale"] is None else end * bound["scale"]
        last = bound["heights"][-1]
        if reached <= last * (1.0 + 1e-6):
            return None
        unit = _UNITS[self.against]
        return Caution(
            f"the light may be wrong at the corners: the curve in the file ends at {last:.4g} "
            f"{unit}, but the picture reaches {reached:.4g} {unit}; the last value is used there",
            "extend the file to the corner",
        )

    @property
    def off(self) -> bool:
        return not self.natural and self.measured == "none"


def curve(file: Path, unit: str, what: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Heights in the field from 0 on, and the values there."""
    points = read_heights(file, unit=unit, what=what, low=0.0, high=_BRIGHTEST)
    places, values = zip(*points, strict=True)
    if places[0] > 0.0:
        return (0.0, *places), (1.0, *values)
    return places, values


def _planned(outputs: ImageOutput) -> tuple[Grid, Law]:
    assert isinstance(outputs.image.recipe, Step)
    how = dict(outputs.image.recipe.parameters)
    return how["grid"], how["law"]


def corner(grid: Grid) -> float:
    return math.hypot(*_half_sides(grid))


def _half_sides(grid: Grid) -> tuple[float, float]:
    x, y = grid.interval_x_mrad, grid.interval_y_mrad
    return 0.5e-3 * grid.columns * x, 0.5e-3 * grid.rows * y


def _profile(grid: Grid, law: Law) -> Array:
    return law(None, tangent=np.linspace(0.0, corner(grid), _POINTS))


@lru_cache(maxsize=64)
def _means(grid: Grid, law: Law) -> tuple[float, float]:
    """Mean and root mean square over the frame, on at most 129 × 129 places."""
    half_x, half_y = _half_sides(grid)
    x, y = (
        half * (2.0 * np.arange(count) + 1.0 - count) / count
        for half, count in ((half_x, min(grid.columns, _POINTS)), (half_y, min(grid.rows, _POINTS)))
    )
    light = law(None, tangent=np.hypot(x, y[:, np.newaxis]))
    return float(light.mean()), math.sqrt(float(np.square(light).mean()))


def darkened(image: Image, law: Law, here: NodeContext) -> Image:
    """The picture times a law of the tangent of the field angle."""
    grid = image.grid()
    step, mean = here.step(lit, image.recipe, grid=grid, law=law), _means(grid, law)[0]
    return stepped(image, step, gain=mean, vignetting=image.vignetting * mean)


@dataclass(frozen=True)
class Vignetted(Linear):
    """The mean over the field of what a place gets; the contrast of a place stays."""

    grid: Grid
    law: Law

    @property
    def gain(self) -> float:
        return _means(self.grid, self.law)[0]

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        return power.scaled(_means(self.grid, self.law)[1])


@picture_step(linear=lambda _, **how: Vignetted(**how))
@by_region(lambda image, **_: image.shape)
def lit(work: Work, region: Region, image: Seen, *, grid: Grid, law: Law) -> Array:
    samples = image(region)
    made = np.empty(samples.shape, samples.dtype)
    x, y = (
        1e-3 * interval * (np.arange(first, last) - 0.5 * (size - 1))
        for interval, first, last, size in (
            (grid.interval_x_mrad, region.left, region.right, grid.columns),
            (grid.interval_y_mrad, region.top, region.bottom, grid.rows),
        )
    )

    def block(top: int) -> None:
        rows = slice(top, top + step)
        tangent = np.sqrt(np.square(x) + np.square(y[rows, np.newaxis]))
        light = law(None, tangent=tangent)
        np.multiply(samples[rows], light.astype(samples.dtype), out=made[rows])

    step = max(1, _BLOCK_SAMPLES // region.columns)
    work.for_each(block, range(0, region.rows, step))
    return made


class MicrolensAngle(LightOverField, key="microlens", title="Microlens Angle", group="Detector"):
    """Darken the picture where the chief ray angle differs from the microlenses' design angle.

    The detector's data sheet gives the chief ray angle (CRA) for which the microlenses at the
    corner are designed. The lens's data sheet gives the CRA of the lens. If the CRAs of lens and
    microlenses are equal, the picture does not change. A difference lowers the response: to half at
    `half_response_deg` or, if `response` is file, according to a measured curve. The optical axis
    is at the middle of the picture, and the corner angles apply at the picture's corners. Only the
    chief ray counts: the response is not averaged over the cone of a fast lens. Put this module
    before Focal Plane, which then computes the shot noise of the darkened picture. Signal and SNR
    use the mean response over the field; transfer functions do not change. Source: Catrysse and
    Wandell 2002, J. Opt. Soc. Am. A 19, 1610.
    """

    formulas = (
        Formula(
            r"L'=L\,R(\delta),\quad\delta=\left|\arctan(h\tan\alpha)-\arctan(h\tan\alpha_m)\right|",
            where="h: distance from the middle, 1 at the corner; α: chief_ray_deg; α_m: "
            "matched_deg; R = 2^(−(δ/δ_half)²), or the file's curve if response is file",
        ),
    )

    chief_ray_deg: float = param(
        0.0,
        "chief ray angle of the lens at the corner",
        (-MOST_DEG, MOST_DEG),
        unit="deg",
        slider=(-40, 40),
    )
    matched_deg: float = param(
        0.0,
        "chief ray angle that the microlenses at the corner are designed for",
        (-MOST_DEG, MOST_DEG),
        unit="deg",
        slider=(-40, 40),
    )
    response: Literal["half_angle", "file"] = param(
        "half_angle",
        "response versus angle: computed from half_response_deg, or a measured curve from a file",
    )
    half_response_deg: float = param(
        20.0,
        "angle difference at which the response falls to half",
        (0.1, 90),
        unit="deg",
        slider=(5, 45),
    )
    path: Path | None = param(
        None, "CSV file of angle difference (°) and response, which is 1 at 0°"
    )

    panel = (
        Section("Chief ray at the corner", "chief_ray_deg matched_deg"),
        Section("Response", "response"),
        Section("", "half_response_deg", shown_when=("response", ("half_angle",))),
        Section("", "path", shown_when=("response", ("file",))),
    )

    def check(self) -> None:
        if self.response == "file" and self.path is None:
            raise ParameterError("path", None, "give a CSV file of angle difference and response")

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.off:
            return ImageOutput(image)
        return ImageOutput(darkened(image, self._law(image, here), here))

    def _law(self, image: Image, here: NodeContext) -> Law:
        bound: dict[str, Any] = {
            "corner": corner(image.grid()),
            "chief_ray_deg": self.chief_ray_deg,
            "matched_deg": self.matched_deg,
        }
        if self.response == "half_angle":
            bound["half_response_deg"] = self.half_response_deg
        else:
            assert self.path is not None
            bound["angles"], bound["values"] = curve(here.folder / self.path, "deg", "response")
        return Law.of(microlens_response, **bound)

    @property
    def off(self) -> bool:
        return self.chief_ray_deg == self.matched_deg
