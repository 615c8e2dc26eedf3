"""The OTF of an exit pupil over a band, as modulus and phase for the two wires."""

import numpy as np

from slow_reference.numbers import PI, like
from slow_reference.pupil_area import overlap
from slow_reference.pupil_samples import autocorrelation, between, transmission, with_wavefront

FINEST = 1024  # samples across up to which a geometric pupil is sampled twice as finely


def exit_pupil_mtf(p, context, pupil):
    """(law of the magnitude, law of the phase or None), or None where it multiplies nothing."""
    if p["interpolation"] == "none":
        return None
    otf, complex_valued = otf_of(p, context, pupil)
    if not complex_valued:
        return otf, None
    return lambda xi, eta: np.abs(otf(xi, eta)), lambda xi, eta: direction(otf(xi, eta))


def direction(values):
    """Complex numbers over their moduli; of a zero, 1."""
    size = np.abs(values)
    return np.where(size == 0, 1, values / np.where(size == 0, 1, size))


def otf_of(p, context, pupil):
    """The OTF as a function of (xi, eta), and whether it is complex."""
    wavelengths, weights = band(p, context)
    mean = sum(w * q for w, q in zip(wavelengths, weights, strict=True))
    columns, rows = pupil["size_x"], pupil["size_y"]
    pitch = np.longdouble(p["size_x_cm"]) * 10 / columns, np.longdouble(p["size_y_cm"]) * 10 / rows
    waves = any(pupil["zernike_waves"])
    geometric = pupil["samples"] is None
    exact = p["method"] == "exact" and geometric and not waves
    isotropic = 10 * p["size_x_cm"] / columns == 10 * p["size_y_cm"] / rows

    def over_band(single):
        def law(xi, eta):
            total = 0
            for wavelength, weight in zip(wavelengths, weights, strict=True):
                x, y = (
                    like(f, wavelength / one) * f for f, one in zip((xi, eta), pitch, strict=True)
                )
                total = total + like(xi, weight) * single(wavelength, x, y)
            return total

        return law

    if exact and not pupil["defocus_waves"]:
        return over_band(lambda _, x, y: geometric_otf(pupil, x, y)), False
    if exact and pupil["shape"] == "clear" and isotropic:
        return over_band(
            lambda wavelength, x, y: defocused_disc(
                np.hypot(x, y) / (2 * pupil["radius"]), pupil["defocus_waves"] * mean / wavelength
            )
        ), False
    fine = 2 if p["method"] == "exact" and geometric and max(rows, columns) <= FINEST else 1
    samples = pupil["samples"]
    if samples is None:
        samples = transmission(pupil, np.longdouble, fine)
    aberrated = bool(pupil["defocus_waves"]) or waves
    known = {}

    def sampled(wavelength, x, y):
        ratio = mean / wavelength if aberrated else 1
        if ratio not in known:
            lit = with_wavefront(pupil, samples, ratio, fine) if aberrated else samples
            known[ratio] = autocorrelation(lit)
        return between(known[ratio], fine * x, fine * y, p["interpolation"])

    return over_band(sampled), aberrated


def band(p, context):
    """Wavelengths and weights: the middle, or Gauss's over the band."""
    of_image = context["band_um"] or (None, None)
    on, off = p["cut_on_um"] or of_image[0], p["cut_off_um"] or of_image[1]
    if p["wavelengths"] == 1:
        return [(np.longdouble(on) + off) / 2], [1]
    nodes, weights = np.polynomial.legendre.leggauss(p["wavelengths"])
    middle, half = (np.longdouble(off) + on) / 2, (np.longdouble(off) - on) / 2
    return [middle + half * node for node in nodes], list(weights / 2)


def geometric_otf(pupil, lag_x, lag_y):
    """Shared area over the area; every shape looks the same in both mirrors, so does its OTF."""
    x, y = np.broadcast_arrays(np.abs(lag_x), np.abs(lag_y))
    if pupil["shape"] in ("clear", "cassegrain"):
        return annulus(pupil, np.hypot(x, y))
    # Lags that are there more than once are worked out once.
    (xs, column), (ys, row) = (np.unique(lag.ravel(), return_inverse=True) for lag in (x, y))
    pairs, place = np.unique(row * len(xs) + column, return_inverse=True)
    area = overlap(pupil, np.append(xs[pairs % len(xs)], 0), np.append(ys[pairs // len(xs)], 0))
    return (area[:-1] / area[-1])[place].reshape(x.shape)


def annulus(pupil, lag):
    """Overlap of two rings from those of discs with discs."""
    outer = pupil["radius"]
    inner = pupil["obscuration_radius"] if pupil["shape"] == "cassegrain" else 0
    total = lens(outer, outer, lag)
    if inner:
        total = total - 2 * lens(outer, inner, lag) + lens(inner, inner, lag)
    return total / (like(lag, PI) * (outer**2 - inner**2))


def lens(a, b, distance):
    """Area that discs of the radii a ≥ b share at a distance."""
    d = np.clip(distance, a - b, a + b)
    d = np.where(d == 0, 1, d)
    kite = np.sqrt(np.maximum((a + b - d) * (d + a - b) * (d - a + b) * (d + a + b), 0)) / 2
    one = a * a * np.arctan2(2 * kite, d * d + a * a - b * b)
    two = b * b * np.arctan2(2 * kite, d * d + b * b - a * a)
    return np.where(distance <= a - b, like(d, PI) * b * b, one + two - kite)


def defocused_disc(v, w20):
    """(4/π)·∫cos²φ·cos(8π·W20·v·(sin φ − v)) dφ from asin v to π/2 (Hopkins 1955)."""
    nodes, weights = np.polynomial.legendre.leggauss(160)
    v = np.minimum(v, 1)
    start = np.arcsin(v)
    half = (like(v, PI) / 2 - start)[..., np.newaxis] / 2
    phi = start[..., np.newaxis] + half * (1 + nodes)
    lever = np.sin(phi) - v[..., np.newaxis]
    wave = np.cos(8 * like(v, PI * w20) * v[..., np.newaxis] * lever)
    return 4 / like(v, PI) * np.sum(np.cos(phi) ** 2 * wave * half * weights, axis=-1)
