"""The wavefront error of a pupil as a small picture."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Pupil
from core.physics.optics.pupil_shapes import PupilShape, sample_pupil
from core.physics.optics.wavefront import wavefront_waves

# Samples across by the number of terms, so that each picture takes a few milliseconds.
_SIDES = ((8, 96), (20, 64), (60, 48))
_LEAST_SIDE = 24
_RADII = 2048


@dataclass(frozen=True, eq=False)
class Wavefront:
    """The error over the square around the disc that it is defined on."""

    waves: NDArray[np.float64]  # shape (side, side): row 0 at the top; beyond the disc it goes on
    least: float  # least, most, rms: over what is open, waves; the rms without piston
    most: float
    rms: float

    @property
    def size(self) -> float:
        """The largest modulus, waves."""
        return max(abs(self.least), abs(self.most))


def wavefront_of(pupil: Pupil) -> Wavefront | None:
    """The pupil's wavefront error; None if there is none."""
    if not pupil.aberrated:
        return None
    terms = sum(value != 0 for value in pupil.zernike_waves)
    side = next((side for most, side in _SIDES if terms <= most), _LEAST_SIDE)
    places = (np.arange(side) - (side - 1) / 2) / (side / 2)
    waves = wavefront_waves(
        x=places,
        y=places[:, np.newaxis],
        coefficients_waves=pupil.zernike_waves,
        defocus_waves=pupil.defocus_waves,
    )
    inside = places * places + (places * places)[:, np.newaxis] <= 1
    is_open = inside
    if pupil.shape is not None:
        shape = scaled(pupil.shape, side / 2 / pupil.shape.radius)
        is_open = inside & (sample_pupil(shape, rows=side, columns=side) > 0)
    if not is_open.any():  # narrower than these samples
        is_open = inside
    seen = waves[is_open]
    return Wavefront(waves, float(seen.min()), float(seen.max()), float(seen.std()))


def open_share(shape: PupilShape) -> float:
    """Share of the disc that is open: of each radius, what vanes or a bar leave of the circle."""
    if shape.shape == "half_moon":
        return 0.5
    inner = shape.inner_radius / shape.radius
    radius = inner + (1 - inner) * (np.arange(_RADII) + 0.5) / _RADII
    # A bar is two vanes.
    count = 2 if shape.bar_width > 0 else shape.vane_count
    width = (shape.bar_width if shape.bar_width > 0 else shape.vane_width) / shape.radius
    covered = 2 * count * np.arcsin(np.minimum(1.0, width / 2 / radius))
    left = np.maximum(0.0, 1 - covered / (2 * math.pi))
    return float(np.mean(2 * radius * left) * (1 - inner))


def scaled(shape: PupilShape, factor: float) -> PupilShape:
    """The shape with all its lengths so many times as long."""
    return replace(
        shape,
        radius=shape.radius * factor,
        obscuration_radius=shape.obscuration_radius * factor,
        slit_width=shape.slit_width * factor,
        vane_width=shape.vane_width * factor,
    )


def coloured(values: NDArray[np.float64], colours: tuple[str, str, str]) -> NDArray[np.uint32]:
    """Values from −1 to 1 between three colours, as 0xFFRRGGBB, C order; others as the ends."""
    ends = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in colours], np.float64)
    pixels = np.full(values.shape, 0xFF000000, np.uint32)
    for channel, shift in enumerate((16, 8, 0)):
        level = np.interp(values, (-1.0, 0.0, 1.0), ends[:, channel])
        pixels |= np.rint(level).astype(np.uint32) << np.uint32(shift)
    return pixels
