"""Blur of a lens and of jitter: Gaussians, and stray light."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError
from core.kernels import special
from core.physics.numerics import all_from_zero, gauss_legendre, non_negative, positive, within

# Gaussian blur: optics, random line-of-sight jitter and a turbulent blur spot.


def gaussian_mtf(*, frequency: ArrayLike, sigma_mrad: float) -> NDArray[np.float64]:
    """MTF of a Gaussian blur along one axis, or of a round one against radial frequency.

    Parameters
    ----------
    frequency : array_like
        Frequencies in cycles/mrad, any shape, finite.
    sigma_mrad : float
        Standard deviation of the blur spot in mrad, zero or above.

    Returns
    -------
    ndarray of float64
        exp(−2π²σ²·frequency²), of the shape of `frequency`.

    Source: Tantalo 1996, eqs. 4.22 and 4.36. Erratum: eq. 4.36 calls σ² the variance and takes
    it in µrad; here σ is in mrad, as the frequencies are per mrad.
    """
    sigma = non_negative("sigma_mrad", sigma_mrad, unit="mrad")
    with np.errstate(over="ignore"):
        turns = sigma * np.asarray(frequency, dtype=np.float64)
        return np.asarray(np.exp(-2.0 * math.pi**2 * np.square(turns)), dtype=np.float64)


def fwhm_to_sigma_mrad(*, fwhm_mrad: float) -> float:
    """Standard deviation of a Gaussian by its full width at half maximum: FWHM/(2·√(2·ln 2)).

    Source: definition of the normal density. Erratum: the width parameter of Tantalo 1996,
    eqs. 4.8-4.9, is damaged in print; this is the relation they stand for.
    """
    width = non_negative("fwhm_mrad", fwhm_mrad, unit="mrad")
    return width / (2.0 * math.sqrt(2.0 * math.log(2.0)))


# Stray light of a lens as a wide second part of its point spread function.

_MANY = 300.0  # 2π × cycles/rad, from which the part beyond the horizon is a short series
_TERMS, _NODES = 4, 900


def veiling_glare_mtf(*, rho: ArrayLike, share: float, length_mrad: float) -> NDArray[np.float64]:
    """MTF of a lens that spreads a share of its light widely.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad, 0 or above.
    share : float
        Of the light that is spread, 0 to 1.
    length_mrad : float
        Length ℓ of the spread ℓ/(2π(r² + ℓ²)^(3/2)), above 0; half of it falls within √3·ℓ.

    Returns
    -------
    ndarray
        1 − g + g·e^(−2πℓρ), of the shape of `rho`; 1 at 0.

    Source: Bracewell 2000, The Fourier Transform and Its Applications, Hankel transforms.
    """
    frequency = all_from_zero("rho", rho)
    spread = within("share", share, 0.0, 1.0)
    length = positive("length_mrad", length_mrad, unit="mrad")
    with np.errstate(under="ignore"):
        return np.asarray(1.0 + spread * np.expm1(-2.0 * np.pi * length * frequency))


def harvey_scatter(*, b_per_sr: float, s: float, l_mrad: float) -> float:
    """Share of the light that a surface scatters into the half space, refused above 1.

    Parameters
    ----------
    b_per_sr : float
        BSDF at no angle, 0 or above.
    s : float
        Slope of the BSDF far from there, −5 to 0.
    l_mrad : float
        Shoulder: sine of the angle at which it begins to fall, above 0 and up to 1000.

    Returns
    -------
    float
        2π∫b·[1 + (β/l)²]^(s/2)·β dβ from 0 to 1.

    Source: Harvey and Shack 1978, Applied Optics 17, 3003; Stover 2012, Optical Scattering, section
    4.5.
    """
    b = non_negative("b_per_sr", b_per_sr, unit="1/sr")
    slope, length = within("s", s, -5.0, 0.0), positive("l_mrad", l_mrad, unit="mrad") / 1e3
    within("l_mrad", l_mrad, 0.0, 1000.0, unit="mrad")
    log, rest = math.log1p(length**-2), 0.5 * slope + 1.0
    total = math.pi * b * length**2 * (math.expm1(rest * log) / rest if rest else log)
    if total > 1.0:
        raise ParameterError(
            "b_per_sr",
            b,
            f"the surface would scatter {total:.3g} times the incident light; lower this value",
        )
    return total


def harvey_mtf(
    *, rho: ArrayLike, b_per_sr: float, s: float, l_mrad: float, surfaces: int = 1
) -> NDArray[np.float64]:
    """MTF of surfaces that scatter by Harvey's law, between the direct light and its tail.

    Parameters
    ----------
    rho : array_like
        Radial frequency, cycles/mrad, 0 or above; angles and their sines are taken alike.
    b_per_sr, s, l_mrad
        As for `harvey_scatter`.
    surfaces : int
        Alike, one behind the other.

    Returns
    -------
    ndarray
        (1 − T + T·S)ⁿ: T is the scatter, S the Hankel transform of the BSDF up to the horizon over
        its value at 0, within 1e-7.

    Source: Harvey and Shack 1978; DLMF 10.22.46 (without the horizon); by parts beyond it.
    """
    share = harvey_scatter(b_per_sr=b_per_sr, s=s, l_mrad=l_mrad)
    k = 2e3 * np.pi * all_from_zero("rho", rho)
    length, near = l_mrad / 1e3, k < _MANY
    spread = np.empty(k.shape)
    spread[near] = _by_sum(k[near], s, length)
    spread[~near] = _by_series(k[~near], s, length)
    spread *= 2.0 * np.pi * b_per_sr
    return np.asarray(np.where(k > 0.0, (1.0 - share + spread) ** surfaces, 1.0))


def _by_sum(k: NDArray[np.float64], s: float, length: float) -> NDArray[np.float64]:
    """∫[1 + (β/l)²]^(s/2)·J₀(kβ)·β dβ from 0 to 1, by Gauss and Legendre in asinh(β/l)."""
    nodes, weights = gauss_legendre(_NODES)
    end = math.asinh(1.0 / length)
    t = 0.5 * end * (nodes + 1.0)
    beta = length * np.sinh(t)
    parts = 0.5 * end * weights * beta * length * np.cosh(t) ** (s + 1.0)
    return np.asarray(special("j0")(np.multiply.outer(k, beta)) @ parts, np.float64)


def _by_series(k: NDArray[np.float64], s: float, length: float) -> NDArray[np.float64]:
    """The same of large k: the integral to infinity, less the part beyond the horizon."""
    order = -0.5 * s - 1.0
    with np.errstate(under="ignore"):
        whole = special("kv")(order, k * length) * (0.5 * k / length) ** order
        whole *= length ** (-s) * special("rgamma")(order + 1.0)
    before, bessel = special("j0")(k), special("j1")(k)
    height, beyond = (1.0 + length**-2) ** (0.5 * s), np.zeros(k.shape)
    for n in range(_TERMS):
        beyond += height * bessel / k ** (n + 1)
        before, bessel = bessel, 2.0 * (n + 1) / k * bessel - before
        height *= -(s - 2.0 * n) / (1.0 + length**2)
    return np.asarray(whole + beyond, np.float64)
