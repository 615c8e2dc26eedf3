"""Exit Pupils: apertures by geometry or from a file, with a wavefront error."""

import math
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.engine import PlannedNode
from core.chain.wires import Pupil
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.modules.preview import Axis, Picture, Plot, Preview, brief
from core.physics.optics.pupil_shapes import (
    BARRED_SHAPES,
    OBSCURED_SHAPES,
    SHAPES,
    PupilShape,
    sample_pupil,
    support_circle,
)
from core.physics.optics.wavefront import known_wavefront, map_scale, wavefront_waves, wrapped_waves
from core.records import replace
from nodes.files.formats import check_finite
from nodes.optics.exit_pupil_mtf import sampled
from nodes.optics.mtf_file import LensSource, lens_source, stored_samples

USUAL_RADIUS = 75.0  # of the thesis' example, 150 samples of 512


class PupilOutput(NamedTuple):
    pupil: Pupil


class ExitPupil(Module, key="exit_pupil", title="Exit Pupils", group="Optics"):
    """Make an exit pupil: 1 transparent, 0 opaque.

    Lengths are in samples, and shapes are centred on the array; Exit Pupil MTF sets the scale.
    `clear` and `half_moon` (x ≥ 0) ignore the obscuration. `hinged` is a disc with an opaque bar
    over the full height. `cassegrain_slit` has the same bar on an annulus; `spider` is an annulus
    with n vanes, 360°/n apart, the first along +x.

    The wavefront error is in waves at the band's middle wavelength, defined on a disc with the
    aperture's radius. For a file, the disc is the smallest circle around all samples above 1 % of
    the largest. The circle is centred on the array if centring increases its radius by at most one
    sample. A `radius` that you enter is always centred on the array. The read-out `aperture_radius`
    gives the radius used. A wavefront map (picture, FITS, `.npy`, text, Zemax listing) is added to
    defocus and Zernike terms. Outside the aperture, the map must be NaN, or 0 all the way to the
    border of the array. Where the map has no value, the pupil is opaque. A map in waves applies at
    its own wavelength; a map in µm is an optical path difference, the same at all wavelengths. A
    complex `.npy` in `path` contains amplitude and phase, valid only at its own wavelength. Row 0
    is at the top. W enters as exp(2πiW), so a W that increases to the right moves the picture to
    the left.
    Sources: Tantalo 1996, section 4.3.2; Noll 1976; Mahajan 1994 (the disc of the wavefront).
    """

    formulas = (
        Formula(
            r"P=t\,e^{2\pi iW},\quad W=W_{20}\,r^2+\sum_j a_j\,Z_j(r,\theta)",
            where="t: amplitude, 0 to 1; W: wavefront error in waves; W₂₀: defocus_waves; a_j: "
            "zernike_waves, rms, in Noll's order; r: radius, 1 at the rim",
        ),
    )

    shape: Literal[
        "clear", "half_moon", "cassegrain", "hinged", "cassegrain_slit", "spider", "file"
    ] = param("clear", "shape of the aperture")
    size_x: int = param(512, "samples per row of the pupil array", (2, 8192))
    size_y: int = param(512, "samples per column of the pupil array", (2, 8192))
    radius: float | None = param(
        None,
        "radius of the aperture; empty: 75, or for a file the radius of the pupil's "
        "enclosing circle",
        low=0,
        unit="samples",
        slider=(1, 256),
    )
    obscuration_radius: float = param(
        25.0, "radius of the central obscuration", low=0, unit="samples", slider=(0, 256)
    )
    slit_width: float = param(
        20.0, "width of the opaque bar", low=0, unit="samples", slider=(0, 256)
    )
    vanes: int = param(3, "number of vanes", (0, 60))
    vane_width: float = param(4.0, "width of a vane", low=0, unit="samples", slider=(0, 64))
    path: Path | None = param(
        None,
        "file of the amplitude transmission, or a complex `.npy`, for the shape `file`; empty: "
        "1 where the wavefront map has a value",
    )
    wavefront_path: Path | None = param(
        None,
        "map of the wavefront error for the shape `file`, relative to the network file's folder",
    )
    wavefront_unit: Literal["waves", "rad", "um", "nm"] = param(
        "waves", "unit of the wavefront map"
    )
    map_wavelength_um: float | None = param(
        None,
        "wavelength of a wavefront map in waves or rad; empty: from the map's "
        "header, else the middle of the band",
        low=0,
        slider=(0.4, 14),
    )
    defocus_waves: float = param(
        0.0, "defocus W20 at the rim of the pupil", (-100, 100), slider=(-2, 2)
    )
    zernike_waves: tuple[float, ...] = param(
        (), "Zernike coefficients in Noll's order, from 1 (piston)", (-100, 100), unit="waves rms"
    )

    preview_lines = 11.0
    panel = (
        Section("Aperture", "shape radius"),
        Section("", "obscuration_radius", shown_when=("shape", OBSCURED_SHAPES)),
        Section("", "slit_width", shown_when=("shape", BARRED_SHAPES)),
        Section("", "vanes vane_width", shown_when=("shape", ("spider",))),
        Section(
            "",
            "path wavefront_path wavefront_unit map_wavelength_um",
            shown_when=("shape", ("file",)),
        ),
        Section("Pupil array", "size_x size_y", shown_when=("shape", SHAPES)),
        Section("Wavefront error", "defocus_waves zernike_waves"),
    )

    def run(self, here: NodeContext) -> PupilOutput:
        if self.shape == "file":
            return PupilOutput(self._from_file(here))
        radius = USUAL_RADIUS if self.radius is None else self.radius
        shape = PupilShape(
            self.shape,
            radius=radius,
            obscuration_radius=self.obscuration_radius,
            slit_width=self.slit_width,
            vanes=self.vanes,
            vane_width=self.vane_width,
        )
        extent = 2 * radius
        for name, size in (("size_x", self.size_x), ("size_y", self.size_y)):
            if extent > size:
                raise ParameterError(
                    name, size, f"at least the aperture's diameter, {extent:g}", unit="samples"
                )
        samples = here.step(sampled, shape=shape, rows=self.size_y, columns=self.size_x)
        return PupilOutput(self._pupil(samples, self.size_y, self.size_x, shape, radius))

    def preview(self, planned: PlannedNode, work: Work, _here: NodeContext) -> Preview:
        """The pupil in the colours of its wavefront error; only that of a file takes samples."""
        pupil: Pupil = planned.sound().outputs["pupil"]
        size = f"{pupil.columns} × {pupil.rows} samples"
        if pupil.shape is None:
            samples = work.value(pupil.samples)
            facts = ["file", size, f"{brief(100 * float(samples.mean()))} % transmitted"]
            wide, high = float(pupil.columns), float(pupil.rows)
            picture = Picture(samples, 0.0, 1.0, (wide, high))
        else:
            wide, high = _shown_samples(pupil, pupil.shape)
            waves, share = _drawn(pupil, pupil.shape, (wide, high))
            seen = waves[np.isfinite(waves)]
            facts = [
                pupil.shape.shape.replace("_", " "),
                size,
                f"diameter {brief(2 * pupil.shape.radius, 4)}",
                f"{100 * share:.0f} % of the disc open",
            ]
            if pupil.aberrated:
                facts.append(f"WFE {brief(float(seen.std()))} waves rms")
            most = float(np.abs(seen).max(initial=0.0))
            picture = Picture(waves, -most, most, (wide, high), signed=True, unit="waves")
        across, down = Axis(-wide / 2, wide / 2, "samples"), Axis(high / 2, -high / 2)
        chart = Plot(across, down, square=True, picture=picture)
        return Preview(", ".join(facts), (chart,), tuple(facts))

    def _from_file(self, here: NodeContext) -> Pupil:
        if self.path is None and self.wavefront_path is None:
            allowed = "the shape `file` needs a pupil in path, or a map in wavefront_path"
            raise ParameterError("path", None, allowed)
        opening = None if self.path is None else lens_source(self.path, here)
        if self.wavefront_path is not None:
            return self._of_map(lens_source(self.wavefront_path, here), opening, here)
        assert opening is not None
        samples = here.step(loaded_opening, **opening.reading)
        pupil = self._pupil(samples, opening.rows, opening.columns, None, self.radius)
        if not opening.is_complex:
            return pupil
        # A complex transmission has its wavefront with it.
        wavefront = here.step(loaded_phase, **opening.reading)
        return replace(
            pupil, wavefront=wavefront, wavefront_um=self.map_wavelength_um, wrapped=True
        )

    def _of_map(
        self, wavefront: LensSource, opening: LensSource | None, here: NodeContext
    ) -> Pupil:
        """A map, over what is open of the other file, or over all that it is known of."""
        size = wavefront.rows, wavefront.columns
        if wavefront.is_complex or (opening is not None and opening.is_complex):
            raise DataError(
                "wavefront_path cannot be used with a complex pupil, which already contains its "
                "wavefront; leave wavefront_path empty and give the complex file in path, or give "
                "amplitude and wavefront as two files of real numbers"
            )
        if wavefront.bands > 1:
            raise DataError(
                f"{wavefront.file.name} has {wavefront.bands} bands; a wavefront map must "
                "have one band"
            )
        factor, wavelength_um = map_scale(
            self.wavefront_unit, self.map_wavelength_um or wavefront.wavelength_um
        )
        known = here.step(loaded_map, factor=factor, **wavefront.reading)
        inputs: tuple[Step, ...] = (known,)
        if opening is not None:
            if (opening.rows, opening.columns) != size:
                raise DataError(
                    f"{opening.file.name} is {opening.columns} × "
                    f"{opening.rows} samples and {wavefront.file.name} {size[1]} × "
                    f"{size[0]}: both must have the same size"
                )
            inputs = (known, here.step(loaded_opening, **opening.reading))
        samples = here.step(known_opening, *inputs, name=wavefront.file.name)
        return replace(
            self._pupil(samples, *size, None, self.radius),
            wavefront=here.step(known_waves, known),
            wavefront_um=wavelength_um,
        )

    def _pupil(
        self, samples: Step, rows: int, columns: int, shape: PupilShape | None, radius: float | None
    ) -> Pupil:
        zernike = self.zernike_waves if any(self.zernike_waves) else ()
        return Pupil(samples, rows, columns, shape, radius, self.defocus_waves, zernike)

    @warning
    def map_unused(self) -> Caution | None:
        """A wavefront map is given, but only the shape `file` uses one."""
        if self.wavefront_path is None or self.shape == "file":
            return None
        return Caution(
            f"wavefront_path is not used by the shape {self.shape}",
            "set shape to file: the aperture then comes from path, or from the map if path is "
            "empty",
        )

    @readout("samples")
    def aperture_radius(self, outputs: PupilOutput) -> Step | float:
        """Radius of the disc on which the wavefront error is defined."""
        pupil = outputs.pupil
        return Step.of(_circled, pupil.samples) if pupil.radius is None else pupil.radius


def _circled(work: Work, samples: Array) -> float:
    return support_circle(samples)[2]


def loaded_opening(work: Work, *, file: Path, **reading: Any) -> Array:
    """Amplitude transmission over its largest; of complex samples their modulus."""
    samples = stored_samples(file=file, **reading)
    check_finite(samples, file.name)
    if np.isrealobj(samples) and samples.min() < 0:
        raise DataError(_refusal(file))
    samples = np.abs(samples)
    if not samples.any():
        raise DataError(_refusal(file))
    return np.asarray(samples / samples.max())


def loaded_phase(work: Work, *, file: Path, **reading: Any) -> Array:
    return wrapped_waves(stored_samples(file=file, **reading))


def loaded_map(work: Work, *, factor: float, file: Path, **reading: Any) -> Array:
    try:
        return factor * known_wavefront(stored_samples(file=file, **reading))
    except DataError as error:
        raise DataError(f"{file.name}: {error.message}") from error


def known_opening(
    work: Work, wavefront: Array, opening: Array | None = None, *, name: str
) -> Array:
    """Transmission where a wavefront map is known, 1 if not given, and 0 elsewhere."""
    known = np.isfinite(wavefront)
    samples = known.astype(np.float64) if opening is None else np.where(known, opening, 0.0)
    if not samples.any():
        raise DataError(f"{name}: the wavefront map has no value where the pupil transmits")
    return np.asarray(samples / samples.max())


def known_waves(work: Work, wavefront: Array) -> Array:
    return np.nan_to_num(wavefront, nan=0.0)


def _refusal(file: Path) -> str:
    return f"{file.name}: the transmissions of a pupil must be 0 or more, and not all 0"


# The preview: the aperture on its samples, its wavefront error in colour.

_MARGIN = 1.2  # of what is drawn around the aperture
_SIDE = 160  # pixels of the picture, along its longer side
_FINER = 4  # samples in a pixel along each axis, by which the open share is counted


def _shown_samples(pupil: Pupil, shape: PupilShape) -> tuple[float, float]:
    """Samples across and along that are drawn: of a small aperture, the middle of the array."""
    part = 1.0
    while min(pupil.columns, pupil.rows) * part / 2 >= _MARGIN * 2 * shape.radius:
        part /= 2
    return pupil.columns * part, pupil.rows * part


def _drawn(pupil: Pupil, shape: PupilShape, shown: tuple[float, float]) -> tuple[Array, float]:
    """The wavefront error where the shape is open, NaN elsewhere; share of the disc that is."""
    scale = _SIDE / max(shown)
    columns, rows = (max(1, round(side * scale)) for side in shown)
    names = ("radius", "obscuration_radius", "slit_width", "vane_width")
    lengths = {name: scale * getattr(shape, name) for name in names}
    shape = replace(shape, **lengths)
    is_open = sample_pupil(shape, rows=rows, columns=columns) > 0
    finely = sample_pupil(shape, rows=rows, columns=columns, oversampling=_FINER)
    radius = lengths["radius"]
    x, y = ((np.arange(count) - (count - 1) / 2) / radius for count in (columns, rows))
    how: Any = {"coefficients_waves": pupil.zernike_waves, "defocus_waves": pupil.defocus_waves}
    waves = wavefront_waves(x=x, y=y[:, np.newaxis], **how)
    share = finely.sum() / _FINER**2 / (math.pi * radius**2)
    return np.where(is_open, waves, np.nan), min(float(share), 1.0)
