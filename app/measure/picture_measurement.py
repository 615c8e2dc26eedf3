"""Pictures to measure, read from files frame by frame, and what a measurement has given."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Matrix
from core.errors import DataError, UsageError
from core.physics.measurement import edge_mtf, found_edge
from core.physics.measurement.sample_noise import SampleNoise
from core.physics.noise.noise_components import MeasuredNoise
from core.physics.sampling.detector_sampling import interval_mrad
from core.records import dataclass
from nodes.files import arrays, picture_info, stored_bytes
from nodes.files.formats import NPY, TIFF, check_finite, format_of, read_info, read_pixels
from nodes.files.frames import FrameFile, open_frames, tiff_pages
from nodes.input_output.source_file import LUMINANCE

Gamma = Literal["", "possible", "usual"]

FREQUENCIES = tuple(step / 64.0 for step in range(65))
"""Cycles per sample at which every MTF is given: of 64 samples, and up to the samples' own."""
BY_HAND = "removed by you"
WITH_LOSS = "the file uses lossy compression (fine detail and noise are altered)"


@dataclass(frozen=True, eq=False)
class MeasuredEdge:
    picture: int  # its number among those measured, from 0
    found: found_edge.FoundEdge  # where it is, and what of the picture belongs to it
    curve: edge_mtf.MtfCurve | None  # MTF along the normal; None where it was not measured
    why_not: str  # why it is not used; empty where it is

    @property
    def used(self) -> bool:
        return not self.why_not

    @property
    def direction(self) -> str:
        """The axis that its normal lies near, ``x`` or ``y``; empty of one between both."""
        away = abs(edge_mtf.off_axis_deg(self.found.angle_deg))
        if away <= edge_mtf.LARGEST_ANGLE_DEG:
            return "x"
        return "y" if away >= 90.0 - edge_mtf.LARGEST_ANGLE_DEG else ""

    @property
    def mtf50_sigma(self) -> float | None:
        """Standard error of the MTF50, as that of its direction where it alone shows it."""
        curve = self.curve
        if curve is None or curve.mtf50 is None:
            return None
        alone = edge_mtf.pooled_mtf(edges=[curve], axis="y" if self.direction == "y" else "x")
        if alone is None:
            return curve.mtf50_sigma
        return edge_mtf.crossing_error(
            frequency=alone.frequency, mtf=alone.mtf, sigma=alone.sigma, crossing=curve.mtf50
        )

    @property
    def stretch(self) -> float:
        """What a frequency along the normal is multiplied by to be that along the axis."""
        return max(abs(part) for part in self.found.normal)


_PREVIEW_SAMPLES = 1400  # of a side


def preview_factor(rows: int, columns: int) -> int:
    """Samples along a side of the squares whose means a preview has."""
    return -(-max(rows, columns, 1) // _PREVIEW_SAMPLES)


@dataclass(frozen=True, eq=False)
class PictureMeasurement:
    files: tuple["PictureFile", ...]  # where the pictures come from, in order
    rows: int  # size of each
    columns: int
    unit: str  # of the samples, or empty
    interval_x_mrad: float | None  # angle between samples, where the field of view is known
    interval_y_mrad: float | None
    edges: tuple[MeasuredEdge, ...]  # all that were seen
    x: edge_mtf.MtfCurve | None  # pooled over the edges across, and along
    y: edge_mtf.MtfCurve | None
    reason_x: str  # why there is none
    reason_y: str
    noise: SampleNoise | None  # of the flat areas of the pictures, or from frame to frame
    noise_reason: str  # why there is none
    frames: MeasuredNoise | None = None  # components of the noise from frame to frame
    frames_reason: str = ""  # why there are none
    previews: tuple[NDArray[np.float32], ...] = ()  # the first pictures, as means of squares
    pitch_um: float | None = None  # from one pixel to the next, where it was given
    warnings: tuple[str, ...] = ()  # what makes the figures other than those of the camera

    @property
    def picture_count(self) -> int:
        return sum(file.frames for file in self.files)

    def interval_mrad(self, direction: str) -> float | None:
        return self.interval_x_mrad if direction == "x" else self.interval_y_mrad

    def picture_name(self, number: int) -> str:
        return picture_name(self.files, number)

    @property
    def preview_shape(self) -> tuple[int, int]:
        """Rows and columns of the pictures that the previews show."""
        factor = preview_factor(self.rows, self.columns)
        return self.rows // factor * factor, self.columns // factor * factor


def picture_name(files: "Sequence[PictureFile]", number: int) -> str:
    file, frame = file_of(files, number)
    return file.name if file.frames == 1 else f"{file.name}, frame {frame}"


def file_of(files: "Sequence[PictureFile]", number: int) -> "tuple[PictureFile, int]":
    for file in files:
        if number < file.frames:
            return file, number
        number -= file.frames
    raise IndexError(number)


NO_DATA = "replace these samples with one number, such as 0; constant areas are not measured"
_COLOURS = ("R", "G", "B")
_WITH_ALPHA = 2  # bands
_FLAT = 2  # dimensions of a single picture
_STACKS = ("envi", "fits")  # formats whose bands are no colours
# Formats whose numbers of 8 bits follow the eye, not the light; of TIFF some do.
_ENCODED = ("jpeg", "jpeg2000", "png", "bmp", "webp", "gif")
_PERHAPS_ENCODED = ("tiff",)


@dataclass(frozen=True, eq=False)
class PictureFile:
    name: str  # its path as it was given, or what an array is called
    rows: int  # size of a frame, and how many there are
    columns: int
    frames: int = 1
    band: int | None = None  # that is measured; None: luminance, or the only one
    taken: str = (
        ""  # what of a file of several bands is measured, in words; empty where there is one
    )
    unit: str = ""  # of the samples as the file words it, or empty
    interval_x_mrad: float | None = None  # between samples, by the header's field of view
    interval_y_mrad: float | None = None
    limits: tuple[float, float] | None = None  # ends of whole numbers
    gamma: Gamma = ""  # whether its numbers follow the eye instead of the light
    is_lossy: bool = False  # whether the format leaves out what the eye would not miss
    is_stack: bool = False  # whether it holds frames, were it a single one
    band_um: tuple[float, float] | None = None  # of the measured band
    samples: Iterable[Any] | None = None  # the frames of an array; None: they are in the file

    @classmethod
    def of(cls, name: str, frames: Sequence[NDArray[Any]], **about: Any) -> "PictureFile":
        rows, columns = frames[0].shape
        return cls(name, rows, columns, len(frames), samples=frames, **about)

    def pictures(self) -> Iterator[Matrix]:
        if self.samples is not None or self.frames > 1 or self.is_stack:
            for frame in self.samples or open_frames(Path(self.name)).each():
                yield np.asarray(frame, np.float64)
            return
        if self.band is None and self.taken:
            yield self._luminance()
            return
        samples = read_pixels(Path(self.name), self.band or 0)
        check_finite(samples, self.name, advice=NO_DATA)
        yield np.asarray(samples, np.float64)

    def _luminance(self) -> Matrix:
        picture = np.zeros((self.rows, self.columns))
        for band, share in enumerate(LUMINANCE):
            samples = read_pixels(Path(self.name), band)
            check_finite(samples, f"{self.name}, band {band}", advice=NO_DATA)
            picture += share * samples
        return picture


def open_picture(path: Path, *, band: int | None = None, instead: str = "") -> PictureFile:
    """Describe a file to be measured without reading its samples.

    `band` counts from 0; without it luminance of colours, and the frames of a file whose bands have
    no wavelengths. Of other files with several bands one must be chosen; `instead` says what to do
    where that cannot be done.
    """
    file = stored_bytes.readable_file(path)
    if format_of(file) is NPY and band is None:
        frames = open_frames(file)  # of three dimensions they are frames, and no picture
        return _of_frames(path, frames, None)
    info = read_info(file)
    if band is None and not info.channels and info.wavelengths_um is None:
        many = (
            info.bands if info.kind == "envi" else TIFF.matches(info.path) and tiff_pages(info.path)
        )
        if many > 1:  # bands of ENVI, pages of TIFF
            return _of_frames(path, open_frames(file), info)
    chosen, taken = _chosen(path, info, band, instead)
    x, y = _intervals(info)
    dtype = np.dtype(info.dtype)
    return PictureFile(
        str(path), info.rows, info.columns, 1, chosen, taken, info.unit or "", x, y,
        limits_of(dtype), gamma=_gamma(info), is_lossy=info.lossy, band_um=_band_um(info, chosen),
    )  # fmt: skip


def _band_um(info: picture_info.PictureInfo, band: int | None) -> tuple[float, float] | None:
    if band is None or info.wavelengths_um is None:
        return None
    centre, half = info.wavelengths_um[band], 0.5 * (info.fwhm_um[band] if info.fwhm_um else 0.0)
    return centre - half, centre + half


def _gamma(info: picture_info.PictureInfo) -> Gamma:
    if info.dtype != "uint8":
        return ""
    if info.kind in _ENCODED:
        return "usual"
    return "possible" if info.kind in _PERHAPS_ENCODED else ""


def _of_frames(path: Path, frames: FrameFile, info: picture_info.PictureInfo | None) -> PictureFile:
    x, y = (None, None) if info is None else _intervals(info)
    return PictureFile(
        str(path), frames.rows, frames.columns, frames.frames, 0, "", frames.unit or "", x, y,
        limits_of(frames.dtype),
        gamma="" if info is None else _gamma(info), is_lossy=info is not None and info.lossy,
        is_stack=arrays.is_npy(frames.path) and len(arrays.npy_header(frames.path).shape) > _FLAT,
    )  # fmt: skip


def _chosen(
    path: Path, info: picture_info.PictureInfo, band: int | None, instead: str
) -> tuple[int | None, str]:
    """The band that is measured, or None for luminance, and the words for it."""
    if band is not None:
        if not 0 <= band < info.bands:
            allowed = "only 0" if info.bands == 1 else f"0 to {info.bands - 1}"
            raise UsageError(f"{path} has no band {band}; allowed: {allowed}")
        if info.bands == 1:
            return 0, ""
        name = f" ({info.channels[band]})" if info.channels else ""
        return band, f"band {band}{name} of {info.bands}"
    if info.bands == 1:
        return 0, ""
    if info.channels[:3] == _COLOURS:
        shares = map("{} {}".format, LUMINANCE, _COLOURS)
        return None, f"luminance, {' + '.join(shares)}"
    if info.bands == _WITH_ALPHA and not info.channels and info.kind not in _STACKS:
        return 0, "grey, without the transparency channel"
    choose = instead or f"choose the band to measure, 0 to {info.bands - 1}"
    raise UsageError(
        f"{path} has {info.bands} bands: {choose}", hint="" if instead else "give --band"
    )


def _intervals(info: picture_info.PictureInfo) -> tuple[float | None, float | None]:
    """Angles between samples, mrad, of a header that has the field of view."""
    x, y = (
        None if fov is None else interval_mrad(fov_deg=fov, samples=samples)
        for fov, samples in ((info.fov_x_deg, info.columns), (info.fov_y_deg, info.rows))
    )
    return x, y


def limits_of(dtype: np.dtype[Any]) -> tuple[float, float] | None:
    """Ends of the whole numbers that can be stored; None of others."""
    if dtype.kind == "b":
        return 0.0, 1.0
    if dtype.kind not in "ui":
        return None
    return float(np.iinfo(dtype).min), float(np.iinfo(dtype).max)


def same_size(files: Sequence[PictureFile]) -> None:
    first = files[0]
    for file in files:
        if (file.rows, file.columns) != (first.rows, first.columns):
            raise DataError(
                f"{file.name} has {file.columns} × {file.rows} samples, but {first.name} has "
                f"{first.columns} × {first.rows}. Give pictures from one camera"
            )


def common_limits(files: Sequence[PictureFile]) -> tuple[float, float] | None:
    """Ends of the numbers of all files; None where not all are whole numbers."""
    known = [(file.name, file.limits) for file in files if file.limits is not None]
    for name, (low, high) in known:
        first, ends = known[0]
        if (low, high) != ends:
            raise DataError(
                f"{name} stores whole numbers from {low:g} to {high:g}, but {first} from "
                f"{ends[0]:g} to {ends[1]:g}. Give pictures from one camera, stored the same way"
            )
    return known[0][1] if len(known) == len(files) else None
