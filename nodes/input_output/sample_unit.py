"""What the samples of a picture file are in, and the factor that brings radiance to W and m²."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.errors import DataError, FileError, ParameterError
from core.evaluation.recipes import ends_lineage, in_blocks
from core.evaluation.work import Work
from core.machine import ForEach, in_turn
from core.modules.parameters import Caution
from core.physics.radiometry import spectra
from core.physics.radiometry.radiance_units import RadianceUnit, radiance_unit
from core.records import dataclass
from nodes.files.picture_info import PictureInfo

DEFAULT_UNIT = "W/m²/sr"


SampleUnit = tuple[str, float]
"""The unit of the samples once they are multiplied by the factor."""


def is_spectral(info: PictureInfo) -> bool:
    """Whether a file holds bands that can be summed: not one that is the radiance of a whole."""
    if info.wavelengths_um is None:
        return False
    try:
        unit = radiance_unit(info.unit) if info.unit and info.bands == 1 else None
    except DataError:
        return True
    return unit is None or bool(unit.spectral)


def sample_unit(info: PictureInfo, *, typed: str, scale: float, integrated: bool) -> SampleUnit:
    """Unit of the samples of a file after `scale`.

    The file's own unit holds where it gives one and the scale is 1, else the typed one. Radiance
    comes out in W/m²/sr, W/m²/sr/µm, W/m²/sr/cm⁻¹ or the same in photons/s, which do not become
    watts; every other unit is a name that stays. `integrated`: bands were summed up, each times its
    width in µm.
    """
    own = _typed(typed)
    chosen = bool(typed) and own != RadianceUnit(1.0)
    if not info.unit or scale != 1.0:
        if integrated or info.bands > 1:
            _refuse_unnamed(info, named=chosen or scale != 1.0)
        return _of_typed(info, typed, own, integrated)
    try:
        stored = _stored(info, "unit or scale")
    except FileError:
        if chosen and not integrated:
            return _of_typed(info, typed, own, integrated)
        raise
    if stored is None:
        return _of_typed(info, typed, own, integrated) if chosen else (info.unit, 1.0)
    file_unit = stored.integrated if integrated else stored
    if not chosen and file_unit.photons:
        raise FileError(
            f"{info.path}: the samples are in {info.unit} and cannot be converted to watts, "
            "because a photon's energy depends on its wavelength; set unit = "
            f"{file_unit.name} to keep photons, or set scale to convert to watts"
        )
    if chosen and (own is None or own.name != file_unit.name):
        allowed = f"give a unit of the same kind as the file's unit, {info.unit}, or give scale"
        raise ParameterError("unit", typed, allowed)
    return file_unit.name, file_unit.factor


def spectral_unit(info: PictureInfo, *, typed: str, scale: float) -> RadianceUnit | None:
    """Unit of the samples of a file's bands times `scale`; None where they are no radiance.

    As in `sample_unit` the file's own unit holds where it gives one and the scale is 1. A radiance
    typed without a share of wavelength is per µm.
    """
    own = _typed(typed)
    chosen = bool(typed) and own != RadianceUnit(1.0)
    if info.unit and scale == 1.0:
        stored = _stored(info, "unit and scale")
        if chosen and (own and own.name) != (stored and stored.name):
            allowed = f"give a unit of the same kind as the file's unit, {info.unit}, or give scale"
            raise ParameterError("unit", typed, allowed)
        return stored
    _refuse_unnamed(info, named=chosen or scale != 1.0)
    if own is None or own.spectral:
        return own
    return RadianceUnit(own.factor, own.photons, "µm")


def _refuse_unnamed(info: PictureInfo, *, named: bool) -> None:
    """Refuse the cube of a file of which nobody says what its samples are in."""
    if info.kind == "envi" and info.wavelengths_um and not info.unit and not named:
        raise FileError(
            f"{info.path}: the header has no data units: add a line such as data units = "
            "W/m^2/sr/um, or set unit to the samples' unit, such as W/cm²/sr/µm or DN"
        )


def _stored(info: PictureInfo, remedy: str) -> RadianceUnit | None:
    try:
        return radiance_unit(info.unit or "")
    except DataError as error:
        raise FileError(
            f"{info.path}: {error.message}; correct the header, or give {remedy}"
        ) from error


def _typed(text: str) -> RadianceUnit | None:
    try:
        return radiance_unit(text)
    except DataError as error:
        allowed = f"must be {error.message.partition('; allowed: ')[2]}"
        raise ParameterError("unit", text, allowed) from error


def _of_typed(
    info: PictureInfo, typed: str, own: RadianceUnit | None, integrated: bool
) -> SampleUnit:
    if own is None:
        return typed, 1.0
    if not integrated or not own.spectral:
        return own.name, own.factor
    if own.spectral != "µm":
        raise ParameterError(
            "unit",
            typed,
            "must be per µm or nm, because the file's bands are integrated over wavelength",
        )
    # The sum over the bands took the samples per µm, or as the file gives it.
    stored = radiance_unit(info.unit) if info.unit else None
    taken = stored.per_um if stored is not None else 1.0
    return RadianceUnit(1.0, own.photons).name, own.factor / taken


_REMEDY = "give the samples' unit, such as K or DN, or the scale that converts them to W/m²/sr"


@in_blocks()
@ends_lineage
def radiance_caution(
    work: Work, samples: NDArray[Any], *, band_um: tuple[float, float] | None, unit_stated: bool
) -> Caution | None:
    """Samples in W/m²/sr that cannot be radiance of a scene, or look like temperatures.

    They cannot where their mean is above what any surface of the Earth gives in the band. Without a
    band, nor a unit, they look like temperatures where mean ± 2 σ (three quarters of the samples at
    least, after Chebyshev) lie between the coldest and the hottest land surface ever seen.
    """
    stats = statistics(samples, for_each=work.for_each)
    limit = spectra.brightest_surface_radiance(band_um=band_um)
    kelvin = _like_kelvin(stats)
    if stats.mean > limit:
        where = (
            "at all wavelengths" if band_um is None else f"from {band_um[0]:g} to {band_um[1]:g} µm"
        )
        looks = "; the samples look like temperatures in kelvin" if kelvin else ""
        return Caution(
            f"the samples' mean, {stats.mean:.4g} W/m²/sr, exceeds {limit:.3g} W/m²/sr, the most "
            f"that a surface on Earth can emit and reflect {where}{looks}",
            f"{_REMEDY}; ignore this warning for flames, lamps, engines and the Sun",
        )
    if band_um is None and kelvin and not unit_stated:
        least = spectra.coldest_for_radiance(radiance=stats.mean)
        return Caution(
            f"the unit may be wrong: the samples, {stats.mean:.4g} ± {stats.sigma:.2g}, look "
            "like temperatures in kelvin but are read as W/m²/sr; over all wavelengths, no scene "
            f"below {least:.0f} K emits as much",
            f"{_REMEDY}; if the samples are radiance, give cut_on_um and cut_off_um",
        )
    return None


def _like_kelvin(stats: Statistics) -> bool:
    low, high = stats.mean - 2 * stats.sigma, stats.mean + 2 * stats.sigma
    return low >= spectra.COLDEST_SURFACE_K and high <= spectra.HOTTEST_SURFACE_K


BLOCK_SAMPLES = 1 << 18
_LEAST, _MOST = 1e-100, 1e100  # deviations that can be squared as they are


@dataclass(frozen=True)
class Statistics:
    minimum: float
    maximum: float
    mean: float
    sigma: float


def blocks(samples: Array, check: Callable[[], None]) -> Iterator[NDArray[np.float64]]:
    """The samples in order as 1-D blocks in double precision, `check` called before each."""
    flat = samples.reshape(-1)
    for start in range(0, flat.size, BLOCK_SAMPLES):
        check()
        yield flat[start : start + BLOCK_SAMPLES].astype(np.float64)


def statistics(samples: Array, *, for_each: ForEach = in_turn) -> Statistics:
    low, high = float(samples.min()), float(samples.max())
    # Relative to the minimum: the sum of large equal samples would round their mean.
    mean = low + _sum_of(samples, lambda block: float(np.sum(block)), low, for_each) / samples.size
    mean = min(max(mean, low), high)
    reach = max(high - mean, mean - low)
    if reach == 0.0:
        return Statistics(low, high, mean, 0.0)
    # Squares of huge or tiny deviations leave the range of numbers.
    scale = 1.0 if _LEAST < reach < _MOST else reach

    def squares(block: Array) -> float:
        if scale != 1.0:
            block /= scale
        return float(np.einsum("i,i->", block, block))

    mean_square = _sum_of(samples, squares, mean, for_each) / samples.size
    return Statistics(low, high, mean, scale * math.sqrt(mean_square))


def _sum_of(
    samples: Array, summed: Callable[[Array], float], offset: float, for_each: ForEach
) -> float:
    """Sum of a function's values on the blocks in double precision, less an offset."""
    flat = samples.reshape(-1)
    starts = range(0, flat.size, BLOCK_SAMPLES)
    sums = [0.0] * len(starts)

    def one(index: int) -> None:
        start = starts[index]
        block = flat[start : start + BLOCK_SAMPLES].astype(np.float64)
        block -= offset
        sums[index] = summed(block)

    for_each(one, range(len(starts)))
    return math.fsum(sums)


def histogram(
    samples: Array, *, bins: int, check: Callable[[], None]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Centres of equal bins from minimum to maximum, and the samples in each; one if constant."""
    low, high = float(samples.min()), float(samples.max())
    width = high - low
    if width == 0.0:
        return np.array([low]), np.array([float(samples.size)])
    counts = np.zeros(bins, np.int64)
    for block in blocks(samples, check):
        index = ((block - low) / width * bins).astype(np.int64)
        counts += np.bincount(np.minimum(index, bins - 1), minlength=bins)
    centres = low + (np.arange(bins) + 0.5) / bins * width
    return centres, counts.astype(np.float64)
