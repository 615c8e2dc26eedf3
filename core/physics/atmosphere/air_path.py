"""What the air between scene and camera does to radiance: transmission and path radiance.

L' = τ(λ)·L + L_path(λ). One wavelength obeys the law of Bouguer and Beer, τ(R) = exp(−β·R); a band
does not, as the wavelengths that the air absorbs are gone after the first part of the way.
"""

import math
from collections.abc import Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Floats
from core.errors import DataError, ParameterError
from core.physics.numerics import finite, non_negative, positive, within
from core.physics.radiometry.planck import (
    band_nodes,
    band_radiance,
    spectral_radiance,
    spectral_radiance_slope,
)
from core.physics.radiometry.spectra import SUN_SHARE, SUNLIGHT_K
from core.records import dataclass, replace

Points = tuple[tuple[float, float], ...]
Band = tuple[float, float]

KOSCHMIEDER = 3.912
"""−ln 0.02: the optical depth at which a black object has 2 % of contrast left."""

VISIBLE_UM = 0.55
"""Wavelength at which a visibility holds."""

_NEAR = 1e-9  # by which a table may end before the band


def optical_depth(*, transmission: float) -> float:
    """−ln of a transmission, infinite where nothing passes."""
    return -math.log(transmission) + 0.0 if transmission > 0.0 else math.inf


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

    def depth(self, wavelength_um: ArrayLike) -> Floats:
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

    def depth_per_m(self, wavelength_um: ArrayLike) -> Floats:
        """The same of a metre of it, where the range is known for which the transmission holds."""
        if self.range_m is None:
            raise _no_range()
        return self.depth(wavelength_um) / self.range_m

    def added(self, wavelength_um: ArrayLike) -> Floats:
        """Path radiance at wavelengths, W/m²/sr/µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.radiance:
            known, values = np.array(self.radiance).T
            return np.asarray(np.interp(wavelength, known, values))
        if self.air_K is None:
            return np.zeros(wavelength.shape)
        emissivity = -np.expm1(-self.depth(wavelength))
        return np.asarray(emissivity * spectral_radiance(wavelength, self.air_K))

    def over_band(
        self, cut_on_um: float, cut_off_um: float, *, source_K: float | None
    ) -> tuple[float, float]:
        """Mean transmission ∫τ·L_λ dλ/∫L_λ dλ, and path radiance ∫L_path dλ, W/m²/sr, of a band.

        A black body of `source_K` weights the transmission; None for a weight that is the same all
        over. It is of no account where all wavelengths pass alike. A table must cover the band.
        """
        self.require_covered(cut_on_um, cut_off_um)
        wavelength, width = band_nodes(cut_on_um, cut_off_um, self.places_um)
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
            return min(passed, 1.0), float(width @ self.added(wavelength))
        depth = self._grey_depth()
        added = 0.0
        if self.radiance:
            added = float(width @ self.added(wavelength))
        elif self.air_K is not None:
            band = {"cut_on_um": cut_on_um, "cut_off_um": cut_off_um}
            added = -math.expm1(-depth) * float(band_radiance(temperature_K=self.air_K, **band))
        return math.exp(-depth), added

    def require_covered(self, cut_on_um: float, cut_off_um: float) -> None:
        """Refuse a band that a table does not cover (`DataError`)."""
        for points in (self.points, self.radiance):
            require_covered(points, cut_on_um, cut_off_um)

    def within_band(self, cut_on_um: float, cut_off_um: float) -> "AirPath":
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
        return optical_depth(transmission=self.transmission)

    @property
    def places_um(self) -> tuple[float, ...]:
        """Wavelengths at which its tables bend."""
        return tuple(sorted({place for place, _ in (*self.points, *self.radiance)}))


def require_covered(points: Points, cut_on_um: float, cut_off_um: float) -> None:
    """Refuse a band that a table, if there is one, does not cover (`DataError`)."""
    if not points:
        return
    first, last = points[0][0], points[-1][0]
    if first > cut_on_um * (1.0 + _NEAR) or last < cut_off_um * (1.0 - _NEAR):
        raise DataError(
            f"the table covers {first:g} to {last:g} µm, not the whole band. Give a table that "
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
        passed, radiance = air.within_band(low, high).over_band(low, high, source_K=None)
        gain.append(passed)
        added.append(radiance / (high - low))
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
    weight = width * spectral_radiance_slope(wavelength, background_K)
    total = float(weight.sum())
    if not total > 0.0:
        raise DataError(
            f"a background of {background_K:g} K emits nothing from {cut_on_um:g} to "
            f"{cut_off_um:g} µm, so it cannot weight the transmission"
        )
    depth = np.sum([path.depth_per_m(wavelength) for path in paths], axis=0)
    return _passed(depth, weight / total, distance)


def _passed(depth_per_m: Floats, weight: Floats, distance: Floats) -> Any:
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
        "connect the context of Init & Trans, put this node after a Camera that has a range, or "
        "set the range of the path here",
        unit="m",
    )


# Light of sun and sky on a horizontal matt surface, and what that reflects.

SUN_SR = math.pi * SUN_SHARE
"""Solid angle of the Sun at its mean distance."""


@lru_cache(maxsize=1)
def standard_sun() -> tuple[Floats, Floats]:
    """Wavelengths of the standard solar spectrum, 0.28 to 4 µm, and its irradiance, W/m²/µm.

    Source: ASTM G173-03, extraterrestrial column (Gueymard 2004, Solar Energy 76, 423), as
    distributed by NREL with SMARTS 2.9.2.
    """
    path = Path(__file__).with_name("astm_g173_extraterrestrial.csv")
    wavelength, irradiance = np.loadtxt(path, delimiter=",", unpack=True)
    return wavelength, irradiance


def standard_sun_irradiance(wavelength_um: ArrayLike) -> Floats:
    """Irradiance of the Sun above the air, at one astronomical unit, by the standard spectrum.

    Parameters
    ----------
    wavelength_um : array_like
        From 0.28 µm on. Beyond 4 µm, where the table ends, a black body of 5800 K continues it.

    Returns
    -------
    ndarray
        W/m²/µm, straight between the points of the table.

    Raises
    ------
    ParameterError
        For a wavelength below the table.

    Source: ASTM G173-03, as of `standard_sun`.
    """
    wavelength = np.asarray(wavelength_um, np.float64)
    known, values = standard_sun()
    shortest = float(wavelength.min(initial=math.inf))
    if not shortest >= known[0]:
        allowed = f"at least {known[0]:g}, where the standard solar spectrum begins"
        raise ParameterError("cut_on_um", shortest, allowed, unit="µm")
    inside = np.interp(wavelength, known, values)
    if not np.any(wavelength > known[-1]):
        return np.asarray(inside)
    end = float(spectral_radiance(known[-1], SUNLIGHT_K))
    beyond = values[-1] / end * spectral_radiance(wavelength, SUNLIGHT_K)
    return np.asarray(np.where(wavelength > known[-1], beyond, inside))


LUMENS_PER_WATT = 683.0
EYE_UM = 0.38, 0.78
"""Wavelengths that the photopic eye sees."""

# Times 10⁻⁶, every 5 nm from 380 nm.
_EYE = (
    39, 64, 120, 217, 396, 640, 1210, 2180, 4000, 7300, 11600, 16840, 23000, 29800, 38000, 48000,
    60000, 73900, 90980, 112600, 139020, 169300, 208020, 258600, 323000, 407300, 503000, 608200,
    710000, 793200, 862000, 914850, 954000, 980300, 994950, 1000000, 995000, 978600, 952000,
    915400, 870000, 816300, 757000, 694900, 631000, 566800, 503000, 441200, 381000, 321000, 265000,
    217000, 175000, 138200, 107000, 81600, 61000, 44580, 32000, 23200, 17000, 11920, 8210, 5723,
    4102, 2929, 2091, 1484, 1047, 740, 520, 361, 249, 172, 120, 85, 60, 42, 30, 21, 15,
)  # fmt: skip


def luminous_efficiency(wavelength_um: ArrayLike) -> Floats:
    """V(λ): sensitivity of the light-adapted eye, 1 at 0.555 µm, 0 outside 0.38 to 0.78 µm.

    Source: CIE 018 (2019), table of V(λ), straight between its points.
    """
    known = np.linspace(*EYE_UM, len(_EYE))
    wavelength = np.asarray(wavelength_um, np.float64)
    values = np.interp(wavelength, known, np.array(_EYE) * 1e-6, left=0.0, right=0.0)
    return np.asarray(values)


def relative_air_mass(*, elevation_deg: float) -> float:
    """Length of the sun's way through the air over that from the zenith.

    1 at the zenith within 0.03 %, 38 at the horizon.
    Source: F. Kasten and A. T. Young, Appl. Opt. 28, 4735 (1989).
    """
    height = within("sun_elevation_deg", elevation_deg, 0.0, 90.0, unit="deg")
    below = 0.50572 * (height + 6.07995) ** -1.6364
    return float(1.0 / (math.sin(math.radians(height)) + below))


@dataclass(frozen=True)
class Sunlight:
    """Sun and sky over a horizontal surface.

    Parameters
    ----------
    irradiance : float, optional
        Of the sun above the air, W/m²/µm, on a surface that faces it; at all wavelengths.
    points : tuple of (float, float)
        Wavelength in µm, rising, and that irradiance, straight between them.
    standard : bool
        Without both, the standard spectrum, or a black body of 5800 K at the sun's distance.
    sky : float
        Radiance of the sky, the same all over, W/m²/sr/µm.
    optical_depth : float
        Of the air from the zenith, in the way of the sun alone.
    illuminance_lux : float, optional
        To which all this light is scaled: 683 lm/W·∫V(λ)·E(λ) dλ.

    Source: Lambert 1760: L = ρ·(E_sun·e^{−τm}·sin h + E_sky)/π, E_sky = π·L_sky of an even sky.
    """

    elevation_deg: float
    irradiance: float | None = None
    points: Points = ()
    standard: bool = True
    sky: float = 0.0
    optical_depth: float = 0.0
    illuminance_lux: float | None = None

    def __post_init__(self) -> None:
        within("sun_elevation_deg", self.elevation_deg, 0.0, 90.0, unit="deg")
        non_negative("sky", self.sky, unit="W/m²/sr/µm")
        non_negative("optical_depth", self.optical_depth)
        if self.irradiance is not None:
            non_negative("solar_irradiance", self.irradiance, unit="W/m²/µm")
        for _, value in self.points:
            non_negative("solar_irradiance", value, unit="W/m²/µm")

    def on_surface(self, wavelength_um: ArrayLike) -> Floats:
        """Irradiance of a horizontal surface at wavelengths, W/m²/µm."""
        scale = 1.0
        if self.illuminance_lux is not None:
            if not self.unscaled_lux:
                allowed = "the spectrum has no light from 0.38 to 0.78 µm that could be scaled"
                if self.unscaled_lux is None:
                    allowed = "the spectrum must cover 0.38 to 0.78 µm"
                elif not (self.elevation_deg or self.sky):
                    allowed = (
                        "no light reaches the ground with the sun on the horizon and sky = 0. "
                        "Raise sun_elevation_deg"
                    )
                raise ParameterError("illuminance_lux", self.illuminance_lux, allowed, unit="lx")
            scale = self.illuminance_lux / self.unscaled_lux
        return scale * self._unscaled(wavelength_um)

    @cached_property
    def unscaled_lux(self) -> float | None:
        """Illuminance before it is scaled; None if the table does not cover what the eye sees."""
        places = [place for place, _ in self.points]
        if places and (places[0] > EYE_UM[0] or places[-1] < EYE_UM[1]):
            return None
        places = [*np.linspace(*EYE_UM, len(_EYE)).tolist(), *self._places()]
        wavelength, width = band_nodes(*EYE_UM, sorted(set(places)))
        seen = luminous_efficiency(wavelength) * self._unscaled(wavelength)
        return LUMENS_PER_WATT * float(width @ seen)

    def _unscaled(self, wavelength_um: ArrayLike) -> Floats:
        wavelength = np.asarray(wavelength_um, np.float64)
        if self.points:
            known, values = np.array(self.points).T
            sun = np.interp(wavelength, known, values)
        elif self.irradiance is not None:
            sun = np.full(wavelength.shape, self.irradiance)
        elif self.standard:
            sun = standard_sun_irradiance(wavelength)
        else:
            sun = SUN_SR * spectral_radiance(wavelength, SUNLIGHT_K)
        way = relative_air_mass(elevation_deg=self.elevation_deg)
        passed = math.exp(-self.optical_depth * way)
        share = passed * math.sin(math.radians(self.elevation_deg))
        return np.asarray(share * sun + math.pi * self.sky)

    def over_band(self, cut_on_um: float, cut_off_um: float) -> float:
        """Irradiance of a horizontal surface in a band, W/m², which the spectrum must cover."""
        require_covered(self.points, cut_on_um, cut_off_um)
        wavelength, width = band_nodes(cut_on_um, cut_off_um, self._places())
        return float(width @ self.on_surface(wavelength))

    def _places(self) -> Sequence[float]:
        if self.standard and self.irradiance is None and not self.points:
            return list(map(float, standard_sun()[0]))
        return [place for place, _ in self.points]
