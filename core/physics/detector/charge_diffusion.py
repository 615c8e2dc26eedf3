"""Charge diffusion: carriers wander before the depletion region collects them, and blur.

A carrier that is born in the depletion region is collected where it is. One born outside reaches it
with a probability that falls with the distance in diffusion lengths; of a wave of frequency f the
diffusion length is L_f = L₀/√(1 + (2πL₀f)²), and the MTF is what is collected of the wave over what
is collected of an even light.

Sources: Seib 1974, IEEE Trans. Electron Devices 21, 210 (front side); Crowell and Labuda 1969, Bell
System Technical Journal 48, 1481 (back side); Holst and Lomheim 2007, CMOS/CCD Sensors and Camera
Systems, chapter 10.
"""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import exprel

from core.errors import ParameterError
from core.physics.checks import all_from_zero, non_negative, positive

Side = Literal["front", "back"]
Floats = NDArray[np.float64]


def diffusion_mtf(
    *,
    cycles_per_mm: ArrayLike,
    absorption_per_um: float,
    depletion_um: float,
    diffusion_length_um: float,
    side: Side = "front",
    thickness_um: float | None = None,
) -> Floats:
    """MTF of charge diffusion at one wavelength.

    Parameters
    ----------
    cycles_per_mm : array_like
        Radial spatial frequency on the detector, 0 or above, any shape.
    absorption_per_um : float
        Absorption coefficient α, above 0.
    depletion_um : float
        Depth d of the depletion region, 0 or above.
    diffusion_length_um : float
        Diffusion length L₀ outside it, above 0.
    side : {"front", "back"}
        Light enters through the depletion region into a deep substrate, or through the back of a
        thinned detector.
    thickness_um : float, optional
        Of a back-illuminated detector, above `depletion_um`.

    Returns
    -------
    ndarray
        Of the shape of the frequencies, 1 at 0. Front: [1 − e^(−αd)/(1 + αL_f)] over the same at
        f = 0.

    Raises
    ------
    ParameterError
        For a value out of range, and for a back side without a thickness.

    Source: as of the module. The back is taken to be passivated: it takes no carriers away.
    """
    collected = {
        "absorption_per_um": positive("absorption_per_um", absorption_per_um, unit="1/µm"),
        **_checked(depletion_um, diffusion_length_um, side, thickness_um),
    }
    frequency = all_from_zero("cycles_per_mm", cycles_per_mm)
    wave = _collected(frequency / 1000.0, **collected)
    return np.asarray(wave / _collected(np.zeros(()), **collected))


def _checked(
    depletion_um: float, diffusion_length_um: float, side: Side, thickness_um: float | None
) -> dict[str, float]:
    """The same for `_collected`: undepleted silicon before the depletion region is `bulk_um`."""
    depletion = non_negative("depletion_um", depletion_um, unit="µm")
    length = positive("diffusion_length_um", diffusion_length_um, unit="µm")
    bulk = math.inf
    if side == "back":
        if thickness_um is None or not depletion < thickness_um < math.inf:
            lit = "for a back-illuminated detector"
            allowed = f"give a thickness above depletion_um = {depletion:g} {lit}"
            raise ParameterError("thickness_um", thickness_um, allowed, unit="µm")
        bulk = thickness_um - depletion
    return {"depletion_um": depletion, "diffusion_length_um": length, "bulk_um": bulk}


def _collected(
    cycles_per_um: Floats,
    *,
    absorption_per_um: float,
    depletion_um: float,
    diffusion_length_um: float,
    bulk_um: float,
) -> Floats:
    """Share of a wave's photons that is collected in phase."""
    alpha = absorption_per_um
    k = np.hypot(1.0 / diffusion_length_um, 2.0 * np.pi * cycles_per_um)  # 1/L_f
    in_depletion = -np.expm1(-alpha * depletion_um)
    if bulk_um == math.inf:
        return np.asarray(in_depletion + np.exp(-alpha * depletion_um) * alpha / (alpha + k))
    # Collected from depth x: cosh(kx)/cosh(k·bulk). The integral over αe^(−αx) is of two
    # exponentials, each kept below 1.
    least, most = np.minimum(alpha, k), np.maximum(alpha, k)
    towards = np.exp(-least * bulk_um) * bulk_um * exprel(-(most - least) * bulk_um)
    away = np.exp(-k * bulk_um) * -np.expm1(-(alpha + k) * bulk_um) / (alpha + k)
    from_bulk = alpha * (towards + away) / (1.0 + np.exp(-2.0 * k * bulk_um))
    return np.asarray(from_bulk + np.exp(-alpha * bulk_um) * in_depletion)


@lru_cache(maxsize=1)
def _silicon() -> tuple[Floats, Floats]:
    """Wavelengths, µm, and the logarithm of silicon's absorption coefficient, 1/µm."""
    path = Path(__file__).with_name("silicon_extinction.csv")
    wavelength, k = np.loadtxt(path, delimiter=",", unpack=True)
    return wavelength, np.log(4.0 * np.pi * k / wavelength)


def silicon_absorption_per_um(*, wavelength_um: ArrayLike) -> Floats:
    """Absorption coefficient of crystalline silicon at 295 K.

    Parameters
    ----------
    wavelength_um : array_like
        From 0.25 to 1.2 µm.

    Returns
    -------
    ndarray
        1/µm; its logarithm is straight between the points of the table, 10 nm apart.

    Source: Schinke et al. 2015, AIP Advances 5, 067168 (uncertainty 11 % at 0.6 µm, 1.4 % at 1 µm).
    """
    wavelength = np.asarray(wavelength_um, np.float64)
    known, logarithm = _silicon()
    beyond = wavelength[~((wavelength >= known[0]) & (wavelength <= known[-1]))]
    if beyond.size:
        allowed = f"{known[0]:g} to {known[-1]:g}, where silicon absorbs"
        raise ParameterError("wavelength_um", float(beyond.flat[0]), allowed, unit="µm")
    return np.asarray(np.exp(np.interp(wavelength, known, logarithm)))


def band_diffusion_mtf(
    *,
    rho: ArrayLike,
    focal_length_mm: float,
    absorptions_per_um: tuple[float, ...],
    weights: tuple[float, ...],
    depletion_um: float,
    diffusion_length_um: float,
    side: Side = "front",
    thickness_um: float | None = None,
) -> Floats:
    """Mean over the wavelengths of a band, weighted by the carriers that each gives.

    Radial frequencies are in cycles/mrad; at the focal length a mrad is as many µm on the detector.
    `weights` are the photons of every wavelength, whose absorption coefficients are given. Else as
    `diffusion_mtf`.
    """
    per_um = all_from_zero("rho", rho) / positive("focal_length_mm", focal_length_mm, unit="mm")
    how = _checked(depletion_um, diffusion_length_um, side, thickness_um)
    wave, whole = np.zeros_like(per_um), 0.0
    for alpha, weight in zip(absorptions_per_um, weights, strict=True):
        positive("absorption_per_um", alpha, unit="1/µm")
        positive("weight", weight)
        wave = wave + weight * _collected(per_um, absorption_per_um=alpha, **how)
        whole += weight * float(_collected(np.zeros(()), absorption_per_um=alpha, **how))
    return np.asarray(wave / whole)
