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
    reference_f_number: float,
    reference_K: float,
    f_number: float,
    optics_transmission: float,
    cut_on_um: float,
    cut_off_um: float,
) -> float:
    """Noise as a radiance of the scene.

    Parameters
    ----------
    netd_K : float
        Of a data sheet, behind lossless optics of `reference_f_number` on a scene of `reference_K`.
    reference_f_number, f_number : float
        Of the data sheet and of the camera; above 0.
    reference_K : float
        Background of the data sheet.
    optics_transmission : float
        Of the camera's optics, above 0 and at most 1.
    cut_on_um, cut_off_um : float
        The band.

    Returns
    -------
    float
        In W/m²/sr: NETD·dL/dT(reference_K)·(4F² + 1)/(4F₀² + 1)/τ. A bolometer's own noise does not
        depend on the scene, so that over dL/dT of another background it is the NETD there.
    """
    netd = non_negative("netd", netd_K, unit="K")
    reference = positive("reference_f_number", reference_f_number)
    own = positive("f_number", f_number)
    share = positive("optics_transmission", optics_transmission)
    slope = float(
        band_radiance_derivative(
            cut_on_um=cut_on_um, cut_off_um=cut_off_um, temperature_K=reference_K
        )
    )
    light = (4.0 * own**2 + 1.0) / (4.0 * reference**2 + 1.0)
    return netd * slope * light / share


def share_kept(*, time_constant_s: float, frame_rate_Hz: float) -> float:
    """Share of a temperature difference that is left after a frame: exp(−1/(rate·τ))."""
    rate = positive("frame_rate_Hz", frame_rate_Hz, unit="Hz")
    constant = non_negative("time_constant_s", time_constant_s, unit="s")
    return math.exp(-1.0 / (rate * constant)) if rate * constant > 0.0 else 0.0


def lag_weights(*, kept: float, most: int) -> tuple[float, ...]:
    """Weights of this frame and those before it in what a first-order lag shows.

    Parameters
    ----------
    kept : float
        Share left after a frame, 0 to below 1.
    most : int
        No more frames than these are counted.

    Returns
    -------
    tuple of float
        (1 − kept)·kept^k, down to `SETTLED`; the last one takes all that is older, so that they add
        to 1.
    """
    if not 0.0 <= kept < 1.0:
        raise ParameterError("share kept", kept, "from 0 to below 1")
    count = 1
    while kept**count > SETTLED and count < most:
        count += 1
    weights = [(1.0 - kept) * kept**age for age in range(count)]
    weights[-1] = kept ** (count - 1)
    return tuple(weights)
