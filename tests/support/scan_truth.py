"""A wide line scanner on tiny frames: stages, their laws, and columns summed up one by one."""

import cmath
import math

import numpy as np

ACROSS, ALONG = 90.0, 70.0  # mrad from sample to sample: a few of them are a wide field
SIGMA_X, SIGMA_Y = 55.0, 80.0
PITCH_X, PITCH_Y, FOCAL = 100.0, 120.0, 1.0
TRANSFERS, EFFICIENCY = 3, 0.8
VELOCITY_X, VELOCITY_Y, RANGE_M, TIME = 30.0, 50.0, 100.0, 0.2
CUTOFF = 0.009  # cycles/mrad of the round aperture, beyond Nyquist at nadir
INIT = {
    "detector_x_um": PITCH_X, "detector_y_um": PITCH_Y, "focal_length_mm": FOCAL,
    "range_m": RANGE_M,
}  # fmt: skip
APERTURE_CM = CUTOFF * 10 / 10  # cutoff × 10 µm in mm, in cm
OPTICS = {
    "cut_on_um": 10, "cut_off_um": 10, "size_x_cm": 2 * APERTURE_CM, "size_y_cm": 2 * APERTURE_CM,
}  # fmt: skip
# At the detector's own frequencies: an angle that is the same in every column.
CHARGE = {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY, "nyquist": "detector"}
STAGES = {
    "blur": ("gaussian_mtf", {"sigma_x_mrad": SIGMA_X, "sigma_y_mrad": SIGMA_Y}),
    "pixel": ("detector_mtf", {}),
    "left": ("charge_eff_mtf", CHARGE),
    "late": ("charge_eff_phase", CHARGE),
    "smear": ("relative_motion_mtf", {
        "image_velocity_x": VELOCITY_X, "platform_velocity_y": VELOCITY_Y, "model": "line",
        "integration_time_s": TIME,
    }),
    "optics": ("exit_pupil_mtf", OPTICS),
    "coma": ("exit_pupil_mtf", OPTICS),
}  # fmt: skip
_PUPIL = {"size_x": 64, "size_y": 64, "radius": 16}
PUPILS = {"optics": _PUPIL, "coma": {**_PUPIL, "zernike_waves": [0, 0, 0, 0.1, 0, 0, 0.2, 0.15]}}


def _sinc(x):
    return 1.0 if x == 0 else math.sin(math.pi * x) / (math.pi * x)


def _round(v):
    v = min(v, 1.0)
    return 2 / math.pi * (math.acos(v) - v * math.sqrt(1 - v * v))


def _charge(xi):
    w = 2 * math.pi * xi * PITCH_X / FOCAL
    return (EFFICIENCY / (1 - (1 - EFFICIENCY) * cmath.exp(-1j * w))) ** TRANSFERS


SMEAR_X = -VELOCITY_X * TIME / RANGE_M * 1000  # platform less image
SMEAR_Y = VELOCITY_Y * TIME / RANGE_M * 1000
ANALYTIC = {
    "blur": lambda xi, eta: math.exp(
        -2 * math.pi**2 * ((SIGMA_X * xi) ** 2 + (SIGMA_Y * eta) ** 2)
    ),
    "pixel": lambda xi, eta: _sinc(PITCH_X / FOCAL * xi) * _sinc(PITCH_Y / FOCAL * eta),
    "left": lambda xi, _: abs(_charge(xi)),
    "late": lambda xi, _: _charge(xi) / abs(_charge(xi)),
    "smear": lambda xi, eta: _sinc(SMEAR_X * xi + SMEAR_Y * eta),
    "optics": lambda xi, eta: _round(math.hypot(xi, eta) / CUTOFF),
}


def column_by_column(picture, laws, edges, scan="x"):
    """Every column (row, for a scan along y) of the frame at its own interval in flight."""
    rows, columns = picture.shape
    found = np.zeros(picture.shape)
    for place in range(columns if scan == "x" else rows):
        middle = ((columns if scan == "x" else rows) - 1) / 2
        angle = (place - middle) * (ACROSS if scan == "x" else ALONG) / 1000
        nearer = 1 / math.hypot(1.0, math.tan(angle))  # altitude over range
        if scan == "x":
            steps = ACROSS, ALONG * nearer
            found[:, place] = _whole(picture, laws, edges, steps, columns=[place])[:, 0]
        else:
            steps = ACROSS * nearer, ALONG
            found[place] = _whole(picture, laws, edges, steps, rows=[place])[0]
    return found


def _whole(picture, laws, edges, steps, rows=None, columns=None):
    """Samples of the frame filtered at one pair of intervals, frequency by frequency."""
    frame = picture
    if edges == "reflect":
        frame = np.vstack([frame, frame[::-1]])
        frame = np.hstack([frame, frame[:, ::-1]])
    high, wide = frame.shape
    rows = range(picture.shape[0]) if rows is None else rows
    columns = range(picture.shape[1]) if columns is None else columns
    y, x = np.arange(high), np.arange(wide)
    total = np.zeros((len(rows), len(columns)), complex)
    for j in range(high):
        for k in range(wide):
            wave_y, wave_x = np.exp(-2j * np.pi * j * y / high), np.exp(-2j * np.pi * k * x / wide)
            amplitude = wave_y @ frame @ wave_x / frame.size
            response = _at(laws, j, k, high, wide, steps)
            back = np.outer(wave_y.conj()[list(rows)], wave_x.conj()[list(columns)])
            total += amplitude * response * back
    return total.real


def _at(laws, j, k, high, wide, steps):
    """H at index (j, k); where that is Nyquist, the mean over both of its signs."""
    etas, xis = (
        [index] if 2 * index < size else [index - size] if 2 * index > size else [index, -index]
        for index, size in ((j, high), (k, wide))
    )
    both = [
        math.prod([law(xi / (wide * steps[0]), eta / (high * steps[1])) for law in laws])
        for eta in etas for xi in xis
    ]  # fmt: skip
    return sum(both) / len(both)
