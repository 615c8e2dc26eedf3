"""What electronics do to a picture without drawing a random number, and patterns of noise."""

import numpy as np

from slow_reference.filtering import filtered_lines
from slow_reference.numbers import PI, like


def periodic_noise(p, rows, columns, interval_x, interval_y):
    """A·(1 + m·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ), x and y from the first sample.

    Also the radians it comes to by the end of the frame: their rounding is the pattern's error.
    """
    x = np.arange(columns) * interval_x
    y = (np.arange(rows) * interval_y)[:, np.newaxis]

    def wave(prefix):
        phase = like(x, p[f"{prefix}phase_deg"]) / 180
        return np.sin(like(x, PI) * (2 * (p[f"{prefix}xi"] * x + p[f"{prefix}eta"] * y) + phase))

    turns = max(
        abs(p[f"{prefix}xi"]) * columns * interval_x + abs(p[f"{prefix}eta"]) * rows * interval_y
        for prefix in ("modulation_", "")
    )
    pattern = p["amplitude"] * (1 + p["modulation"] * wave("modulation_")) * wave("")
    return pattern, 2 * float(PI * turns)


def scan_velocity(p, context):
    if p["scan_mirror_rate_Hz"]:
        return 2000 * PI * p["scan_mirror_rate_Hz"]
    return np.longdouble(context["scan_velocity_mrad_per_s"])


def read_out(p, context, samples, interval_x, scale):
    """Gain as printed in eq. 4.59, pre-amplifier, post filter; and how much they may amplify.

    Random gains are 0 here, and so are the noises: `d_star` must be large, the SNR empty.
    """
    gain = 1.0
    if p["gain_model"] == "literal":
        g, b = (p[f"{name}_percent"] / 100 for name in ("gain", "bias"))
        mean = samples.mean()
        samples = samples * (g * mean) + b * mean
        # A mean of nothing is as uncertain as the samples that cancel in it.
        gain = g * scale + b
    if p["use_mtf"]:
        velocity = scan_velocity(p, context)
        tau = p["time_constant_s"] or context["interval_x"] / velocity
        samples = filtered_lines(samples, low_pass(tau * velocity), interval_x, context["edges"])
    if p["post_filter"] != "none":
        corner = p["post_corner_Hz"] / scan_velocity(p, context)
        law = post_filter(p, corner)
        samples = filtered_lines(samples, law, interval_x, context["edges"])
        gain *= p["post_gain"] if p["post_filter"] == "boost" else 1
    return samples, gain


def low_pass(lag_mrad):
    return lambda xi: 1 / (1 + 2j * like(xi, PI * lag_mrad) * xi)


def post_filter(p, corner):
    def law(xi):
        u = xi / like(xi, corner)
        if p["post_filter"] == "boost":
            share = np.minimum(np.abs(u), 1)
            return (1 + (p["post_gain"] - 1) * (1 - np.cos(like(xi, PI) * share)) / 2) + 0j
        pole = 1 / (1 + 1j * u) if p["post_filter"] == "lowpass" else 1j * u / (1 + 1j * u)
        return pole ** p["post_poles"]

    return law


def quantized(p, samples):
    """(nearest of the levels, distance to where the decision turns, distance of the levels)."""
    low, high = p["range_low"], p["range_high"]
    if not low and not high:
        low = high = None
    first = samples.min() if low is None else like(samples, low)
    last = samples.max() if high is None else like(samples, high)
    steps = like(samples, 2) ** p["bits"] - 1
    q = (last - first) / steps
    if q == 0:
        return samples, np.full(samples.shape, np.inf), q
    place = np.clip((samples - first) / q, 0, steps)
    level = np.floor(place + 0.5)
    return first + level * q, np.abs(0.5 - (place - np.floor(place))) * q, q
