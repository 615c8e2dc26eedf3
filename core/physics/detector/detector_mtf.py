"""MTF of a detector: its aperture, charge transfer, and motion during time delay integration."""

import math
from decimal import Decimal
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.arrays import Floats
from core.errors import ParameterError
from core.kernels import special
from core.physics.numerics import (
    all_from_zero,
    finite,
    mean_of_waves,
    non_negative,
    positive,
    sinc,
    within,
)

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
    return np.asarray(smear * mean_of_waves(shifts, stages * phases))


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


# Charge diffusion: carriers wander before the depletion region collects them, and blur.
#
# A carrier that is born in the depletion region is collected where it is. One born outside reaches
# it with a probability that falls with the distance in diffusion lengths; of a wave of frequency f
# the diffusion length is L_f = L₀/√(1 + (2πL₀f)²), and the MTF is what is collected of the wave
# over what is collected of an even light.
#
# Sources: Seib 1974, IEEE Trans. Electron Devices 21, 210 (front side); Crowell and Labuda 1969,
# Bell System Technical Journal 48, 1481 (back side); Holst and Lomheim 2007, CMOS/CCD Sensors and
# Camera Systems, chapter 10.

Side = Literal["front", "back"]


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
            allowed = (
                "the thickness of a back-illuminated detector must be above "
                f"depletion_um = {depletion:g} µm"
            )
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
    towards = np.exp(-least * bulk_um) * bulk_um * special("exprel")(-(most - least) * bulk_um)
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


# Crosstalk between pixels: charge, light or capacitance that a neighbour gets of a pixel.

Kernel = tuple[tuple[float, ...], ...]
SIZES = (3, 5)
_SUM_TOLERANCE = 1e-6


def crosstalk_kernel(text: str) -> Kernel:
    """Kernel of numbers, rows separated by semicolons, as "0 0.02 0; 0.02 0.92 0.02; 0 0.02 0".

    3 × 3 or 5 × 5 numbers, 0 or above, that add up to 1 (within 1e-6) and are divided by their sum:
    of a lit pixel's signal, what the pixels round it get; row 0 is above it, column 0 left of it.
    """
    rows = [row.replace(",", " ").split() for row in text.strip().strip(";").split(";")]
    size = len(rows)
    try:
        numbers = [[float(word) for word in row] for row in rows]
    except ValueError as error:
        raise ParameterError(
            "kernel", text, f"give 3 × 3 or 5 × 5 numbers, rows separated by semicolons ({error})"
        ) from None
    if size not in SIZES or any(len(row) != size for row in numbers):
        counts = ", ".join(str(len(row)) for row in numbers)
        words = "number" if counts == "1" else "numbers"
        found = f"{size} row{'s' if size > 1 else ''} with {counts} {words}"
        allowed = f"give 3 × 3 or 5 × 5 numbers, rows separated by semicolons, not {found}"
        raise ParameterError("kernel", text, allowed)
    flat = [value for row in numbers for value in row]
    if not all(0.0 <= value < math.inf for value in flat):
        raise ParameterError("kernel", text, "numbers that are 0 or above")
    total = math.fsum(flat)
    if abs(total - 1.0) > _SUM_TOLERANCE:
        raise ParameterError("kernel", text, f"numbers that add up to 1, not {total:.6g}")
    return tuple(tuple(value / total for value in row) for row in numbers)


def crosstalk_otf(
    *, xi: ArrayLike, eta: ArrayLike, kernel: Kernel, pitch_x_mrad: float, pitch_y_mrad: float
) -> NDArray[np.complex128]:
    """OTF of crosstalk.

    Parameters
    ----------
    xi, eta : array_like
        Frequencies, cycles/mrad; they broadcast.
    kernel : tuple of tuple of float
        As of `crosstalk_kernel`.
    pitch_x_mrad, pitch_y_mrad : float
        From one pixel to the next, above 0.

    Returns
    -------
    ndarray of complex128
        Σ k·e^(−2πi(ξx + ηy)), with x to the right and y downwards; 1 at frequency 0.

    Source: Holst and Lomheim 2007, CMOS/CCD Sensors and Camera Systems, chapter 10; Moore, Ninkov
    and Forrest 2006, Optical Engineering 45, 076402 (interpixel capacitance).
    """
    x = positive("pitch_x_mrad", pitch_x_mrad, unit="mrad")
    y = positive("pitch_y_mrad", pitch_y_mrad, unit="mrad")
    weights = np.asarray(kernel, np.float64)
    if not np.isfinite(weights).all():
        raise ParameterError("kernel", "a number that is not finite", "finite numbers")
    steps = np.arange(len(weights)) - len(weights) // 2
    across = [np.exp(-2j * np.pi * x * step * np.asarray(xi, np.float64)) for step in steps]
    along = [np.exp(-2j * np.pi * y * step * np.asarray(eta, np.float64)) for step in steps]
    return np.asarray(
        sum(
            row * sum(weight * wave for weight, wave in zip(line, across, strict=True))
            for line, row in zip(weights, along, strict=True)
        ),
        np.complex128,
    )
