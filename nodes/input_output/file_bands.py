"""The spectral bands of a cube: of a file, which stays on disk, sums are made in one pass."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.band_stack import BandStack, Row, Rows
from core.chain.step_lineage import source_step
from core.errors import DataError, FileError, ParameterError
from core.evaluation.recipes import Recipe, Step, ends_lineage, in_blocks
from core.evaluation.work import Work
from core.physics.detector.photon_conversion import PHOTON_ENERGY_J_UM
from core.physics.radiometry.radiance_units import RadianceUnit
from nodes.files import envi
from nodes.files.common.picture_info import PictureInfo, oversized
from nodes.files.envi import CubeInMemory, Layout
from nodes.files.envi_header import read_layout
from nodes.input_output.source_file import HeldSamples, Missing, Source, Stamp, check_unchanged

Array = NDArray[Any]
Interval = tuple[float, float]
_WIDEST_UM = 1e6
_PER_WAVENUMBER = 1e4  # dν = 1e4/λ² dλ, ν in cm⁻¹ and λ in µm


@dataclass(frozen=True)
class CubeFile:
    """An ENVI file, in the state (`stamps`) in which the network was planned with it."""

    file: Path
    stamps: tuple[Stamp, ...]


Cube = CubeFile | HeldSamples


def _is_file(*, cube: Cube, **_: Any) -> bool:
    return isinstance(cube, CubeFile)


@contextmanager
def _opened(cube: Cube) -> Iterator[Layout]:
    if isinstance(cube, HeldSamples):
        yield CubeInMemory(cube.samples)
        return
    check_unchanged(cube.file, cube.stamps)
    yield read_layout(cube.file)
    check_unchanged(cube.file, cube.stamps)


@dataclass(frozen=True)
class CubeBands(BandStack):
    """Bands of a cube, which stays where it is: in a file, or in memory.

    `places` are their indices in the cube, `factors` what their samples are multiplied by.
    """

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
        return isinstance(self.cube, CubeFile)

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
        return Step.of(
            _spectrum,
            node=self.node,
            cube=self.cube,
            places=self.places,
            factors=self.factors,
            rows=(row, row + rows),
            columns=(column, column + columns),
        )


def bands_of(
    cube: Source | HeldSamples,
    *,
    unit: RadianceUnit | None,
    scale: float,
    interval_um: tuple[float, float] | None,
    missing: Missing = "refuse",
    node: str,
) -> CubeBands:
    """The bands of a cube that count, by wavelength; in W/m²/sr/µm where they are radiance.

    `unit` is that of the samples times `scale`, None where they are no radiance. Of `interval_um` a
    band at an end counts by its part within, about the middle of that part.
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
    places = sorted(lit, key=lambda place: _centre(info, place))
    if not places:
        ends = f"{min(info.wavelengths_um):g} to {max(info.wavelengths_um):g} µm"
        raise ParameterError(
            "cut_on_um", low, f"an interval that contains bands of the file, {ends}"
        )
    centres = [_middle(info, place, (first[place], last[place]), (low, high)) for place in places]
    factors = [
        scale * (1.0 if unit is None else _per_um(unit, centre, last[place] - first[place]))
        for place, centre in zip(places, centres, strict=True)
    ]
    return CubeBands(
        tuple(centres),
        tuple(float(widths[place]) for place in places),
        CubeFile(cube.file, cube.stamps) if isinstance(cube, Source) else cube,
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
    for place in np.flatnonzero(~sound)[:1]:
        raise FileError(
            f"{info.path}: band {place} at {_centre(info, int(place)):g} µm extends from "
            f"{first[place]:g} to {last[place]:g} µm; bands must have a width and lie between "
            f"0 and {_WIDEST_UM:g} µm: check wavelength, fwhm and wavelength units in the "
            "header"
        )


def _centre(info: PictureInfo, place: int) -> float:
    assert info.wavelengths_um is not None
    return info.wavelengths_um[place]


def _middle(info: PictureInfo, place: int, ends: Interval, interval: Interval) -> float:
    left = max(ends[0], interval[0]), min(ends[1], interval[1])
    return _centre(info, place) if left == ends else float(sum(left)) / 2.0


def _per_um(unit: RadianceUnit, centre_um: float, width_um: float) -> float:
    """Factor to W/m²/sr/µm of a band, which without a share of wavelength holds its whole width."""
    factor = unit.factor
    if unit.photons:
        factor *= PHOTON_ENERGY_J_UM / centre_um
    if unit.spectral == "cm⁻¹":
        return factor * _PER_WAVENUMBER / centre_um**2
    return factor if unit.spectral else factor / width_um


def _made_sums(
    work: Work,
    fills: tuple[Array, ...],
    cube: Cube,
    places: tuple[int, ...],
    rows: Rows,
    missing: Missing,
) -> Array:
    file = cube.file if isinstance(cube, CubeFile) else None
    with _opened(cube) as layout:
        if file is not None and work.blocks is None:
            reason = oversized(layout.rows, layout.columns, work.policy.dtype)
            if reason:
                raise FileError(f"{file}: {reason}")
        weights = np.zeros((len(rows), layout.bands))
        weights[:, places] = rows
        used = np.flatnonzero(np.any(weights != 0.0, axis=0))

        def fill(block: Array) -> None:
            # Of the bands that are read, in their order.
            places_of = fills[0][used] if fills else np.zeros(len(used))
            number, sample = np.nonzero(~np.isfinite(block))
            block[number, sample] = places_of[number]

        sums = envi.weighted_sums(
            layout,
            weights,
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
        "missing to mean or zero to replace samples that are not finite or missing"
    )


@in_blocks(_is_file)
@ends_lineage
def _sums(
    work: Work, *fills: Array, cube: Cube, places: tuple[int, ...], weights: Rows, missing: Missing
) -> Array:
    return _made_sums(work, fills, cube, places, weights, missing)


@in_blocks(_is_file)
@source_step(area_means=False)  # a scene in a file or an array may be blurred by anything
def _sum(
    work: Work, *fills: Array, cube: Cube, places: tuple[int, ...], weights: Row, missing: Missing
) -> Array:
    return np.asarray(_made_sums(work, fills, cube, places, (weights,), missing)[0])


@ends_lineage
def _stored_means(work: Work, *, cube: Cube, places: tuple[int, ...], missing: Missing) -> Array:
    """Mean of every band that counts, as stored; of its samples that are finite, or all but 0."""
    with _opened(cube) as layout:
        totals, counts = envi.band_totals(layout, for_each=work.for_each)
    size = layout.rows * layout.columns
    means = np.zeros(layout.bands)
    name = cube.file if isinstance(cube, CubeFile) else cube.name
    for place in places:
        if missing == "refuse" and counts[place] < size:
            raise DataError(
                f"{name}: {size - counts[place]} of {size} samples of band {place} are not "
                "finite: set missing to mean or zero to replace them"
            )
        if missing == "mean" and not counts[place]:
            raise DataError(f"{name}: band {place} has no finite sample")
        means[place] = totals[place] / (size if missing == "zero" else counts[place])
    return means


@ends_lineage
def _means(work: Work, stored: Array, *, places: tuple[int, ...], factors: Row) -> Array:
    return np.asarray(stored[list(places)] * np.array(factors))


@ends_lineage
def _spectrum(
    work: Work,
    *,
    cube: Cube,
    places: tuple[int, ...],
    factors: Row,
    rows: tuple[int, int],
    columns: tuple[int, int],
) -> Array:
    with _opened(cube) as layout:
        stored = envi.mean_spectrum(layout, slice(*rows), slice(*columns))
    return np.asarray(stored[list(places)] * np.array(factors))
