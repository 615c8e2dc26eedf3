"""Init & Trans, the sensor's geometry and the image's magnitude and phase; and Back Transform."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from core.chain.back_transformed import back_transform
from core.chain.engine import PlannedNode
from core.chain.wires import CameraSheet, Context, Image, Magnitude, Phase, Platform
from core.errors import ParameterError
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.modules.preview import Axis, Colour, Curve, Plot, Preview, Style, brief, pair
from core.physics.sampling.detector_sampling import ifov_mrad
from core.records import replace
from core.transfer.factors import Edges, Grid
from nodes.shared.context_defaults import apart, interval_of
from nodes.shared.module_ports import ImageOutput


class InitOutputs(NamedTuple):
    context: Context
    magnitude: Magnitude
    phase: Phase


class InitTrans(
    Module, key="init_trans", title="Init & Trans", explained="Fourier transform", group="Transform"
):
    """Transform the image to magnitude and phase, and pass the geometry to the other modules.

    Empty parameters take their values from a Camera before this module, otherwise from the image's
    header. A fill factor of 1 is treated as empty. Values entered here take priority; a warning
    reports any difference. Source: Tantalo 1996, section 4.1.
    """

    formulas = (
        Formula(
            r"\Delta=\frac{\mathrm{FOV}}{N},\quad f_N=\frac{1}{2\Delta},\quad\delta f=\frac{1}{"
            r"N\Delta}",
            where="Δ: sampling interval, mrad; FOV: field of view; N: samples per row or "
            "column; f_N: Nyquist frequency; δf: frequency interval, cycles/mrad",
        ),
        Formula(
            r"\mathrm{IFOV}=\frac{p\,\varphi}{f},\quad\mathrm{oversampling}=\frac{p}{f\,\Delta}",
            where="p: detector_x_um or detector_y_um; φ: fill factor; f: focal_length_mm; "
            "µm/mm is mrad",
        ),
        Formula(
            r"\mathcal{F}(\xi,\eta)=\sum_{x,y}L(x,y)\,e^{-2\pi i(\xi x+\eta y)}",
            where="magnitude and phase are the modulus and argument of the transform",
        ),
    )

    detector_x_um: float | None = param(None, "horizontal detector pitch", low=0, slider=(1, 1000))
    detector_y_um: float | None = param(None, "vertical detector pitch", low=0, slider=(1, 1000))
    focal_length_mm: float | None = param(None, "effective focal length", low=0, slider=(10, 1000))
    f_number: float | None = param(None, "F-number", low=0, slider=(0.5, 32))
    obscuration_ratio: float | None = param(
        None,
        "obscuration: inner diameter of the aperture divided by its outer diameter; "
        "empty: from Camera, or no obscuration",
        (0, 1),
        below=True,
        slider=(0, 0.6),
    )
    range_m: float | None = param(
        None, "altitude, or distance to the scene", low=0, slider=(10, 10000)
    )
    fill_x: float | None = param(1.0, "horizontal fill factor; empty: 1", (0, 1))
    fill_y: float | None = param(1.0, "vertical fill factor; empty: 1", (0, 1))
    fov_x_deg: float | None = param(None, "horizontal field of view", (0, 180), below=True)
    fov_y_deg: float | None = param(None, "vertical field of view", (0, 180), below=True)
    platform: Platform = param(
        "line",
        "how the detectors collect the picture: line scanner, pushbroom line or staring array",
    )
    velocity_m_per_s: float = param(
        0.0,
        "velocity of the platform or object; 0: from Camera's orbit; without an orbit, no motion",
        slider=(0, 300),
    )
    scan_velocity_mrad_per_s: float = param(0.0, "scan velocity", low=0, slider=(0, 1e5))
    edges: Edges = param(
        "reflect",
        "how the frame continues beyond its edges: mirrored, or repeated as in a plain FFT",
    )

    preview_lines = 12.0
    panel = (
        Section(
            "Detector and optics",
            "detector_x_um detector_y_um focal_length_mm f_number range_m fill_x "
            "fill_y obscuration_ratio",
        ),
        Section("Field of view", "fov_x_deg fov_y_deg"),
        Section("Collection", "platform velocity_m_per_s scan_velocity_mrad_per_s"),
        Section("Fourier transform", "edges"),
    )

    def run(self, image: Image) -> InitOutputs:
        grid = Grid(
            image.rows,
            image.columns,
            self._interval("fov_x_deg", image.columns, image.interval_x_mrad),
            self._interval("fov_y_deg", image.rows, image.interval_y_mrad),
        )
        camera = image.camera or CameraSheet()
        orbit = camera.orbit
        own_optics = self.focal_length_mm is not None or self.f_number is not None
        context = Context(
            grid=grid,
            edges=self.edges,
            platform=self.platform,
            detector_x_um=self.detector_x_um or camera.pitch_x_um,
            detector_y_um=self.detector_y_um or camera.pitch_y_um,
            focal_length_mm=self.focal_length_mm
            or camera.focal_length_mm
            or image.header.focal_length_mm,
            f_number=self.f_number or camera.f_number,
            range_m=self.range_m or camera.range_m,
            fill_x=_fill(self.fill_x, camera.fill_x),
            fill_y=_fill(self.fill_y, camera.fill_y),
            velocity_m_per_s=self.velocity_m_per_s or (orbit.velocity_m_per_s if orbit else 0.0),
            scan_velocity_mrad_per_s=self.scan_velocity_mrad_per_s,
            band_um=image.band_um,
            aperture_mm=None if own_optics else camera.aperture_mm,
            obscuration_ratio=self.obscuration_ratio or camera.obscuration_ratio,
            t_number=camera.t_number,
            irradiance=camera.irradiance,
            elevation_deg=orbit.elevation_deg if orbit else None,
        )
        x, y = (
            ifov_mrad(pitch_um=pitch, focal_length_mm=context.focal_length_mm)
            if pitch is not None and context.focal_length_mm is not None
            else None
            for pitch in (context.detector_x_um, context.detector_y_um)
        )
        image = replace(image, pixel_mrad=(x, y))
        return InitOutputs(
            context, Magnitude(image, grid, self.edges), Phase(image, grid, self.edges)
        )

    def preview(self, planned: PlannedNode, _work: Work, _here: NodeContext) -> Preview:
        """The detectors on the samples of the scene, to scale, and where they move."""
        context: Context = planned.sound().outputs["context"]
        x, y = planned.outputs["magnitude"].pixel_mrad
        pitch = None if x is None or y is None else (x, y)
        facts = _facts(context, pitch)
        return Preview(", ".join(facts), (_sketch(context, pitch),), facts)

    def _interval(self, name: str, samples: int, of_image: float | None) -> float:
        interval = interval_of(name, getattr(self, name), samples) or of_image
        if interval is None:
            allowed = "the picture has no field of view; give a value here or on Read Image"
            raise ParameterError(name, None, allowed)
        return interval

    @warning
    def focal_length(self, image: Image) -> Caution | None:
        """The focal length differs from its value in the picture's file."""
        in_file = {"focal_length_mm": image.header.focal_length_mm}
        return apart(self, in_file, where="in the picture's file")

    @warning
    def camera(self, image: Image, given: frozenset[str]) -> Caution | None:
        """A parameter differs from the value on Camera."""
        if image.camera is None:
            return None
        sheet, orbit = image.camera, image.camera.orbit
        for name, of_camera in (("fill_x", sheet.fill_x), ("fill_y", sheet.fill_y)):
            if name in given and getattr(self, name) == 1.0 and of_camera not in (None, 1.0):
                return Caution(
                    f"{name} = 1 is treated as empty here, so {of_camera:g} from Camera is used",
                    "change the fill factor on Camera",
                )
        of_sheet = {
            "detector_x_um": sheet.pitch_x_um,
            "detector_y_um": sheet.pitch_y_um,
            "focal_length_mm": sheet.focal_length_mm,
            "f_number": sheet.f_number,
            "obscuration_ratio": sheet.obscuration_ratio,
            "range_m": sheet.range_m,
            "fill_x": sheet.fill_x if self.fill_x != 1.0 else None,
            "fill_y": sheet.fill_y if self.fill_y != 1.0 else None,
        }
        return apart(self, of_sheet, where="on Camera") or apart(
            self,
            {"velocity_m_per_s": orbit.velocity_m_per_s if orbit else None},
            where="on Camera",
            remedy="set velocity_m_per_s to 0 to use the velocity from Camera; ignore this "
            "warning if the difference is intended",
        )

    @warning
    def field_of_view(self, image: Image) -> Caution | None:
        """The field of view differs from the number of samples times the sampling interval."""
        sampled = {
            name: None if interval is None else math.degrees(interval * samples / 1000.0)
            for name, interval, samples in (
                ("fov_x_deg", image.interval_x_mrad, image.columns),
                ("fov_y_deg", image.interval_y_mrad, image.rows),
            )
        }
        return apart(self, sampled, where="from the picture's sampling interval")

    @readout("mrad")
    def interval_x_mrad(self, axis: str, outputs: InitOutputs) -> float:
        """Horizontal sampling interval."""
        return _along(axis, outputs.context.grid, "interval_{}_mrad")

    @readout("mrad")
    def ifov_x_mrad(self, axis: str, outputs: InitOutputs) -> float | None:
        """Horizontal instantaneous field of view of a detector, including its fill factor."""
        pixel = _pixel(axis, outputs)
        return None if pixel is None else pixel * _along(axis, outputs.context, "fill_{}")

    @readout("cyc/mrad")
    def frequency_interval_x(self, axis: str, outputs: InitOutputs) -> float:
        """Spacing of the image's horizontal frequencies."""
        return _along(axis, outputs.context.grid, "frequency_interval_{}")

    @readout("cyc/mrad")
    def nyquist_x(self, axis: str, outputs: InitOutputs) -> float:
        """Horizontal Nyquist frequency of the image's samples."""
        return _along(axis, outputs.context.grid, "nyquist_{}")

    @readout("cyc/mrad")
    def pixel_nyquist_x(self, axis: str, outputs: InitOutputs) -> float | None:
        """Horizontal Nyquist frequency of the pixels: half a cycle per detector pitch."""
        pixel = _pixel(axis, outputs)
        return 0.5 / pixel if pixel else None

    @readout("samples")
    def oversampling_x(self, axis: str, outputs: InitOutputs) -> float | None:
        """Samples per horizontal detector pitch."""
        pixel, interval = _pixel(axis, outputs), self.interval_x_mrad(axis, outputs)
        return None if pixel is None else pixel / interval


def _along(axis: str, of: Context | Grid, name: str) -> float:
    value: float = getattr(of, name.format(axis))
    return value


def _pixel(axis: str, outputs: InitOutputs) -> float | None:
    return outputs.magnitude.pixel_mrad["xy".index(axis)]


def _fill(own: float | None, of_camera: float | None) -> float:
    return (own if own not in (None, 1.0) else None) or of_camera or 1.0


# The preview: sensitive areas at the detectors' pitch, and the scene's samples as dots.

_NAMES: Mapping[Platform, str] = MappingProxyType(
    {"line": "line scanner", "push": "pushbroom", "array": "staring array"}
)
_PLACES: Mapping[Platform, tuple[tuple[int, int], ...]] = MappingProxyType(
    {
        "line": ((0, 0),),
        "push": ((-1, 0), (0, 0), (1, 0)),
        "array": tuple((x, y) for y in (-1, 0, 1) for x in (-1, 0, 1)),
    }
)
_PITCHES = 3.3  # across the sketch
_INTERVALS = 4.0  # at least
_MOST_DOTS = 40  # samples across that are still drawn


def _sketch(context: Context, pitch: tuple[float, float] | None) -> Plot:
    grid = context.grid
    interval = grid.interval_x_mrad, grid.interval_y_mrad
    side = max(_INTERVALS * max(interval), _PITCHES * max(pitch or (0.0,)))
    curves = [_samples(interval, side)]
    if pitch is not None:
        if context.platform != "array":
            curves.insert(0, _arrow(pitch, along=context.platform == "push"))
        sensitive = pitch[0] * context.fill_x, pitch[1] * context.fill_y
        for column, row in _PLACES[context.platform]:
            middle = column * pitch[0], row * pitch[1]
            curves.append(_rectangle(middle, pitch, "faint_text", "dotted"))
            curves.append(_rectangle(middle, sensitive, 3, "solid"))
    across, down = Axis(-side / 2, side / 2, "mrad"), Axis(side / 2, -side / 2)
    return Plot(across, down, curves=tuple(curves), square=True)


def _samples(interval: tuple[float, float], side: float) -> Curve:
    """The scene's samples; their lattice lies so that one is in the middle."""
    counts = [int(side / 2 // step) for step in interval]
    if 2 * max(counts) > _MOST_DOTS:
        return Curve((), (), style="dots")
    across, along = (
        step * np.arange(-count, count + 1) for step, count in zip(interval, counts, strict=True)
    )
    x, y = np.meshgrid(across, along)
    return Curve(x.ravel(), y.ravel(), style="dots", width=min(2.0, 16.0 / max(*counts, 1)))


def _rectangle(
    middle: tuple[float, float], size: tuple[float, float], colour: Colour, style: Style
) -> Curve:
    x = middle[0] + size[0] / 2 * np.array([-1, 1, 1, -1, -1])
    y = middle[1] + size[1] / 2 * np.array([-1, -1, 1, 1, -1])
    return Curve(x, y, colour, style, width=1.2, fill="inside" if style == "solid" else "")


def _arrow(pitch: tuple[float, float], *, along: bool) -> Curve:
    length, aside = np.array([0.6, 1.45, 1.25, 1.45, 1.25]), np.array([0, 0, 0.12, 0, -0.12])
    x, y = (aside, length) if along else (length, aside)
    return Curve(x * pitch[along], y * pitch[along], "text", width=2.0)


def _facts(context: Context, pitch: tuple[float, float] | None) -> tuple[str, ...]:
    grid = context.grid
    facts = [
        f"{_NAMES[context.platform]}, {grid.columns} × {grid.rows}",
        f"interval {pair(grid.interval_x_mrad, grid.interval_y_mrad)} mrad",
        f"Nyquist {pair(grid.nyquist_x, grid.nyquist_y)} cyc/mrad",
    ]
    if pitch is None:
        return (*facts, "detector pitch or focal length is missing")
    facts += [
        f"IFOV {pair(pitch[0] * context.fill_x, pitch[1] * context.fill_y)} mrad",
        f"fill {pair(context.fill_x, context.fill_y)}",
        "samples per pitch "
        f"{pair(pitch[0] / grid.interval_x_mrad, pitch[1] / grid.interval_y_mrad)}",
    ]
    if context.scan_velocity_mrad_per_s:
        facts.append(f"scan {brief(context.scan_velocity_mrad_per_s)} mrad/s")
    if context.velocity_m_per_s:
        facts.append(f"platform {brief(context.velocity_m_per_s)} m/s")
    return tuple(facts)


class BackTransform(Module, key="back_transform", title="Back Transform", group="Transform"):
    """Compute the image from a magnitude and a phase.

    Magnitude and phase may come from different images A and B of the same size. The result then has
    the spectrum |A|·exp(i·∠B) and periodic edges. Source: Tantalo 1996, section 4.1.
    """

    formulas = (
        Formula(
            r"L'=\mathcal{F}^{-1}\left\{A\,e^{i\phi}\prod_k M_k\,e^{i\theta_k}\right\}",
            where="A, φ: magnitude and phase of the image; M_k, θ_k: MTF and PTF of every "
            "stage in the chain",
        ),
    )

    def run(self, magnitude: Magnitude, phase: Phase, here: NodeContext) -> ImageOutput:
        return ImageOutput(back_transform(magnitude, phase, node=here.node))
