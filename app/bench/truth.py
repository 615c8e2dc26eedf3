"""Truth for the benchmark by independent slow ways: direct sums, areas and integrals.

Nothing here calls the code that is measured. Sums are matrix products over every sample and every
frequency; overlap areas are integrals of chord lengths; laws in mpmath where it is installed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Intervals = list[tuple[Array, Array]]

NEEDS_MPMATH = "not measured: its truth needs mpmath, which is not installed (extra `test`)"


def mpmath() -> Any:
    """The module mpmath at 40 digits, or None where it is not installed."""
    try:
        import mpmath as found
    except ImportError:
        return None
    context = found.mp.clone()
    context.dps = 40
    return context


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


def mirrored_picture(scene: Array, sensor: Sensor) -> Array:
    """The filtered frame, mirrored without end, 2 × 2 samples combined; no fast transform."""
    size = len(scene)
    frequency = np.arange(size, dtype=np.longdouble) / (2 * size * sensor.interval_mrad)
    transfer = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    charge = sensor.charge(frequency)
    steps = np.outer(2 * np.arange(size) + 1, np.arange(size)) % (4 * size)
    angle = np.pi / (2 * size) * steps
    cosine, sine = np.cos(angle), np.sin(angle)
    twice = np.where(np.arange(size) == 0, 1.0, 2.0) / size
    spectrum = cosine.T @ scene.astype(np.float64) @ cosine
    spectrum *= np.outer(twice, twice)
    even = np.asarray(transfer * charge.real, np.float64)
    odd = np.asarray(transfer * charge.imag, np.float64)
    picture = cosine @ (spectrum * even) @ cosine.T - cosine @ (spectrum * odd) @ sine.T
    return combined(picture)


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


@dataclass(frozen=True)
class Aperture:
    """A disc of some radius without an inner disc, without a bar |x| ≤ half_bar, or half of it."""

    radius: float
    inner: float = 0.0
    half_bar: float = 0.0
    half_moon: bool = False

    def otf(self, shift_x: float, shift_y: float) -> float:
        """Overlap with itself moved, over its area."""
        return self._overlap(shift_x, shift_y) / self._overlap(0.0, 0.0)

    def _overlap(self, shift_x: float, shift_y: float) -> float:
        """Integral over y of the length common to a row and the row moved onto it.

        Between all crossings of the edges the length is smooth but for square roots at the ends,
        which the double exponential rule takes.
        """
        breaks = [y for y in self._breaks(shift_x, shift_y) if abs(y) <= self.radius]
        places = np.array(sorted({-self.radius, self.radius, *breaks}))
        node, weight = _double_exponential()
        total = 0.0
        for low, high in pairwise(places):
            y = low + (high - low) * node
            here, moved = self._row(y), self._row(y - shift_y)
            length: Any = 0.0
            for a, b in here:
                for c, d in moved:
                    length = length + np.maximum(
                        np.minimum(b, d + shift_x) - np.maximum(a, c + shift_x), 0.0
                    )
            total += (high - low) * float(np.sum(weight * length))
        return total

    def _row(self, y: Array) -> Intervals:
        outer = np.sqrt(np.maximum((self.radius - y) * (self.radius + y), 0.0))
        if self.half_moon:
            return [(np.zeros_like(outer), outer)]
        hole = np.sqrt(np.maximum((self.inner - y) * (self.inner + y), 0.0))
        blocked = np.minimum(np.maximum(hole, self.half_bar), outer)
        return [(-outer, -blocked), (blocked, outer)]

    def _breaks(self, shift_x: float, shift_y: float) -> list[float]:
        circles, lines = [], []
        for x, y in ((0.0, 0.0), (shift_x, shift_y)):
            circles += [(x, y, r) for r in (self.radius, self.inner) if r > 0]
            lines += [x - self.half_bar, x + self.half_bar]
        found = [y + sign * r for _, y, r in circles for sign in (-1, 1)]
        for x, y, r in circles:
            roots = [math.sqrt(r * r - (line - x) ** 2) for line in lines if abs(line - x) <= r]
            found += [y + sign * root for root in roots for sign in (-1, 1)]
        for first, second in combinations(circles, 2):
            found += _crossings(first, second)
        return found


def _crossings(
    first: tuple[float, float, float], second: tuple[float, float, float]
) -> list[float]:
    """Heights at which two circles cross."""
    (x0, y0, r0), (x1, y1, r1) = first, second
    dx, dy = x1 - x0, y1 - y0
    apart = math.hypot(dx, dy)
    if apart == 0 or apart > r0 + r1 or apart < abs(r0 - r1):
        return []
    along = (apart**2 + r0**2 - r1**2) / (2 * apart)
    across = math.sqrt(max(r0**2 - along**2, 0.0))
    return [y0 + (along * dy + sign * across * dx) / apart for sign in (-1, 1)]


def _double_exponential() -> tuple[Array, Array]:
    """Nodes in (0, 1) and weights of the tanh-sinh rule."""
    step = 1 / 32
    t = np.arange(-112, 113) * step
    u = 0.5 * np.pi * np.sinh(t)
    weight = step * 0.25 * np.pi * np.cosh(t) / np.cosh(u) ** 2
    return 1 / (1 + np.exp(-2 * u)), weight


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
