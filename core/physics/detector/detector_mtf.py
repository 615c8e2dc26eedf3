"""MTF of a detector: its aperture, charge transfer, and motion during time delay integration."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.checks import finite, non_negative, positive, within
from core.physics.numerics import sinc

MODELS = ("exact", "published", "leading")


def charge_transfer_mtf(
    *, phase_per_transfer: ArrayLike, transfers: float, efficiency: float, model: str = "exact"
) -> NDArray[np.float64]:
    """MTF of incomplete charge transfer along the read-out direction.

    Parameters
    ----------
    phase_per_transfer : array_like
        w = 2π·xi·Δ in radians, any shape, finite; π at Nyquist.
    transfers : float
        Number N of transfers, zero or above.
    efficiency : float
        Share ε of the charge that moves on at each transfer, 0 to 1.
    model : str
        `exact`: |ε/(1 − (1−ε)e^{−iw})|^N. `published` and `leading`: exp(−N(1−ε)(1 − cos w)).

    Returns
    -------
    ndarray of float64
        MTF from 0 to 1, of the shape of `phase_per_transfer`.

    Source: Tantalo 1996, eq. 4.57, after LeBlanc and Contini (1990); exact form: the product of N
    transfers. 1 − cos w is taken as 2·sin²(w/2), which keeps its digits near w = 0.
    """
    count, lost = _count_and_loss(transfers, efficiency, model)
    half_sine = np.abs(np.sin(0.5 * np.asarray(phase_per_transfer, dtype=np.float64)))
    if count == 0.0:
        return np.ones_like(half_sine)
    if model == "exact":
        exponent = -count * _log_one_transfer(half_sine, float(efficiency), lost)
    else:
        exponent = -2.0 * count * lost * np.square(half_sine)
    return np.asarray(np.exp(exponent), dtype=np.float64)


def charge_transfer_ptf(
    *, phase_per_transfer: ArrayLike, transfers: float, efficiency: float, model: str = "exact"
) -> NDArray[np.float64]:
    """PTF of incomplete charge transfer along the read-out direction, not wrapped.

    Parameters
    ----------
    phase_per_transfer, transfers, efficiency
        As of `charge_transfer_mtf`.
    model : str
        `exact`: −N·arctan((1−ε)sin w/(1 − (1−ε)cos w)). `published`: −N(1−ε)(w − sin w).
        `leading`: −N(1−ε)·sin w, the first term of `exact`.

    Returns
    -------
    ndarray of float64
        Phase in radians, odd in w; charge that lags behind gives a negative one.

    Source: Tantalo 1996, eq. 4.58. Erratum: the published phase starts with w³; that of N
    transfers starts as −N(1−ε)·w. Series for w − sin w below 1 radian, where it cancels.
    """
    count, lost = _count_and_loss(transfers, efficiency, model)
    phase = np.asarray(phase_per_transfer, dtype=np.float64)
    if model == "published":
        return np.asarray(-count * lost * _minus_sine(phase), dtype=np.float64)
    if model == "leading":
        return np.asarray(-count * lost * np.sin(phase), dtype=np.float64)
    real_part = float(efficiency) + 2.0 * lost * np.square(np.sin(0.5 * phase))
    return np.asarray(-count * np.arctan2(lost * np.sin(phase), real_part), dtype=np.float64)


def _count_and_loss(transfers: float, efficiency: float, model: str) -> tuple[float, float]:
    count = non_negative("transfers", transfers)
    share = within("efficiency", efficiency, 0.0, 1.0)
    if model not in MODELS:
        raise ParameterError("model", model, "one of " + ", ".join(MODELS))
    # An efficiency is typed as a decimal; 1 − 0.99999 in float64 keeps eleven digits of the loss.
    return count, float(1 - Decimal(repr(share)))


def _log_one_transfer(
    half_sine: NDArray[np.float64], efficiency: float, lost: float
) -> NDArray[np.float64]:
    """Natural logarithm of |1 − (1−ε)e^{−iw}|/ε, zero or above.

    |1 − (1−ε)e^{−iw}|² = ε² + 4(1−ε)sin²(w/2).
    """
    # At ε = 0 the smallest float64 stands in for it: zero beyond w = 0, and 1 there.
    with np.errstate(over="ignore"):
        ratio = 2.0 * math.sqrt(lost) * half_sine / max(efficiency, math.ulp(0.0))
        large = np.log(np.hypot(1.0, ratio))
        small = 0.5 * np.log1p(np.square(ratio))
    return np.asarray(np.where(ratio < 1.0, small, large), dtype=np.float64)


def _minus_sine(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Difference x − sin x, without cancellation."""
    square = np.square(np.clip(x, -1.0, 1.0))
    series = np.ones_like(square)
    for order in (17, 15, 13, 11, 9, 7, 5):
        series = 1.0 - square / (order * (order - 1)) * series
    near = x * square / 6.0 * series
    return np.asarray(np.where(np.abs(x) < 1.0, near, x - np.sin(x)), dtype=np.float64)


# Time delay and integration: charge that follows a moving image in steps, and not quite.
#
# In a stage, of one pitch, the charge moves in as many steps as the clock has phases; between them
# it stands while the image moves on. In units of the step s = pitch/phases the image is, at the
# share u of step k, m·k + (1 + m)·u ahead of its charge, for an image faster by the share m. The
# mean over all steps is a smear of one step and a sum over shifted exposures:
#
#     sinc((1 + m)·s·f) · sin(πNm·s·f)/(N·sin(πm·s·f)),   N = stages·phases.
#
# Sources: Wong, Yao and Schlig 1992, TDI charge-coupled devices: design and applications, IBM J.
# Res. Develop. 36 (discrete charge motion, velocity mismatch); Holst and Lomheim 2007, CMOS/CCD
# Sensors and Camera Systems, chapter 10.


def tdi_mtf(
    *,
    frequency: ArrayLike,
    pitch_mrad: float,
    stages: int,
    phases: int,
    velocity_mismatch: float,
    aside: ArrayLike = 0.0,
) -> NDArray[np.float64]:
    """MTF of the motion between image and charge, about its mean place.

    Parameters
    ----------
    frequency : array_like
        Along the motion, cycles/mrad.
    pitch_mrad : float
        Of the stages.
    stages : int
        1 or more.
    phases : int
        Steps of the charge in a stage; 0: it moves without steps.
    velocity_mismatch : float
        Velocity of the image over that of the charge, less 1; above −1.
    aside : array_like
        Motion of the image across the stages, in pitches while the charge moves one, times the
        frequency across them; it broadcasts with `frequency`.

    Returns
    -------
    ndarray of float64
        Signed.
    """
    pitch = positive("pitch", pitch_mrad, unit="mrad")
    if not stages >= 1:
        raise ParameterError("stages", stages, "1 or more")
    if not phases >= 0:
        raise ParameterError("phases", phases, "0 or more")
    mismatch = finite("velocity_mismatch", velocity_mismatch)
    if not mismatch > -1.0:
        raise ParameterError("velocity_mismatch", mismatch, "above -1")
    place, across = np.asarray(frequency, np.float64), np.asarray(aside, np.float64)
    if phases == 0:
        return np.asarray(sinc(stages * mismatch * pitch * place + stages * pitch * across))
    step = pitch / phases
    smear = sinc((1.0 + mismatch) * step * place + step * across)
    shifts = mismatch * step * place + step * across
    return np.asarray(smear * _mean_of_shifts(shifts, stages * phases))


def tdi_askew_mtf(
    *, xi: ArrayLike, eta: ArrayLike, drift: float, direction: str, **clock: Any
) -> NDArray[np.float64]:
    """`tdi_mtf` of charge that moves in x or y, and an image that moves across it by `drift`."""
    along, across = (eta, xi) if direction == "y" else (xi, eta)
    aside = finite("drift", drift) * np.asarray(across, np.float64)
    return tdi_mtf(frequency=along, aside=aside, **clock)


def image_motion(*, velocity_mismatch: float, yaw_deg: float) -> tuple[float, float]:
    """Mismatch along the stages, (1 + m)·cos ψ − 1, and drift across them, (1 + m)·sin ψ.

    Both in velocities of the charge; ψ is the yaw, from the stages to the image motion.
    """
    angle = math.radians(within("yaw_deg", yaw_deg, -89.0, 89.0, unit="deg"))
    mismatch = finite("velocity_mismatch", velocity_mismatch)
    along = mismatch * math.cos(angle) - 2.0 * math.sin(0.5 * angle) ** 2
    return along, (1.0 + mismatch) * math.sin(angle)


def _mean_of_shifts(turns: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """sin(πnt)/(n·sin(πt)), with all digits where sin(πt) is next to 0."""
    whole = np.rint(turns)
    rest = turns - whole
    odd = (count % 2 == 0) & (whole % 2 != 0)
    return np.where(odd, -1.0, 1.0) * sinc(count * rest) / sinc(rest)


def smear_mrad(
    *, pitch_mrad: float, stages: int, phases: int, velocity_mismatch: float
) -> tuple[float, float]:
    """Smear of one step of the charge, and how far image and charge part over all stages, mrad.

    The second has the sign of the mismatch; arguments as of `tdi_mtf`.
    """
    pitch = positive("pitch", pitch_mrad, unit="mrad")
    step = (1.0 + velocity_mismatch) * pitch / phases if phases else 0.0
    return step, stages * velocity_mismatch * pitch


# Averaging over the sensitive width of a detector element.


def aperture_mtf(*, frequency: ArrayLike, effective_ifov_mrad: float) -> NDArray[np.float64]:
    """MTF of a rectangular detector element along one axis, signed.

    Parameters
    ----------
    frequency : array_like
        Frequencies along this axis in cycles/mrad, any shape, finite.
    effective_ifov_mrad : float
        pitch·fill/focal length, zero or above
        (`core.physics.sampling.detector_sampling.ifov_mrad`).

    Returns
    -------
    ndarray of float64
        sinc(IFOV·frequency); negative beyond the first zero, where the phase is π.

    Source: Tantalo 1996, eqs. 4.44 and 4.48; the MTF in x and y is the product of two of these.
    """
    width = non_negative("effective_ifov_mrad", effective_ifov_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        return sinc(width * np.asarray(frequency, dtype=np.float64))


def first_zero_cyc_per_mrad(*, effective_ifov_mrad: float) -> float:
    """Frequency at which the element averages one whole cycle: 1/IFOV.

    Source: Tantalo 1996, eqs. 4.45-4.46 and 4.49-4.50 (the "sinc width").
    """
    return 1.0 / positive("effective_ifov_mrad", effective_ifov_mrad, unit="mrad")
