"""Minimum detectable temperature difference (MDTD) of a thermal imager against target size.

The target is a square of side W and difference ΔT on a uniform background. The sensor blurs it;
averaged over a window of side w at its middle, the share Ī of ΔT is left of it. It is detected
when Ī·ΔT is SNR_th times the noise σ_p that is left after the eye has averaged over that window and
over time:

    MDTD(W) = SNR_th·σ_p(w)/Ī(W, w).
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.physics.acquisition.eye import coloured_share, frame_count, spatial_share
from core.physics.checks import all_above_zero, all_finite, positive, rising
from core.physics.noise.noise_components import COMPONENTS, NoiseVariances
from core.physics.numerics import sinc

Vector = NDArray[np.float64]
Window = Literal["target", "image"]


def mdtd_K(  # noqa: N802
    *,
    size_mrad: ArrayLike,
    frequency: ArrayLike,
    mtf_x: ArrayLike,
    mtf_y: ArrayLike,
    noise: NoiseVariances,
    snr_threshold: float,
    noise_bandwidth_x_cyc_per_mrad: float,
    noise_bandwidth_y_cyc_per_mrad: float,
    frames: float = 1.0,
    window: Window = "target",
    eye_limit_mrad: float | None = None,
    spectrum: ArrayLike | None = None,
) -> Vector:
    """MDTD of a square target.

    Parameters
    ----------
    size_mrad
        Side W of the target in mrad, above zero, shape (n,).
    frequency
        Frequencies in cycles/mrad from 0 in equal steps δ, shape (m,), to where both transfer
        functions have died away; W is at most 1/(2δ), as the sums repeat themselves after 1/δ.
    mtf_x, mtf_y
        Transfer functions H of the whole sensor across and along, signed, 1 at zero frequency,
        shape (m,).
    noise : NoiseVariances
        The seven variances in K²; one estimated below zero counts as none. The static performance
        model has `tvh` alone, NETD².
    snr_threshold
        Signal to noise ratio SNR_th at which half of the observers detect, above zero.
    noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
        Bandwidth of the noise, as for `core.physics.acquisition.eye.spatial_share`.
    frames
        Frames F_R·t_E that the eye averages, at least 1.
    window
        `target`: the eye averages over the target's own square, as the models have it. `image`:
        over the equivalent width of the blurred image, 1/∫ sinc²(W·ξ)·H(ξ)² dξ in each
        direction. Take it where the blur is wider than a sample: there a window of the target's
        size leaves the noise of a small target all but unaveraged.
    eye_limit_mrad
        Longest side of the window, mrad; None for no limit. A larger target is no easier to see.
    spectrum
        Power of all temporal noise together in equal cells from zero to the bandwidths, shape
        (along y, across x), as for `core.physics.acquisition.mrtd.mrtd_flir92_K`. None: σ_tvh is
        white.

    Returns
    -------
    ndarray of float64, shape (n,)
        K; infinite where the blur leaves nothing of the target.

    Notes
    -----
    Ī is the product over both directions of W·∫ sinc(W·ξ)·sinc(w·ξ)·H(ξ) dξ, over negative
    frequencies too. σ_p² = E_x·E_y·(E_t·σ_tvh² + σ_vh²) + E_x·(E_t·σ_th² + σ_h²) +
    E_y·(E_t·σ_tv² + σ_v²), E_t = 1/(F_R·t_E), E_x and E_y of
    `core.physics.acquisition.eye.spatial_share`; what a whole frame has in common (σ_t) does not
    hide a target. With a spectrum E_t·(σ_tvh² + σ_th² + σ_tv² +
    σ_t²)·`core.physics.acquisition.eye.coloured_share` takes the place of all terms with E_t. MDTD
    falls as one over W, the root of the area, for targets larger than blur and samples, and as one
    over the area W² for targets smaller than both (`image`: smaller than the blur).

    Source: Ratches et al. 1975, ECOM-7043 (temporal noise, the target's window); Scott and
    D'Agostino 1992, Proc. SPIE 1689, 194 (noise in three dimensions). The equations' numbers could
    not be checked, nor which components FLIR92 takes into its MDTD; the form was derived anew.
    """
    size = all_above_zero("size_mrad", size_mrad, unit="mrad")
    at = rising("frequency", frequency, unit="cyc/mrad")
    longest = 0.5 / float(at[1])
    if size.size and size.max() > longest:
        allowed = f"at most {longest:g}, half the inverse of the frequency step"
        raise ParameterError("size_mrad", float(size.max()), allowed, unit="mrad")
    limit = math.inf
    if eye_limit_mrad is not None:
        limit = positive("eye_limit_mrad", eye_limit_mrad, unit="mrad")
    transfers = []
    for name, mtf in (("mtf_x", mtf_x), ("mtf_y", mtf_y)):
        transfer = all_finite(name, mtf)
        if transfer.shape != at.shape:
            allowed = f"an array of the same shape as frequency, {at.shape}"
            raise ParameterError(name, f"an array of shape {transfer.shape}", allowed)
        transfers.append(transfer)
    *sides, intensity = _blurred(size, at, transfers, window, limit)
    bandwidths = noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
    left = _variance_left(noise, sides, bandwidths, 1.0 / frame_count(frames), spectrum)
    seen = intensity > 0.0
    threshold = positive("snr_threshold", snr_threshold) * np.sqrt(left)
    with np.errstate(over="ignore"):
        return np.where(seen, threshold / np.where(seen, intensity, 1.0), np.inf)


def _variance_left(
    noise: NoiseVariances,
    sides: list[Vector],
    bandwidths: tuple[float, float],
    in_time: float,
    spectrum: ArrayLike | None,
) -> Vector:
    across, along = (
        spatial_share(length_mrad=side, noise_bandwidth_cyc_per_mrad=bandwidth)
        for side, bandwidth in zip(sides, bandwidths, strict=True)
    )
    size = {name: max(noise.variance(name), 0.0) for name in COMPONENTS}
    fixed = across * along * size["vh"] + across * size["h"] + along * size["v"]
    if spectrum is None:
        temporal = across * along * size["tvh"] + across * size["th"] + along * size["tv"]
    else:
        shares = coloured_share(
            length_x_mrad=sides[0].ravel(),
            length_y_mrad=sides[1].ravel(),
            noise_bandwidth_x_cyc_per_mrad=bandwidths[0],
            noise_bandwidth_y_cyc_per_mrad=bandwidths[1],
            spectrum=spectrum,
        )
        whole = size["tvh"] + size["tv"] + size["th"] + size["t"]
        temporal = whole * shares.reshape(sides[0].shape)
    return np.asarray(fixed + in_time * temporal)


def _blurred(
    size: Vector, at: Vector, transfers: list[Vector], window: Window, limit: float
) -> tuple[Vector, Vector, Vector]:
    """Sides of the window across and along, and Ī over both, for each size of the target.

    The integrals over frequency are sums by the trapezoidal rule, which is exact where the profile
    that the product is the spectrum of ends within 1/step.
    """
    steps = np.full(at.shape, 2.0 * float(at[1]))
    steps[[0, -1]] *= 0.5
    amplitudes = [steps * transfer for transfer in transfers]
    powers = [steps * np.square(transfer) for transfer in transfers]
    rows = []
    for length in size.ravel():
        square = sinc(length * at)
        sides, intensity = [], 1.0
        for amplitude, power in zip(amplitudes, powers, strict=True):
            side = length if window == "target" else _image_width(square, power)
            # Of a target of which nothing is left the image has no width; any will do.
            side = min(side, limit) if side < math.inf else length
            averaged = square if side == length else sinc(side * at)
            intensity *= length * float(np.dot(square * averaged, amplitude))
            sides.append(side)
        rows.append((*sides, intensity))
    across, along, intensities = np.array(rows, np.float64).reshape(-1, 3).T
    return across.reshape(size.shape), along.reshape(size.shape), intensities.reshape(size.shape)


def _image_width(square: Vector, power: Vector) -> float:
    """Width of the rectangle that has area and power of the blurred target's profile."""
    total = float(np.dot(np.square(square), power))
    return 1.0 / total if total else math.inf
