"""Pictures of a scene of polygons through a blurred camera, by sums over a fine grid, with noise.

Nothing of the product is imported. Levels are electrons of a sample.
"""

import math
from dataclasses import dataclass

import numpy as np

FINE = 4


@dataclass(frozen=True)
class Sensor:
    """What makes numbers of electrons: all random parts known."""

    gain: float = 4.0
    read_e: float = 12.0
    offset: float = 0.0
    rows: float = 0.0
    columns: float = 0.0
    lines: tuple[tuple[float, float, float], ...] = ()  # amplitude, cycles per sample x, y
    bits: int | None = 14

    def sigma(self, electrons):
        """Of a sample, in numbers, rounding included."""
        rounding = 0.0 if self.bits is None else 1 / 12
        return math.sqrt((electrons + self.read_e**2) / self.gain**2 + rounding)

    def picture(self, electrons, seed):
        random = np.random.default_rng(seed)
        shape = electrons.shape
        signal = random.poisson(electrons) + self.read_e * random.standard_normal(shape)
        numbers = signal / self.gain + self.offset
        numbers += self.rows * random.standard_normal((shape[0], 1))
        numbers += self.columns * random.standard_normal(shape[1])
        y, x = np.indices(shape)
        for amplitude, across, down in self.lines:
            numbers += amplitude * np.cos(2 * math.pi * (across * x + down * y) + 1.0)
        return numbers if self.bits is None else np.rint(numbers).clip(0, 2**self.bits - 1)


def blurred(fine, sigma):
    """Means over samples of a scene on a grid `FINE` times finer, blurred by a Gaussian before."""
    reach = math.ceil(4 * sigma * FINE)
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) / (sigma * FINE)) ** 2)
    weight /= weight.sum()
    for axis in (0, 1):
        ends = [(reach, reach) if k == axis else (0, 0) for k in (0, 1)]
        wide = np.pad(fine, ends, mode="edge")
        size = fine.shape[axis]
        fine = sum(
            w * np.take(wide, np.arange(k, k + size), axis=axis) for k, w in enumerate(weight)
        )
    rows, columns = (size // FINE for size in fine.shape)
    return fine.reshape(rows, FINE, columns, FINE).mean(axis=(1, 3))


def polygons(rows, columns, levels, seed):
    """A scene of overlapping turned rectangles, on the fine grid."""
    random = np.random.default_rng(seed)
    y, x = np.indices((rows * FINE, columns * FINE)) / FINE
    scene = np.full(x.shape, float(levels[0]))
    for level in levels[1:]:
        angle = random.uniform(0, math.pi)
        away_x, away_y = x - random.uniform(0, columns), y - random.uniform(0, rows)
        along = away_x * math.cos(angle) + away_y * math.sin(angle)
        across = away_y * math.cos(angle) - away_x * math.sin(angle)
        half = random.uniform(0.15, 0.35, 2) * min(rows, columns)
        scene[(np.abs(along) < half[0]) & (np.abs(across) < half[1])] = level
    return scene
