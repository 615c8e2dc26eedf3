"""A camera's mean electrons and what becomes of them, without noise; pixels as sums of waves."""

from functools import lru_cache

import numpy as np

from slow_reference.numbers import PI, like

PLANCK, LIGHT, BOLTZMANN = (
    np.longdouble(text) for text in ("6.62607015e-34", "299792458", "1.380649e-23")
)
NODES = 96
DEEPEST = 1e-6  # of the brightest sample, below which no temperature is looked for
STEPS = 60


@lru_cache(maxsize=8)
def _band(low_um, high_um):
    """Wavelengths in m and weights of a sum over a band."""
    places, weights = np.polynomial.legendre.leggauss(NODES)
    half = np.longdouble(high_um - low_um) / 2
    middle = np.longdouble(high_um + low_um) / 2
    return (middle + half * places) * 1e-6, half * weights * 1e-6


def black_body(kelvin, low_um, high_um):
    """(W/m²/sr, photons/s/m²/sr) of a band."""
    wave, weights = _band(low_um, high_um)
    kelvin = np.asarray(kelvin, np.longdouble)[..., np.newaxis]
    # Beyond 11000 exponentials of the longest type end, and nothing is emitted.
    occupied = 1 / np.expm1(np.minimum(PLANCK * LIGHT / (wave * BOLTZMANN * kelvin), 11000))
    photons = 2 * LIGHT / wave**4 * occupied * weights
    return (photons * PLANCK * LIGHT / wave).sum(axis=-1), photons.sum(axis=-1)


def photons_per_radiance(p, radiance):
    """Photons over watts, of each sample or of all; None where no temperature is right."""
    low, high = p["cut_on_um"], p["cut_off_um"]
    if p["photon_weighting"] == "middle":
        return np.longdouble(low + high) / 2 * 1e-6 / (PLANCK * LIGHT)
    if p["photon_weighting"] == "source" or low < 2.5:
        watts, photons = black_body(p["source_K"], low, high)
        return photons / watts
    most = float(radiance.max())
    if not DEEPEST * most < float(radiance.min()) or not 1e-6 < most < 1e8:
        return None
    # Newton's method for the logarithm of radiance over 1/T, in which it is nearly straight.
    inverse = np.full(radiance.shape, np.longdouble(1) / 300)
    step = np.longdouble("1e-7")
    for _ in range(STEPS):
        here, beside = (black_body(1 / i, low, high)[0] for i in (inverse, inverse * (1 + step)))
        slope = np.log(beside / here) / (inverse * step)
        change = np.log(radiance / here) / slope
        inverse = np.maximum(inverse + change, inverse / 4)
        if np.abs(change / inverse).max() < 1e-16:
            break
    watts, photons = black_body(1 / inverse, low, high)
    return photons / watts


def focal_plane(p, context, radiance, scale):
    """(samples in the units wanted, scale of their errors); None where hung on rounding.

    N = t·n·A·FF·QE·Ω·[τ·L_q + (1−τ)·L_q(optics)] + t·n·A·FF·QE·(π−Ω)(1−η)·L_q(housing) + dark; of
    that the response bends N·(1 − p·N/W), and gain and offset make numbers that are not rounded.
    """
    one = like(radiance, 1)
    cone = PI / (4 * np.longdouble(context["f_number"]) ** 2 + 1)
    stage_s = np.longdouble(p["integration_time_s"]) * p["tdi_stages"]
    area = np.longdouble(context["detector_x_um"]) * context["detector_y_um"] * 1e-12
    counted = stage_s * area * context["fill_x"] * context["fill_y"] * p["quantum_efficiency"]
    ratio = photons_per_radiance(p, radiance)
    if ratio is None:
        return None
    ratio = ratio * (counted * cone * p["optics_transmission"])
    band = p["cut_on_um"], p["cut_off_um"]
    pedestal = stage_s * p["dark_current_e_per_s"]
    if p["optics_K"] is not None:
        warm = black_body(p["optics_K"], *band)[1]
        pedestal += counted * cone * (1 - np.longdouble(p["optics_transmission"])) * warm
    if p["housing_K"] is not None:
        warm = black_body(p["housing_K"], *band)[1]
        pedestal += counted * (PI - cone) * (1 - np.longdouble(p["cold_shield_efficiency"])) * warm
    electrons = radiance * np.asarray(ratio, radiance.dtype) + one * like(radiance, pedestal)
    per_radiance = float(np.max(ratio))
    error = max(2 * per_radiance * scale, float(pedestal), float(np.abs(electrons).max()))
    if p["nonlinearity_percent"]:
        curvature = (
            like(radiance, p["nonlinearity_percent"]) / 100 / like(radiance, p["full_well_e"])
        )
        electrons = np.minimum(electrons, 1 / (2 * curvature))
        error *= 1 + 2 * float(curvature * np.abs(electrons).max())
        electrons = electrons * (1 - curvature * electrons)
    gain, offset = p["gain_e_per_dn"], p["offset_dn"]
    if not gain:
        gain = p["full_well_e"] / (2 ** p["bits"] - 1) if p["bits"] else 1.0
    if p["bits"]:  # electrons and radiances are those of the numbers
        error = max(error, abs(offset) * gain)
    if p["units"] == "electrons":
        return electrons, error
    if p["units"] == "dn":
        return electrons / like(radiance, gain) + like(radiance, offset), error / gain + abs(offset)
    least = float(np.min(ratio))
    return (electrons - like(radiance, pedestal)) / np.asarray(ratio, radiance.dtype), error / least


def at_places(places, size, edges, kind):
    """Values of a frame's waves between its samples, from the sums over the frame."""
    number = 2 * size if edges == "reflect" else size
    index = np.arange(number)
    signed = np.where(2 * index >= number, index - number, index)
    angle = 2 * kind(PI) * np.multiply.outer(places.astype(kind), signed.astype(kind)) / number
    waves = np.cos(angle) + 1j * np.sin(angle)
    if number % 2 == 0:  # it stands for both signs
        waves[:, number // 2] = np.cos(angle[:, number // 2])
    return waves / number


def pixel_places(samples, ratio, offset, kind):
    """Middles of the pixels that fit the frame whole, counted in samples."""
    count = int(np.floor(samples / ratio + 1e-6))
    return (np.arange(count) + kind(0.5) + kind(offset)) * kind(ratio) - kind(0.5)
