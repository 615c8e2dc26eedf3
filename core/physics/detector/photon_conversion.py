"""Photon radiance as a detector counts it: weighted with its quantum efficiency."""

import math
from collections.abc import Callable
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from core import kernels
from core.arrays import Array, Floats
from core.errors import DataError, ParameterError
from core.physics import numerics
from core.physics.detector.detectivity import ResponseCurve
from core.physics.radiometry import planck
from core.physics.radiometry.planck import PHOTON_ENERGY_J_UM
from core.records import dataclass


def efficiency_of_responsivity(
    *, responsivity_A_per_W: float, wavelength_um: float, gain: float = 1.0
) -> float:
    """Electrons per photon of a current responsivity at a wavelength: R·hc/(G·q·λ), at most 1.

    The current includes the charge gain G.
    Source: Rogalski 2011, Infrared Detectors, 2nd ed., chapter 3, R = G·η·q·λ/(hc).
    """
    wavelength = numerics.positive("responsivity_um", wavelength_um, unit="µm")
    most = gain * planck.ELEMENTARY_CHARGE_C * wavelength / PHOTON_ENERGY_J_UM
    efficiency = numerics.positive("responsivity_A_per_W", responsivity_A_per_W, unit="A/W") / most
    if efficiency > 1.0:
        allowed = f"at most {most:.4g} at {wavelength:g} µm, for a quantum efficiency of 1"
        raise ParameterError("responsivity_A_per_W", responsivity_A_per_W, allowed, unit="A/W")
    return efficiency


@dataclass(frozen=True)
class QuantumEfficiency:
    """Electrons per photon in a band: one number, or points joined by straight lines.

    Outside the band, and beyond the first and last point, nothing is counted. Points are (µm,
    efficiency), rising; `value` holds in the whole band where there are none.
    """

    cut_on_um: float
    cut_off_um: float
    value: float = 1.0
    points: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        numerics.positive("cut_on_um", self.cut_on_um, unit="µm")
        if not self.cut_on_um < self.cut_off_um < np.inf:
            allowed = f"above cut_on_um = {self.cut_on_um:g} µm"
            raise ParameterError("cut_off_um", self.cut_off_um, allowed, unit="µm")
        numerics.within("quantum_efficiency", self.value, 0.0, 1.0)
        if self.points and len(self._places()[0]) == 0:
            first, last = self.points[0][0], self.points[-1][0]
            raise ParameterError(
                "response",
                f"{first:g} to {last:g} µm",
                f"must overlap the band, {self.cut_on_um:g} to {self.cut_off_um:g} µm",
            )

    def at(self, wavelength_um: ArrayLike) -> Floats:
        """Efficiency at wavelengths, µm."""
        wavelength = np.asarray(wavelength_um, np.float64)
        inside = (wavelength >= self.cut_on_um) & (wavelength <= self.cut_off_um)
        if not self.points:
            return np.where(inside, self.value, 0.0)
        return np.where(inside, ResponseCurve("file", points=self.points).at(wavelength), 0.0)

    def photon_radiance(self, temperature_K: ArrayLike, *, slope: bool = False) -> Floats:
        """∫ QE·L_q dλ of black bodies, s⁻¹ m⁻² sr⁻¹, or its derivative by the temperature."""
        if self.points:
            return _summed(temperature_K, *self._places(), photons=True, slope=slope)
        integral = planck.band_photon_radiance_derivative if slope else planck.band_photon_radiance
        band = {"cut_on_um": self.cut_on_um, "cut_off_um": self.cut_off_um}
        photons = integral(temperature_K=np.asarray(temperature_K, np.float64), **band)
        return np.asarray(self.value * photons)

    def integral(self, low_um: float, high_um: float) -> float:
        """∫ QE dλ over a part of the wavelengths, µm; exact for straight lines."""
        low, high = max(low_um, self.cut_on_um), min(high_um, self.cut_off_um)
        if not low < high:
            return 0.0
        if not self.points:
            return self.value * (high - low)
        return ResponseCurve("file", points=self.points).integral(low, high)

    def mean(self) -> float:
        """Mean over the wavelengths of the band."""
        if not self.points:
            return self.value
        return float(self._places()[1].sum() / (self.cut_off_um - self.cut_on_um))

    def _places(self) -> tuple[Floats, Floats]:
        """Nodes of a quadrature between the points within the band, and weights with QE."""
        known = np.array([place for place, _ in self.points])
        low, high = max(self.cut_on_um, known[0]), min(self.cut_off_um, known[-1])
        if not low < high:
            return np.empty(0), np.empty(0)
        wavelength, weight = planck.band_nodes(float(low), float(high), known.tolist())
        efficiency = np.interp(wavelength, known, [value for _, value in self.points])
        return wavelength, weight * efficiency


def _summed(
    temperature_K: ArrayLike,
    wavelength_um: Floats,
    weight: Floats,
    *,
    photons: bool = False,
    slope: bool = False,
) -> Floats:
    """Weighted sums of black bodies' light, in photons if these are wanted, or its derivative."""
    temperature = np.asarray(temperature_K, np.float64)
    light_of = planck.spectral_radiance_slope if slope else planck.spectral_radiance
    light = light_of(wavelength_um, temperature.reshape(-1, 1))
    if photons:
        light = light * wavelength_um / PHOTON_ENERGY_J_UM
    return np.asarray((light @ weight).reshape(temperature.shape))


# From the radiance of a band to electrons, where no spectrum is known.
#
# Photons per watt depend on the spectrum. A thermal scene's is that of a black body of each
# sample's own brightness temperature; sunlight's that of a source; or all photons have the energy
# of the band's middle. Electrons over radiance is then a smooth function of the radiance's
# logarithm that lies between the efficiencies at the ends of the band: one Chebyshev sum serves all
# samples.

Weighting = Literal["scene", "source", "middle", "spectrum"]
WEIGHTINGS: tuple[Weighting, ...] = ("scene", "source", "middle")
SHORTEST_THERMAL_UM = 2.5
"""What reaches a camera of shorter waves is reflected light, of no brightness temperature."""

_DEEPEST = 1e-9  # of the largest radiance; below it electrons are in proportion to the radiance
_COLDEST_K, _HOTTEST_K, _LEAST_LIGHT = 1.0, 1e6, 1e-290
_FLAT = 1e-14  # of ln L: a picture of one value
_FINEST = 2e-14
_FIT_SIZES = (8, 16, 32, 64)
_STEPS = 80
_NEWTON_STEPS, _NEAR = 60, 1e-14  # of ln L
_HORNER = 10  # terms up to which powers are as accurate as the recurrence


@dataclass(frozen=True)
class FilteredBody:
    """What a detector receives of black bodies.

    The light comes in the `windows`, parts of the band in µm, twice where two overlap, and has
    passed the responses; the efficiency is that of the detector within its filter.
    """

    windows: tuple[tuple[float, float], ...]
    efficiency: QuantumEfficiency
    responses: tuple[ResponseCurve, ...] = ()

    def photons(self, temperature_K: ArrayLike, *, slope: bool = False) -> Floats:
        """∫ QE·R·L_q dλ, s⁻¹ m⁻² sr⁻¹, or its derivative by the temperature."""
        if self._counts_all:
            return self.efficiency.photon_radiance(temperature_K, slope=slope)
        return _summed(temperature_K, *self._counting, slope=slope)

    @property
    def flat_photons(self) -> float:
        """∫ QE·R·λ/(hc) dλ: photons counted of 1 W/m²/sr/µm at all wavelengths."""
        return float(self._counting[1].sum())

    def radiance(self, temperature_K: ArrayLike, *, slope: bool = False) -> Floats:
        """∫ R·L dλ, W/m²/sr, or its derivative by the temperature."""
        if self.responses:
            return _summed(temperature_K, *self._passing, slope=slope)
        integral = planck.band_radiance_derivative if slope else planck.band_radiance
        return integral(temperature_K=np.asarray(temperature_K, np.float64), **self._band)

    def temperature(self, radiance: ArrayLike) -> Floats:
        """Temperatures whose `radiance` is this."""
        wanted = np.asarray(radiance, np.float64)
        if not self.responses:
            return planck.brightness_temperature(radiance=wanted, **self._band)
        target = np.log(wanted)
        inverse = np.full(wanted.shape, 1.0 / 300.0)
        for _ in range(_NEWTON_STEPS):
            kelvin = 1.0 / inverse
            there = self.radiance(kelvin)
            away = np.log(there) - target
            # d ln L/d(1/T) = −T²·L'/L
            step = away * there / (self.radiance(kelvin, slope=True) * kelvin**2)
            # The logarithm bends upwards where it is steep: no further than by halves or doubles.
            inverse = np.clip(inverse + step, inverse / 2.0, inverse * 2.0)
            inverse = np.clip(inverse, 1.0 / _HOTTEST_K, 1.0 / _COLDEST_K)
            if np.abs(away).max() <= _NEAR:
                break
        if not np.allclose(np.log(self.radiance(1.0 / inverse)), target, rtol=0.0, atol=1e-9):
            raise DataError(
                f"no black body from {_COLDEST_K:g} to {_HOTTEST_K:g} K has a response-weighted "
                f"radiance of {float(wanted.ravel()[0]):.6g} W/m²/sr"
            )
        return np.asarray(1.0 / inverse)

    @property
    def _band(self) -> dict[str, float]:
        ((low, high),) = self.windows
        return {"cut_on_um": low, "cut_off_um": high}

    @property
    def _counts_all(self) -> bool:
        """Whether all that the detector counts by its efficiency is what it receives."""
        detector = self.efficiency.cut_on_um, self.efficiency.cut_off_um
        return not self.responses and self.windows == (detector,)

    @cached_property
    def _passing(self) -> tuple[Floats, Floats]:
        """Nodes of a quadrature over the windows, and weights with the responses."""
        places = sorted(
            {place for response in self.responses for place in response.bends_um}
            | {place for place, _ in self.efficiency.points}
            | {self.efficiency.cut_on_um, self.efficiency.cut_off_um}
        )
        nodes = [planck.band_nodes(*window, places) for window in self.windows]
        wavelength = np.concatenate([place for place, _ in nodes])
        weight = np.concatenate([width for _, width in nodes])
        for response in self.responses:
            weight = weight * response.at(wavelength)
        return wavelength, weight

    @cached_property
    def _counting(self) -> tuple[Floats, Floats]:
        """The same with the photons of a watt that are counted."""
        wavelength, weight = self._passing
        counted = self.efficiency.at(wavelength) * wavelength / PHOTON_ENERGY_J_UM
        return wavelength, weight * counted


@dataclass(frozen=True)
class PhotonWeights:
    """The spectrum by which a band's radiance is counted in photons.

    `scene` gives way to `source` where the band begins below 2.5 µm. The band is that of the
    radiance, the efficiency that of the detector within its filter, and `source_K` the temperature
    of the source. The `responses` have dimmed the radiance before: that of a black body has come
    through these. Light whose `spectrum` is known comes as the photons that the detector counts;
    where it has gaps, `windows` are the parts of the band in which it is known; empty: all.
    """

    weighting: Weighting
    band_um: tuple[float, float]
    efficiency: QuantumEfficiency
    source_K: float
    responses: tuple[ResponseCurve, ...] = ()
    windows: tuple[tuple[float, float], ...] = ()

    @property
    def is_thermal(self) -> bool:
        """Whether a brightness temperature means anything in the band."""
        return min(self.band_um[0], self.efficiency.cut_on_um) >= SHORTEST_THERMAL_UM

    @property
    def used(self) -> Weighting:
        """The weighting that is used."""
        return "source" if self.weighting == "scene" and not self.is_thermal else self.weighting

    @property
    def flat_photons(self) -> float:
        """Photons counted of a spectral radiance of 1 W/m²/sr/µm all over the band."""
        low = max(self.band_um[0], self.efficiency.cut_on_um)
        high = min(self.band_um[1], self.efficiency.cut_off_um)
        if not low < high:
            return 0.0
        windows = self.windows or ((low, high),)
        return FilteredBody(windows, self.efficiency, self.responses).flat_photons

    def per_radiance(self, radiance: Floats, *, temperature_K: Floats | None = None) -> Floats:
        """∫ QE·L_q dλ over L, s⁻¹ W⁻¹, for radiances above 0.

        `temperature_K`: their brightness temperatures, where known.
        """
        if self.used == "scene":
            if temperature_K is None:
                temperature_K = self._dimmed.temperature(radiance)
            return np.asarray(self._counted.photons(temperature_K) / radiance)
        return np.full(np.shape(radiance), self._constant)

    def slope(self, radiance: float, *, temperature_K: float | None = None) -> float:
        """Derivative of ∫ QE·L_q dλ by L at a radiance above 0, s⁻¹ W⁻¹.

        `temperature_K`: its brightness temperature, where known.
        """
        if self.used == "scene":
            if temperature_K is None:
                temperature_K = self.temperature(radiance)
            photons = float(self._counted.photons(temperature_K, slope=True))
            return photons / self.per_kelvin(temperature_K)
        return self._constant

    def temperature(self, mean: float) -> float:
        """Temperature of the black body whose light, or counted photons, give this mean, K."""
        if self.used != "spectrum":
            return float(self._dimmed.temperature(mean))

        def above(logarithm: float) -> float:
            photons = float(self._counted.photons(math.exp(logarithm)))
            return math.log(max(photons, _LEAST_LIGHT) / mean)

        low, high = math.log(_COLDEST_K), math.log(_HOTTEST_K)
        if not above(low) < 0.0 < above(high):
            raise DataError(
                f"no black body from {_COLDEST_K:g} to {_HOTTEST_K:g} K gives {mean:.6g} "
                "photons/s/m²/sr"
            )
        return math.exp(kernels.brentq(above, low, high, xtol=1e-16 * (high - low), rtol=1e-13))

    def per_kelvin(self, temperature_K: float) -> float:
        """Derivative of that light, or of those photons, by the temperature."""
        if self.used == "spectrum":
            return float(self._counted.photons(temperature_K, slope=True))
        return float(self._dimmed.radiance(temperature_K, slope=True))

    @cached_property
    def _dimmed(self) -> FilteredBody:
        """Black bodies behind the responses, in the band of the radiance."""
        return FilteredBody((self.band_um,), self.efficiency, self.responses)

    @cached_property
    def _counted(self) -> FilteredBody:
        """The same within the detector's filter."""
        windows: tuple[tuple[float, float], ...] = (
            (self.efficiency.cut_on_um, self.efficiency.cut_off_um),
        )
        if self.used == "spectrum":
            windows = self.windows or windows
        return FilteredBody(windows, self.efficiency, self.responses)

    @cached_property
    def _constant(self) -> float:
        """Photons per radiance where that is the same for all samples."""
        efficiency = self.efficiency
        if self.used == "spectrum":
            return 1.0
        if self.used == "source":
            radiance = float(self._dimmed.radiance(self.source_K))
            if not radiance > 0.0:
                low, high = self.band_um
                raise DataError(
                    f"a source of {self.source_K:g} K emits nothing from {low:g} to {high:g} µm. "
                    "Raise source_K"
                )
            return float(self._counted.photons(self.source_K)) / radiance
        low = max(self.band_um[0], efficiency.cut_on_um)
        high = min(self.band_um[1], efficiency.cut_off_um)
        if not low < high:
            return 0.0
        share = (high - low) / (self.band_um[1] - self.band_um[0])
        counted = QuantumEfficiency(low, high, efficiency.value, efficiency.points).mean()
        return share * counted * (low + high) / 2.0 / PHOTON_ENERGY_J_UM


@dataclass(frozen=True)
class SmoothRatio:
    """A ratio over the logarithm of what it multiplies; beyond its limits as at them.

    Chebyshev's polynomials have the coefficients; `half` is 0 where the ratio is one number.
    """

    coefficients: Floats
    middle: float
    half: float

    def times(self, values: Array) -> Array:
        """Values times their ratio."""
        number = values.dtype.type
        if self.half == 0.0:
            return np.asarray(values * number(self.coefficients[0]))
        least, greatest = np.exp([self.middle - self.half, self.middle + self.half])
        least = max(number(least), np.finfo(values.dtype).tiny)
        # A third of the time of numpy's maximum and minimum by a number.
        places = np.clip(values, least, number(greatest))
        np.log(places, out=places)
        places -= number(self.middle)
        if len(self.coefficients) <= _HORNER:
            total = places * number(self._powers[-1])
            for power in self._powers[-2:0:-1]:
                total += number(power)
                total *= places
            total += number(self._powers[0])
        else:
            places *= number(1.0 / self.half)
            np.clip(places, -1.0, 1.0, out=places)
            total = numerics.chebyshev_sum(self.coefficients.astype(values.dtype), places)
        total *= values
        return np.asarray(total)

    @cached_property
    def inverse(self) -> "SmoothRatio":
        """Of the values times their ratio, what gives the values back."""
        if self.half == 0.0:
            ratio = float(self.coefficients[0])
            return SmoothRatio(np.array([1.0 / ratio if ratio > 0.0 else 0.0]), 0.0, 0.0)
        ends = np.array([-1.0, 1.0])
        logs = (
            self.middle + self.half * ends + np.log(numerics.chebyshev_sum(self.coefficients, ends))
        )
        target_middle, target_half = float(logs.mean()), float(logs[1] - logs[0]) / 2.0

        def ratio_at(places: Floats) -> Floats:
            target = target_middle + target_half * places
            scaled = places
            for _ in range(_STEPS):  # each leaves less than a half of the error
                logs = target - np.log(numerics.chebyshev_sum(self.coefficients, scaled))
                before, scaled = scaled, np.clip((logs - self.middle) / self.half, -1.0, 1.0)
                if np.abs(scaled - before).max() < _FLAT:
                    break
            return np.asarray(1.0 / numerics.chebyshev_sum(self.coefficients, scaled))

        return SmoothRatio(_fit(ratio_at, _FINEST), target_middle, target_half)

    @cached_property
    def _powers(self) -> Floats:
        """Coefficients of the powers of the logarithm less its middle."""
        powers = np.polynomial.chebyshev.cheb2poly(self.coefficients)
        return np.asarray(powers / self.half ** np.arange(len(powers)))


def conversion_between(
    *,
    weights: PhotonWeights,
    electrons_per_photon: float,
    low: float,
    high: float,
    tolerance: float = _FINEST,
) -> SmoothRatio:
    """Electrons over radiance, from `low` to `high`, W/m²/sr; exact where there is only one.

    `electrons_per_photon` multiplies ∫ QE·L_q dλ, m² sr s. What is below 1e-9 of the greatest
    radiance is taken in proportion; `tolerance` is the largest relative error between the limits.
    """
    if not high > 0.0:
        low = high = 1.0  # a picture without light
    ends = np.log([max(low, high * _DEEPEST), high])
    middle, half = float(ends.mean()), float(ends[1] - ends[0]) / 2.0

    def forward(places: Floats) -> Floats:
        radiance = np.exp(middle + half * places)
        return np.asarray(electrons_per_photon * weights.per_radiance(radiance))

    if half <= _FLAT or weights.used != "scene":
        return SmoothRatio(forward(np.zeros(1)), middle, 0.0)
    return SmoothRatio(_fit(forward, tolerance), middle, half)


def _fit(function: Callable[[Floats], Floats], tolerance: float) -> Floats:
    for size in _FIT_SIZES:
        coefficients = numerics.chebyshev_coefficients(function, size)
        floor = 0.1 * tolerance * abs(coefficients[0])
        if np.abs(coefficients[-3:]).max() <= floor:
            break
    rest = np.cumsum(np.abs(coefficients[::-1]))[::-1]
    return np.asarray(coefficients[: max(1, int(np.count_nonzero(rest > floor)))])
