"""Noise of a detector that counts electrons, and the figures made of it."""

from __future__ import annotations

from math import hypot, inf, log10, sqrt

from core.physics.numerics.scalar_checks import non_negative, positive


def shot_noise_e(*, electrons: float, frames_averaged: int = 1) -> float:
    """Standard deviation of a Poisson number of electrons, averaged over frames: √(N/n)."""
    frames = positive("frames_averaged", frames_averaged)
    return sqrt(non_negative("electrons", electrons, unit="e-") / frames)


def quantization_noise_e(*, gain_e_per_dn: float) -> float:
    """Standard deviation of rounding to whole numbers of the gain: gain/√12."""
    return non_negative("gain_e_per_dn", gain_e_per_dn, unit="e-/DN") / sqrt(12.0)


def gain_to_fill_e_per_dn(*, full_well_e: float, bits: int) -> float:
    """Gain at which the full well is the converter's last number: well/(2^bits − 1)."""
    steps: float = 2.0 ** positive("bits", bits) - 1.0
    return positive("full_well_e", full_well_e, unit="e-") / steps


def temporal_noise_e(*, shot_e: float, read_e: float, quantization_e: float) -> float:
    """All noise that changes from frame to frame: the root of the sum of squares.

    Source: Janesick 2007, Photon Transfer, chapter 3; EMVA 1288.
    """
    return hypot(shot_e, read_e, quantization_e)


def fixed_pattern_e(*, electrons: float, prnu_percent: float, dsnu_e: float) -> float:
    """Standard deviation of the fixed pattern: PRNU in proportion to the electrons, and DSNU."""
    return hypot(electrons * prnu_percent / 100.0, dsnu_e)


def netd_of_electrons_K(  # noqa: N802
    *, temporal_e: float, responsivity_e_per_K: float
) -> float:
    """Noise equivalent temperature difference: temporal noise over dN/dT, K; infinite without it.

    Source: Dereniak and Boreman 1996, chapter 9.
    """
    return temporal_e / responsivity_e_per_K if responsivity_e_per_K > 0.0 else inf


def nei_photons_per_cm2(*, temporal_e: float, quantum_efficiency: float, area_cm2: float) -> float:
    """Noise equivalent irradiation: photons/cm² in an exposure that make one noise of electrons.

    Parameters
    ----------
    temporal_e : float
        Noise, electrons.
    quantum_efficiency : float
        Mean over the photons of the band, above 0.
    area_cm2 : float
        Light-sensitive area of the pixel.

    Returns
    -------
    float
        σ/(QE·A).
    """
    efficiency = positive("quantum_efficiency", quantum_efficiency)
    return temporal_e / (efficiency * positive("area_cm2", area_cm2, unit="cm²"))


def dynamic_range_dB(*, full_well_e: float, dark_noise_e: float) -> float:  # noqa: N802
    """Full well over the temporal noise in the dark, 20·log₁₀; infinite without noise.

    Source: EMVA 1288.
    """
    well = positive("full_well_e", full_well_e, unit="e-")
    return 20.0 * log10(well / dark_noise_e) if dark_noise_e > 0.0 else inf
