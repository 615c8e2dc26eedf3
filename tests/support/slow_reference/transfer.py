"""Transfer functions of the modules but for the pupil's, each a function of (xi, eta).

`p` are the module's parameters, all of them, and `context` what Init & Trans says. An empty number
is None or 0. A law is None where the module passes its input on.
"""

from decimal import Decimal

import numpy as np

from slow_reference.numbers import PI, like, sinc

PLATEAUS = {"low": 0.99, "moderate": 0.975, "high": 0.955}


def gaussian(sigma_x, sigma_y):
    def law(xi, eta):
        return np.exp(-2 * like(xi, PI) ** 2 * ((sigma_x * xi) ** 2 + (sigma_y * eta) ** 2))

    return law


def gaussian_mtf(p, context):
    return gaussian(p["sigma_x_mrad"], p["sigma_y_mrad"])


def jitter_mtf(p, context):
    return gaussian(p["sigma_mrad"], p["sigma_mrad"])


def box(width_x, width_y):
    return lambda xi, eta: sinc(like(xi, width_x) * xi) * sinc(like(eta, width_y) * eta)


def detector_mtf(p, context):
    def own(name):
        return p[name] or context[name]

    focal = own("focal_length_mm")
    return box(
        np.longdouble(own("detector_x_um")) / focal * own("fill_x"),
        np.longdouble(own("detector_y_um")) / focal * own("fill_y"),
    )


def blur(velocity, time, distance):
    """Milliradians moved: m/s · s / m · 1000."""
    return np.longdouble(velocity) * time / distance * 1000 if velocity and time else 0.0


def crosstrack_mtf(p, context):
    velocity = p["scan_velocity_mrad_per_s"] or context["scan_velocity_mrad_per_s"]
    return box(np.longdouble(velocity) * p["dwell_time_s"], 0.0)


def alongtrack_mtf(p, context):
    # An empty velocity is that of Init & Trans; a zero is empty.
    velocity = p["velocity_m_per_s"] or context["velocity_m_per_s"]
    distance = p["range_m"] or context["range_m"]
    return box(0.0, blur(velocity, p["integration_time_s"], distance))


def relative_motion_mtf(p, context):
    distance, time = p["range_m"] or context["range_m"], p["integration_time_s"]
    x, y = (
        blur(
            np.longdouble(p[f"platform_velocity_{axis}"]) - p[f"image_velocity_{axis}"],
            time,
            distance,
        )
        for axis in "xy"
    )
    if p["model"] == "line":
        return lambda xi, eta: sinc(like(xi, x) * xi + like(eta, y) * eta)
    return box(x, y)


def vibration_mtf(p, context):
    rate, time = p["frequency_Hz"] or 0, p["integration_time_s"] or 0
    periods = np.longdouble(rate) * time
    if abs(periods - np.rint(periods)) <= 1e-14 * periods:
        periods = None  # whole, or many

    def axis(amplitude, frequency):
        return vibration(2 * like(frequency, PI) * amplitude * frequency, periods)

    def law(xi, eta):
        return axis(p["amplitude_x_mrad"], xi) * axis(p["amplitude_y_mrad"], eta)

    return law


def vibration(size, periods):
    """Time average of exp(−i·size·sin θ): J0 for whole periods, else its modulus."""
    largest = float(np.abs(size).max())
    if periods is None:
        # The mean over a turn by equal steps: exact to rounding once they outnumber `size`.
        steps = int(largest + 30 * np.cbrt(largest)) + 60
        angle = 2 * like(size, PI) * np.arange(steps) / steps
        return np.cos(np.multiply.outer(size, np.sin(angle))).mean(axis=-1)
    whole = np.floor(periods)
    rest = periods - whole
    # Gauss's rule on short pieces of what is left of a period.
    pieces = 4 + int(largest * float(rest))
    nodes, weights = np.polynomial.legendre.leggauss(24)
    places = (np.arange(pieces)[:, np.newaxis] + (nodes + 1) / 2).ravel() / pieces
    moved = np.multiply.outer(size, np.sin(2 * PI * rest * places).astype(size.dtype))
    share = np.tile(weights, pieces) / (2 * pieces)
    real, imaginary = np.cos(moved) @ share, -np.sin(moved) @ share
    if whole:
        rest = like(size, rest / periods)
        real = (1 - rest) * vibration(size, None) + rest * real
        imaginary = rest * imaginary
    return np.hypot(real, imaginary)


def charge_transfer(p, context):
    """Transfers, loss and phase per transfer over frequency; efficiency is read as a decimal."""
    if p["nyquist"] == "image":
        distance = context["interval_x"]
    else:
        distance = np.longdouble(context["detector_x_um"]) / context["focal_length_mm"]
    lost = np.longdouble(str(1 - Decimal(repr(p["efficiency"]))))
    return p["detectors_per_line"], lost, lambda xi: 2 * like(xi, PI * distance) * xi


def one_transfer(lost, w):
    """ε/(1 − (1 − ε)·exp(−iw)), its modulus and angle."""
    real, imaginary = 1 - lost * np.cos(w), lost * np.sin(w)
    return (1 - lost) / np.hypot(real, imaginary), -np.arctan2(imaginary, real)


def charge_eff_mtf(p, context):
    count, lost, phase = charge_transfer(p, context)

    def law(xi, eta):
        w = phase(xi) + 0 * eta
        loss = like(w, lost)
        if p["model"] == "exact":
            modulus = one_transfer(loss, w)[0]
            # Without any efficiency all is left behind, but for what never varies.
            return np.where(w == 0, 1, modulus) ** count
        return np.exp(-count * loss * (1 - np.cos(w)))

    return law


def charge_eff_phase(p, context):
    count, lost, phase = charge_transfer(p, context)

    def law(xi, eta):
        w = phase(xi) + 0 * eta
        loss = like(w, lost)
        if p["model"] == "exact":
            angle = count * one_transfer(loss, w)[1]
        elif p["model"] == "leading":
            angle = -count * loss * np.sin(w)
        else:
            angle = -count * loss * (w - np.sin(w))
        return np.cos(angle) + 1j * np.sin(angle)

    return law


def atmosphere_mtf(p, context):
    turbulence, depth = p["turbulence"], optical_depth(p, context)
    cutoff = p["turbidity_cutoff_cyc_per_mrad"]

    def law(xi, eta):
        rho = np.hypot(xi, eta)
        aerosol = np.exp(-like(rho, depth) * np.minimum(rho / cutoff, 1) ** 2)
        if turbulence == "none":
            return aerosol
        if turbulence == "gaussian":
            sigma = p["fwhm_mrad"] / (2 * np.sqrt(2 * np.log(np.longdouble(2))))
            return aerosol * gaussian(like(rho, sigma), 0)(rho, 0 * rho)
        wavelength = p["wavelength_um"] or sum(context["band_um"]) / 2
        lag_mm = wavelength * rho
        tilt = 1
        if turbulence == "short_exposure":
            tilt = np.maximum(0, 1 - p["alpha"] * np.cbrt(lag_mm / p["aperture_mm"]))
        r0_mm = 1000 * (p["fried_r0_m"] or fried_r0_m(p, context, wavelength))
        third = np.cbrt(lag_mm / like(rho, r0_mm))
        return aerosol * np.exp(-3.44 * third**5 * tilt)

    return law


def optical_depth(p, context):
    if p["turbidity"] == "none":
        return 0.0
    if p["turbidity"] != "custom":
        return -np.log(np.longdouble(str(PLATEAUS[p["turbidity"]])))
    if p["scatter_depth"]:
        return p["scatter_depth"]
    path_km = np.longdouble(context["range_m"]) / 1000
    if p["view"] != "horizontal":
        height = p["scale_height_km"]
        path_km = height * (1 - np.exp(-path_km / height))
    return p["scattering_per_km"] * path_km


def fried_r0_m(p, context, wavelength_um):
    """(0.423·k²·∫Cn²(z)·(z/L)^(5/3) dz)^(−3/5), z from the target to the sensor.

    Cn² the same all along, or Hufnagel and Valley's at 21 m/s above the one on the ground.
    """
    length = np.longdouble(context["range_m"])
    # Steps that grow from either end: the trapezoidal rule in t with z = L/(1 + exp(−π·sinh t)).
    t = np.arange(-400, 401).astype(np.longdouble) / 100
    z = length / (1 + np.exp(-PI * np.sinh(t)))
    step = PI * np.cosh(t) * z * (1 - z / length) / 100
    cn2 = p["cn2"] + 0 * z
    if p["view"] != "horizontal":
        h = length - z if p["view"] == "up" else z
        high = 0.00594 * (np.longdouble(21) / 27) ** 2 * (h / 1e5) ** 10 * np.exp(-h / 1000)
        cn2 = high + 2.7e-16 * np.exp(-h / 1500) + p["cn2"] * np.exp(-h / 100)
    k = 2 * PI / (np.longdouble(wavelength_um) / 1000000)
    moment = np.sum(cn2 * (z / length) ** (np.longdouble(5) / 3) * step)
    return (np.longdouble("0.423") * k**2 * moment) ** (-np.longdouble(3) / 5)


MAGNITUDE = {
    "atmosphere_mtf": atmosphere_mtf, "gaussian_mtf": gaussian_mtf,
    "crosstrack_mtf": crosstrack_mtf, "alongtrack_mtf": alongtrack_mtf,
    "relative_motion_mtf": relative_motion_mtf, "jitter_mtf": jitter_mtf,
    "vibration_mtf": vibration_mtf, "detector_mtf": detector_mtf,
    "charge_eff_mtf": charge_eff_mtf,
}  # fmt: skip
PHASE = {"charge_eff_phase": charge_eff_phase}
