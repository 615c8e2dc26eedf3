"""Figures of EMVA Standard 1288, release 4 Linear, that follow from a photon transfer curve.

Source: EMVA Standard 1288, release 4.0 Linear (2021), by the names and sums of the working group's
reference program; on simulated frames of 12 bits both give the same dynamic range to 0.01 dB.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.physics.measurement.levels.flat_field import FlatField

_LEAST_DARK = 0.24  # steps², below which rounding hides the dark noise (the standard)


@dataclass(frozen=True)
class EmvaFigures:
    """What the standard calls by these names; None of what the flat fields do not show.

    Parameters
    ----------
    system_gain_dn_per_e : float
        K, digital numbers of an electron.
    saturation_capacity_e : float or None
        Electrons at the level whose temporal variance is the largest (µe.sat); None where no level
        beyond it is saturated.
    sensitivity_threshold_e : float or None
        Electrons of light at which SNR is 1 (µe.min): the dark noise, rounding included, and ½.
    snr_max : float or None
        Root of the saturation capacity.
    dynamic_range : float or None
        Saturation capacity over sensitivity threshold.
    dsnu_row_e, dsnu_column_e, dsnu_pixel_e : float or None
        Parts of DSNU that differ by row, by column, and by neither.
    prnu_row_percent, prnu_column_percent, prnu_pixel_percent : float or None
        The same of PRNU.
    """

    system_gain_dn_per_e: float
    saturation_capacity_e: float | None
    sensitivity_threshold_e: float | None
    snr_max: float | None
    dynamic_range: float | None
    dsnu_row_e: float | None
    dsnu_column_e: float | None
    dsnu_pixel_e: float | None
    prnu_row_percent: float | None
    prnu_column_percent: float | None
    prnu_pixel_percent: float | None


def emva_figures(
    *,
    levels: Sequence[FlatField],
    dark: FlatField | None,
    gain_e_per_dn: float,
    offset_dn: float | None,
    used: NDArray[np.bool_],
    saturated: NDArray[np.bool_],
) -> EmvaFigures:
    """The standard's figures.

    Parameters
    ----------
    levels
        Flat fields of light.
    dark
        Frames without light.
    gain_e_per_dn, offset_dn
        Of the photon transfer curve through them.
    used, saturated
        Which levels make its straight line, and which are saturated.
    """
    gain = gain_e_per_dn
    capacity = threshold = None
    if offset_dn is not None and saturated.any():
        noisiest = max(levels, key=lambda level: level.temporal_dn2)
        capacity = gain * (noisiest.mean_dn - offset_dn)
    if dark is not None:
        least = _LEAST_DARK * dark.step_dn**2
        threshold = gain * math.sqrt(max(dark.temporal_dn2, least)) + 0.5
    known = capacity is not None and capacity > 0.0 and threshold is not None
    kinds: list[Callable[[FlatField], float]] = [
        lambda field: field.rows_dn2,
        lambda field: field.columns_dn2,
        lambda field: field.single_pixels_dn2,
    ]
    lit = [level for level, taken in zip(levels, used, strict=True) if taken]
    dsnu = [None if dark is None else gain * math.sqrt(max(part(dark), 0.0)) for part in kinds]
    prnu = [None if dark is None else prnu_percent(lit, dark, part) for part in kinds]
    return EmvaFigures(
        1.0 / gain,
        capacity,
        threshold,
        math.sqrt(capacity) if capacity is not None and capacity > 0.0 else None,
        capacity / threshold if known and capacity and threshold else None,
        *dsnu,
        *prnu,
    )


def prnu_percent(
    lit: Sequence[FlatField], dark: FlatField, part: Callable[[FlatField], float]
) -> float:
    """Share of the signal that a part of the fixed pattern grows with, percent.

    Parameters
    ----------
    lit
        Levels of the straight part of the curve.
    dark
        Frames without light, whose pattern is taken off.
    part
        Variance of the part, DN².

    Notes
    -----
    The standard takes one level of half the saturation; here all levels count, by their weights.
    """
    signal = np.array([level.mean_dn - dark.mean_dn for level in lit])
    squares = np.array([part(level) - part(dark) for level in lit])
    variance = np.array([level.fixed_dn2 + level.temporal_dn2 / level.frames for level in lit])
    weights = np.array([level.pixels for level in lit]) / np.maximum(variance, 1e-12) ** 2
    square = float(np.sum(weights * signal**2 * squares) / np.sum(weights * signal**4))
    return 100.0 * math.sqrt(max(square, 0.0))
