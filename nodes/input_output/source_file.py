"""A picture file that a network names: found, described and read."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.step_lineage import source_step
from core.errors import DataError, FileError, ParameterError
from core.evaluation.recipes import Step, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.modules.declaration import NodeContext
from core.scratch import Empty
from nodes.files.common.picture_info import PictureInfo
from nodes.files.envi import integrate_bands
from nodes.files.envi_header import header_beside
from nodes.files.read import check_finite, read_info, read_pixels
from nodes.files.store_folder import is_store, readable_picture, store_state

Stamp = tuple[str, int, int]
Channel = int | tuple[int, ...]
"""A band, or those of red, green and blue of which the luminance is taken."""
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
Missing = Literal["refuse", "mean", "zero"]
"""What to do with samples that are NaN, infinite, or missing by the header."""
_BLOCK_SAMPLES = 1 << 20
_ADVICE = (
    "samples with the header's no-data value count as NaN; set missing to mean or zero to "
    "replace them"
)


@dataclass(frozen=True)
class Source:
    """A picture file with what its header gives and the state its files were found in."""

    file: Path
    info: PictureInfo
    stamps: tuple[Stamp, ...]


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
    interval_um: tuple[float, float] | None = None,
    missing: Missing = "refuse",
) -> Step:
    """Recipe of the samples of a band, or integrated over an interval, times `scale` and `offset`.

    Three bands are summed to their luminance. Samples that are not finite are refused, or replaced
    by the mean of the others, or by zero.
    """
    return Step.of(
        read_scaled,
        node=node,
        file=source.file,
        stamps=source.stamps,
        band=band,
        scale=scale,
        interval_um=interval_um,
        missing=missing,
        **({"offset": offset} if offset else {}),
    )


@in_blocks()
@source_step(area_means=False)  # a scene in a file may be blurred by anything
def read_scaled(
    work: Work,
    *,
    file: Path,
    stamps: tuple[Stamp, ...],
    band: Channel,
    scale: float,
    interval_um: tuple[float, float] | None,
    missing: Missing,
    offset: float = 0.0,
) -> NDArray[np.floating]:
    samples = _stored(work, file, stamps, band, interval_um)
    if missing == "refuse":
        check_finite(samples, str(file), advice=_ADVICE)
    else:
        samples = _filled(work, samples, missing, file)
    if scale == 1.0 and offset == 0.0 and samples.dtype == work.policy.dtype:
        return samples
    return scaled_samples(work, samples, scale, str(file), offset)


@in_blocks()
@ends_lineage
def count_missing(
    work: Work,
    *,
    file: Path,
    stamps: tuple[Stamp, ...],
    band: Channel,
    interval_um: tuple[float, float] | None,
    **_: Any,
) -> int:
    samples = _stored(work, file, stamps, band, interval_um)
    finite = (np.count_nonzero(np.isfinite(samples[rows])) for rows in work.row_slabs(samples))
    return int(samples.size - sum(finite))


def _stored(
    work: Work,
    file: Path,
    stamps: tuple[Stamp, ...],
    band: Channel,
    interval_um: tuple[float, float] | None,
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


def check_unchanged(file: Path, stamps: tuple[Stamp, ...]) -> None:
    """Refuse a file that is another one than was planned with (`FileError`)."""
    if tuple(_stamp(Path(name)) for name, _, _ in stamps) != stamps:
        raise FileError(f"{file}: changed since the network was planned; run the network again")


def stamps_of(*files: Path | None) -> tuple[Stamp, ...]:
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
    """Samples times a factor, plus an offset, in the evaluation's precision.

    `name` is what they are called.
    """
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
def _described(file: Path, stamps: tuple[Stamp, ...]) -> PictureInfo:
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

    (rows, columns), or (bands, rows, columns) with the middle of every band and perhaps its width;
    float32 or float64, C order, read-only. `name` is what they are called in messages.
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
        wavelengths_um: tuple[float, ...] | None = None,
        widths_um: tuple[float, ...] | None = None,
    ) -> HeldSamples:
        """A copy: float32 as it is, all other real numbers as float64."""
        if array.dtype.kind not in "buif":
            raise DataError(f"{name} has samples of type {array.dtype}; allowed: real numbers")
        if array.ndim != (2 if wavelengths_um is None else 3) or array.size == 0:
            raise DataError(f"{name} has the shape {array.shape}: {_SHAPES}")
        for what, values in (("wavelengths_um", wavelengths_um), ("widths_um", widths_um)):
            if values is not None and len(values) != len(array):
                raise DataError(f"{what} has {len(values)} numbers for {len(array)} bands")
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
        """Content key: equal samples of equal type have the same."""
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
