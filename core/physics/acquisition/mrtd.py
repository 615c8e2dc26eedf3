"""Minimum resolvable temperature difference (MRTD) of a thermal imager against frequency.

The target is four bars, each of width W = 1/(2f) and length 7·W. Of its square wave of difference
ΔT a sensor passes the first harmonic, of amplitude (4/π)·(ΔT/2)·H(f). Averaged over a bar that is
2/π of it, so that bars and gaps differ by (8/π²)·H(f)·ΔT. The bars are resolved when this is
SNR_th times the noise σ_p that is left after the eye has averaged over a bar and over time:

    MRTD(f) = (π²/8)·SNR_th·σ_p(f)/H(f).

Both models are this equation; they differ in σ_p.
"""

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from core.arrays import Vector
from core.errors import ParameterError
from core.physics import numerics
from core.physics.acquisition.target_acquisition import (
    coloured_share,
    frame_count,
    resolvable_frequency,
    spatial_share,
)
from core.physics.noise.noise_components import COMPONENTS, NoiseVariances

Direction = Literal["horizontal", "vertical"]
BARS_LENGTH = 7.0  # widths of a bar
HARMONIC = math.pi**2 / 8.0
_ZERO = 1e-12  # a transfer function below this is rounding
_LEVELS = 257  # temperatures of the MRTD for both directions


def mrtd_ratches_K(  # noqa: N802
    *,
    frequency: ArrayLike,
    mtf: ArrayLike,
    netd_K: float,
    snr_threshold: float,
    noise_bandwidth_cyc_per_mrad: float,
    detector_along_mrad: float,
    overscan: float = 1.0,
    frames: float = 1.0,
    spectrum: ArrayLike | None = None,
) -> Vector:
    """MRTD of the static performance model: NETD, averaged over a bar and over time.

    Parameters
    ----------
    frequency
        Frequency f of the bars in cycles/mrad, rising, above zero, shape (n,).
    mtf
        Transfer function H of the whole sensor at f, signed, 1 at zero frequency, shape (n,).
    netd_K
        Noise equivalent temperature difference, temporal noise only, K, zero or above.
    snr_threshold
        Signal to noise ratio SNR_th at which half of the observers resolve the bars, above zero;
        2.25 in the model of 1975, 2.5 in FLIR92.
    noise_bandwidth_cyc_per_mrad
        Bandwidth B of the noise across the bars, cycles/mrad: Δf_N/v of a scan, noise bandwidth
        in Hz over scan velocity in mrad/s; half the samples per mrad of a staring array.
    detector_along_mrad
        Angle Δ of a detector element along the bars, mrad.
    overscan
        Samples N_os per detector element along the bars; the lines lie Δ/N_os apart.
    frames
        Frames F_R·t_E that the eye averages (`frames_integrated`), at least 1.
    spectrum
        Power of the noise in equal cells from zero to the bandwidth, shape (along, across) the
        bars, in any unit; its mean along is taken. None: white.

    Returns
    -------
    ndarray of float64, shape (n,)
        K; infinite from the first zero of H on.

    Notes
    -----
    MRTD = (π²/(4√14))·SNR_th·(NETD/H(f))·√(Δ·v·f·Q(f)/(Δf_N·N_os·F_R·t_E)), Q(f) = ∫ sinc²(ξ/(2f))
    dξ from 0 to Δf_N/v. It is the equation above, with the average over the bar's length 7/(2f)
    written as Δ·2f/(7·N_os), whence the √14, and Q(f) for the one over its width. Under Q(f) the
    model of 1975 has the noise's spectrum, given here, and eye and display, which are not. Lines
    count as independent. It has no fixed pattern and no limit by sampling.

    Source: Ratches, Lawson, Obert, Bergemann, Cassidy and Swenson 1975, ECOM-7043; Ratches 1976,
    Opt. Eng. 15, 525. The equation's number could not be checked; the form was derived anew.
    """
    at, transfer = _curve(frequency, mtf)
    netd = numerics.non_negative("netd_K", netd_K, unit="K")
    line = numerics.positive(
        "detector_along_mrad", detector_along_mrad, unit="mrad"
    ) / numerics.positive("overscan", overscan)
    power = np.ones((1, 1)) if spectrum is None else np.asarray(spectrum, np.float64)
    over_width = coloured_share(
        length_x_mrad=0.5 / at,
        length_y_mrad=np.zeros_like(at),
        noise_bandwidth_x_cyc_per_mrad=noise_bandwidth_cyc_per_mrad,
        noise_bandwidth_y_cyc_per_mrad=1.0,
        spectrum=power.mean(axis=0, keepdims=True),
    )
    over_length = line * 2.0 * at / BARS_LENGTH
    left = np.sqrt(over_width * over_length / frame_count(frames))
    return _threshold(transfer, numerics.positive("snr_threshold", snr_threshold) * netd * left)


def mrtd_flir92_K(  # noqa: N802
    *,
    frequency: ArrayLike,
    mtf: ArrayLike,
    noise: NoiseVariances,
    snr_threshold: float,
    across_cyc_per_mrad: float,
    along_cyc_per_mrad: float,
    direction: Direction,
    frames: float = 1.0,
    sampled: bool = True,
    spectrum: ArrayLike | None = None,
) -> Vector:
    """MRTD of FLIR92: three-dimensional noise, averaged over a bar, and over time if temporal.

    Parameters
    ----------
    frequency, mtf, snr_threshold, frames
        As in `mrtd_ratches_K`.
    noise : NoiseVariances
        The seven variances in K²; one estimated below zero counts as none.
    across_cyc_per_mrad, along_cyc_per_mrad
        Bandwidth of the noise across and along the bars, cycles/mrad: half the samples per mrad
        where the picture is sampled, noise bandwidth over scan velocity along an analogue scan.
    direction
        `horizontal`: frequencies across, upright bars; `vertical`: lying bars.
    sampled
        Whether the picture is sampled across the bars, as that of an array is in both directions
        and that of a scanner across its scan; then `across_cyc_per_mrad` is Nyquist's frequency,
        from which on nothing is resolved.
    spectrum
        Power of all temporal noise together in equal cells from zero to the bandwidths, shape
        (along, across) the bars, in any unit: then what neighbouring samples have in common is in
        it, and not in σ_tv, σ_th and σ_t apart. None: σ_tvh is white.

    Returns
    -------
    ndarray of float64, shape (n,)
        K; infinite from the first zero of H on, and beyond the limit of sampling.

    Notes
    -----
    MRTD_h(f) = (π²/8)·SNR_th·σ_tvh·k_h(f)·√(E_t·E_h(f)·E_v(f))/H_h(f), where E_t = 1/(F_R·t_E),
    E_h is the average over the width 1/(2f) of upright bars and E_v that over their length 7/(2f)
    (`spatial_share`), and k_h² = 1 + (σ_vh²/σ_tvh²)/E_t + (σ_th²/σ_tvh²)/E_v +
    (σ_h²/σ_tvh²)/(E_t·E_v). For lying bars h and v change places. What is the same in a bar and the
    gap beside it (σ_tv, σ_v and σ_t of upright bars) does not hide the bars. With a spectrum
    (σ_tvh² + σ_th² + σ_tv² + σ_t²)·`coloured_share` replaces σ_tvh²·E_h·E_v and σ_th²·E_h.

    Source: Scott and D'Agostino 1992, NVEOD FLIR92 thermal imaging systems performance model, Proc.
    SPIE 1689, 194. The equations' numbers could not be checked; the form was derived anew.
    """
    at, transfer = _curve(frequency, mtf)
    over_width = spatial_share(
        length_mrad=0.5 / at, noise_bandwidth_cyc_per_mrad=across_cyc_per_mrad
    )
    over_length = spatial_share(
        length_mrad=0.5 * BARS_LENGTH / at, noise_bandwidth_cyc_per_mrad=along_cyc_per_mrad
    )
    in_time = 1.0 / frame_count(frames)
    size = {name: max(noise.variance(name), 0.0) for name in COMPONENTS}
    from_bar_to_bar = "h" if direction == "horizontal" else "v"
    left = over_width * (over_length * size["vh"] + size[from_bar_to_bar])
    if spectrum is None:
        left += in_time * over_width * (over_length * size["tvh"] + size[f"t{from_bar_to_bar}"])
    else:
        temporal = size["tvh"] + size["tv"] + size["th"] + size["t"]
        left += (in_time * temporal) * coloured_share(
            length_x_mrad=0.5 / at,
            length_y_mrad=0.5 * BARS_LENGTH / at,
            noise_bandwidth_x_cyc_per_mrad=across_cyc_per_mrad,
            noise_bandwidth_y_cyc_per_mrad=along_cyc_per_mrad,
            spectrum=spectrum,
        )
    mrtd = _threshold(transfer, numerics.positive("snr_threshold", snr_threshold) * np.sqrt(left))
    if sampled:
        mrtd[at > across_cyc_per_mrad] = np.inf
    return mrtd


def mrtd_two_dimensional(
    *, frequency: ArrayLike, horizontal_K: ArrayLike, vertical_K: ArrayLike
) -> tuple[Vector, Vector]:
    """The one MRTD for both directions: at each temperature √(f_h·f_v) of the two curves.

    Parameters
    ----------
    frequency
        Frequencies of both curves in cycles/mrad, rising, above zero, shape (n,).
    horizontal_K, vertical_K
        MRTD in K, shape (n,); an infinite one ends the curve.

    Returns
    -------
    (frequency, mrtd) : ndarrays of float64, at most 257 each
        cycles/mrad, rising, and K, the least that resolves them, from the higher of the curves'
        lowest values to the higher of their highest; without noise in both directions zero up to
        where the curves end. No samples if one of the directions resolves nothing.

    Notes
    -----
    A temperature above the end of one curve, where sampling cuts it off, resolves that
    direction up to its end, as any temperature does one without noise.
    Source: Scott and D'Agostino 1992, Proc. SPIE 1689, 194. The equation's number could not be
    checked.
    """
    curves = [
        numerics.all_from_zero(name, curve, unit="K", infinite=True)
        for name, curve in (("horizontal_K", horizontal_K), ("vertical_K", vertical_K))
    ]
    finite = [curve[np.isfinite(curve)] for curve in curves]
    if any(len(values) == 0 for values in finite):
        return np.empty(0), np.empty(0)
    low = max(float(values.min()) for values in finite)
    high = max(float(values.max()) for values in finite)
    levels = (np.geomspace if low > 0.0 else np.linspace)(low, high, _LEVELS)
    reached = [
        resolvable_frequency(frequency=frequency, mrtd_K=curve, apparent_K=levels)
        for curve in curves
    ]
    if high == 0.0:
        at = numerics.rising("frequency", frequency, unit="cyc/mrad")
        both = np.array([at[0], math.sqrt(float(reached[0][0] * reached[1][0]))])
        return (both, np.zeros(2)) if both[1] > both[0] else (both[:1], np.zeros(1))
    both = np.sqrt(reached[0] * reached[1])
    # Where both stay at a frequency, such as that of their ends, the least temperature counts.
    least = np.concatenate([[True], both[1:] > np.maximum.accumulate(both)[:-1]])
    return both[least], levels[least]


def _curve(frequency: ArrayLike, mtf: ArrayLike) -> tuple[Vector, Vector]:
    at = numerics.rising("frequency", frequency, unit="cyc/mrad")
    numerics.positive("frequency[0]", at[0], unit="cyc/mrad")
    return at, numerics.along(at, "mtf", numerics.all_finite("mtf", mtf))


def _threshold(transfer: Vector, noise_K: Vector) -> Vector:
    """(π²/8)·noise/H up to the first zero of H, beyond which bars and gaps change places."""
    resolved = np.logical_and.accumulate(transfer > _ZERO)
    safe = np.where(resolved, transfer, 1.0)
    return np.where(resolved, HARMONIC * noise_K / safe, np.inf)


# Noise of a display as the eye filters it while it looks for a sine of one frequency.

_CD_M2_OF_FOOT_LAMBERT = 3.4262590996
_NODES = 4  # of a cell of the spectrum
_CHANNEL = 2.2  # of the logarithm squared: a channel of vision is 1.6 octaves wide


def eyeball_mtf(*, frequency_cyc_per_mrad: ArrayLike, luminance_cd_m2: float) -> Vector:
    """MTF of the eye's optics, retina and tremor, both eyes' pupils as wide as the display makes.

    exp(−(43.69·u/f0)^i0)·exp(−0.375·u^1.21)·exp(−0.4441·u²) at a frequency u at the eye, with f0 =
    exp(3.663 − 0.0216·D²·ln D), i0 = (0.7155 + 0.277/√D)² and a pupil of D = −9.011 +
    13.23·exp(−lg(L/fL)/21.082) mm, 2 to 8.

    Source: Overington 1976, Vision and Acquisition, as Vollmerhausen and Jacobs 2004, report
    AMSEL-NV-TR-230, has it. Written down from the literature that quotes it; the coefficients could
    not be checked.
    """
    places = numerics.all_from_zero(
        "frequency_cyc_per_mrad", frequency_cyc_per_mrad, unit="cyc/mrad"
    )
    luminance = numerics.positive("luminance_cd_m2", luminance_cd_m2, unit="cd/m²")
    foot_lamberts = np.log10(luminance / _CD_M2_OF_FOOT_LAMBERT)
    pupil = float(np.clip(-9.011 + 13.23 * np.exp(-foot_lamberts / 21.082), 2.0, 8.0))
    f0 = np.exp(3.663 - 0.0216 * pupil**2 * np.log(pupil))
    i0 = (0.7155 + 0.277 / np.sqrt(pupil)) ** 2
    with np.errstate(under="ignore", over="ignore"):
        optics = (43.69 * places / f0) ** i0
        return np.asarray(np.exp(-optics - 0.375 * places**1.21 - 0.4441 * places**2), np.float64)


def perceived_share(
    *,
    frequency: ArrayLike,
    across_cyc_per_mrad: float,
    along_cyc_per_mrad: float,
    magnification: float,
    luminance_cd_m2: float,
    spectrum: ArrayLike | None = None,
) -> Vector:
    """Share of a noise's variance that hides a sine across, of each frequency.

    Parameters
    ----------
    frequency
        Of the sines, cycles/mrad in the scene, above zero, shape (n,).
    across_cyc_per_mrad, along_cyc_per_mrad
        Frequencies up to which the spectrum goes, above zero.
    magnification
        Angle on the display over angle in the scene, above zero.
    spectrum
        Power of the noise in equal cells from 0 to these, shape (along, across); white if not
        given.

    Returns
    -------
    ndarray
        ∬ S(ξ′, η)·B²(ξ′/ξ)·E²(ξ′/M)·E²(η/M) dξ′ dη over ∬ S dξ′ dη, with the channel of vision
        B(r) = exp(−2.2·ln² r) and the eyeball's MTF E; the display is perfect. Within 1e-5: E has a
        cusp at zero.

    Source: Vollmerhausen and Jacobs 2004, report AMSEL-NV-TR-230: the noise integrals Q_H and Q_V.
    The numbers of the equations could not be checked.
    """
    places = numerics.all_above_zero("frequency", frequency, unit="cyc/mrad")
    magnified = numerics.positive("magnification", magnification)
    power = np.ones((1, 1)) if spectrum is None else numerics.all_from_zero("spectrum", spectrum)
    if power.ndim != 2:
        raise ParameterError("spectrum.shape", power.shape, "two-dimensional")
    if not power.sum() > 0.0:
        raise ParameterError("spectrum.sum()", float(power.sum()), "above 0")
    rows, columns = power.shape
    # A white spectrum is one cell: cut finely enough for the channel's logarithm.
    finer_x, finer_y = max(1, 256 // columns), max(1, 64 // rows)
    power = np.repeat(np.repeat(power, finer_x, axis=1), finer_y, axis=0)
    x = _nodes(power.shape[1], numerics.positive("across_cyc_per_mrad", across_cyc_per_mrad))
    y = _nodes(power.shape[0], numerics.positive("along_cyc_per_mrad", along_cyc_per_mrad))
    weights = numerics.gauss_legendre(_NODES)[1] / 2.0

    def eye(points: Vector) -> Vector:
        return eyeball_mtf(
            frequency_cyc_per_mrad=points / magnified, luminance_cd_m2=luminance_cd_m2
        )

    across = (eye(y) ** 2 @ weights) @ power / power.sum()
    with np.errstate(under="ignore", over="ignore"):
        channel = np.exp(-2.0 * _CHANNEL * np.log(x / places[:, np.newaxis, np.newaxis]) ** 2)
    return np.asarray(((channel * eye(x) ** 2) @ weights) @ across, np.float64)


def _nodes(cells: int, highest: float) -> Vector:
    """Points of each of the equal cells from 0 to the highest frequency, shape (cells, nodes)."""
    nodes, _ = numerics.gauss_legendre(_NODES)
    width = highest / cells
    return np.asarray(width * (np.arange(cells)[:, np.newaxis] + (1.0 + nodes) / 2.0), np.float64)


# Minimum detectable temperature difference (MDTD) of a thermal imager against target size.
#
# The target is a square of side W and difference ΔT on a uniform background. The sensor blurs it;
# averaged over a window of side w at its middle, the share Ī of ΔT is left of it. It is detected
# when Ī·ΔT is SNR_th times the noise σ_p that is left after the eye has averaged over that window
# and over time:
#
#     MDTD(W) = SNR_th·σ_p(w)/Ī(W, w).

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
        Bandwidth of the noise, as for `spatial_share`.
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
        (along y, across x), as for `mrtd_flir92_K`. None: σ_tvh is white.

    Returns
    -------
    ndarray of float64, shape (n,)
        K; infinite where the blur leaves nothing of the target.

    Notes
    -----
    Ī is the product over both directions of W·∫ sinc(W·ξ)·sinc(w·ξ)·H(ξ) dξ, over negative
    frequencies too. σ_p² = E_x·E_y·(E_t·σ_tvh² + σ_vh²) + E_x·(E_t·σ_th² + σ_h²) +
    E_y·(E_t·σ_tv² + σ_v²), E_t = 1/(F_R·t_E), E_x and E_y of `spatial_share`; what a whole frame
    has in common (σ_t) does not hide a target. With a spectrum E_t·(σ_tvh² + σ_th² + σ_tv² +
    σ_t²)·`coloured_share` takes the place of all terms with E_t. MDTD falls as one over W, the root
    of the area, for targets larger than blur and samples, and as one over the area W² for targets
    smaller than both (`image`: smaller than the blur).

    Source: Ratches et al. 1975, ECOM-7043 (temporal noise, the target's window); Scott and
    D'Agostino 1992, Proc. SPIE 1689, 194 (noise in three dimensions). The equations' numbers could
    not be checked, nor which components FLIR92 takes into its MDTD; the form was derived anew.
    """
    size = numerics.all_above_zero("size_mrad", size_mrad, unit="mrad")
    at = numerics.rising("frequency", frequency, unit="cyc/mrad")
    longest = 0.5 / float(at[1])
    if size.size and size.max() > longest:
        allowed = f"at most {longest:g}, half the inverse of the frequency step"
        raise ParameterError("size_mrad", float(size.max()), allowed, unit="mrad")
    limit = math.inf
    if eye_limit_mrad is not None:
        limit = numerics.positive("eye_limit_mrad", eye_limit_mrad, unit="mrad")
    transfers = [
        numerics.along(at, name, numerics.all_finite(name, mtf))
        for name, mtf in (("mtf_x", mtf_x), ("mtf_y", mtf_y))
    ]
    *sides, intensity = _blurred(size, at, transfers, window, limit)
    bandwidths = noise_bandwidth_x_cyc_per_mrad, noise_bandwidth_y_cyc_per_mrad
    left = _variance_left(noise, sides, bandwidths, 1.0 / frame_count(frames), spectrum)
    seen = intensity > 0.0
    threshold = numerics.positive("snr_threshold", snr_threshold) * np.sqrt(left)
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
        square = numerics.sinc(length * at)
        sides, intensity = [], 1.0
        for amplitude, power in zip(amplitudes, powers, strict=True):
            side = length if window == "target" else _image_width(square, power)
            # Of a target of which nothing is left the image has no width; any will do.
            side = min(side, limit) if side < math.inf else length
            averaged = square if side == length else numerics.sinc(side * at)
            intensity *= length * float(np.dot(square * averaged, amplitude))
            sides.append(side)
        rows.append((*sides, intensity))
    across, along, intensities = np.array(rows, np.float64).reshape(-1, 3).T
    return across.reshape(size.shape), along.reshape(size.shape), intensities.reshape(size.shape)


def _image_width(square: Vector, power: Vector) -> float:
    """Width of the rectangle that has area and power of the blurred target's profile."""
    total = float(np.dot(np.square(square), power))
    return 1.0 / total if total else math.inf
