"""Repeatable variety: numbers that depend on a counter alone, and soft mottling."""

from __future__ import annotations

import numpy as np

from nodes.scenes.coverage import FloatArray, Mix, Texture
from nodes.scenes.profiles import wave
from nodes.scenes.scene_canvas import Drawing

GOLDEN_STEPS = (0.7548776662466927, 0.5698402909980532)
"""The plastic number's powers: fill the unit square evenly (Roberts 2018, R2 sequence)."""


def scatter(count: int, *, seed: int) -> FloatArray:
    """Numbers in 0 to 1 from counters by 64-bit mixing, the same on every machine.

    Source: Steele, Lea, Flood 2014, SplitMix64.
    """
    z = (np.arange(count, dtype=np.uint64) + np.uint64(seed * 1_000_003 + 1)) * np.uint64(
        0x9E3779B97F4A7C15
    )
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    numbers: FloatArray = (z ^ (z >> np.uint64(31))).astype(np.float64) / 2.0**64
    return numbers


def mottle(
    drawing: Drawing,
    *,
    box: tuple[float, float, float, float],
    amplitude: Mix,
    limit: float,
    surfaces: tuple[str, ...],
    coarse: float,
    fine: float,
    stretch: float,
    count: int,
    seed: int,
) -> None:
    """Add plane waves of random direction over `box` (left, top, right, low).

    The waves run from `coarse` to `fine` cycles per frame, weaker when finer, and `stretch`
    times finer in y (ground seen at a grazing angle). A plane wave is a sum of two products,
    so that its mean over each sample is exact. However strong the given contrast, the waves
    together stay within ± `limit` of the least of `surfaces`.
    """
    left, top, right, low = box
    size = coarse * (fine / coarse) ** scatter(count, seed=seed)
    angle = np.pi * scatter(count, seed=seed + 1)
    phase = 2.0 * np.pi * scatter(count, seed=seed + 2)
    weight = np.sqrt(2.0 / count) * np.sqrt(coarse / size)
    texture = Texture(f"mottle {seed}", amplitude, float(weight.sum()), limit, surfaces)
    # A frequency of exactly 0 has no integral of this form; the sum keeps clear of it.
    fx, fy = (np.where(f == 0.0, 1e-6, f) for f in (size * np.cos(angle), size * np.sin(angle)))
    fy = fy * stretch
    quarter = 0.5 * np.pi
    drawing.add_texture(
        texture,
        (
            wave(top, low, cycles=fy, phase=0.0, height=weight),
            wave(left, right, cycles=fx, phase=phase),
        ),
        (
            wave(top, low, cycles=fy, phase=-quarter, height=-weight),
            wave(left, right, cycles=fx, phase=phase - quarter),
        ),
    )
