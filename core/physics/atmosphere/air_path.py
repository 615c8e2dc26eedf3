"""What the air between scene and camera does to radiance: transmission and path radiance.

L' = τ(λ)·L + L_path(λ). One wavelength obeys the law of Bouguer and Beer, τ(R) = exp(−β·R); a band
does not, as the wavelengths that the air absorbs are gone after the first part of the way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import DataError, ParameterError
from core.physics.checks import finite, non_negative, positive, within
from core.physics.radiometry.constants import SECOND_RADIATION_CONSTANT_UM_K
from core.physics.radiometry.planck import band_nodes, band_radiance, spectral_radiance

FloatArray = NDArray[np.float64]
Points = tuple[tuple[float, float], ...]
Band = tuple[float, float]

KOSCHMIEDER = 3.912
"""−ln 0.02: the optical depth at which a black object has 2 % of contrast left."""

VISIBLE_UM = 0.55
"""Wavelength at which a visibility holds."""

_NEAR = 1e-9  # by which a table may end before the band
_LARGEST_X = 700.0


@dataclass(frozen=True)
class PathBand:
    """Mean transmission of a path over a band, and what it adds to the radiance, W/m²/sr."""

    transmission: float
    path_radiance: float

    @property
    def optical_depth(self) -> float:
        """−ln of the transmission, infinite where nothing passes."""
        return -math.log(self.transmission) + 0.0 if self.transmission > 0.0 else math.inf


@dataclass(frozen=True)
class AirPath:
    """Transmission and path radiance of a path, by wavelength.

    Parameters
    ----------
    range_m : float, optional
        Length for which it holds, above zero.
    transmission : float
        At all wavelengths, 0 to 1; where there are neither points nor an extinction.
    points : tuple of (float, float)
        Wavelength in µm, rising, and transmission there, straight between them.
    extinction_per_km : float, optional
        Extinction coefficient at 0.55 µm, zero or above; needs a range.
    angstrom_q : float
        The coefficient goes as (0.55/λ)^q.
    radiance : tuple of (float, float)
        Wavelength in µm, rising, and path radiance in W/m²/sr/µm.
    air_K : float, optional
        Temperature of the air, which emits (1 − τ)·L_BB; without it, and without a table of path
        radiance, there is none.

    Source: Bouguer 1729 and Beer 1852; Ångström 1929 (exponent); Kirchhoff's law for air of one
    temperature that scatters nothing into the path.
    """

    range_m: float | None = None
    transmission: float = 1.0
    points: Points = ()
    extinction_per_km: float | None = None
    angstrom_q: float = 0.0
    radiance: Points = ()
    air_K: float | None = None

    def __post_init__(self) -> None:
        within("transmission", self.transmission, 0.0, 1.0)
        finite("angstrom_q", self.angstrom_q)
        if self.range_m is not None:
            positive("range_m", self.range_m, unit="m")
        if self.air_K is not None:
            non_negative("air_K", self.air_K, unit="K")
        for _, value in self.points:
            within("transmission", value, 0.0, 1.0)
        for _, value in self.radiance:
            non_negative("path_radiance", value, unit="W/m²/sr/µm")
        if self.extinction_per_km is not None:
            non_negative("extinction_per_km", self.extinction_per_km, unit="1/km")
            if self.range_m is None:
                raise _no_range()

    @property
    def is_grey(self) -> bool:
        """Whether all wavelengths pass alike."""
        if self.points:
            return False
        return not self.extinction_per_km or self.angstrom_q == 0.0

    @property
    def is_clear(self) -> bool:
        """Whether nothing is lost and nothing added."""
        if not self.is_grey or any(value for _, value in self.radiance):
            return False
        return self._grey_depth() == 0.0

    def depth(self, wavelength_um: ArrayLike) -> FloatArray:
        """Optical depth of the path at wavelengths, µm; infinite where nothing passes."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.points:
            known, values = np.array(self.points).T
            with np.errstate(divide="ignore"):
                return np.asarray(-np.log(np.interp(wavelength, known, values)) + 0.0)
        grey = self._grey_depth()
        if self.is_grey:
            return np.full(wavelength.shape, grey)
        return np.asarray(grey * (VISIBLE_UM / wavelength) ** self.angstrom_q)

    def depth_per_m(self, wavelength_um: ArrayLike) -> FloatArray:
        """The same of a metre of it, where the range is known for which the transmission holds."""
        if self.range_m is None:
            raise _no_range()
        return self.depth(wavelength_um) / self.range_m

    def added(self, wavelength_um: ArrayLike) -> FloatArray:
        """Path radiance at wavelengths, W/m²/sr/µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.radiance:
            known, values = np.array(self.radiance).T
            return np.asarray(np.interp(wavelength, known, values))
        if self.air_K is None:
            return np.zeros(wavelength.shape)
        emissivity = -np.expm1(-self.depth(wavelength))
        return np.asarray(emissivity * spectral_radiance(wavelength, self.air_K))

    def over_band(self, cut_on_um: float, cut_off_um: float, *, source_K: float | None) -> PathBand:
        """Mean transmission ∫τ·L_λ dλ/∫L_λ dλ and path radiance ∫L_path dλ of a band.

        A black body of `source_K` weights the transmission; None for a weight that is the same all
        over. It is of no account where all wavelengths pass alike. A table must cover the band.
        """
        self.require_covered(cut_on_um, cut_off_um)
        wavelength, width = self._nodes(cut_on_um, cut_off_um)
        if not self.is_grey:
            weight = width
            if source_K is not None:
                weight = width * spectral_radiance(wavelength, source_K)
            total = float(weight.sum())
            if not total > 0.0:
                raise DataError(
                    f"a black body of {source_K:g} K emits nothing from {cut_on_um:g} to "
                    f"{cut_off_um:g} µm, so it cannot weight the transmission"
                )
            passed = float(weight @ np.exp(-self.depth(wavelength))) / total
            return PathBand(min(passed, 1.0), float(width @ self.added(wavelength)))
        depth = self._grey_depth()
        added = 0.0
        if self.radiance:
            added = float(width @ self.added(wavelength))
        elif self.air_K is not None:
            band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
            added = -math.expm1(-depth) * float(band_radiance(temperature_K=self.air_K, **band))
        return PathBand(math.exp(-depth), added)

    def require_covered(self, cut_on_um: float, cut_off_um: float) -> None:
        """Refuse a band that a table does not cover (`DataError`)."""
        for points in (self.points, self.radiance):
            require_covered(points, cut_on_um, cut_off_um)

    def within_band(self, cut_on_um: float, cut_off_um: float) -> AirPath:
        """The same with no more of its tables than the band needs."""
        return replace(
            self,
            points=_cut(self.points, cut_on_um, cut_off_um),
            radiance=_cut(self.radiance, cut_on_um, cut_off_um),
        )

    def _grey_depth(self) -> float:
        """Optical depth at 0.55 µm, or at all wavelengths."""
        if self.extinction_per_km is not None and self.range_m is not None:
            return self.extinction_per_km * (self.range_m / 1000.0)
        return -math.log(self.transmission) + 0.0 if self.transmission > 0.0 else math.inf

    @property
    def places_um(self) -> tuple[float, ...]:
        """Wavelengths at which its tables bend."""
        return tuple(sorted({place for place, _ in (*self.points, *self.radiance)}))

    def _nodes(self, low: float, high: float) -> tuple[FloatArray, FloatArray]:
        return band_nodes(low, high, self.places_um)


def require_covered(points: Points, cut_on_um: float, cut_off_um: float) -> None:
    """Refuse a band that a table, if there is one, does not cover (`ParameterError`)."""
    if not points:
        return
    first, last = points[0][0], points[-1][0]
    if first > cut_on_um * (1.0 + _NEAR) or last < cut_off_um * (1.0 - _NEAR):
        raise DataError(
            f"the table covers {first:g} to {last:g} µm, not the whole band: give a table that "
            f"covers {cut_on_um:g} to {cut_off_um:g} µm, or a narrower band"
        )


@lru_cache(maxsize=32)
def path_of_bands(
    air: AirPath, centres_um: tuple[float, ...], widths_um: tuple[float, ...]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Mean transmission and mean path radiance, W/m²/sr/µm, of narrow bands of a flat spectrum.

    Where a band has no width its centre alone counts.
    """
    gain, added = [], []
    for centre, width in zip(centres_um, widths_um, strict=True):
        low, high = centre - width / 2.0, centre + width / 2.0
        if not low < high:
            air.require_covered(centre, centre)
            gain.append(math.exp(-float(air.depth(centre))))
            added.append(float(air.added(centre)))
            continue
        band = air.within_band(low, high).over_band(low, high, source_K=None)
        gain.append(band.transmission)
        added.append(band.path_radiance / (high - low))
    return tuple(gain), tuple(added)


def extinction_of_visibility(*, visibility_km: float) -> float:
    """Extinction coefficient at 0.55 µm, 1/km, of a visibility: 3.912/V.

    At the visibility a black object before the horizon has 2 % of contrast left.
    Source: Koschmieder 1924; the threshold of 2 % is the usual one.
    """
    return KOSCHMIEDER / positive("visibility_km", visibility_km, unit="km")


def transmission_at_ranges(
    *,
    paths: Sequence[AirPath],
    range_m: ArrayLike,
    cut_on_um: float,
    cut_off_um: float,
    background_K: float,
) -> Any:
    """Share of a small temperature difference that is left after a range.

    Parameters
    ----------
    paths : sequence of AirPath
        What the air consists of; each, of a known range of its own, holds along the whole range.
    range_m : array_like
        Ranges in m, zero or above.
    cut_on_um, cut_off_um : float
        The band, µm, which a table must cover.
    background_K : float
        Temperature about which the difference is, above zero.

    Returns
    -------
    float or ndarray
        ∫τ(λ, R)·∂L/∂T dλ over ∫∂L/∂T dλ, of the shape of `range_m`.

    Source: Bouguer 1729, Beer 1852. A table is taken to have no lines narrower than its steps: of
    molecular lines it is exact at the table's own range, and the further from it the less so.
    """
    for path in paths:
        path.require_covered(cut_on_um, cut_off_um)
    distance = np.asarray(range_m, np.float64)
    if all(path.is_grey for path in paths):
        middle = (cut_on_um + cut_off_um) / 2.0
        per_m = sum(float(path.depth_per_m(middle)) for path in paths)
        return _passed(np.asarray([per_m]), np.ones(1), distance)
    places = tuple(sorted({place for path in paths for place in path.places_um}))
    wavelength, width = band_nodes(cut_on_um, cut_off_um, places)
    x = SECOND_RADIATION_CONSTANT_UM_K / (wavelength * background_K)
    x = np.minimum(x, _LARGEST_X)  # beyond, the radiance is zero anyway
    weight = width * spectral_radiance(wavelength, background_K) * x / -np.expm1(-x)
    total = float(weight.sum())
    if not total > 0.0:
        raise DataError(
            f"a background of {background_K:g} K emits nothing from {cut_on_um:g} to "
            f"{cut_off_um:g} µm, so it cannot weight the transmission"
        )
    depth = np.sum([path.depth_per_m(wavelength) for path in paths], axis=0)
    return _passed(depth, weight / total, distance)


def _passed(depth_per_m: FloatArray, weight: FloatArray, distance: FloatArray) -> Any:
    """Σ w·exp(−depth·R) for each range; all passes over no distance."""
    opaque = np.isinf(depth_per_m)
    ranges = distance.reshape(-1, 1)
    with np.errstate(under="ignore", over="ignore"):
        left = np.exp(-np.where(opaque, 0.0, depth_per_m) * ranges)
    left = np.where(opaque & (ranges > 0.0), 0.0, left)
    return np.minimum((left @ weight).reshape(distance.shape), 1.0)[()]


def _cut(points: Points, low: float, high: float) -> Points:
    """The points in the band, and one beyond each end."""
    places = [place for place, _ in points]
    first = max(int(np.searchsorted(places, low, side="right")) - 1, 0)
    last = int(np.searchsorted(places, high, side="left"))
    return points[first : last + 1]


def _no_range() -> ParameterError:
    return ParameterError(
        "range_m",
        None,
        "set the range of the path here, put this node after a Camera with range_m, or "
        "connect the context of Init & Trans",
        unit="m",
    )
