"""1/f noise of independent samples, of any frame by its number alone.

A spectrum of 1/f from a lowest to a highest frequency is parted into strata of equal ratio, which
hold equal variances. A sample has one wave in each, of a frequency drawn from the stratum's part of
the spectrum (log-uniform), an amplitude of Rayleigh's distribution and a uniform phase. Over all
samples the spectrum is then 1/f without a ripple, whatever the number of strata, the noise is
stationary, and its distribution in any frame exactly normal.

Source: Shinozuka and Deodatis 1991, Simulation of stochastic processes by spectral representation,
with the frequencies drawn at random within their strata.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import ceil, log, log2, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import finite, non_negative, positive, within

Array = NDArray[Any]


@dataclass(frozen=True)
class FlickerBand:
    """Ends of the spectrum of a 1/f noise."""

    low_Hz: float
    high_Hz: float

    @property
    def strata(self) -> int:
        """Number of parts of an octave or less."""
        return max(1, ceil(log2(self.high_Hz / self.low_Hz)))


def flicker_band(*, frame_rate_Hz: float, longest_period_s: float) -> FlickerBand:
    """From 1/longest period, which must exceed two frames, to the frames' Nyquist frequency."""
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    longest = positive("longest_period_s", longest_period_s, unit="s")
    if not longest * rate > 2.0:
        allowed = f"longer than two frames, {2.0 / rate:g}"
        raise ParameterError("longest_period_s", longest, allowed, unit="s")
    return FlickerBand(1.0 / longest, 0.5 * rate)


def flicker_sigma(*, white_sigma: float, corner_Hz: float, band: FlickerBand) -> float:
    """Standard deviation of the 1/f noise that equals a white one's density at the corner.

    white_sigma·√(corner/high·ln(high/low)), the root of the integral of the density: that of the
    white noise of a frame is white_sigma²/high_Hz up to high_Hz.
    """
    corner = non_negative("corner_Hz", corner_Hz, unit="Hz")
    share = corner / band.high_Hz * log(band.high_Hz / band.low_Hz)
    return non_negative("white_sigma", white_sigma) * sqrt(share)


def filtered_flicker(*, kept: float, band: FlickerBand) -> float:
    """Standard deviation of 1/f noise behind a recursive filter over frames, over that before.

    `kept` is the share a of the last result that stays: y = a·y₋₁ + (1 − a)·x. 0 to below 1.

    Source: the integral of |H|²/f over that of 1/f, |H(f)|² = (1 − a)²/(1 − 2a·cos(2πf/r) + a²)
    (Oppenheim and Schafer 2010, Discrete-Time Signal Processing, chapter 5).
    """
    share = within("fraction that is kept", kept, 0.0, 1.0)
    places, weights = np.polynomial.legendre.leggauss(32)
    octaves = np.linspace(log(band.low_Hz / band.high_Hz), 0.0, band.strata + 1)
    middles, half = (octaves[1:] + octaves[:-1]) / 2.0, (octaves[1] - octaves[0]) / 2.0
    angle = math.pi * np.exp(middles[:, np.newaxis] + half * places)
    power = (1.0 - share) ** 2 / (1.0 - 2.0 * share * np.cos(angle) + share**2)
    return float(np.sqrt(np.mean(power @ (weights / 2.0))))


def flicker_wave(
    *, band: FlickerBand, stratum: int, time_s: float, place: Array, level: Array, phase: Array
) -> Array:
    """One stratum's waves at a time, standard normal; all strata have the variance of their number.

    Uniform deviates in [0, 1) of the samples, in double, tell where in its stratum the frequency
    is, the amplitude and the phase; `place` may be the same for all strata. Stratum 0 is the
    slowest.
    """
    return wave_at(
        time_s=time_s,
        frequency_hz=wave_frequency(band=band, stratum=stratum, place=place),
        amplitude=wave_amplitude(level=level),
        phase=phase,
    )


def wave_frequency(*, band: FlickerBand, stratum: int, place: Array) -> Array:
    """Frequencies in Hz of one stratum's waves, as `flicker_wave` has them."""
    ratio = (band.high_Hz / band.low_Hz) ** (1.0 / band.strata)
    return np.asarray(band.low_Hz * ratio ** (stratum + place))


def wave_amplitude(*, level: Array) -> Array:
    """Amplitudes of waves, Rayleigh-distributed of mean square 2, as `flicker_wave` has them."""
    return np.asarray(np.sqrt(-2.0 * np.log1p(-level)))


def wave_at(*, time_s: float, frequency_hz: Array, amplitude: Array, phase: Array) -> Array:
    """Values of waves of frequencies in Hz at a time; their phase is in turns."""
    turns = frequency_hz * finite("time_s", time_s, unit="s")
    turns += phase
    turns -= np.floor(turns)  # before the cosine, whose argument so keeps its digits
    return np.asarray(amplitude * np.cos(2.0 * np.pi * turns))


# Periodic noise: a sinusoid, plain or modulated in amplitude.


def periodic_pattern(
    *,
    x_mrad: ArrayLike,
    y_mrad: ArrayLike,
    amplitude: float,
    xi: float,
    eta: float,
    phase_rad: float = 0.0,
    modulation: float = 0.0,
    modulation_xi: float = 0.0,
    modulation_eta: float = 0.0,
    modulation_phase_rad: float = 0.0,
) -> NDArray[np.float64]:
    """Sinusoidal pattern A·(1 + m·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ).

    Positions broadcast: a row of columns and a column of rows make a frame at the cost of vectors.
    The depth m of the modulation is 0 to 1; frequencies are in cycles/mrad.

    Source: Tantalo 1996, chapter 3 ("simple sinusoidal noise models and modified periodic noise").
    """
    x = np.asarray(x_mrad, dtype=np.float64)
    y = np.asarray(y_mrad, dtype=np.float64)
    size = finite("amplitude", amplitude)
    depth = within("modulation", modulation, 0.0, 1.0)
    frequencies = (finite("xi", xi, unit="cyc/mrad"), finite("eta", eta, unit="cyc/mrad"))
    pattern = size * _wave(x, y, *frequencies, finite("phase_rad", phase_rad, unit="rad"))
    if depth > 0.0:
        envelope = _wave(
            x,
            y,
            finite("modulation_xi", modulation_xi, unit="cyc/mrad"),
            finite("modulation_eta", modulation_eta, unit="cyc/mrad"),
            finite("modulation_phase_rad", modulation_phase_rad, unit="rad"),
        )
        pattern = pattern * (1.0 + depth * envelope)
    return np.asarray(pattern, dtype=np.float64)


def _wave(
    x: NDArray[np.float64], y: NDArray[np.float64], xi: float, eta: float, phase: float
) -> NDArray[np.float64]:
    """sin(2π(ξx + ηy) + φ) by the addition theorem: sines of the axes, not of the frame."""
    across = 2.0 * math.pi * xi * x + phase
    along = 2.0 * math.pi * eta * y
    wave = np.sin(across) * np.cos(along)
    return np.asarray(wave + np.cos(across) * np.sin(along), dtype=np.float64)
