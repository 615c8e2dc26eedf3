"""Exit Pupils: apertures by geometry or from a file, with a wavefront error."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Pupil
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Step, ends_lineage
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.physics.optics.enclosing_circle import support_circle
from core.physics.optics.pupil_shapes import (
    BARRED_SHAPES,
    OBSCURED_SHAPES,
    SHAPES,
    PupilShape,
    sample_pupil,
)

Array = NDArray[Any]
USUAL_RADIUS = 75.0  # of the thesis' example, 150 samples of 512


class PupilOutput(NamedTuple):
    """The pupil."""

    pupil: Pupil


class ExitPupil(Module, key="exit_pupil", title="Exit Pupils", group="Optics"):
    """Make an exit pupil: 1 transparent, 0 opaque.

    Lengths are in samples and centred; their scale is set in Exit Pupil MTF. `clear` and
    `half_moon` (x ≥ 0) ignore the obscuration; `hinged` is a disc with an opaque bar over the full
    height, `cassegrain_slit` the same bar on an annulus, `spider` an annulus with vanes at
    360°/n from +x. The wavefront error is in waves at the band's mean wavelength, on the disc of
    the aperture's radius. Of a file this is the smallest circle round all samples above 1 % of the
    largest, about the array's centre where that is at most a sample larger; a `radius` typed in is
    centred on the array. `aperture_radius` reads out the one that was taken. Sources: Tantalo
    1996, section 4.3.2; Noll 1976; Mahajan 1994 (the disc of the wavefront).
    """

    shape: Annotated[
        Literal["clear", "half_moon", "cassegrain", "hinged", "cassegrain_slit", "spider", "file"],
        Param("form of the aperture"),
    ] = "clear"
    size_x: Annotated[int, Param("samples of the pupil array across", low=2, high=8192)] = 512
    size_y: Annotated[int, Param("samples of the pupil array along", low=2, high=8192)] = 512
    radius: Annotated[
        float | None,
        Param(
            "radius of the aperture; empty: 75, of a file the circle round it",
            unit="samples", low=0, slider=(1, 256),
        ),
    ] = None  # fmt: skip
    obscuration_radius: Annotated[
        float, Param("radius of the central obscuration", unit="samples", low=0, slider=(0, 256))
    ] = 25.0
    slit_width: Annotated[
        float, Param("width of the opaque bar", unit="samples", low=0, slider=(0, 256))
    ] = 20.0
    vanes: Annotated[int, Param("number of vanes", low=0, high=60)] = 3
    vane_width: Annotated[
        float, Param("width of a vane", unit="samples", low=0, slider=(0, 64))
    ] = 4.0
    path: Annotated[Path | None, Param("image of the pupil, for `file`")] = None
    defocus_waves: Annotated[
        float, Param("defocus W20 at the rim", unit="waves", low=-100, high=100, slider=(-2, 2))
    ] = 0.0
    zernike_waves: Annotated[
        tuple[float, ...],
        Param(
            "Zernike coefficients from Noll's 1 (piston) on", unit="waves rms", low=-100, high=100
        ),
    ] = ()

    illustration = "pupil"
    panel = (
        Section("Aperture", ("shape", "radius")),
        Section("", ("obscuration_radius",), shown_when=("shape", OBSCURED_SHAPES)),
        Section("", ("slit_width",), shown_when=("shape", BARRED_SHAPES)),
        Section("", ("vanes", "vane_width"), shown_when=("shape", ("spider",))),
        Section("", ("path",), shown_when=("shape", ("file",))),
        Section("Pupil array", ("size_x", "size_y"), shown_when=("shape", SHAPES)),
        Section("Wavefront error", ("defocus_waves", "zernike_waves")),
    )

    def run(self, here: NodeContext) -> PupilOutput:
        """Plan the samples."""
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
                    name, size, f"at least the aperture's diameter {extent:g}", unit="samples"
                )
        samples = Step.of(
            _sampled, node=here.node, shape=shape, rows=self.size_y, columns=self.size_x
        )
        return PupilOutput(self._pupil(samples, self.size_y, self.size_x, shape, radius))

    def _from_file(self, here: NodeContext) -> Pupil:
        from nodes.files.read import read_info

        if self.path is None:
            raise ParameterError("path", None, "the shape `file` needs the image of a pupil")
        path = here.folder / self.path
        info = read_info(path)
        state = path.stat()
        samples = Step.of(
            _loaded, node=here.node, path=path, stamp=(state.st_size, state.st_mtime_ns)
        )
        return self._pupil(samples, info.rows, info.columns, None, self.radius)

    def _pupil(
        self,
        samples: Step,
        rows: int,
        columns: int,
        shape: PupilShape | None,
        radius: float | None,
    ) -> Pupil:
        return Pupil(
            samples,
            rows,
            columns,
            shape,
            radius,
            self.defocus_waves,
            self.zernike_waves if any(self.zernike_waves) else (),
        )

    @readout("samples")
    def aperture_radius(self, outputs: PupilOutput) -> Step | float:
        """Radius of the disc on which the wavefront error is: of a file, the circle's round it."""
        pupil = outputs.pupil
        return Step.of(_circled, pupil.samples) if pupil.radius is None else pupil.radius


@ends_lineage
def _circled(work: Work, samples: Array) -> float:
    return support_circle(samples)[2]


@ends_lineage
def _sampled(work: Work, *, shape: PupilShape, rows: int, columns: int) -> Array:
    return sample_pupil(shape, rows=rows, columns=columns)


@ends_lineage
def _loaded(work: Work, *, path: Path, stamp: object) -> Array:
    from nodes.files.read import check_finite, read_pixels

    samples = np.asarray(read_pixels(path, 0), np.float64)
    check_finite(samples, path.name)
    if samples.min() < 0 or not samples.any():
        raise DataError(f"{path.name}: a pupil needs transmissions of 0 and above, and not 0 alone")
    return np.asarray(samples / samples.max())
