"""What a pixel collects and adds: solid angle, electrons per photon, dark current, bad pixels."""

import math
from math import hypot, inf, log10, pi, sqrt
from typing import Any, Literal, TypeVar, cast

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray

from core.arrays import Array
from core.errors import DataError, ParameterError
from core.kernels import special
from core.physics.numerics import non_negative, positive, within
from core.physics.radiometry.planck import (
    BOLTZMANN_J_K,
    ELEMENTARY_CHARGE_C,
    band_radiance_derivative,
)

Irradiance = Literal["disc", "sine"]
"""How the light of a lens goes with its F-number: see `solid_angle`."""

FASTEST_SINE = 0.5
"""F-number at which a lens that obeys the sine condition fills the half space."""


def solid_angle(
    *, f_number: float, obscuration_ratio: float = 0.0, irradiance: Irradiance = "disc"
) -> float:
    """Projected solid angle in which a pixel sees the exit pupil.

    Parameters
    ----------
    f_number : float
        Focal length over full aperture, above 0; at least 0.5 for `sine`. A T-number gives the
        solid angle times the transmission, without an obscuration.
    obscuration_ratio : float
        Inner over outer diameter of the aperture, 0 to below 1.
    irradiance : {"disc", "sine"}
        `disc` for a flat disc seen from the axis, tan θ = 1/(2F); `sine` for a lens that obeys the
        sine condition, sin θ = 1/(2F). At F/1 `sine` gives 25 % more light, at F/4 1.6 %.

    Returns
    -------
    float
        Ω = π·sin²θ·(1 − ε²), sr: π/(4F² + 1)·(1 − ε²) or π/(4F²)·(1 − ε²).

    Source: Dereniak and Boreman 1996, Infrared Detectors and Systems, chapter 2 (`disc`); Kingslake
    1983, Optical System Design, chapter 6 (sine condition, T-number).
    """
    cone = inverse_sin_squared(f_number=f_number, irradiance=irradiance)
    return pi / cone * open_share(obscuration_ratio=obscuration_ratio)


def inverse_sin_squared(*, f_number: float, irradiance: Irradiance = "disc") -> float:
    """1/sin²θ of the cone of light: 4F² + 1, or 4F²; parameters and source as of `solid_angle`."""
    number = positive("f_number", f_number)
    if irradiance == "disc":
        return 1.0 + 4.0 * number**2
    if number < FASTEST_SINE:
        allowed = f"at least {FASTEST_SINE:g} for a lens that obeys the sine condition"
        raise ParameterError("f_number", number, allowed)
    return 4.0 * number**2


def open_share(*, obscuration_ratio: float) -> float:
    """Share of the aperture's area that a central obscuration leaves open: 1 − ε²."""
    ratio = float(obscuration_ratio)
    if not 0.0 <= ratio < 1.0:
        raise ParameterError("obscuration_ratio", ratio, "at least 0 and below 1")
    return 1.0 - ratio * ratio


def housing_sr(*, solid_angle_sr: float, cold_shield_efficiency: float) -> float:
    """Projected solid angle in which a pixel sees its warm housing past the cold shield.

    (π − Ω)(1 − η), sr, with Ω of the optics as `solid_angle` gives it, and η the share of the half
    space outside the optics' cone that the shield covers, 0 to 1.

    Source: Dereniak and Boreman 1996, chapter 2.
    """
    efficiency = within("cold_shield_efficiency", cold_shield_efficiency, 0.0, 1.0)
    return (pi - solid_angle_sr) * (1.0 - efficiency)


def exposure_m2_s(
    *,
    pitch_x_um: float,
    pitch_y_um: float,
    fill_x: float,
    fill_y: float,
    integration_time_s: float,
    tdi_stages: int = 1,
) -> float:
    """Light-sensitive area times the time in which it collects, t·n·A·FF, m² s.

    Times a photon radiance and a solid angle it is a number of photons. The fill is the share of
    the pitch that is sensitive, the time that of one of the stages, which add their charge.

    Source: Holst and Lomheim 2007, CMOS/CCD Sensors and Camera Systems, chapter 4.
    """
    area_m2 = (
        positive("pitch_x_um", pitch_x_um, unit="µm")
        * positive("pitch_y_um", pitch_y_um, unit="µm")
        * 1e-12
    )
    fill = positive("fill_x", fill_x) * positive("fill_y", fill_y)
    time = positive("integration_time_s", integration_time_s, unit="s")
    return area_m2 * fill * time * positive("tdi_stages", tdi_stages)


def dark_electrons(
    *, dark_current_e_per_s: float, integration_time_s: float, tdi_stages: int = 1
) -> float:
    """Electrons of a pixel's dark current in an exposure, of all its stages: i·t·n."""
    current = non_negative("dark_current_e_per_s", dark_current_e_per_s, unit="e/s")
    time = positive("integration_time_s", integration_time_s, unit="s")
    return current * time * positive("tdi_stages", tdi_stages)


# Noise of a detector that counts electrons, and the figures made of it.


def shot_noise_e(*, electrons: float, frames_averaged: int = 1) -> float:
    """Standard deviation of a Poisson number of electrons, averaged over frames: √(N/n)."""
    frames = positive("frames_averaged", frames_averaged)
    return sqrt(non_negative("electrons", electrons, unit="e-") / frames)


def quantization_noise_e(*, gain_e_per_dn: float) -> float:
    """Standard deviation of rounding to whole numbers of the gain: gain/√12."""
    return non_negative("gain_e_per_dn", gain_e_per_dn, unit="e-/DN") / sqrt(12.0)


def gain_to_fill_e_per_dn(*, full_well_e: float, bits: int) -> float:
    """Gain at which the full well is the converter's last number: well/(2^bits − 1)."""
    steps: float = 2.0 ** positive("bits", bits) - 1.0
    return positive("full_well_e", full_well_e, unit="e-") / steps


def temporal_noise_e(*, shot_e: float, read_e: float, quantization_e: float) -> float:
    """All noise that changes from frame to frame: the root of the sum of squares.

    Source: Janesick 2007, Photon Transfer, chapter 3; EMVA 1288.
    """
    return hypot(shot_e, read_e, quantization_e)


def fixed_pattern_e(*, electrons: float, prnu_percent: float, dsnu_e: float) -> float:
    """Standard deviation of the fixed pattern: PRNU in proportion to the electrons, and DSNU."""
    return hypot(electrons * prnu_percent / 100.0, dsnu_e)


def netd_of_electrons_K(  # noqa: N802
    *, temporal_e: float, responsivity_e_per_K: float
) -> float:
    """Noise equivalent temperature difference: temporal noise over dN/dT, K; infinite without it.

    Source: Dereniak and Boreman 1996, chapter 9.
    """
    return temporal_e / responsivity_e_per_K if responsivity_e_per_K > 0.0 else inf


def nei_photons_per_cm2(*, temporal_e: float, quantum_efficiency: float, area_cm2: float) -> float:
    """Noise equivalent irradiation: photons/cm² in an exposure that make one noise of electrons.

    σ/(QE·A), of the mean efficiency over the photons of the band and the pixel's sensitive area.
    """
    efficiency = positive("quantum_efficiency", quantum_efficiency)
    return temporal_e / (efficiency * positive("area_cm2", area_cm2, unit="cm²"))


def dynamic_range_dB(*, full_well_e: float, dark_noise_e: float) -> float:  # noqa: N802
    """Full well over the temporal noise in the dark, 20·log₁₀; infinite without noise.

    Source: EMVA 1288.
    """
    well = positive("full_well_e", full_well_e, unit="e-")
    return 20.0 * log10(well / dark_noise_e) if dark_noise_e > 0.0 else inf


# A response that bends down towards the full well.

FloatOrArray = TypeVar("FloatOrArray", float, NDArray[Any])
HIGHEST_PERCENT = 25.0
"""With it the response just reaches the full well."""


def bent_response(
    *,
    electrons: FloatOrArray,
    full_well_e: float,
    nonlinearity_percent: float,
    out: NDArray[Any] | None = None,
) -> FloatOrArray:
    """Electrons as the read-out sees them: N·(1 − p·N/well), p percent too few at the full well.

    Parameters
    ----------
    electrons : float or ndarray
        Collected.
    nonlinearity_percent : float
        0 to 25.
    out : ndarray, optional
        Where to put those of an array; not that array itself.

    Returns
    -------
    float or ndarray
        The largest value of the parabola from there on, so that more light never gives less.

    Source: Janesick 2007, Photon Transfer, chapter 7: V/V and V/e nonlinearity to first order.
    """
    percent = within("nonlinearity_percent", nonlinearity_percent, 0.0, HIGHEST_PERCENT)
    well = positive("full_well_e", full_well_e, unit="e-")
    if percent == 0.0:
        return electrons if out is None else cast(FloatOrArray, np.positive(electrons, out=out))
    curvature = percent / 100.0 / well
    # A third of the time of numpy's minimum by a number.
    result: Any = np.clip(electrons, -np.inf, 0.5 / curvature, out=out)
    factor = result * -curvature
    factor += 1.0
    result *= factor
    return cast(FloatOrArray, result)


def bent_slope(*, electrons: float, full_well_e: float, nonlinearity_percent: float) -> float:
    """Its derivative, 1 − 2·p·N/well; 0 from the largest value on."""
    share = 2.0 * nonlinearity_percent / 100.0 * electrons / positive("full_well_e", full_well_e)
    return max(1.0 - share, 0.0)


# Pixels that are dead or hot, alone and in clusters.

DEAD, HOT = 1, 2
_SINGLE_SHARE = 0.7  # of the clusters, which are then of one pixel
_LARGEST = 9
_ROW_STEPS, _COLUMN_STEPS = np.array([-1, 1, 0, 0]), np.array([0, 0, -1, 1])


def bad_pixel_places(
    *, rows: int, columns: int, percent: float, generator: Generator
) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Where the dead and the hot pixels are.

    `percent` of all pixels, rounded to a number, are bad. Gives the place of each in the rows one
    after the other, no place twice, in no order; and whether it is `DEAD` or `HOT`. Seven in ten
    clusters are single pixels, the others up to nine neighbours; the pixels of a cluster are of one
    kind, which is either with equal chance.
    """
    wanted = round(within("bad_pixel_percent", percent, 0.0, 100.0) / 100.0 * rows * columns)
    if wanted > rows * columns // 4:
        # So many are no clusters any more.
        anywhere = generator.permutation(rows * columns)[:wanted]
        either = generator.integers(DEAD, HOT, size=wanted, endpoint=True)
        return anywhere, either.astype(np.uint8)
    taken = np.zeros(rows * columns, bool)
    all_places = [np.empty(0, np.intp)]
    all_kinds = [np.empty(0, np.uint8)]
    left = wanted
    while left > 0:
        places, kinds = _clusters(left, rows, columns, generator)
        first = np.unique(places, return_index=True)[1]
        first.sort()  # in the order they came, so that a cut leaves no edge
        first = first[~taken[places[first]]][:left]
        taken[places[first]] = True
        all_places.append(places[first])
        all_kinds.append(kinds[first])
        left -= len(first)
    return np.concatenate(all_places), np.concatenate(all_kinds)


def _clusters(
    count: int, rows: int, columns: int, generator: Generator
) -> tuple[NDArray[np.intp], NDArray[np.uint8]]:
    """Flat places and kinds of about so many pixels, cluster by cluster."""
    clusters = max(1, count // 2)
    single = generator.random(clusters) < _SINGLE_SHARE
    sizes = np.where(single, 1, generator.integers(2, _LARGEST, size=clusters, endpoint=True))
    kinds = generator.integers(DEAD, HOT, size=clusters, endpoint=True).astype(np.uint8)
    row = generator.integers(0, rows, size=clusters)
    column = generator.integers(0, columns, size=clusters)
    # A walk from neighbour to neighbour; a pixel that is met twice counts once.
    directions = generator.integers(0, len(_ROW_STEPS), size=(clusters, _LARGEST))
    places = np.empty((clusters, _LARGEST), np.intp)
    inside = np.zeros((clusters, _LARGEST), bool)
    places[:, 0], inside[:, 0] = row * columns + column, True
    walking = np.flatnonzero(~single)
    at_row, at_column = (
        start[walking, np.newaxis] + np.cumsum(steps[directions[walking, 1:]], axis=1)
        for start, steps in ((row, _ROW_STEPS), (column, _COLUMN_STEPS))
    )
    places[walking, 1:] = at_row * columns + at_column
    met = np.arange(1, _LARGEST) < sizes[walking, np.newaxis]
    met &= (at_row >= 0) & (at_row < rows) & (at_column >= 0) & (at_column < columns)
    inside[walking, 1:] = met
    return places[inside], np.broadcast_to(kinds[:, np.newaxis], inside.shape)[inside]


# Dark current of HgCdTe by the rule of thumb of 2007.

_J0_A_PER_CM2 = 8367.00001853855
_EXPONENT = -1.16239134096245
_SCALE_UM = 0.200847413564122
_THRESHOLD_UM = 4.63513642316149
_POWER = 0.544071281108481
_PHOTON_EV_UM = 1.24  # as published, rounded
_MOST_DOUBLINGS = 100.0


def rule_07_A_per_cm2(*, cutoff_um: float, detector_K: float) -> float:  # noqa: N802
    """Dark current density of good HgCdTe photodiodes.

    Parameters
    ----------
    cutoff_um : float
        Cutoff wavelength of the material at the temperature, µm, above 0.201.
    detector_K : float
        Temperature of the detector, K, above 0.

    Returns
    -------
    float
        J₀·exp(C·1.24 q/(k·λₑ·T)), A/cm². λₑ is the cutoff from 4.635 µm on, and below it
        λ/(1 − (λₛ/λ − λₛ/λₜ)^P).

    Notes
    -----
    Within a factor of 2.5 for λ·T from 400 to 1700 µm K and 77 K and above. Source: Tennant, Lee,
    Zandian, Piquette and Carmody 2008, MBE HgCdTe technology: a very general solution to IR
    detection, described by "Rule 07", J. Electronic Materials 37, 1406.
    """
    cutoff = positive("material_cutoff_um", cutoff_um, unit="µm")
    temperature = positive("detector_K", detector_K, unit="K")
    effective = cutoff
    if cutoff < _THRESHOLD_UM:
        left = 1.0 - (_SCALE_UM / cutoff - _SCALE_UM / _THRESHOLD_UM) ** _POWER
        if left <= 0.0:
            shortest = _SCALE_UM / (1.0 + _SCALE_UM / _THRESHOLD_UM)
            raise ParameterError(
                "material_cutoff_um", cutoff_um, f"above {shortest:.3g}", unit="µm"
            )
        effective = cutoff / left
    energy = _PHOTON_EV_UM * ELEMENTARY_CHARGE_C / (BOLTZMANN_J_K * effective * temperature)
    return _J0_A_PER_CM2 * math.exp(_EXPONENT * energy)


def rule_07_e_per_s(*, cutoff_um: float, detector_K: float, area_um2: float) -> float:
    """Electrons per second of that current through a pixel of some area, µm²."""
    density = rule_07_A_per_cm2(cutoff_um=cutoff_um, detector_K=detector_K)
    return current_e_per_s(dark_current_A_per_cm2=density, area_um2=area_um2)


def current_e_per_s(*, dark_current_A_per_cm2: float, area_um2: float) -> float:
    """Electrons per second of a current density through a pixel of some area, µm²: J·A/q."""
    density = non_negative("dark_current_A_per_cm2", dark_current_A_per_cm2, unit="A/cm²")
    area_cm2 = positive("area_um2", area_um2, unit="µm²") * 1e-8
    return density * area_cm2 / ELEMENTARY_CHARGE_C


def dark_factor(*, detector_K: float, reference_K: float, doubling_K: float) -> float:
    """Dark current at a temperature over the one at a reference: 2^((T − T₀)/ΔT), all above 0 K.

    Source: EMVA 1288, release 3.1, section 2.4; for silicon ΔT is 5 to 8 K around room temperature
    (Janesick 2001, Scientific Charge-Coupled Devices, chapter 7).
    """
    away = positive("detector_K", detector_K) - positive("dark_reference_K", reference_K)
    doublings = away / positive("dark_doubling_K", doubling_K, unit="K")
    if abs(doublings) > _MOST_DOUBLINGS:
        least = abs(away) / _MOST_DOUBLINGS
        allowed = f"at least {least:.3g} if detector_K is {abs(away):g} K from dark_reference_K"
        raise ParameterError("dark_doubling_K", doubling_K, allowed, unit="K")
    return float(2.0**doublings)


# Correction of the unlike gains and offsets of detector elements by uniform references.

LEAST_RESPONSE = 0.1
"""Of the mean response; an element of less is taken for bad, and its gain is left as it is."""


def one_point_offset(*, low: Array) -> Array:
    """Offset to be added, by one reference: its mean less each element's own.

    Source: Perry and Dereniak 1993, Linear theory of nonuniformity correction in infrared staring
    sensors, Opt. Eng. 32; Holst 2008, Electro-Optical Imaging System Performance.
    """
    return np.asarray(np.mean(low, dtype=np.float64) - np.asarray(low, np.float64))


def two_point_gain(*, low: Array, high: Array) -> Array:
    """Factor by which an element's response between two references becomes the mean one.

    (mean of high − mean of low)/(high − low) of a cooler and a warmer uniform reference; 1 where an
    element's response is below `LEAST_RESPONSE` of the mean one. Refused where both references give
    the same on average (`DataError`).

    Source: Perry and Dereniak 1993; Schulz and Caldwell 1995, Infrared Phys. Technol. 36.
    """
    response = np.asarray(high, np.float64) - np.asarray(low, np.float64)
    mean = float(response.mean())
    if mean == 0.0 or not np.isfinite(mean):
        raise DataError(
            f"both references give {float(np.mean(low)):.6g} on average: a gain correction "
            "needs two references with different signals, neither of them saturated"
        )
    share = response / mean
    good = share > LEAST_RESPONSE
    return np.asarray(1.0 / np.where(good, share, 1.0))


def two_point_offset(*, low: Array, gain: Array) -> Array:
    """Offset to be added behind the gain: the cooler reference comes out as its mean."""
    return np.asarray(np.mean(low, dtype=np.float64) - gain * np.asarray(low, np.float64))


# Microbolometers: noise by a data sheet's NETD, and the lag of their heat capacity.
#
# Sources: Kruse 2001, Uncooled Thermal Imaging Arrays, Systems and Applications, chapters 3 and 4;
# Rogalski 2011, Infrared Detectors, 2nd ed., chapters 4 and 22.

SETTLED = 1e-6
"""Share of a step that is left where earlier frames are no longer counted."""


def netd_noise_radiance(
    *,
    netd_K: float,
    reference_K: float,
    reference_sr: float,
    lens_sr: float,
    cut_on_um: float,
    cut_off_um: float,
) -> float:
    """Noise of a data sheet's NETD as a radiance of the scene, W/m²/sr: NETD·dL/dT(T₀)·τ₀Ω₀/(τΩ).

    `reference_K` is the background of the data sheet, `reference_sr` the light of its optics and
    `lens_sr` that of the camera's: transmission times solid angle. A bolometer's own noise does not
    depend on the scene, so that over dL/dT of another background it is the NETD there.
    """
    netd = non_negative("netd", netd_K, unit="K")
    light = positive("reference_sr", reference_sr, unit="sr") / positive(
        "lens_sr", lens_sr, unit="sr"
    )
    slope = float(
        band_radiance_derivative(
            cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=reference_K
        )
    )
    return netd * slope * light


def share_kept(*, time_constant_s: float, frame_rate_Hz: float) -> float:
    """Share of a temperature difference that is left after a frame: exp(−1/(rate·τ))."""
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    constant = non_negative("time_constant_s", time_constant_s, unit="s")
    return math.exp(-1.0 / (rate * constant)) if rate * constant > 0.0 else 0.0


def lag_weights(*, kept: float, most: int) -> tuple[float, ...]:
    """Weights of this frame and those before it in what a first-order lag shows.

    (1 − kept)·kept^k with the share `kept` of a frame, down to `SETTLED` and over `most` frames;
    the last one takes all that is older, so that they add to 1.
    """
    if not 0.0 <= kept < 1.0:
        raise ParameterError("fraction of a change that remains", kept, "from 0 to below 1")
    count = 1
    while kept**count > SETTLED and count < most:
        count += 1
    weights = [(1.0 - kept) * kept**age for age in range(count)]
    weights[-1] = kept ** (count - 1)
    return tuple(weights)


# Gain of charge before it is read: excess noise of photoconductors, avalanches, EM registers.

ChargeGain = Literal["none", "photoconductive", "em_register", "avalanche"]

LARGE_SHAPE = 16.0
"""Shape of a gamma deviate from which on the cube root is taken as normal: mean within 1e-6,
variance within 4e-5, quantiles to 3 σ within 1 % of σ. Below it, the quantile is exact."""
_FARTHEST = 8.0  # of a deviate; beyond, Φ(z) rounds to 1


def excess_noise_factor(
    *, charge_gain: ChargeGain, factor: float, register_stages: int, ionization_ratio: float
) -> float:
    """Variance of the multiplied charge over G² times that of the charge before: F.

    Parameters
    ----------
    charge_gain : ChargeGain
        What multiplies. None gives 1; a photoconductor 2, as recombination adds as much variance as
        generation.
    factor : float
        Mean gain G, above 0; at least 1 for register and avalanche.
    register_stages : int
        Stages N of an EM register, G at most 2^N: (2(G − 1)·G^(−1/N) + 1)/G, F² of its literature.
    ionization_ratio : float
        k of an avalanche, 0 to 1: k·G + (1 − k)(2 − 1/G).

    Source: Levine 1993, Quantum-well infrared photodetectors, J. Appl. Phys. 74, R1 (noise current
    4qGI); Robbins and Hadwen 2003, The noise performance of electron multiplying charge-coupled
    devices, IEEE Trans. Electron Devices 50, 1227; McIntyre 1966, Multiplication noise in uniform
    avalanche diodes, IEEE Trans. Electron Devices 13, 164.
    """
    gain = positive("charge_gain_factor", factor)
    if charge_gain in ("none", "photoconductive"):
        return 1.0 if charge_gain == "none" else 2.0
    if gain < 1.0:
        raise ParameterError(
            "charge_gain_factor", factor, f"at least 1 for charge_gain = {charge_gain}"
        )
    if charge_gain == "avalanche":
        ratio = within("ionization_ratio", ionization_ratio, 0.0, 1.0)
        return ratio * gain + (1.0 - ratio) * (2.0 - 1.0 / gain)
    per_stage: float = gain ** (1.0 / positive("register_stages", register_stages))
    if per_stage > 2.0:
        allowed = f"at most 2^{register_stages:g}, a gain of 2 per register stage"
        raise ParameterError("charge_gain_factor", factor, allowed)
    return (2.0 * (gain - 1.0) / per_stage + 1.0) / gain


def multiplied_charge(
    *, electrons: Array, deviates: Array, excess_noise_factor: float, out: Array | None = None
) -> Array:
    """Charge behind a noisy gain, over the mean gain: gamma deviates.

    Standard normal deviates are of the shape and type of the electrons, float32 or float64; `out`
    is contiguous, and neither of the two. With F above 1, n electrons give a deviate of mean n and
    variance (F − 1)·n; charge that is not above 0 stays.

    Source: Basden, Haniff and Mackay 2003, Photon counting strategies with low-light-level CCDs,
    Mon. Not. R. Astron. Soc. 345, 985: at F = 2 each electron gives an exponential number. For
    other F the form is an approximation. Wilson and Hilferty 1931 (cube root).
    """
    width, number = excess_noise_factor - 1.0, electrons.dtype.type
    large = np.maximum(electrons, number(LARGE_SHAPE * width))
    ninth = np.divide(number(width / 9.0), large)
    made = np.sqrt(ninth, out=out)
    made *= deviates
    made += number(1.0)
    made -= ninth
    cube = made * made
    made *= cube
    made *= large
    few = np.flatnonzero(electrons.reshape(-1) < number(LARGE_SHAPE * width))
    if few.size:
        before = electrons.reshape(-1)[few].astype(np.float64)
        z = np.clip(deviates.reshape(-1)[few].astype(np.float64), -_FARTHEST, _FARTHEST)
        shape = np.where(before > 0.0, before, 1.0) / width
        exact = width * special("gammaincinv")(shape, special("ndtr")(z))
        made.reshape(-1)[few] = np.where(before > 0.0, exact, before)
    return np.asarray(made)


def low_gain_share(*, high: ArrayLike, switch_level: float, blend: float) -> Array:
    """Share, from 0 to 1, that the read-out of low gain has in a pixel that is read at two gains.

    Parameters
    ----------
    high : array_like
        Read-out of high gain.
    switch_level : float
        Value of `high` beyond which the low gain is used alone, above 0, in the same unit.
    blend : float
        Width of a linear change below it, as a share of it, from 0 to 1; 0 switches at once.

    Source: as in dual-gain sCMOS cameras; Fowler et al. 2010, Proc. SPIE 7536, 753607.
    """
    level = positive("switch_level", switch_level)
    values, width = np.asarray(high, np.float64), level * within("blend", blend, 0.0, 1.0)
    if width == 0.0:
        return np.asarray(values > level, np.float64)
    return np.clip((values - level) / width + 1.0, 0.0, 1.0)
