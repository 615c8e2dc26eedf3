"""Repeatable variety: numbers that depend on a counter alone, and soft mottling."""

from __future__ import annotations

import numpy as np

from nodes.scenes.canvas import Drawing, Term
from nodes.scenes.coverage import FloatArray
from nodes.scenes.profiles import wave

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
    amplitude: float,
    limit: float,
    coarse: float,
    fine: float,
    stretch: float,
    count: int,
    seed: int,
) -> None:
    """Add plane waves of random direction over `box` (left, top, right, low).

    The waves run from `coarse` to `fine` cycles per frame, weaker when finer, and `stretch`
    times finer in y (ground seen at a grazing angle). A plane wave is a sum of two products,
    so that its mean over each sample is exact. However strong the contrast asked for, the waves
    together stay within ± `limit`, so that no radiance falls below 0.
    """
    left, top, right, low = box
    size = coarse * (fine / coarse) ** scatter(count, seed=seed)
    angle = np.pi * scatter(count, seed=seed + 1)
    phase = 2.0 * np.pi * scatter(count, seed=seed + 2)
    weight = amplitude * np.sqrt(2.0 / count) * np.sqrt(coarse / size)
    reach = float(np.abs(weight).sum())
    if reach > limit:
        weight *= limit / reach
    terms: list[Term] = []
    for k in range(count):
        # A frequency of exactly 0 has no integral of this form; the sum keeps clear of it.
        fx = float(size[k] * np.cos(angle[k])) or 1e-6
        fy = float(size[k] * np.sin(angle[k]) * stretch) or 1e-6
        quarter = float(phase[k]) - 0.5 * np.pi
        across = wave(left, right, cycles=fx, phase=float(phase[k]))
        across_quarter = wave(left, right, cycles=fx, phase=quarter)
        down = wave(top, low, cycles=fy, phase=0.0)
        down_quarter = wave(top, low, cycles=fy, phase=-0.5 * np.pi)
        terms.append((float(weight[k]), down, across))
        terms.append((-float(weight[k]), down_quarter, across_quarter))
    drawing.add(terms)
