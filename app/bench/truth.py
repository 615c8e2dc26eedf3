"""Reference values: direct sums, areas and integrals that share no code with what is measured."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from core.arrays import Array
from core.records import dataclass

NEEDS_MPMATH = (
    "not measured: the reference values need mpmath, which is not installed (extra `peers`)"
)
PI = np.longdouble("3.14159265358979323846264338327950288")


@dataclass(frozen=True)
class Sensor:
    """The transfer functions of the Kodak network, from its parameters, in extended precision.

    `blurs_mrad` are Gaussian blurs beside its aberration, whose exponents add.
    """

    interval_mrad: float
    aperture_mm: float = 90.0
    wavelength_um: float = 4.0
    aberration_mrad: float = 0.1
    pixel_mrad: float = 25.0 / 200.0 * 0.95
    transfers: int = 640
    lost: str = "0.00001"
    blurs_mrad: tuple[float, ...] = ()

    def modulus(self, xi: Array, eta: Array) -> Array:
        """Real and even part of the transfer function, frequencies in extended precision."""
        v = np.hypot(xi, eta) * np.longdouble(self.wavelength_um) / np.longdouble(self.aperture_mm)
        v = np.minimum(v, 1)
        otf = 2 / PI * (np.arccos(v) - v * np.sqrt(1 - v * v))
        variance = sum(np.longdouble(one) ** 2 for one in (self.aberration_mrad, *self.blurs_mrad))
        otf = otf * np.exp(-2 * PI**2 * variance * (xi * xi + eta * eta))
        for frequency in (xi, eta):
            x = PI * np.longdouble(self.pixel_mrad) * frequency
            otf = otf * np.where(x == 0, 1, np.sin(x) / np.where(x == 0, 1, x))
        return np.asarray(otf)

    def charge(self, xi: Array) -> Array:
        w = 2 * PI * np.longdouble(self.interval_mrad) * xi
        lost = np.longdouble(self.lost)
        one = (1 - lost) / (1 - lost * (np.cos(w) - 1j * np.sin(w)))
        return np.asarray(one**self.transfers)


def mirrored_frame(scene: Array, sensor: Sensor) -> Array:
    """The filtered frame, mirrored without end; no fast transform."""
    size = len(scene)
    frequency = np.arange(size, dtype=np.longdouble) / (2 * size * sensor.interval_mrad)
    transfer = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    charge = sensor.charge(frequency)
    cosine, sine = cosines_and_sines(size)
    spectrum = cosine_spectrum(scene)
    even = np.asarray(transfer * charge.real, np.float64)
    odd = np.asarray(transfer * charge.imag, np.float64)
    frame = cosine @ (spectrum * even) @ cosine.T - cosine @ (spectrum * odd) @ sine.T
    return np.asarray(frame, np.float64)


def mirrored_picture(scene: Array, sensor: Sensor) -> Array:
    return _combined(mirrored_frame(scene, sensor))


def periodic_picture(scene: Array, sensor: Sensor) -> Array:
    """The filtered frame, repeating without end, 2 × 2 samples combined; no fast transform."""
    size = len(scene)
    number = np.arange(size)
    centred = np.where(2 * number < size, number, number - size).astype(np.longdouble)
    frequency = centred / (size * sensor.interval_mrad)
    transfer = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    response = np.asarray(transfer * sensor.charge(frequency), np.complex128)
    wave = np.exp(-2j * np.pi / size * (np.outer(number, number) % size))
    spectrum = wave @ scene.astype(np.float64) @ wave
    picture = wave.conj() @ (spectrum * response) @ wave.conj()
    return _combined(np.real(picture) / size**2)


def cosine_spectrum(scene: Array) -> Array:
    """Amplitudes of the cosines that make up a square frame mirrored without end."""
    cosine, _ = cosines_and_sines(len(scene))
    twice = np.where(np.arange(len(scene)) == 0, 1.0, 2.0) / len(scene)
    return np.asarray(cosine.T @ scene.astype(np.float64) @ cosine * np.outer(twice, twice))


def cosines_and_sines(size: int) -> tuple[Array, Array]:
    """Waves of the mirrored frame, (samples, frequencies)."""
    steps = np.outer(2 * np.arange(size) + 1, np.arange(size)) % (4 * size)
    angle = np.pi / (2 * size) * steps
    return np.cos(angle), np.sin(angle)


def _combined(picture: Array) -> Array:
    rows, columns = picture.shape
    return np.asarray(picture.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3)))


def pupil_otf(radius: float, shift_x: float, shift_y: float, *, half_moon: bool = False) -> float:
    """A disc's overlap with itself moved, over its area; of its right half for a half moon."""
    x, y = (0.0, shift_x), (0.0, shift_y)
    breaks = [-radius, radius, shift_y - radius, shift_y + radius]
    for centre_x, centre_y in zip(x, y, strict=True):
        away = [(line - centre_x) ** 2 for line in x if half_moon]
        roots = [math.sqrt(radius**2 - one) for one in away if one <= radius**2]
        breaks += [centre_y + sign * root for root in roots for sign in (-1, 1)]
    apart = math.hypot(shift_x, shift_y)
    if 0 < apart <= 2 * radius:
        across = math.sqrt(radius**2 - apart**2 / 4)
        breaks += [shift_y / 2 + sign * across * shift_x / apart for sign in (-1, 1)]
    step = 1 / 32
    t = np.arange(-112, 113) * step
    u = 0.5 * np.pi * np.sinh(t)
    weight = step * 0.25 * np.pi * np.cosh(t) / np.cosh(u) ** 2
    node = 1 / (1 + np.exp(-2 * u))
    common = 0.0
    for low, high in pairwise(sorted({one for one in breaks if abs(one) <= radius})):
        rows = low + (high - low) * node
        squares = ((radius - rows + own) * (radius + rows - own) for own in y)
        here, there = (np.sqrt(np.maximum(square, 0)) for square in squares)
        left = max(0.0, shift_x) if half_moon else np.maximum(-here, shift_x - there)
        length = np.maximum(np.minimum(here, shift_x + there) - left, 0.0)
        common += (high - low) * float(np.sum(weight * length))
    return common / (math.pi * radius**2 / (2 if half_moon else 1))


def mpmath() -> Any:
    """The module mpmath at 40 digits, or None where it is not installed."""
    try:
        import mpmath as module
    except ImportError:
        return None
    context = module.mp.clone()
    context.dps = 40
    return context


def disc_band_mean(mp: Any, lag_per_um: float, diameter_mm: float, band: Sequence[float]) -> float:
    """Mean of a disc's OTF over a band, frequency `lag_per_um` in mm a µm; adaptive integral."""
    if lag_per_um == 0:
        return 1.0
    low, high = (mp.mpf(end) for end in band)
    cutoff = mp.mpf(diameter_mm) / mp.mpf(lag_per_um)

    def otf(wavelength: Any) -> Any:
        v = wavelength / cutoff
        return 0 if v >= 1 else 2 / mp.pi * (mp.acos(v) - v * mp.sqrt(1 - v * v))

    ends = [low, *([cutoff] if low < cutoff < high else []), high]
    return float(mp.quad(otf, ends) / (high - low))


def charge_transfer(mp: Any, w: float, transfers: int, efficiency: str) -> tuple[float, float]:
    """MTF and unwrapped PTF of N transfers: the product of all of them, in extended precision."""
    share = mp.mpf(efficiency)
    one = share / (1 - (1 - share) * mp.expj(-mp.mpf(w)))
    return float(abs(one) ** transfers), float(transfers * mp.arg(one))


def poisson_cumulative(mean: float) -> Array:
    """P(count ≤ k) for k = 0 … far beyond the mean, as the sum of the probabilities."""
    last = math.ceil(mean + 40.0 * math.sqrt(mean) + 40.0)
    logarithms = [k * math.log(mean) - mean - math.lgamma(k + 1) for k in range(last)]
    return np.asarray(np.minimum(np.cumsum(np.exp(logarithms)), 1.0))


def kolmogorov_distance(counts: Array, mean: float) -> float:
    """Largest difference between the counts' distribution function and Poisson's."""
    law = poisson_cumulative(mean)
    histogram = np.bincount(np.clip(counts, 0, len(law) - 1).astype(np.int64).ravel())
    share = np.cumsum(np.pad(histogram, (0, len(law) - len(histogram)))) / counts.size
    return float(np.abs(share - law).max())
