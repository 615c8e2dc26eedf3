"""Write Image and Write Matrix: files of a picture, of curves or of a transfer function."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.atomic import atomic_file, write_text
from core.chain.band_stack import BandStack
from core.chain.engine import realize
from core.chain.wires import Curve, CurveData, Image, Transfer
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Region
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.records import dataclass, field
from nodes.files import formats, frames
from nodes.files.arrays import write_curves, write_matrix
from nodes.files.file_format import CSV, ENVI_FRAMES, ZARR, Format, suffixes
from nodes.files.picture_info import MetadataValue
from nodes.files.zarr_array import check_zarr, write_store

Dtype = Literal["automatic", "float", "double", "half", "uint8", "uint16"]
Files = list[tuple[Path, Callable[[Path], None]]]

_BY_SUFFIX = "by_suffix"
_CUBE = "envi"
_FORMATS: dict[str, Format] = {**{kind.name: kind for kind in formats.WRITTEN}, _CUBE: ENVI_FRAMES}
_FLOATS: dict[str, np.dtype[Any]] = {"float": np.dtype(np.float32), "double": np.dtype(np.float64)}


class WriteImage(
    Module, key="write_image", title="Write Image", group="Input and output", sink=True
):
    """Write the picture to a file when a run saves its outputs.

    `imagechain run` saves outputs. In the editor, use Run > Add to the Queue; generating the
    picture writes no file.

    Integer types map `range_low` … `range_high` (empty: the picture's smallest and largest sample)
    to the full range of the type. If `range_low` and `range_high` are empty, a picture in digital
    numbers (DN) is not stretched: 12-bit samples stay 0 to 4095 in the file. `automatic` uses the
    precision of the computation if the format allows it, and 16-bit integers for PNG and for
    digital numbers up to 65535.

    An ENVI file (`.img`, `.bsq`, or `format` envi) keeps all bands of a spectral picture, as floats
    in W/m²/sr/µm. Bands are written one at a time, so the whole cube is never in memory. Every
    other format stores the sum of the bands. A Zarr store (`.zarr`) is written chunk by chunk.
    """

    formulas = (
        Formula(
            r"n=\mathrm{round}\left(\frac{L-L_{low}}{L_{high}-L_{low}}\;(2^b-1)\right)",
            where="n: the number in the file, from 0 to 2^b − 1; b: bits of the type; L_low, "
            "L_high: range_low and range_high; values outside are clipped",
            when="integer types, except digital numbers, which are stored unchanged",
        ),
    )

    path: Path | None = param(None, "file to write, relative to the network file's folder")
    format: str = param(
        _BY_SUFFIX,
        "format of the file; by_suffix: from the suffix of path",
        choices=(_BY_SUFFIX, *_FORMATS),
    )
    dtype: Dtype = param("automatic", "type of the stored samples")
    range_low: float | None = param(
        None, "sample stored as 0 by integer types", zero_is_empty=False
    )
    range_high: float | None = param(
        None, "sample stored as the largest integer of the type", zero_is_empty=False
    )

    panel = (
        Section("File", "path format dtype"),
        Section("Range of integer types", "range_low range_high"),
    )

    def check(self) -> None:
        low, high = self.range_low, self.range_high
        if low is not None and high is not None and low >= high:
            raise ParameterError("range_high", high, f"above range_low = {low:g}")

    def run(self, image: Image, here: NodeContext) -> None:
        target = self.target(here)
        if ENVI_FRAMES.matches(target) and image.bands is None:
            endings = ", ".join(suffixes(*formats.WRITTEN))
            allowed = f"the picture has no spectral bands, so the name must end in {endings}"
            raise ParameterError("path", target.name, allowed)
        if ZARR.matches(target):
            check_zarr(target)
        held = _dtypes(target)
        if self.dtype not in ("automatic", *held):
            types = ", ".join(held)
            allowed = f"choose automatic, or a type that {target.suffix.lower()} can store: {types}"
            raise ParameterError("dtype", self.dtype, allowed)

    def target(self, here: NodeContext) -> Path:
        if self.path is None:
            allowed = "a file name, relative to the network file's folder"
            raise ParameterError("path", None, allowed)
        path, wanted = here.folder / self.path, _FORMATS.get(self.format)
        others = (ENVI_FRAMES, ZARR) if wanted is None else (wanted,)
        known = next((kind for kind in (*formats.WRITTEN, *others) if kind.matches(path)), None)
        if known is not None and wanted not in (None, known):
            allowed = f"the name {self.path.name} has another format's suffix; choose by_suffix"
            raise ParameterError("format", self.format, allowed)
        if known is not None:
            return path
        if wanted is None:
            endings = ", ".join(suffixes(*formats.WRITTEN, ENVI_FRAMES, ZARR))
            allowed = f"no format has this suffix; choose a format, or end the name in {endings}"
            raise ParameterError("path", self.path.as_posix(), allowed)
        return path.with_name(path.name + wanted.suffixes[0])

    def files(self, inputs: Mapping[str, Any], here: NodeContext, work: Work) -> Files:
        image: Image = inputs["image"]
        target = self.target(here)
        if ENVI_FRAMES.matches(target):
            return self._cube_files(image, target, work)
        samples = realize(image, work)
        formats.check_finite(samples, target.name)
        if ZARR.matches(target):
            kind = _FLOATS.get(self.dtype, samples.dtype)
            store = partial(write_store, samples=samples, metadata=_metadata(image), dtype=kind)
            return [(target, store)]
        dtype = self._stored(_dtypes(target), samples, image.unit)
        low, high = (None, None)
        if dtype.startswith("uint") and not self._as_they_are(image.unit):
            low, high = self._range(samples)
        writer = partial(
            formats.write_picture,
            array=samples,
            dtype=dtype,
            low=low,
            high=high,
            metadata=_metadata(image),
        )
        return [(target, writer)]

    def _cube_files(self, image: Image, target: Path, work: Work) -> Files:
        dtype = _FLOATS.get(self.dtype, np.dtype(work.policy.dtype))
        cube = Cube(image, dtype, _metadata(image))
        frames.refuse_without_room([(target, cube.series)])
        return [
            (target, partial(cube.write, work=work, name=target.name)),
            (frames.header_beside_frames(target), cube.write_header),
        ]

    def _as_they_are(self, unit: str) -> bool:
        """Whether integers are the samples themselves: digital numbers, and no range is given."""
        return unit == formats.DIGITAL_NUMBER and self.range_low is None and self.range_high is None

    def _stored(self, held: tuple[str, ...], samples: NDArray[Any], unit: str) -> str:
        if self.dtype != "automatic":
            return self.dtype
        if self._as_they_are(unit) and (whole := formats.integer_type(samples, unit, held)):
            return whole
        if "float" not in held:
            return held[-1]
        return "double" if samples.dtype == np.float64 and "double" in held else "float"

    def _range(self, samples: NDArray[Any]) -> tuple[float, float]:
        low = float(samples.min()) if self.range_low is None else self.range_low
        high = float(samples.max()) if self.range_high is None else self.range_high
        if high > low:
            return low, high
        # Every sample lies beyond the one end that was given, or all are equal.
        if self.range_high is not None:
            return math.nextafter(high, -math.inf), high
        return low, math.nextafter(low, math.inf)


def _dtypes(path: Path) -> tuple[str, ...]:
    if ENVI_FRAMES.matches(path) or ZARR.matches(path):
        return tuple(_FLOATS)
    kind = formats.written_format(path)
    return kind.dtypes if kind is not None else ()


def _metadata(image: Image) -> dict[str, MetadataValue]:
    """What Read Image finds again in the file."""
    fields: dict[str, MetadataValue] = {}
    if image.unit:
        fields["unit"] = image.unit
    for name, interval, samples in (
        ("fov_x_deg", image.interval_x_mrad, image.columns),
        ("fov_y_deg", image.interval_y_mrad, image.rows),
    ):
        fov_deg = None if interval is None else math.degrees(interval * samples / 1000)
        if fov_deg is not None and fov_deg < 180:
            fields[name] = fov_deg
    if image.header.focal_length_mm is not None:
        fields["focal_length_mm"] = image.header.focal_length_mm
    return fields


_BYTES_AT_ONCE = 1 << 26
_BANDS_AT_ONCE = 16
_TOUCHING = 1e-9  # of the wavelength, by which bands that touch may overlap by rounding


@dataclass(frozen=True)
class Cube:
    """The bands of a picture, as they are written; of a `region` alone, where one is given."""

    image: Image
    dtype: np.dtype[Any]
    metadata: Mapping[str, MetadataValue] = field(default_factory=dict)
    region: Region | None = None

    @property
    def bands(self) -> BandStack:
        assert self.image.bands is not None
        return self.image.bands

    @property
    def series(self) -> frames.FrameSeries:
        bands, unit = self.bands, _plain(self.image.unit)
        header: dict[str, MetadataValue | tuple[float, ...]] = {**self.metadata}
        header["unit"] = f"{unit}/um" if bands.density else unit
        header["wavelength_units"] = "Micrometers"
        header["wavelength"] = bands.centres_um
        header["fwhm"] = bands.widths_um
        if _overlapping(bands):  # would be shared once more where it is read
            header["band_shares"] = bands.widths_um
        shape = self.image.shape if self.region is None else self.region.shape
        return frames.FrameSeries(
            bands.count, *shape, self.dtype.newbyteorder("<"), header, "bands"
        )

    def write(self, path: Path, work: Work, *, name: str) -> None:
        dtype = self.series.dtype
        with atomic_file(path) as temporary, temporary.open("wb") as file:
            for several in work.one_by_one(self._recipes(), forgetting=True):
                work.check()
                for band in several:
                    cut = band if self.region is None else self.region.cut(band)
                    formats.check_finite(cut, name)
                    file.write(np.ascontiguousarray(cut, dtype).data)

    def write_header(self, path: Path) -> None:
        write_text(path, frames.envi_header_text(self.series))

    def _recipes(self) -> Iterator[Recipe]:
        count = self.bands.count
        of_band = self.image.rows * self.image.columns * 8
        step = min(max(1, _BYTES_AT_ONCE // of_band), _BANDS_AT_ONCE)
        for start in range(0, count, step):
            chosen = range(start, min(start + step, count))
            yield self.bands.sums(
                tuple(tuple(float(place == one) for place in range(count)) for one in chosen)
            )


def _overlapping(bands: BandStack) -> bool:
    """Whether shares of the spectrum, laid about their wavelengths, overlap."""
    order = np.argsort(bands.centres_um)
    centres, halves = np.array(bands.centres_um)[order], np.array(bands.widths_um)[order] / 2.0
    low, high = centres - halves, centres + halves
    return bool(np.any(np.maximum.accumulate(high)[:-1] > low[1:] * (1.0 + _TOUCHING)))


def _plain(unit: str) -> str:
    return unit.replace("²", "^2").replace("µ", "u")


_SUFFIXES = suffixes(*formats.MATRICES)


class WriteMatrix(
    Module, key="write_matrix", title="Write Matrix", group="Input and output", sink=True
):
    """Write values as plain text, one row per line, readable by MathCad's READPRN.

    A .csv file separates values with commas and names the columns of curves; .txt and .prn files
    use spaces. For bar charts, the first column holds the names of the bars in a .csv file, and
    their numbers, counted from 0, in other files. A transfer function is written in FFT order, zero
    frequency first. Files are written when a run saves its outputs, as for Write Image.
    """

    without_formula = "Write Matrix writes numbers unchanged."

    renamed = MappingProxyType({"curve": "image", "transfer": "image"})

    path: Path | None = param(None, "file to write, relative to the network file's folder")

    def run(self, image: Image | Curve | Transfer, here: NodeContext) -> None:
        self.target(here)

    def target(self, here: NodeContext) -> Path:
        if self.path is None:
            allowed = "a file name, relative to the network file's folder"
            raise ParameterError("path", None, allowed)
        if self.path.suffix.lower() not in _SUFFIXES:
            allowed = f"a name that ends in {', '.join(_SUFFIXES)}"
            raise ParameterError("path", self.path.as_posix(), allowed)
        return here.folder / self.path

    def files(self, inputs: Mapping[str, Any], here: NodeContext, work: Work) -> Files:
        target = self.target(here)
        value = realize(inputs["image"], work)
        if not isinstance(value, CurveData):
            return [(target, partial(write_matrix, array=value))]
        columns = curve_columns(value)
        if CSV.matches(target):
            return [(target, partial(write_curves, curves=value, columns=columns))]
        matrix = np.stack(list(columns.values()), axis=1)
        return [(target, partial(write_matrix, array=matrix))]


def curve_columns(curves: CurveData) -> dict[str, NDArray[np.float64]]:
    """Columns of equal length for curves, by unique names.

    One abscissa where all share it; else pairs of columns where all are equally long; else one
    curve below the other, with its number in the first column.
    """
    series = curves.series
    columns: dict[str, NDArray[np.float64]] = {}
    if series and all(np.array_equal(curve.x, series[0].x) for curve in series):
        columns[_name(curves.x_label, columns)] = series[0].x
        for curve in series:
            columns[_name(curve.label or curves.y_label, columns)] = curve.y
        return columns
    if series and len({len(curve.x) for curve in series}) == 1:
        for curve in series:
            columns[_name(f"{curve.label}: {curves.x_label}", columns)] = curve.x
            columns[_name(curve.label, columns)] = curve.y
        return columns
    numbers = [np.full(len(curve.x), float(n)) for n, curve in enumerate(series, 1)]
    columns["curve"] = np.concatenate([*numbers, np.empty(0)])
    columns[_name(curves.x_label, columns)] = np.concatenate([*(s.x for s in series), np.empty(0)])
    columns[_name(curves.y_label, columns)] = np.concatenate([*(s.y for s in series), np.empty(0)])
    return columns


def _name(wanted: str, taken: Mapping[str, object]) -> str:
    """`wanted` without the signs that end a name in CSV, numbered if it is taken."""
    plain = " ".join(wanted.replace(",", ";").replace('"', "'").split()) or "value"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain} ({number})", number + 1
    return name
