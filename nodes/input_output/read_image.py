"""Read Image: a picture from a file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal

from core.declaration import Here, Module, readout
from core.errors import ParameterError
from core.parameters import Param
from core.physics.sampling import interval_mrad
from core.recipes import Step
from core.values import Header, Image
from nodes.files.paths import checked_band
from nodes.files.picture_info import PictureInfo
from nodes.input_output.source_file import count_missing, picture_source, read_step
from nodes.ports import ImageOutput

_PER_CM2 = re.compile(r"/\s*cm\s*(\^?2|²)|cm\s*(\^?-2|⁻²)", re.IGNORECASE)


class ReadImage(Module, key="read_image", title="Read Image", group="Input and output"):
    """Read a picture: EXR, TIFF, HDR, PNG, FITS, ENVI as DIRSIG writes it, .npy or plain text.

    Samples are the numbers the file stores times `scale`. Where an ENVI header gives wavelengths,
    its bands are integrated from `cut_on_um` to `cut_off_um` if both are given; for every other
    file these two say which band the samples are of. Where the header says radiance per cm², as
    DIRSIG's W cm⁻² sr⁻¹ µm⁻¹, a scale of 1 stands for the 10000 to W m⁻² sr⁻¹. An empty field of
    view is taken from the header. FITS pictures come with their first row at the bottom. Samples
    that are no numbers are refused unless `missing` says what stands for them.
    """

    path: Annotated[Path | None, Param("picture file, relative to the network file's folder")] = (
        None
    )
    band: Annotated[int, Param("band or channel, counted from 0", low=0)] = 0
    scale: Annotated[float, Param("factor on the samples", slider=(0, 10000))] = 1.0
    unit: Annotated[str, Param("unit of the samples after scaling")] = "W/m²/sr"
    fov_x_deg: Annotated[
        float | None, Param("field of view across", unit="deg", low=0, high=180, below=True)
    ] = None
    fov_y_deg: Annotated[
        float | None, Param("field of view along", unit="deg", low=0, high=180, below=True)
    ] = None
    cut_on_um: Annotated[float | None, Param("shortest wavelength", unit="µm", low=0)] = None
    cut_off_um: Annotated[float | None, Param("longest wavelength", unit="µm", low=0)] = None

    missing: Annotated[
        Literal["refuse", "mean", "zero"],
        Param("samples that are NaN or infinite: an error, or the others' mean or 0 for them"),
    ] = "refuse"

    def check(self) -> None:
        """Refuse half a band and an empty one."""
        low, high = self.cut_on_um, self.cut_off_um
        if low is None and high is None:
            return
        if low is None:
            raise ParameterError("cut_on_um", None, "given together with cut_off_um", unit="µm")
        if high is None or low >= high:
            raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}", unit="µm")

    def run(self, here: Here) -> ImageOutput:
        """Read the header and plan to read the samples."""
        source = picture_source(self.path, here)
        info, stated = source.info, self._stated_band()
        spectral = stated is not None and info.wavelengths_um is not None
        band = 0 if spectral else checked_band(self.band, info.bands, info.path)
        recipe = read_step(
            source,
            band=band,
            scale=self.scale * (_per_m2(info) if self.scale == 1.0 else 1.0),
            node=here.node,
            interval_um=stated if spectral else None,
            missing=self.missing,
        )
        fov_x_deg = self.fov_x_deg or info.fov_x_deg
        fov_y_deg = self.fov_y_deg or info.fov_y_deg
        return ImageOutput(
            Image(
                recipe,
                info.rows,
                info.columns,
                _interval(fov_x_deg, info.columns),
                _interval(fov_y_deg, info.rows),
                unit=self.unit,
                band_um=stated or _band_um(info, band),
                header=Header(fov_x_deg, fov_y_deg, info.focal_length_mm),
            )
        )

    @readout("samples")
    def missing_samples(self, outputs: ImageOutput) -> Step | int:
        """Samples of the file that are NaN or infinite."""
        read = outputs.image.recipe
        if self.missing == "refuse" or not isinstance(read, Step):
            return 0
        return Step.of(count_missing, node=read.node, **dict(read.parameters))

    def _stated_band(self) -> tuple[float, float] | None:
        if self.cut_on_um is None or self.cut_off_um is None:
            return None
        return self.cut_on_um, self.cut_off_um


def _per_m2(info: PictureInfo) -> float:
    """What turns the header's radiance per cm² into radiance per m²."""
    return 1e4 if info.unit and _PER_CM2.search(info.unit) else 1.0


def _interval(fov_deg: float | None, samples: int) -> float | None:
    return None if fov_deg is None else interval_mrad(fov_deg=fov_deg, samples=samples)


def _band_um(info: PictureInfo, band: int) -> tuple[float, float] | None:
    """Where the header says how wide the band is, its two ends."""
    if info.wavelengths_um is None or info.fwhm_um is None:
        return None
    centre, half = info.wavelengths_um[band], info.fwhm_um[band] / 2
    return (centre - half, centre + half) if centre > half else None
