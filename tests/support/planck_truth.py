"""Planck's law integrated over a band by quadrature, 30 digits."""

import mpmath


def band_radiance(cut_on_um, cut_off_um, temperature_K):
    """W/m²/sr, over the logarithm of the wavelength."""
    with mpmath.workdps(30):
        h, c, k = mpmath.mpf("6.62607015e-34"), mpmath.mpf(299792458), mpmath.mpf("1.380649e-23")
        x_times_wavelength = h * c / (k * mpmath.mpf(temperature_K))
        ends = [mpmath.log(mpmath.mpf(um) / 10**6) for um in (cut_on_um, cut_off_um)]

        def spectral(u):
            x = x_times_wavelength / mpmath.exp(u)
            return 2 * h * c**2 * mpmath.exp(-4 * u) / mpmath.expm1(x)

        # The rule stops at an error of 1e-30, whatever the size of the integral.
        size = max(spectral(end) for end in ends)
        return float(size * mpmath.quad(lambda u: spectral(u) / size, mpmath.linspace(*ends, 15)))
