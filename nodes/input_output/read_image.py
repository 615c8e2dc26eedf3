"""Read Image: a picture from a file."""

from pathlib import Path
from typing import Any, Literal

import numpy as np

from core.chain.wires import Header, Image
from core.errors import ParameterError, several
from core.evaluation.recipes import Recipe, Step
from core.modules.declaration import Caution, Formula, NodeContext, Section, param, readout, warning
from core.records import replace
from nodes.files.envi import coverage
from nodes.files.formats import readable_formats
from nodes.files.picture_info import PictureInfo
from nodes.files.stored_bytes import checked_band
from nodes.input_output import source_file
from nodes.input_output.sample_unit import (
    DEFAULT_UNIT,
    is_spectral,
    radiance_caution,
    sample_unit,
    spectral_unit,
)
from nodes.shared.context_defaults import Band, interval_of, is_radiance
from nodes.shared.module_ports import ImageOutput, PicturePreview

_WHOLE = 0.99  # of the wavelengths: less is warned of


class ReadImage(PicturePreview, key="read_image", title="Read Image", group="Input and output"):
    """Read a picture from a file: ENVI (DIRSIG's format), or another format listed under `path`.

    Samples are the file's numbers times `scale`, plus `offset`. If an ENVI header gives wavelengths
    and you set both `cut_on_um` and `cut_off_um`, the file's bands are integrated between these
    wavelengths. For any other file, the two wavelengths give the band of the samples. The radiance
    is in W/m²/sr, or in W/m²/sr/µm for one spectral band. If the file names its unit (W cm⁻² sr⁻¹
    µm⁻¹, uW/cm^2/sr/um, …) and `scale` is 1, that unit is converted; otherwise `unit` applies. A
    cube whose header names no unit needs `unit` or `scale`. Gains and offsets of an ENVI header are
    applied, and its bad bands are left out. K, DN and similar units are kept. Photons are converted
    to watts only if `bands` is all. An unknown radiance unit is an error.

    A colour picture gives one channel or, with `bands` luminance, all three, weighted by the eye's
    sensitivity. A cube gives one band or plane, by default the first; set `band` for another. With
    `bands` all, a cube with wavelengths in its header gives every band between `cut_on_um` and
    `cut_off_um`. Each band is in W/m²/sr/µm; photons are converted with their energy at the band's
    wavelength. Optics and atmosphere act on each band separately until a detector sums the bands.
    The cube stays on disk.

    An empty field of view is taken from the header. The first row of a FITS picture is at the
    bottom. Samples that are not finite, or that equal the file's no-data value, are an error unless
    `missing` replaces them.
    """

    formulas = (
        Formula(
            r"L=\sum_b s\,c_b\,S_b\,\Delta\lambda_b",
            where="S_b: the numbers that the file stores for band b; s: `scale`; c_b: factor "
            "from the file's unit to W/m²/sr/µm; Δλ_b: the part of the band between "
            "cut_on_um and cut_off_um, µm",
            when="a header with wavelengths, and bands summed",
        ),
        Formula(
            r"L=s\,c\,S+o",
            where="c: factor from the unit to W/m²/sr; 1 for kelvin, digital numbers and the "
            "like; o: `offset`",
            when="any other file",
        ),
        Formula(
            r"S=0.2126\,R+0.7152\,G+0.0722\,B",
            where="R, G, B: the numbers of the three channels (ITU-R BT.709)",
            when="luminance",
        ),
    )

    path: Path | None = param(
        None, f"picture file, relative to the network file's folder: {readable_formats()}"
    )
    band: int = param(0, "band or channel to read, counted from 0", low=0)
    bands: Literal["one", "all", "luminance"] = param(
        "one",
        "one band, all bands of a spectral cube (each goes through the chain separately), "
        "or the luminance of a colour picture",
    )
    scale: float = param(1.0, "factor applied to the samples", slider=(0, 10000))
    offset: float = param(0.0, "number added after scaling, in the unit of the scaled samples")
    unit: str = param(DEFAULT_UNIT, "unit of the samples after scaling")
    fov_x_deg: float | None = param(None, "horizontal field of view", (0, 180), below=True)
    fov_y_deg: float | None = param(None, "vertical field of view", (0, 180), below=True)
    cut_on_um: float | None = param(None, "shortest wavelength", low=0)
    cut_off_um: float | None = param(None, "longest wavelength", low=0)

    missing: Literal["refuse", "mean", "zero"] = param(
        "refuse",
        "samples that are NaN, infinite or missing: refuse them, or replace them with 0 or "
        "the mean of the other samples",
    )

    panel = (
        Section("File", "path bands"),
        Section("", "band", shown_when=("bands", ("one",))),
        Section("Samples", "scale offset unit missing"),
        Section("Field of view", "fov_x_deg fov_y_deg"),
        Section("Band", "cut_on_um cut_off_um"),
    )

    def check(self) -> None:
        if self.bands == "all" and self.offset:
            raise ParameterError("offset", self.offset, "0 if bands = all")
        low, high = self.cut_on_um, self.cut_off_um
        if low is None and high is None:
            return
        if low is None:
            raise ParameterError("cut_on_um", None, "give a number, or leave cut_off_um empty too")
        if high is None or low >= high:
            raise ParameterError("cut_off_um", high, f"above cut_on_um = {low:g}")

    def run(self, here: NodeContext) -> ImageOutput:
        source = source_file.picture_source(self.path, here)
        info, stated = source.info, self._stated_band()
        if self.bands == "all":
            return ImageOutput(self._cube(source, here.node, missing=self.missing))
        spectral = stated is not None and is_spectral(info)
        band = 0 if spectral else self._channel(info)
        unit, factor = sample_unit(info, typed=self.unit, scale=self.scale, integrated=spectral)
        recipe = source_file.read_step(
            source,
            band=band,
            scale=self.scale * factor,
            offset=self.offset,
            node=here.node,
            interval_um=stated if spectral else None,
            missing=self.missing,
        )
        known: dict[str, Any] = {"channels": info.channels, "absent_chunks": info.absent_chunks}
        known["bands"] = 1 if spectral else info.bands
        if spectral:
            known |= {"bad_bands": len(info.bad_bands), "coverage": coverage(info, stated)}
        of_band = stated or header_band(info, band)
        return ImageOutput(self._picture(info, recipe, unit, of_band, **known))

    def _channel(self, info: PictureInfo) -> int | tuple[int, ...]:
        if self.bands != "luminance":
            return checked_band(self.band, info.bands, info.path)
        if not info.rgb:
            why = f"set bands to one or all, because {info.path.name} has no channels R, G and B"
            raise ParameterError("bands", self.bands, why)
        return info.rgb

    def of_samples(self, held: source_file.HeldSamples, node: str) -> ImageOutput:
        """The picture of samples in memory: that of a file which says no more of them."""
        info = held.info
        cube = info.wavelengths_um is not None
        if cube != (self.bands == "all"):
            allowed = (
                "must be all, because the array has bands"
                if cube
                else "must be one, because the array has no bands"
            )
            raise ParameterError("bands", self.bands, allowed)
        if cube:
            return ImageOutput(self._cube(held, node))
        checked_band(self.band, 1, info.path)
        unit, factor = sample_unit(info, typed=self.unit, scale=self.scale, integrated=False)
        recipe = held.step(scale=self.scale * factor, offset=self.offset, node=node)
        return ImageOutput(self._picture(info, recipe, unit, self._stated_band()))

    def _cube(
        self, cube: source_file.Cube, node: str, missing: source_file.Missing = "refuse"
    ) -> Image:
        info, stated = cube.info, self._stated_band()
        unit = spectral_unit(info, typed=self.unit, scale=self.scale)
        stack = source_file.bands_of(
            cube, unit=unit, scale=self.scale, interval_um=stated, missing=missing, node=node
        )
        name = DEFAULT_UNIT if stack.density else info.unit or self.unit
        known = {"bad_bands": len(info.bad_bands), "coverage": coverage(info, stated)}
        image = self._picture(info, stack.picture(stack.whole), name, stack.band_um, **known)
        return replace(image, bands=stack)

    def _picture(
        self, info: PictureInfo, recipe: Recipe, unit: str, band_um: Band | None, **known: Any
    ) -> Image:
        """The image, of which the file says what is `known` besides."""
        fov_x_deg = self.fov_x_deg or info.fov_x_deg
        fov_y_deg = self.fov_y_deg or info.fov_y_deg
        return Image(
            recipe,
            info.rows,
            info.columns,
            interval_of("fov_x_deg", fov_x_deg, info.columns),
            interval_of("fov_y_deg", fov_y_deg, info.rows),
            unit=unit,
            band_um=band_um,
            header=Header(
                fov_x_deg,
                fov_y_deg,
                info.focal_length_mm,
                bare_integers=np.dtype(info.dtype).kind in "bui" and not info.unit,
                not_applied=info.not_applied,
                unit_named=bool(info.unit),
                wavelengths_assumed=info.wavelengths_assumed,
                **known,
            ),
        )

    @warning
    def numbers_without_unit(self, outputs: ImageOutput) -> Caution | None:
        """Whole numbers without a unit are read as radiance."""
        bare = outputs.image.header.bare_integers
        scaled = self.scale != 1.0 or self.offset != 0.0
        if not bare or scaled or not is_radiance(self.unit):
            return None
        return Caution(
            f"the radiance may be wrong: the file stores whole numbers, but unit = {self.unit}",
            "set scale to convert the numbers to radiance, or set unit to the unit of the "
            "numbers, such as DN",
        )

    @warning
    def as_stored(self, outputs: ImageOutput) -> Caution | None:
        """The header has a factor or offset that is not applied."""
        fields = outputs.image.header.not_applied
        if not fields or self.scale != 1.0:
            return None
        return Caution(
            "the samples may be in the wrong unit: Read Image does not apply "
            f"{' and '.join(fields)} from the header",
            "convert the samples with scale and offset, and set unit to the resulting unit",
        )

    @warning
    def bands_left_out(self, outputs: ImageOutput) -> Caution | None:
        """Bands that the header marks as bad are left out."""
        count = outputs.image.header.bad_bands
        if not count:
            return None
        bands, them = ("1 band is", "it") if count == 1 else (f"{count} bands are", "them")
        return Caution(
            f"{bands} left out, because the header marks {them} as bad (bbl = 0)",
            "remove bbl from the header if the samples are good",
        )

    @warning
    def bands_with_gaps(self, outputs: ImageOutput) -> Caution | None:
        """There are gaps between the bands."""
        share = outputs.image.header.coverage
        if share >= _WHOLE:
            return None
        stated = self._stated_band()
        ends = "from the first to the last band" if stated is None else "from {:g} to {:g} µm"
        where = ends.format(*stated or ())
        return Caution(
            f"radiance between the bands is missing: the bands cover {100 * share:.0f} % of the "
            f"wavelengths {where}",
            "choose cut_on_um and cut_off_um within the bands, or use a cube without gaps",
        )

    @warning
    def chunks_not_there(self, outputs: ImageOutput) -> Caution | None:
        """The Zarr store lacks some of its chunks."""
        count = outputs.image.header.absent_chunks
        if not count:
            return None
        return Caution(
            f"the store lacks {several(count, 'chunk')}: samples there are treated as missing",
            "if the store should be complete, copy it again",
        )

    @warning
    def wavelengths_without_unit(self, outputs: ImageOutput) -> Caution | None:
        """The header gives no unit for the wavelengths, which are read as µm."""
        if not outputs.image.header.wavelengths_assumed:
            return None
        return Caution(
            "the wavelengths are read as µm: the header gives no unit for wavelengths",
            "add a line to the header: wavelength units = Micrometers, or the actual unit",
        )

    @warning
    def radiance(self, outputs: ImageOutput, given: frozenset[str]) -> Step | None:
        """The samples look like temperatures, or cannot be radiances."""
        image = outputs.image
        band = image.band_um
        if not is_radiance(image.unit) or self.numbers_without_unit(outputs) is not None:
            return None
        return Step.of(
            radiance_caution,
            image.recipe,
            band_um=band if band is None or band[0] < band[1] else None,
            # A scale of 1 that is written out says no more about the unit than one left out.
            unit_stated=image.header.unit_named or "unit" in given or self.scale != 1.0,
        )

    @warning
    def one_channel(self, outputs: ImageOutput, given: frozenset[str]) -> Caution | None:
        """Only one channel of a colour picture is read, and `band` is not set."""
        channels = outputs.image.header.channels
        if len(channels) < 2 or "band" in given or self.bands == "luminance":
            return None
        read = channels[self.band] if self.band < len(channels) else f"number {self.band}"
        return Caution(
            f"only channel {read} of this colour picture ({', '.join(channels)}) is read",
            f"for another channel, set band (0 to {len(channels) - 1}); for all channels, set "
            "bands to luminance",
        )

    @warning
    def one_band(self, outputs: ImageOutput, given: frozenset[str]) -> Caution | None:
        """Only one band, plane or frame of a cube is read, and `band` is not set."""
        header = outputs.image.header
        if header.bands < 2 or header.channels or "band" in given:
            return None
        return Caution(
            f"only band {self.band} is read: the file contains {header.bands} bands",
            f"for another band, set band (0 to {header.bands - 1})",
        )

    @readout("samples")
    def missing_samples(self, outputs: ImageOutput) -> Step | int:
        """Number of missing samples in the file: NaN, infinite or equal to its no-data value."""
        read = outputs.image.recipe
        if self.missing == "refuse" or not isinstance(read, Step) or self.bands == "all":
            return 0
        parameters = dict(read.parameters)
        if "missing" not in parameters:  # samples in memory: an array with any is refused
            return 0
        return Step.of(source_file.count_missing, node=read.node, **parameters)

    def _stated_band(self) -> Band | None:
        if self.cut_on_um is None or self.cut_off_um is None:
            return None
        return self.cut_on_um, self.cut_off_um


def header_band(info: PictureInfo, band: int | tuple[int, ...]) -> Band | None:
    if info.wavelengths_um is None or info.fwhm_um is None or isinstance(band, tuple):
        return None
    centre, half = info.wavelengths_um[band], info.fwhm_um[band] / 2
    return (centre - half, centre + half) if centre > half else None
