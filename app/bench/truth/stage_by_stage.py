"""The Kodak chain as a plain program of 1996 has it: every stage a full 2-D array of its own.

The baseline of the speed benchmark, written for reading: complex transforms of the whole frame,
magnitude and phase apart, each transfer function on a full frequency plane and multiplied on at
once, the frame repeating without end. It shares no code with the rest of the program.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

FIELD_DEG = 25.0
APERTURE_MM = 90.0
WAVELENGTH_UM = 4.0
ABERRATION_MRAD = 0.1
PIXEL_MRAD = 25.0 / 200.0 * 0.95  # pitch in µm over focal length in mm, times the fill factor
TRANSFERS, EFFICIENCY = 640, 0.99999
COMBINED = 2
DETECTOR_NOISE = 1e-4  # W m⁻² sr⁻¹
AMPLIFIER_SNR = 100.0
GAIN_SPREAD = BIAS_SPREAD = 0.01
BITS = 6


def whole_chain(scene: Array, *, lines: int, samples: int, seed: int) -> Array:
    """From the scene to the picture of the frame grabber, without photon noise."""
    return grab(read_out(optics(scene), seed), lines, samples)


def optics(scene: Array) -> Array:
    """Optics, detector and charge transfer, and the pixels combined."""
    rows, columns = scene.shape
    interval_x = np.radians(FIELD_DEG) * 1000.0 / columns
    interval_y = np.radians(FIELD_DEG) * 1000.0 / rows
    xi, eta = np.meshgrid(np.fft.fftfreq(columns, interval_x), np.fft.fftfreq(rows, interval_y))

    spectrum = np.fft.fft2(scene)
    magnitude, phase = np.abs(spectrum), np.angle(spectrum)

    magnitude = magnitude * aperture(np.hypot(xi, eta))
    magnitude = magnitude * np.exp(-2.0 * np.pi**2 * ABERRATION_MRAD**2 * (xi**2 + eta**2))
    magnitude = magnitude * np.sinc(PIXEL_MRAD * xi) * np.sinc(PIXEL_MRAD * eta)
    transfer = charge_transfer(2.0 * np.pi * interval_x * xi)
    magnitude = magnitude * np.abs(transfer)
    phase = phase + np.angle(transfer)

    picture = np.real(np.fft.ifft2(magnitude * np.exp(1j * phase)))
    blocks = picture.reshape(rows // COMBINED, COMBINED, columns // COMBINED, COMBINED)
    return np.asarray(blocks.mean(axis=(1, 3)))


def aperture(rho: Array) -> Array:
    """OTF of a clear circular aperture (Goodman 2005, eq. 6-32)."""
    v = np.minimum(rho * WAVELENGTH_UM / APERTURE_MM, 1.0)
    return np.asarray(2.0 / np.pi * (np.arccos(v) - v * np.sqrt(1.0 - v**2)))


def charge_transfer(w: Array) -> Array:
    """Transfer function of all charge transfers, w = 2π·xi·Δ."""
    lost = 1.0 - EFFICIENCY
    return np.asarray((EFFICIENCY / (1.0 - lost * np.exp(-1j * w))) ** TRANSFERS)


def read_out(picture: Array, seed: int) -> Array:
    """Gain and bias of each detector, detector and amplifier noise, quantization."""
    draw = np.random.default_rng(seed).standard_normal
    mean = picture.mean()
    picture = picture * (1.0 + GAIN_SPREAD * draw(picture.shape))
    picture = picture + BIAS_SPREAD * mean * draw(picture.shape)
    picture = picture + DETECTOR_NOISE * draw(picture.shape)
    picture = picture + mean / AMPLIFIER_SNR * draw(picture.shape)
    low, high = picture.min(), picture.max()
    step = (high - low) / (2**BITS - 1)
    return np.asarray(low + step * np.round((picture - low) / step))


def grab(picture: Array, lines: int, samples: int) -> Array:
    """Bilinear samples of another size over the same field."""
    rows, columns = picture.shape
    y = np.clip((np.arange(lines) + 0.5) * rows / lines - 0.5, 0, rows - 1)
    x = np.clip((np.arange(samples) + 0.5) * columns / samples - 0.5, 0, columns - 1)
    top, left = np.floor(y).astype(int), np.floor(x).astype(int)
    below, right = np.minimum(top + 1, rows - 1), np.minimum(left + 1, columns - 1)
    down, across = (y - top)[:, np.newaxis], x - left
    upper = picture[top][:, left] * (1 - across) + picture[top][:, right] * across
    lower = picture[below][:, left] * (1 - across) + picture[below][:, right] * across
    return np.asarray(upper * (1 - down) + lower * down)
