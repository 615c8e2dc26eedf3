"""Microbolometers: noise by a data sheet's NETD, and the lag of their heat capacity.

Sources: Kruse 2001, Uncooled Thermal Imaging Arrays, Systems and Applications, chapters 3 and 4;
Rogalski 2011, Infrared Detectors, 2nd ed., chapters 4 and 22.
"""

from __future__ import annotations

import math

from core.errors import ParameterError
from core.physics.checks import non_negative, positive
from core.physics.radiometry.planck import band_radiance_derivative

SETTLED = 1e-6
"""Share of a step that is left where earlier frames are no longer counted."""


def netd_noise_radiance(
    *,
    netd_K: float,
    reference_K: float,
    reference_sr: float,
    lens_sr: float,
    cut_on_um: float,
    cut_off_um: float,
) -> float:
    """Noise of a data sheet's NETD as a radiance of the scene, W/m²/sr: NETD·dL/dT(T₀)·τ₀Ω₀/(τΩ).

    `reference_K` is the background of the data sheet, `reference_sr` the light of its optics and
    `lens_sr` that of the camera's: transmission times solid angle. A bolometer's own noise does not
    depend on the scene, so that over dL/dT of another background it is the NETD there.
    """
    netd = non_negative("netd", netd_K, unit="K")
    light = positive("reference_sr", reference_sr, unit="sr") / positive(
        "lens_sr", lens_sr, unit="sr"
    )
    slope = float(
        band_radiance_derivative(
            cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=reference_K
        )
    )
    return netd * slope * light


def share_kept(*, time_constant_s: float, frame_rate_Hz: float) -> float:
    """Share of a temperature difference that is left after a frame: exp(−1/(rate·τ))."""
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    constant = non_negative("time_constant_s", time_constant_s, unit="s")
    return math.exp(-1.0 / (rate * constant)) if rate * constant > 0.0 else 0.0


def lag_weights(*, kept: float, most: int) -> tuple[float, ...]:
    """Weights of this frame and those before it in what a first-order lag shows.

    (1 − kept)·kept^k with the share `kept` of a frame, down to `SETTLED` and over `most` frames;
    the last one takes all that is older, so that they add to 1.
    """
    if not 0.0 <= kept < 1.0:
        raise ParameterError("fraction of a change that remains", kept, "from 0 to below 1")
    count = 1
    while kept**count > SETTLED and count < most:
        count += 1
    weights = [(1.0 - kept) * kept**age for age in range(count)]
    weights[-1] = kept ** (count - 1)
    return tuple(weights)
