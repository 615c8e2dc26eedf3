"""A picture file that a network names: found, described and read, and the bands of a cube."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.chain.band_stack import BandStack, Row, Rows
from core.chain.step_lineage import source_step
from core.errors import DataError, FileError, ParameterError, several
from core.evaluation.recipes import Recipe, Step, in_blocks
from core.evaluation.work import Work
from core.machine import Empty
from core.modules.declaration import NodeContext
from core.physics.radiometry.planck import PHOTON_ENERGY_J_UM
from core.physics.radiometry.radiance_units import RadianceUnit
from core.records import dataclass, field
from nodes.files import envi
from nodes.files.envi import integrate_bands
from nodes.files.envi_header import EnviLayout, header_beside, read_layout
from nodes.files.formats import check_finite, read_info, read_pixels
from nodes.files.picture_info import PictureInfo, oversized
from nodes.files.zarr_array import is_store, readable_picture, store_state

Stamp = tuple[str, int, int]
Stamps = tuple[Stamp, ...]
Interval = tuple[float, float]
Channel = int | tuple[int, ...]
"""A band, or those of red, green and blue of which the luminance is taken."""
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
Missing = Literal["refuse", "mean", "zero"]
"""What to do with samples that are NaN, infinite, or missing by the header."""
_BLOCK_SAMPLES = 1 << 20
_ADVICE = (
    "samples with the header's no-data value count as NaN; set missing to mean or zero to "
    "replace non-finite samples"
)


@dataclass(frozen=True)
class Source:
    """A picture file with what its header gives and the state its files were found in."""

    file: Path
    info: PictureInfo
    stamps: Stamps


def picture_source(path: Path | None, here: NodeContext) -> Source:
    """Find and describe the file of a `path` parameter, relative to the network's folder."""
    if path is None:
        raise ParameterError("path", None, "a picture file, relative to the network file's folder")
    # Not resolved: an ENVI header lies beside the link, not beside what the link points to.
    file = readable_picture((here.folder / path).absolute())
    header = header_beside(file)
    stamps = stamps_of(file, header)
    info = _described(file, stamps)
    if info.path != file:
        stamps += (_stamp(info.path),)
    return Source(file, info, stamps)


def read_step(
    source: Source,
    *,
    band: Channel,
    scale: float,
    node: str,
    offset: float = 0.0,
    interval_um: Interval | None = None,
    missing: Missing = "refuse",
) -> Step:
    """Recipe of a band, an interval, or the luminance of three, times `scale` plus `offset`."""
    how: dict[str, Any] = {"file": source.file, "stamps": source.stamps, "band": band}
    how |= {"scale": scale, "interval_um": interval_um, "missing": missing}
    how |= {"offset": offset} if offset else {}
    return Step.of(read_scaled, node=node, **how)


@in_blocks()
@source_step(area_means=False)  # a scene in a file may be blurred by anything
def read_scaled(
    work: Work, *, file: Path, scale: float, missing: Missing, offset: float = 0.0, **of: Any
) -> NDArray[np.floating]:
    samples = _stored(work, file, **of)
    if missing == "refuse":
        check_finite(samples, str(file), advice=_ADVICE)
    else:
        samples = _filled(work, samples, missing, file)
    if scale == 1.0 and offset == 0.0 and samples.dtype == work.policy.dtype:
        return samples
    return scaled_samples(work, samples, scale, str(file), offset)


@in_blocks()
def count_missing(work: Work, **reading: Any) -> int:
    samples = _stored(work, **reading)
    finite = (np.count_nonzero(np.isfinite(samples[rows])) for rows in work.row_slabs(samples))
    return int(samples.size - sum(finite))


def _stored(
    work: Work, file: Path, stamps: Stamps, band: Channel, interval_um: Interval | None, **_: Any
) -> NDArray[Any]:
    check_unchanged(file, stamps)
    empty: Empty = np.empty if work.blocks is None else work.empty
    if interval_um is not None:
        samples = integrate_bands(file, *interval_um, empty=empty)
    elif isinstance(band, int):
        samples = read_pixels(file, band, empty=empty)
    else:
        samples = luminance(file, band, empty=empty)
    check_unchanged(file, stamps)  # rows of before and after a change are no picture
    return samples


def luminance(file: Path, bands: tuple[int, ...], *, empty: Empty = np.empty) -> NDArray[Any]:
    samples: NDArray[Any] | None = None
    for weight, band in zip(LUMINANCE, bands, strict=True):
        channel = read_pixels(file, band, empty=empty)
        channel *= channel.dtype.type(weight)
        samples = channel if samples is None else np.add(samples, channel, out=samples)
    assert samples is not None
    return samples


def check_unchanged(file: Path, stamps: Stamps) -> None:
    if tuple(_stamp(Path(name)) for name, _, _ in stamps) != stamps:
        raise FileError(f"{file}: changed since the network was planned; run the network again")


def stamps_of(*files: Path | None) -> Stamps:
    return tuple(_stamp(one) for one in files if one is not None)


def _filled(work: Work, samples: NDArray[Any], missing: Missing, file: Path) -> NDArray[Any]:
    slabs = work.row_slabs(samples)
    number = sum(int(np.count_nonzero(np.isfinite(samples[rows]))) for rows in slabs)
    if number == samples.size:
        return samples
    if not number:
        raise DataError(f"{file}: none of the {samples.size} samples is finite")
    value = 0.0
    if missing == "mean":
        finite = (samples[rows][np.isfinite(samples[rows])] for rows in slabs)
        sums = [(np.mean(one, dtype=np.float64), one.size) for one in finite if one.size]
        value = sum(mean * (size / number) for mean, size in sums)
    for rows in slabs:
        samples[rows][~np.isfinite(samples[rows])] = value
    return samples


def scaled_samples(
    work: Work, samples: NDArray[Any], scale: float, name: str, offset: float = 0.0
) -> NDArray[np.floating]:
    """Samples of that name times a factor, plus an offset, in the evaluation's precision."""
    scaled: NDArray[Any] = work.empty(samples.shape)
    step = max(1, _BLOCK_SAMPLES // samples.shape[1])
    with np.errstate(over="ignore"):  # reported below, with the place
        for start in range(0, samples.shape[0], step):
            work.check()
            rows = slice(start, start + step)
            scaled[rows] = samples[rows].astype(np.float64) * scale + offset
    check_finite(scaled, f"{name} times scale = {scale:g} in {work.policy.precision} precision")
    return scaled


@lru_cache(maxsize=256)
def _described(file: Path, stamps: Stamps) -> PictureInfo:
    return read_info(file)


def _stamp(file: Path) -> Stamp:
    picture = readable_picture(file)
    if is_store(picture):
        return str(file), *store_state(picture)
    status = picture.stat()
    return str(file), status.st_size, status.st_mtime_ns


# Samples of a scene that are in memory, not in a file, and the picture that is read from them.

Samples = NDArray[np.floating[Any]]
_SHAPES = "allowed: (rows, columns), or (bands, rows, columns) with their wavelengths"


@dataclass(frozen=True, eq=False)
class HeldSamples:
    """Samples that nobody can change any more, named by their content.

    (rows, columns), or (bands, rows, columns) with the middle of every band; float32 or float64, C
    order, read-only. `name` is what they are called in messages.
    """

    samples: Samples
    name: str = field(default="the array")
    wavelengths_um: tuple[float, ...] | None = None
    widths_um: tuple[float, ...] | None = None

    @classmethod
    def of(
        cls,
        array: NDArray[Any],
        name: str = "the array",
        wavelengths_um: Row | None = None,
        widths_um: Row | None = None,
    ) -> HeldSamples:
        """A copy: float32 as it is, all other real numbers as float64."""
        if array.dtype.kind not in "buif":
            raise DataError(f"{name} has samples of type {array.dtype}; allowed: real numbers")
        if array.ndim != (2 if wavelengths_um is None else 3) or array.size == 0:
            raise DataError(f"{name} has the shape {array.shape}: {_SHAPES}")
        for what, values in (("wavelengths_um", wavelengths_um), ("widths_um", widths_um)):
            if values is not None and len(values) != len(array):
                raise DataError(
                    f"{what} has {several(len(values), 'number')}, but the array has "
                    f"{several(len(array), 'band')}; allowed: one number for each band"
                )
        if np.ma.is_masked(array):
            raise DataError(f"{name} has masked samples: replace them with numbers")
        single = array.dtype.newbyteorder("=") == np.float32
        kept: Any = np.float32 if single else np.float64
        samples: Samples = np.array(array, kept, order="C", copy=True)
        for place, band in enumerate(samples.reshape(-1, *samples.shape[-2:])):
            check_finite(band, name if samples.ndim == 2 else f"{name}, band {place}")
        samples.flags.writeable = False
        return cls(samples.view(), name, wavelengths_um, widths_um)

    def __reduce__(self) -> tuple[Any, ...]:
        # Made anew, so that it is read-only again.
        fields = (self.samples, self.name, self.wavelengths_um, self.widths_um)
        return HeldSamples.of, fields

    @cached_property
    def key(self) -> str:
        digest = hashlib.blake2b(self.samples.data, digest_size=16)
        samples = self.samples
        about = (samples.shape, samples.dtype.str, self.wavelengths_um, self.widths_um)
        digest.update(repr(about).encode())
        return digest.hexdigest()

    @property
    def info(self) -> PictureInfo:
        rows, columns = self.samples.shape[-2:]
        return PictureInfo(
            path=Path(self.name),
            rows=rows,
            columns=columns,
            bands=1 if self.wavelengths_um is None else len(self.wavelengths_um),
            wavelengths_um=self.wavelengths_um,
            fwhm_um=self.widths_um,
            dtype=self.samples.dtype.name,
            kind="array",
        )

    def step(self, *, scale: float, offset: float, node: str) -> Step:
        return Step.of(scaled_array, node=node, held=self, scale=scale, offset=offset)


@in_blocks()
@source_step(area_means=False)  # as a scene in a file, it may be blurred by anything
def scaled_array(work: Work, *, held: HeldSamples, scale: float, offset: float) -> Samples:
    if scale == 1.0 and offset == 0.0 and held.samples.dtype == work.policy.dtype:
        return held.samples
    return scaled_samples(work, held.samples, scale, held.name, offset)


# The spectral bands of a cube: of a file, which stays on disk, sums are made in one pass.

Span = tuple[int, int]
_WIDEST_UM = 1e6
_PER_WAVENUMBER = 1e4  # dν = 1e4/λ² dλ, ν in cm⁻¹ and λ in µm

Cube = Source | HeldSamples


def _is_file(*, cube: Cube, **_: Any) -> bool:
    return isinstance(cube, Source)


@contextmanager
def _opened(cube: Cube) -> Iterator[EnviLayout]:
    if isinstance(cube, HeldSamples):
        bands, rows, columns = cube.samples.shape
        how: Any = (cube.samples.dtype, "bsq", 0, None, None, {}, cube.samples)
        yield EnviLayout(Path(), Path(), rows, columns, bands, *how)
        return
    check_unchanged(cube.file, cube.stamps)
    yield read_layout(cube.file)
    check_unchanged(cube.file, cube.stamps)


@dataclass(frozen=True)
class CubeBands(BandStack):
    """Bands of a cube in a file or in memory, at `places` in it, times `factors`."""

    cube: Cube
    places: tuple[int, ...]
    factors: Row
    missing: Missing = "refuse"
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.cube, self.places, self.factors, self.missing

    def _source(self) -> dict[str, Any]:
        return {"cube": self.cube, "places": self.places, "missing": self.missing}

    def _with_factors(self, row: Row) -> Row:
        return tuple(float(w * f) for w, f in zip(row, self.factors, strict=True))

    def _fills(self) -> tuple[Recipe, ...]:
        """Means of the bands as stored, where these stand for what is missing."""
        if self.missing != "mean":
            return ()
        return (Step.of(_stored_means, node=self.node, **self._source()),)

    @property
    def in_blocks(self) -> bool:
        return isinstance(self.cube, Source)

    def sums(self, weights: Rows) -> Recipe:
        rows = tuple(self._with_factors(row) for row in weights)
        return Step.of(_sums, *self._fills(), node=self.node, weights=rows, **self._source())

    def picture(self, weights: Row) -> Recipe:
        row = self._with_factors(weights)
        return Step.of(_sum, *self._fills(), node=self.node, weights=row, **self._source())

    def means(self) -> Recipe:
        stored = Step.of(_stored_means, node=self.node, **self._source())
        how = {"places": self.places, "factors": self.factors}
        return Step.of(_means, stored, node=self.node, **how)

    def spectrum(self, row: int, column: int, *, rows: int = 1, columns: int = 1) -> Recipe:
        """Bands of a sample, or their mean over some; nothing else of a file is read."""
        how: Any = {"cube": self.cube, "places": self.places, "factors": self.factors}
        spans: Any = {"rows": (row, row + rows), "columns": (column, column + columns)}
        return Step.of(_spectrum, node=self.node, **how, **spans)


def bands_of(
    cube: Cube,
    *,
    unit: RadianceUnit | None,
    scale: float,
    interval_um: Interval | None,
    missing: Missing = "refuse",
    node: str,
) -> CubeBands:
    """The bands of a cube that count, by wavelength; in W/m²/sr/µm where they are radiance.

    `unit` is that of the samples times `scale`, or None. A band at an end of `interval_um` counts
    by its part within, about the middle of that part.
    """
    info = cube.info
    if info.wavelengths_um is None or (isinstance(cube, Source) and info.kind != "envi"):
        raise FileError(
            f"{info.path}: the bands have no wavelengths; give the wavelengths in an ENVI header, "
            "or set bands = one to read a single band"
        )
    low, high = interval_um or (0.0, _WIDEST_UM)
    first, last = envi.band_ends_um(info)
    _check_ends(info, first, last)
    widths = envi.band_weights_um(info, cut_on_um=low, cut_off_um=high)
    lit = [int(place) for place in np.flatnonzero(widths > 0.0)]
    places = sorted(lit, key=info.wavelengths_um.__getitem__)
    if not places:
        ends = f"{min(info.wavelengths_um):g} to {max(info.wavelengths_um):g} µm"
        allowed = (
            f"the interval from cut_on_um to cut_off_um must contain bands of the file, {ends}"
        )
        raise ParameterError("cut_on_um", low, allowed)
    centres = []
    for place in places:
        whole = first[place], last[place]
        left = max(whole[0], low), min(whole[1], high)
        centres.append(info.wavelengths_um[place] if left == whole else float(sum(left)) / 2.0)
    factors = [
        scale * (1.0 if unit is None else _per_um(unit, centre, last[place] - first[place]))
        for place, centre in zip(places, centres, strict=True)
    ]
    return CubeBands(
        tuple(centres),
        tuple(float(widths[place]) for place in places),
        cube,
        tuple(places),
        tuple(map(float, factors)),
        missing,
        node,
        density=unit is not None,
    )


def _check_ends(info: PictureInfo, first: Array, last: Array) -> None:
    """Refuse a band that reaches where no light is: widths in another unit than wavelengths."""
    sound = (first > 0.0) & (first < last) & (last <= _WIDEST_UM)
    sound[list(info.bad_bands)] = True  # left out
    assert info.wavelengths_um is not None
    for place in np.flatnonzero(~sound)[:1]:
        raise FileError(
            f"{info.path}: band {place} at {info.wavelengths_um[place]:g} µm extends from "
            f"{first[place]:g} to {last[place]:g} µm; bands must have a width and lie between "
            f"0 and {_WIDEST_UM:g} µm: check wavelength, fwhm and wavelength units in the "
            "header"
        )


def _per_um(unit: RadianceUnit, centre_um: float, width_um: float) -> float:
    """Factor to W/m²/sr/µm of a band, which without a share of wavelength holds its whole width."""
    factor = unit.factor
    if unit.photons:
        factor *= PHOTON_ENERGY_J_UM / centre_um
    if unit.spectral == "cm⁻¹":
        return factor * _PER_WAVENUMBER / centre_um**2
    return factor if unit.spectral else factor / width_um


@in_blocks(_is_file)
def _sums(
    work: Work, *fills: Array, cube: Cube, places: tuple[int, ...], weights: Rows, missing: Missing
) -> Array:
    file = cube.file if isinstance(cube, Source) else None
    with _opened(cube) as layout:
        size = layout.rows, layout.columns
        if file and work.blocks is None and (reason := oversized(*size, work.policy.dtype)):
            raise FileError(f"{file}: {reason}")
        spread = np.zeros((len(weights), layout.bands))
        spread[:, places] = weights
        used = np.flatnonzero(np.any(spread != 0.0, axis=0))

        def fill(block: Array) -> None:
            # Of the bands that are read, in their order.
            places_of = fills[0][used] if fills else np.zeros(len(used))
            number, sample = np.nonzero(~np.isfinite(block))
            block[number, sample] = places_of[number]

        sums = envi.weighted_sums(
            layout,
            spread,
            dtype=work.policy.dtype,
            fill=None if missing == "refuse" else fill,
            for_each=work.for_each,
            empty=work.empty,
        )
    if file is not None:
        for picture in sums:
            for block in work.row_slabs(picture):
                _refuse_not_finite(picture[block], block.start, file)
    return sums


def _refuse_not_finite(samples: Array, top: int, file: Path) -> None:
    finite = np.isfinite(samples)
    if finite.all():
        return
    # Not by a list of all places: a cube without data has more of these than samples.
    row, column = np.unravel_index(np.argmin(finite), finite.shape)
    raise DataError(
        f"{file}: a band has a sample that is not finite at row {top + row}, column {column}: set "
        "missing to mean or zero to replace such samples"
    )


@in_blocks(_is_file)
@source_step(area_means=False)  # a scene in a file or an array may be blurred by anything
def _sum(work: Work, *fills: Array, weights: Row, **how: Any) -> Array:
    return np.asarray(_sums(work, *fills, weights=(weights,), **how)[0])


def _stored_means(work: Work, *, cube: Cube, places: tuple[int, ...], missing: Missing) -> Array:
    """Mean of every band that counts, as stored; of its samples that are finite, or all but 0."""
    with _opened(cube) as layout:
        totals, counts = envi.band_totals(layout, for_each=work.for_each)
    size = layout.rows * layout.columns
    means = np.zeros(layout.bands)
    name = cube.file if isinstance(cube, Source) else cube.name
    for place in places:
        if missing == "refuse" and counts[place] < size:
            raise DataError(
                f"{name}: band {place} has "
                f"{several(int(size - counts[place]), 'non-finite sample')} of {size}: set "
                "missing to mean or zero to replace such samples"
            )
        if missing == "mean" and not counts[place]:
            raise DataError(f"{name}: band {place} has no finite sample")
        means[place] = totals[place] / (size if missing == "zero" else counts[place])
    return means


def _means(work: Work, stored: Array, *, places: tuple[int, ...], factors: Row) -> Array:
    return np.asarray(stored[list(places)] * np.array(factors))


def _spectrum(
    work: Work, *, cube: Cube, places: tuple[int, ...], factors: Row, rows: Span, columns: Span
) -> Array:
    with _opened(cube) as layout:
        stored = envi.mean_spectrum(layout, slice(*rows), slice(*columns))
    return np.asarray(stored[list(places)] * np.array(factors))
