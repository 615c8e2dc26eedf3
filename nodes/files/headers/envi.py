"""ENVI pictures as DIRSIG writes them: raw samples, described by a text header.

Interleave bsq, bil and bip, every real data type (1, 2, 3, 4, 5, 12, 13, 14, 15), both byte
orders and a header offset. ``data gain values`` and ``data offset values`` are applied. A sample
equal to the header's ``data ignore value`` is missing: NaN. See
`nodes.files.headers.header_fields` for the header keys that are read besides ENVI's own
``wavelength``, ``wavelength units`` and ``fwhm``.
"""

from __future__ import annotations

import os

import numpy as np

from core.errors import FileError
from core.scratch import Empty
from nodes.files.common.paths import checked_band
from nodes.files.common.picture_info import PictureInfo, Samples, delivered_dtype
from nodes.files.common.size_limits import refuse_oversized
from nodes.files.headers.envi_cube import row_blocks, sample_block
from nodes.files.headers.envi_header import EnviLayout, number_list, read_layout
from nodes.files.headers.header_fields import header_fields

_TO_UM = {
    "micrometers": 1.0,
    "micrometer": 1.0,
    "microns": 1.0,
    "micron": 1.0,
    "um": 1.0,
    "µm": 1.0,
    "μm": 1.0,
    "nanometers": 1e-3,
    "nanometer": 1e-3,
    "nm": 1e-3,
    "angstroms": 1e-4,
    "angstrom": 1e-4,
    "millimeters": 1e3,
    "mm": 1e3,
    "centimeters": 1e4,
    "cm": 1e4,
    "meters": 1e6,
    "m": 1e6,
}
_NOT_APPLIED = "reflectance scale factor"
_LONGEST_ASSUMED_UM = 100.0  # beyond thermal infrared: numbers above, with no unit, are no µm
_WAVENUMBERS = ("wavenumber", "wavenumbers", "cm-1", "1/cm", "cm^-1")


def read_info(path: str | os.PathLike[str]) -> PictureInfo:
    """Read an ENVI header and check it against the size of its data file.

    Parameters
    ----------
    path
        The data file or its header.

    Raises
    ------
    FileError
        See `nodes.files.headers.envi_header.read_layout`; also a wavelength or fwhm list that is
        not one positive number for each band, or wavelengths without a unit that cannot be µm.
    """
    return info_of(read_layout(path))


def info_of(layout: EnviLayout) -> PictureInfo:
    description = layout.fields.get("description", "")
    common = header_fields(
        layout.fields,
        description=description if isinstance(description, str) else ", ".join(description),
        where=str(layout.header),
    )
    wavelengths_um, fwhm_um = _wavelengths(layout)
    listed = number_list(layout.fields, "bbl", layout.header, layout.bands) or ()
    bad_bands = tuple(place for place, good in enumerate(listed) if good == 0.0)
    return PictureInfo(
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
        **vars(common),
    )


def read_band(path: str | os.PathLike[str], band: int = 0, *, empty: Empty = np.empty) -> Samples:
    """Read one band of a data file or of its header; missing samples are NaN."""
    layout = read_layout(path)
    info = info_of(layout)  # a faulty header is refused even where its fault does not matter here
    if empty is np.empty:
        refuse_oversized(info)
    band = checked_band(band, info.bands, info.path)
    return band_of(layout, band, empty=empty)


def band_of(layout: EnviLayout, band: int, *, empty: Empty = np.empty) -> Samples:
    """One band of a checked header, as `read_band` gives it."""
    samples = empty((layout.rows, layout.columns), delivered_dtype(layout.dtype))
    for rows in row_blocks(layout, 1):
        block = sample_block(layout, rows, np.array([band]), samples.dtype)
        samples[rows] = block.reshape(-1, layout.columns)
    return samples


def _not_applied(layout: EnviLayout) -> tuple[str, ...]:
    """Names of the fields by which the header would scale the samples."""
    texts = layout.fields.get(_NOT_APPLIED, ())
    texts = [texts] if isinstance(texts, str) else texts
    scales = any(text and not _is_number(text, 1.0) for text in texts)
    return (_NOT_APPLIED,) if scales else ()


def _is_number(text: str, number: float) -> bool:
    try:
        return float(text) == number
    except ValueError:
        return False


def _wavelengths(
    layout: EnviLayout,
) -> tuple[tuple[float, ...] | None, tuple[float, ...] | None]:
    """Centres and widths in µm; None where absent or in a unit that is no length."""
    centres = _numbers(layout, "wavelength")
    widths = _numbers(layout, "fwhm")
    unit = _wavelength_unit(layout)
    if not unit:
        if centres is not None and max(centres) > _LONGEST_ASSUMED_UM:
            raise FileError(
                f"{layout.header}: wavelength reaches {max(centres):g} and the header has no "
                f"wavelength units; allowed without: µm up to {_LONGEST_ASSUMED_UM:g}; add a line "
                "such as wavelength units = Nanometers"
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
            f"{layout.header}: {key} has {len(values)} values; allowed: one for each of the "
            f"{layout.bands} bands"
        )
    for place, value in enumerate(values):
        if value <= 0:
            raise FileError(
                f"{layout.header}: {key} of band {place} = {value:g}; allowed: positive numbers"
            )
    return values
