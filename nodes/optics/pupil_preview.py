"""The preview of an exit pupil: the aperture on its samples, its wavefront error in colour."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.chain.wires import Pupil
from core.evaluation.work import Work
from core.modules.preview import Axis, Picture, Plot, Preview, brief
from core.physics.optics.pupil_shapes import PupilShape, sample_pupil
from core.physics.optics.wavefront import wavefront_waves

_MARGIN = 1.2  # of what is drawn around the aperture
_SIDE = 256  # pixels of the picture, along its longer side
# Samples across by the number of terms, so that each picture takes a few milliseconds.
_SIDES = ((8, 96), (20, 64), (60, 48))
_LEAST_SIDE = 24
_RADII = 2048


@dataclass(frozen=True, eq=False)
class _Wavefront:
    """The error over the square around the disc that it is defined on."""

    waves: NDArray[np.float64]  # shape (side, side): row 0 at the top; beyond the disc it goes on
    least: float  # least, most, rms: over what is open, waves; the rms without piston
    most: float
    rms: float

    @property
    def size(self) -> float:
        """The largest modulus, waves."""
        return max(abs(self.least), abs(self.most))


def _wavefront_of(pupil: Pupil) -> _Wavefront | None:
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
        shape = _scaled(pupil.shape, side / 2 / pupil.shape.radius)
        is_open = inside & (sample_pupil(shape, rows=side, columns=side) > 0)
    if not is_open.any():  # narrower than these samples
        is_open = inside
    seen = waves[is_open]
    return _Wavefront(waves, float(seen.min()), float(seen.max()), float(seen.std()))


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


def _scaled(shape: PupilShape, factor: float) -> PupilShape:
    """The shape with all its lengths so many times as long."""
    return replace(
        shape,
        radius=shape.radius * factor,
        obscuration_radius=shape.obscuration_radius * factor,
        slit_width=shape.slit_width * factor,
        vane_width=shape.vane_width * factor,
    )


def pupil_preview(pupil: Pupil, work: Work) -> Preview:
    """The pupil, and what it is; only that of a file takes samples."""
    size = f"{pupil.columns} × {pupil.rows} samples"
    if pupil.shape is None:
        samples = work.value(pupil.samples)
        facts = ["file", size, f"{brief(100 * float(samples.mean()))} % transmitted"]
        wide, high = float(pupil.columns), float(pupil.rows)
        picture = Picture(samples, 0.0, 1.0, (wide, high))
    else:
        shape, wavefront = pupil.shape, _wavefront_of(pupil)
        facts = [
            shape.shape.replace("_", " "),
            size,
            f"diameter {brief(2 * shape.radius, 4)}",
            f"{100 * open_share(shape):.0f} % of the disc open",
        ]
        if wavefront is not None:
            facts.append(f"rms {brief(wavefront.rms)} waves")
        wide, high = _shown_samples(pupil, shape)
        picture = _drawn(shape, wavefront, (wide, high))
    chart = Plot(
        Axis(-wide / 2, wide / 2, "samples"),
        Axis(high / 2, -high / 2),
        square=True,
        picture=picture,
    )
    return Preview(", ".join(facts), (chart,), tuple(facts))


def _shown_samples(pupil: Pupil, shape: PupilShape) -> tuple[float, float]:
    """Samples across and along that are drawn: of a small aperture, the middle of the array."""
    part = 1.0
    while min(pupil.columns, pupil.rows) * part / 2 >= _MARGIN * 2 * shape.radius:
        part /= 2
    return pupil.columns * part, pupil.rows * part


def _drawn(shape: PupilShape, wavefront: _Wavefront | None, shown: tuple[float, float]) -> Picture:
    """The wavefront error where the shape is open, NaN elsewhere; 0 without one."""
    scale = _SIDE / max(shown)
    shape = _scaled(shape, scale)
    columns, rows = (max(1, round(side * scale)) for side in shown)
    waves = np.zeros((rows, columns))
    if wavefront is not None:
        down, across = (_places(n, shape.radius, len(wavefront.waves)) for n in (rows, columns))
        waves = wavefront.waves[np.ix_(down, across)]
    waves = np.where(sample_pupil(shape, rows=rows, columns=columns) > 0, waves, np.nan)
    size = 0.0 if wavefront is None else wavefront.size
    return Picture(waves, -size, size, shown, signed=True, unit="waves")


def _places(count: int, radius: float, side: int) -> NDArray[np.intp]:
    """Which of `side` samples of a wavefront, which cover the disc, lie at so many pixels."""
    share = (np.arange(count) - (count - 1) / 2) / radius
    return np.clip((share + 1) / 2 * side, 0, side - 1).astype(np.intp)
