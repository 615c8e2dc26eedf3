"""ENVI pictures as DIRSIG writes them: raw samples, described by a text header.

Gains and offsets are applied; a sample equal to ``data ignore value`` is missing: NaN.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.arrays import Array
from core.errors import DataError, FileError, ParameterError, several
from core.machine import Empty, ForEach, in_turn
from core.physics.radiometry.radiance_units import radiance_unit
from core.records import replace
from nodes.files import picture_info
from nodes.files.envi_header import EnviLayout, number_list, read_layout
from nodes.files.stored_bytes import checked_band, stored_bytes
from nodes.files.table_cells import numbers_of

_TO_UM = {
    name: factor
    for factor, names in (
        (1.0, "micrometers micrometer microns micron um µm μm"),
        (1e-3, "nanometers nanometer nm"),
        (1e-4, "angstroms angstrom"),
        (1e3, "millimeters mm"),
        (1e4, "centimeters cm"),
        (1e6, "meters m"),
    )
    for name in names.split()
}
_NOT_APPLIED = "reflectance scale factor"
_LONGEST_ASSUMED_UM = 100.0  # beyond thermal infrared: numbers above, with no unit, are no µm
_WAVENUMBERS = ("wavenumber", "wavenumbers", "cm-1", "1/cm", "cm^-1")


def read_info(path: str | os.PathLike[str]) -> picture_info.PictureInfo:
    return info_of(read_layout(path))


def info_of(layout: EnviLayout) -> picture_info.PictureInfo:
    description = layout.fields.get("description", "")
    common = picture_info.header_fields(
        layout.fields,
        description=description if isinstance(description, str) else ", ".join(description),
        where=str(layout.header),
    )
    wavelengths_um, fwhm_um = _wavelengths(layout)
    listed = number_list(layout.fields, "bbl", layout.header, layout.bands) or ()
    bad_bands = tuple(place for place, good in enumerate(listed) if good == 0.0)
    return picture_info.PictureInfo(
        path=layout.data,
        rows=layout.rows,
        columns=layout.columns,
        bands=layout.bands,
        wavelengths_um=wavelengths_um,
        fwhm_um=fwhm_um,
        shares_um=None if fwhm_um is None else _numbers(layout, "band shares"),
        dtype=layout.value_dtype.name,
        kind="envi",
        not_applied=_not_applied(layout),
        wavelengths_assumed=wavelengths_um is not None and not _wavelength_unit(layout),
        bad_bands=bad_bands if layout.bands > 1 else (),
        **common,
    )


def read_band(
    path: str | os.PathLike[str], band: int = 0, *, empty: Empty = np.empty
) -> picture_info.Samples:
    layout = read_layout(path)
    info = info_of(layout)  # a faulty header is refused even where its fault does not matter here
    if empty is np.empty:
        picture_info.refuse_oversized(info)
    band = checked_band(band, info.bands, info.path)
    return band_of(layout, band, empty=empty)


def band_of(layout: EnviLayout, band: int, *, empty: Empty = np.empty) -> picture_info.Samples:
    samples = empty((layout.rows, layout.columns), picture_info.delivered_dtype(layout.dtype))
    for rows in row_blocks(layout, 1):
        block = sample_block(layout, rows, np.array([band]), samples.dtype)
        samples[rows] = block.reshape(-1, layout.columns)
    return samples


def _not_applied(layout: EnviLayout) -> tuple[str, ...]:
    texts = layout.fields.get(_NOT_APPLIED, ())
    texts = [texts] if isinstance(texts, str) else texts
    numbers = numbers_of(filter(None, texts))
    scales = numbers is None or any(number != 1.0 for number in numbers)
    return (_NOT_APPLIED,) if scales else ()


def _wavelengths(layout: EnviLayout) -> tuple[tuple[float, ...] | None, tuple[float, ...] | None]:
    centres = _numbers(layout, "wavelength")
    widths = _numbers(layout, "fwhm")
    unit = _wavelength_unit(layout)
    if not unit:
        if centres is not None and max(centres) > _LONGEST_ASSUMED_UM:
            raise FileError(
                f"{layout.header}: the header gives wavelengths up to {max(centres):g} without "
                f"wavelength units; values above {_LONGEST_ASSUMED_UM:g} are not assumed to be in "
                "µm: add a line such as wavelength units = Nanometers"
            )
        return centres, widths
    if unit in _WAVENUMBERS:
        return _from_wavenumbers(centres, widths)
    factor = _TO_UM.get(unit)
    if factor is None:
        return None, None
    return (
        None if centres is None else tuple(value * factor for value in centres),
        None if widths is None else tuple(value * factor for value in widths),
    )


def _wavelength_unit(layout: EnviLayout) -> str:
    return str(layout.fields.get("wavelength units", "")).strip().lower()


def _from_wavenumbers(
    centres: tuple[float, ...] | None, widths: tuple[float, ...] | None
) -> tuple[tuple[float, ...] | None, tuple[float, ...] | None]:
    if centres is None:
        return None, None
    centres_um = tuple(1e4 / value for value in centres)
    if widths is None:
        return centres_um, None
    # d(1/k) = dk/k²: the width of a narrow band; both edges would shift the centre as well.
    return centres_um, tuple(1e4 * w / k**2 for k, w in zip(centres, widths, strict=True))


def _numbers(layout: EnviLayout, key: str) -> tuple[float, ...] | None:
    values = number_list(layout.fields, key, layout.header, layout.bands)
    if values is None:
        return None
    if len(values) != layout.bands:
        raise FileError(
            f"{layout.header}: {key} has {several(len(values), 'value')} for "
            f"{several(layout.bands, 'band')}; allowed: one value per band"
        )
    for place, value in enumerate(values):
        if value <= 0:
            raise FileError(
                f"{layout.header}: {key} of band {place} = {value:g}; allowed: positive numbers"
            )
    return values


def integrate_bands(
    path: str | os.PathLike[str],
    cut_on_um: float,
    cut_off_um: float,
    *,
    min_coverage: float = 0.99,
    empty: Empty = np.empty,
) -> picture_info.Samples:
    """Integrate spectral radiance over an interval of wavelength: L = Σ L_k·w_k, in double.

    `min_coverage` is the least part of the interval that the bands must cover. The result has the
    file's unit times µm: DIRSIG's W cm⁻² sr⁻¹ µm⁻¹ gives W cm⁻² sr⁻¹. A file without a unit is
    taken to be per µm, as DIRSIG's are; a unit per nm is allowed for.
    """
    layout = read_layout(path)
    info = info_of(layout)
    if empty is np.empty:
        picture_info.refuse_oversized(info)
    weights = band_weights_um(info, cut_on_um=cut_on_um, cut_off_um=cut_off_um)
    _check_coverage(info, cut_on_um, cut_off_um, min_coverage)
    weights = weights * _per_um(info)
    used = np.flatnonzero(weights)
    total = empty((info.rows, info.columns), picture_info.delivered_dtype(layout.value_dtype))
    for rows in row_blocks(layout, len(used)):
        block = sample_block(layout, rows, used, np.dtype(np.float64))
        block *= weights[used][:, None]
        total[rows] = block.sum(axis=0).reshape(-1, info.columns)
    return total


def band_weights_um(
    info: picture_info.PictureInfo, *, cut_on_um: float, cut_off_um: float
) -> NDArray[np.float64]:
    """Width of each band's share of the interval, µm; the sum is the covered part of the interval.

    A band reaches over wavelength ± fwhm/2; without ``fwhm`` half-way to its neighbours, which
    inside the spectrum is the trapezoid rule. Where bands overlap they share the width equally, so
    that a constant spectrum L gives L·(covered width); gaps and bad bands count nothing. Shares
    that the header gives itself (``band shares``) hold as they are.
    """
    if not (math.isfinite(cut_on_um) and cut_on_um >= 0):
        raise ParameterError("cut_on_um", cut_on_um, "a finite number of 0 or more")
    if not (math.isfinite(cut_off_um) and cut_off_um > cut_on_um):
        allowed = f"a finite number above cut_on_um = {cut_on_um:g}"
        raise ParameterError("cut_off_um", cut_off_um, allowed)
    low, high = band_ends_um(info)
    whole = high - low
    low, high = np.maximum(low, cut_on_um), np.minimum(high, cut_off_um)
    high = np.maximum(low, high)
    if info.shares_um is not None:
        parts = np.divide(high - low, whole, out=np.zeros_like(whole), where=whole > 0)
        return np.asarray(np.array(info.shares_um) * parts)
    edges = np.unique(np.concatenate([low, high]))
    # Of the pieces between two edges, where each band begins and ends: no table of both.
    first, last = np.searchsorted(edges, low), np.searchsorted(edges, high)
    starts, ends = (np.bincount(places, minlength=len(edges)) for places in (first, last))
    sharing = np.cumsum(starts - ends)
    shares = np.zeros(len(edges))
    np.divide(np.diff(edges), sharing[:-1], out=shares[:-1], where=sharing[:-1] > 0)
    widths = np.add.reduceat(shares, np.column_stack([first, last]).ravel())[::2]
    return np.asarray(np.where(first < last, widths, 0.0), dtype=np.float64)


def band_ends_um(info: picture_info.PictureInfo) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wavelengths from which and up to which each band reaches, µm; as `band_weights_um` has it."""
    if info.wavelengths_um is None:
        raise FileError(
            f"{info.path}: the header gives no wavelengths in a unit of length, so the bands "
            "cannot be integrated"
        )
    centres = np.asarray(info.wavelengths_um)
    if len(info.bad_bands) == len(centres):
        raise FileError(
            f"{info.path}: the header marks all bands as bad (bbl = 0); remove bbl from the "
            "header if the samples are good"
        )
    if info.fwhm_um is not None:
        half = np.asarray(info.fwhm_um) / 2
        half[list(info.bad_bands)] = 0.0
        return centres - half, centres + half
    order = np.argsort(centres)
    order = order[~np.isin(order, info.bad_bands)]
    spacing = np.diff(centres[order])
    if order.size < 2 or not np.all(spacing > 0):
        raise FileError(
            f"{info.path}: the header gives no fwhm, so the bands can be integrated "
            "only if there are two or more good bands, all at different wavelengths"
        )
    low, high = centres.copy(), centres.copy()  # a bad band has no width
    low[order] = centres[order] - np.concatenate([spacing[:1], spacing]) / 2
    high[order] = centres[order] + np.concatenate([spacing, spacing[-1:]]) / 2
    return low, high


def coverage(info: picture_info.PictureInfo, interval_um: tuple[float, float] | None) -> float:
    """Share of an interval that the bands cover, 0 to 1; of all from first to last without one."""
    low, high = band_ends_um(info)
    first, last = interval_um or (max(0.0, float(low.min())), float(high.max()))
    covered = band_weights_um(replace(info, shares_um=None), cut_on_um=first, cut_off_um=last)
    return float(covered.sum() / (last - first))


def _check_coverage(
    info: picture_info.PictureInfo, cut_on_um: float, cut_off_um: float, min_coverage: float
) -> None:
    """Bands that are bad count here as if they were there: a warning tells of those."""
    every = replace(info, bad_bands=())
    covered = coverage(every, (cut_on_um, cut_off_um)) * (cut_off_um - cut_on_um)
    if covered > 0 and covered >= min_coverage * (cut_off_um - cut_on_um):
        return
    low, high = band_ends_um(every)
    raise ParameterError(
        "cut_on_um, cut_off_um",
        (cut_on_um, cut_off_um),
        f"the bands of {info.path.name} cover {covered:.6g} µm of this interval; set "
        "cut_on_um and cut_off_um within the bands, which lie between "
        f"{low.min():.6g} and {high.max():.6g} µm",
    )


def _per_um(info: picture_info.PictureInfo) -> float:
    if not info.unit:
        return 1.0
    try:
        unit = radiance_unit(info.unit)
    except DataError as error:
        raise FileError(f"{info.path}: {error.message}") from error
    if unit is None or unit.spectral != "µm":
        raise FileError(
            f"{info.path}: the samples are in {info.unit}, not per unit wavelength; read one band "
            "instead of integrating"
        )
    return unit.per_um


# Weighted sums of a file's bands, read block by block: the cube is never in memory whole.


_BLOCK_BYTES = 1 << 21  # of samples as the file has them, so that they stay in a core's cache
_PIECE = 1 << 13  # samples of one matrix product: a larger one would start threads of its own


def weighted_sums(
    layout: EnviLayout,
    weights: NDArray[np.float64],
    *,
    dtype: np.dtype[Any],
    fill: Callable[[Array], None] | None = None,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Array:
    """Σ_b w_b·L_b for a few rows of weights (sums, bands), in one pass over the file.

    Bands whose weights are all 0 are not read where they lie by themselves. Samples are multiplied
    and summed in `dtype`. `fill` is given every block, (bands, samples), with NaN for what is
    missing, to put numbers in place of those; without, such sums are not finite.
    """
    used = np.flatnonzero(np.any(weights != 0.0, axis=0))
    sums = empty((len(weights), layout.rows, layout.columns), dtype)
    if len(used) == 0:
        sums.fill(0.0)
        return sums
    chosen = np.ascontiguousarray(weights[:, used].astype(dtype))
    as_stored = fill is None and layout.missing is None and layout.dtype == dtype
    as_stored = as_stored and layout.scaling is None
    in_a_row = int(used[-1]) - int(used[0]) == len(used) - 1

    def one(rows: slice) -> None:
        if as_stored and in_a_row and layout.interleave != "bsq":
            # A band that does not count, which may be no number, is left out by a view.
            stored = _stored_rows(layout, rows, used)
            bands = slice(int(used[0]), int(used[-1]) + 1)
            _multiply(stored, bands, chosen, sums[:, rows], layout.interleave)
            return
        block = sample_block(layout, rows, used, dtype)
        if fill is not None:
            fill(block)
        made = sums[:, rows].reshape(len(weights), -1)  # a copy where rows are not all
        for left in range(0, block.shape[1], _PIECE):
            part = slice(left, left + _PIECE)
            made[:, part] = chosen @ block[:, part]
        sums[:, rows] = made.reshape(sums[:, rows].shape)

    for_each(one, list(row_blocks(layout, len(used))))
    return sums


def _multiply(stored: Array, bands: slice, factors: Array, sums: Array, order: str) -> None:
    """Σ_b w_b·L_b of some rows, straight from the file's samples as they lie."""
    if order == "bil":
        for row in range(len(stored)):
            np.matmul(factors, stored[row, bands], out=sums[:, row])
        return
    columns = sums.shape[2]
    step = max(1, _PIECE // columns)
    for start in range(0, len(stored), step):
        part = slice(start, start + step)
        samples = stored[part, :, bands].reshape(-1, factors.shape[1]).T
        made = sums[:, part].reshape(len(sums), -1)
        made[...] = factors @ samples
        sums[:, part] = made.reshape(sums[:, part].shape)


def band_totals(
    layout: EnviLayout, *, for_each: ForEach = in_turn
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    blocks = list(row_blocks(layout, layout.bands))
    totals = np.zeros((len(blocks), layout.bands))
    counts = np.zeros((len(blocks), layout.bands), np.int64)
    every = np.arange(layout.bands)

    def one(item: tuple[int, slice]) -> None:
        number, rows = item
        block = sample_block(layout, rows, every, np.dtype(np.float64))
        finite = np.isfinite(block)
        counts[number] = finite.sum(axis=1)
        totals[number] = np.where(finite, block, 0.0).sum(axis=1)

    for_each(one, list(enumerate(blocks)))
    return totals.sum(axis=0), counts.sum(axis=0)


def mean_spectrum(layout: EnviLayout, rows: slice, columns: slice) -> NDArray[np.float64]:
    """Mean of all bands over some samples, (bands,); NaN where one is missing."""
    every = np.arange(layout.bands)
    block = sample_block(layout, rows, every, np.dtype(np.float64))
    samples = block.reshape(layout.bands, -1, layout.columns)[:, :, columns]
    return np.asarray(samples.mean(axis=(1, 2)))


def row_blocks(layout: EnviLayout, bands: int) -> Iterator[slice]:
    read = bands if layout.interleave == "bsq" else layout.bands
    of_row = layout.columns * read * layout.dtype.itemsize
    step = max(1, _BLOCK_BYTES // of_row)
    for start in range(0, layout.rows, step):
        yield slice(start, min(start + step, layout.rows))


def sample_block(layout: EnviLayout, rows: slice, bands: Array, dtype: np.dtype[Any]) -> Array:
    """Samples of some rows, (bands, rows·columns), by gain and offset; NaN where missing."""
    stored = _stored_rows(layout, rows, bands)
    if layout.interleave == "bil":
        stored = stored[:, bands].transpose(1, 0, 2)
    elif layout.interleave == "bip":
        stored = stored.reshape(-1, layout.bands).T[bands]
    stored = stored.reshape(len(bands), -1)
    samples = np.ascontiguousarray(stored, dtype)
    missing = None if layout.missing is None else stored == layout.missing
    if layout.scaling is not None:  # in place: only a file's samples, which are nobody else's
        gains, offsets = layout.scaling[:, bands]
        samples *= gains[:, None]
        samples += offsets[:, None]
    if missing is not None:
        samples[missing] = np.nan
    return samples


def _stored_rows(layout: EnviLayout, rows: slice, bands: Array) -> Array:
    """Samples of some rows in the file's order; of its bands only these where they lie apart."""
    if layout.in_memory is not None:
        return layout.in_memory[bands, rows]
    count = rows.stop - rows.start
    columns, every = layout.columns, layout.bands
    start, size = layout.offset_bytes, layout.dtype.itemsize
    with stored_bytes(layout.data) as file:
        if layout.interleave == "bsq":
            stored = np.empty((len(bands), count, columns), layout.dtype)
            for place, band in enumerate(bands):
                first = (int(band) * layout.rows + rows.start) * columns
                file.fill(stored[place], start + first * size)
            return stored
        inner = (every, columns) if layout.interleave == "bil" else (columns, every)
        stored = np.empty((count, *inner), layout.dtype)
        file.fill(stored, start + rows.start * columns * every * size)
    return stored
