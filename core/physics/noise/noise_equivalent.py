"""Noise of a detector as power, radiance and temperature difference (NEP, NER, NETD)."""

import math
from collections.abc import Sequence
from math import hypot, inf, pi, sqrt

from core.errors import DataError, ParameterError
from core.physics.detector import focal_plane_array
from core.physics.numerics import non_negative, positive
from core.physics.radiometry.planck import band_radiance_derivative


def g_number(
    *,
    f_number: float,
    filter_transmission: float,
    optics_transmission: float,
    obscuration_ratio: float = 0.0,
    irradiance: focal_plane_array.Irradiance = "disc",
) -> float:
    """Throughput number G#: radiance of the scene per irradiance of the detector.

    Parameters
    ----------
    f_number, obscuration_ratio, irradiance
        As of `solid_angle`.
    filter_transmission, optics_transmission
        Above 0, at most 1.

    Returns
    -------
    1/(τ_f·τ_o·Ω), sr⁻¹: (1 + 4F²)/(τ_f·τ_o·π) for a clear aperture and `disc`.

    Source: Tantalo 1996, eq. 4.54 (F/1.75 with 0.9 and 0.9 gives the published 5.20692); there the
    aperture is clear.
    """
    _check_share("filter_transmission", filter_transmission)
    _check_share("optics_transmission", optics_transmission)
    cone = focal_plane_array.inverse_sin_squared(f_number=f_number, irradiance=irradiance)
    light = filter_transmission * optics_transmission * pi
    return cone / (light * focal_plane_array.open_share(obscuration_ratio=obscuration_ratio))


def detector_area_cm2(
    *, pitch_x_um: float, pitch_y_um: float, fill_x: float, fill_y: float
) -> float:
    """Light-sensitive area of a detector element, cm², from pitch (µm) and fill factors (0 to 1].

    Source: the effective area of Tantalo 1996, eqs. 4.51-4.52.
    """
    positive("pitch_x_um", pitch_x_um, unit="µm")
    positive("pitch_y_um", pitch_y_um, unit="µm")
    _check_share("fill_x", fill_x)
    _check_share("fill_y", fill_y)
    return pitch_x_um * pitch_y_um * fill_x * fill_y * 1e-8


def nep_W(  # noqa: N802
    *, area_cm2: float, bandwidth_Hz: float, d_star: float
) -> float:
    """Noise-equivalent power √(A·Δf)/D*, W, of the light-sensitive area and the noise bandwidth.

    A D* of 0, cm √Hz/W, means no response in the band and is refused.

    Source: Tantalo 1996, eq. 4.52 (power in W; the text says W/sr).
    """
    positive("area_cm2", area_cm2, unit="cm²")
    positive("bandwidth_Hz", bandwidth_Hz, unit="Hz")
    positive("d_star", d_star, unit="cm √Hz/W")
    return sqrt(area_cm2 * bandwidth_Hz) / d_star


def ner_W_m2_sr(  # noqa: N802
    *, nep_W: float, area_cm2: float, g_number: float
) -> float:
    """Noise-equivalent radiance NEP·G#/A, W m⁻² sr⁻¹.

    Source: Tantalo 1996, eq. 4.51.
    """
    positive("area_cm2", area_cm2, unit="cm²")
    positive("g_number", g_number, unit="1/sr")
    return nep_W * g_number / (area_cm2 * 1e-4)


def netd_K(  # noqa: N802
    *, noise_radiance: float, cut_on_um: float, cut_off_um: float, background_K: float
) -> float:
    """Noise-equivalent temperature difference, K: noise over the slope dL/dT of the background.

    The noise is a standard deviation in W m⁻² sr⁻¹; a background too cold to have a slope is
    refused.

    Source: Tantalo 1996, eq. 4.63.
    """
    noise = non_negative("noise_radiance", noise_radiance, unit="W/m²/sr")
    slope = band_radiance_derivative(
        cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=float(background_K)
    )
    netd = noise / slope if slope > 0.0 else inf
    if netd == inf:
        allowed = f"the background emits nothing from {cut_on_um:g} to {cut_off_um:g} µm"
        raise ParameterError("background_K", background_K, allowed, unit="K")
    return netd


def amplifier_noise_radiance(*, reference_radiance: float, snr: float) -> float:
    """Standard deviation of the amplifier's noise: reference over SNR, W m⁻² sr⁻¹.

    `reference_radiance` is the picture's mean, or its range for an SNR of contrast; its sign is
    of no effect.

    Source: Tantalo 1996, eq. 4.61.
    """
    positive("snr", snr)
    return abs(reference_radiance) / snr


def system_netd_K(  # noqa: N802
    *, amplifier_netd_K: float, detector_netd_K: float
) -> float:
    """NETD of amplifier and detector together, the root of the sum of squares, K.

    Source: Tantalo 1996, eq. 4.62.
    """
    return hypot(amplifier_netd_K, detector_netd_K)


def _check_share(name: str, value: float) -> None:
    if not 0.0 < value <= 1.0:
        raise ParameterError(name, value, "must be above 0 and at most 1")


# How stages whose transfer functions multiply share in what is lost.


def loss(*, mtf: float) -> float:
    """What a transfer function takes from a frequency: −ln |MTF|.

    0 for what passes whole, infinite for what lets nothing through, below 0 for what amplifies.
    Moduli of stages multiply, so their losses add. That of a Gaussian blur of deviation σ is
    2π²σ²f²: at one frequency Gaussian blurs share as their variances.
    """
    if not math.isfinite(mtf):
        raise DataError(f"an MTF of {mtf} cannot be used: it must be finite")
    if mtf == 0.0:
        return math.inf
    return 0.0 - math.log(abs(mtf))


def shares_of_losses(*, losses: Sequence[float]) -> list[float]:
    """Share of each stage in all that is lost, of their losses −ln |MTF|.

    Those of stages that lose add up to 1. What amplifies has a share below 0: how much of the
    loss it makes up for. Where nothing is lost, shares are those of all that is amplified, and
    add up to −1. Stages that let nothing through share all of it alike.
    """
    if math.inf in losses:
        opaque = list(losses).count(math.inf)
        return [1.0 / opaque if value == math.inf else 0.0 for value in losses]
    whole = math.fsum(value for value in losses if value > 0.0)
    whole = whole or -math.fsum(losses)
    return [value / whole if value else 0.0 for value in losses]
