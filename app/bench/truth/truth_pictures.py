"""Truth for whole pictures: sums over every sample and frequency, without the measured code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class Sensor:
    """The transfer functions of the Kodak network, from its parameters, in extended precision."""

    interval_mrad: float
    aperture_mm: float = 90.0
    wavelength_um: float = 4.0
    aberration_mrad: float = 0.1
    pixel_mrad: float = 25.0 / 200.0 * 0.95
    transfers: int = 640
    lost: str = "0.00001"

    def modulus(self, xi: Array, eta: Array) -> Array:
        """Real and even part of the transfer function, frequencies in extended precision."""
        pi = np.longdouble("3.14159265358979323846264338327950288")
        v = np.hypot(xi, eta) * np.longdouble(self.wavelength_um) / np.longdouble(self.aperture_mm)
        v = np.minimum(v, 1)
        otf = 2 / pi * (np.arccos(v) - v * np.sqrt(1 - v * v))
        sigma = np.longdouble(self.aberration_mrad)
        otf = otf * np.exp(-2 * (pi * sigma) ** 2 * (xi * xi + eta * eta))
        for frequency in (xi, eta):
            x = pi * np.longdouble(self.pixel_mrad) * frequency
            otf = otf * np.where(x == 0, 1, np.sin(x) / np.where(x == 0, 1, x))
        return np.asarray(otf)

    def charge(self, xi: Array) -> Array:
        """Transfer function of the charge transfers, complex."""
        pi = np.longdouble("3.14159265358979323846264338327950288")
        w = 2 * pi * np.longdouble(self.interval_mrad) * xi
        lost = np.longdouble(self.lost)
        one = (1 - lost) / (1 - lost * (np.cos(w) - 1j * np.sin(w)))
        return np.asarray(one**self.transfers)


@dataclass(frozen=True)
class WeakStages(Sensor):
    """A sensor without charge transfer, with Gaussian blurs and Fried's long exposures besides."""

    sigmas_mrad: tuple[float, ...] = ()
    fried_r0_mm: tuple[float, ...] = ()
    transfers: int = 0

    def modulus(self, xi: Array, eta: Array) -> Array:
        """The exponents of all weak stages add."""
        pi = np.longdouble("3.14159265358979323846264338327950288")
        square = xi * xi + eta * eta
        exponent = sum(2 * (pi * np.longdouble(sigma)) ** 2 * square for sigma in self.sigmas_mrad)
        lag_mm = np.sqrt(square) * np.longdouble(self.wavelength_um)
        for r0 in self.fried_r0_mm:
            exponent = exponent + np.longdouble("3.44") * (lag_mm / np.longdouble(r0)) ** (
                np.longdouble(5) / 3
            )
        return np.asarray(super().modulus(xi, eta) * np.exp(-exponent))


def mirrored_frame(scene: Array, sensor: Sensor) -> Array:
    """The filtered frame, mirrored without end; no fast transform."""
    size = len(scene)
    frequency = np.arange(size, dtype=np.longdouble) / (2 * size * sensor.interval_mrad)
    transfer = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    charge = sensor.charge(frequency)
    cosine, sine = _waves(size)
    spectrum = cosine_spectrum(scene)
    even = np.asarray(transfer * charge.real, np.float64)
    odd = np.asarray(transfer * charge.imag, np.float64)
    return np.asarray(
        cosine @ (spectrum * even) @ cosine.T - cosine @ (spectrum * odd) @ sine.T, np.float64
    )


def mirrored_picture(scene: Array, sensor: Sensor) -> Array:
    """The mirrored frame with 2 × 2 samples combined."""
    return combined(mirrored_frame(scene, sensor))


def mirrored_column(
    spectrum: Array, sensor: Sensor, column: int, interval_in_flight_mrad: float
) -> Array:
    """One column of the mirrored frame, its samples that far apart along it.

    `spectrum` is the scene's from `cosine_spectrum`; the sensor's interval holds across.
    """
    size = len(spectrum)
    number = np.arange(size, dtype=np.longdouble)
    xi = number / (2 * size * sensor.interval_mrad)
    eta = number / (2 * size * np.longdouble(interval_in_flight_mrad))
    transfer = np.asarray(sensor.modulus(xi[np.newaxis, :], eta[:, np.newaxis]), np.float64)
    cosine, _ = _waves(size)
    return np.asarray(cosine @ ((spectrum * transfer) @ cosine[column]))


def cosine_spectrum(scene: Array) -> Array:
    """Amplitudes of the cosines that make up a square frame mirrored without end."""
    cosine, _ = _waves(len(scene))
    twice = np.where(np.arange(len(scene)) == 0, 1.0, 2.0) / len(scene)
    return np.asarray(cosine.T @ scene.astype(np.float64) @ cosine * np.outer(twice, twice))


def _waves(size: int) -> tuple[Array, Array]:
    """Cosines and sines of the mirrored frame, (samples, frequencies)."""
    steps = np.outer(2 * np.arange(size) + 1, np.arange(size)) % (4 * size)
    angle = np.pi / (2 * size) * steps
    return np.cos(angle), np.sin(angle)


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
    return combined(np.real(picture) / size**2)


def combined(picture: Array) -> Array:
    """Means of 2 × 2 samples."""
    rows, columns = picture.shape
    return np.asarray(picture.reshape(rows // 2, 2, columns // 2, 2).mean(axis=(1, 3)))
