"""Figures of EMVA 1288 of frames that numpy has drawn, beside the standard's own sums."""

import math

import numpy as np
import pytest

from core.physics.measurement.photon_transfer import FlatFrames, photon_transfer

ROWS, COLUMNS = 96, 128
GAIN, READ_E, OFFSET, LAST_DN = 8.0, 6.8, 40.0, 4095
DSNU, PRNU = (4.0, 6.0, 12.0), (0.2, 0.4, 0.8)  # rows, columns, pixels; electrons and percent
SHARES = (0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.68, 0.8, 0.9, 0.96, 1.1)
FULL_E = GAIN * (LAST_DN - OFFSET)


def pattern(parts, seed):
    random = np.random.default_rng(seed)
    row, column, pixel = (
        random.standard_normal(size) for size in ((ROWS, 1), (1, COLUMNS), (ROWS, COLUMNS))
    )
    pixel -= pixel.mean(axis=0)
    pixel -= pixel.mean(axis=1, keepdims=True)
    alike = [(part - part.mean()) / part.std() for part in (row, column, pixel)]
    return sum(size * part for size, part in zip(parts, alike, strict=True))


def stack(electrons, count, seed):
    random = np.random.default_rng(seed)
    mean = np.broadcast_to(electrons * (1 + pattern(PRNU, 1) / 100), (count, ROWS, COLUMNS))
    signal = random.poisson(mean) + pattern(DSNU, 2) + READ_E * random.standard_normal(mean.shape)
    return np.rint(signal / GAIN + OFFSET).clip(0, LAST_DN)


def field(frames):
    taken = FlatFrames(ROWS, COLUMNS)
    for frame in frames:
        taken.add(frame)
    return taken.measured()


@pytest.fixture(scope="module")
def stacks():
    dark = stack(0.0, 40, 90)
    return dark, [stack(share * FULL_E, 12, number) for number, share in enumerate(SHARES)]


@pytest.fixture(scope="module")
def curve(stacks):
    dark, lit = stacks
    return photon_transfer(levels=[field(frames) for frames in lit], dark=field(dark))


def split(frames):
    """Variances of rows, columns and pixels by the equations of release 4, as they stand there."""
    count, m, n = frames.shape
    mean = frames.mean(axis=0)
    stacked = frames.var(axis=0, ddof=1).mean()
    whole = mean.var(ddof=1) - stacked / count
    of_columns = np.mean((mean.mean(axis=0) - mean.mean()) ** 2) - stacked / (count * m)
    of_rows = np.mean((mean.mean(axis=1) - mean.mean()) ** 2) - stacked / (count * n)
    least = m * n - m - n
    column = (m * n - m) / least * of_columns - n / least * (whole - of_rows)
    row = (m * n - n) / least * of_rows - m / least * (whole - of_columns)
    return row, column, m * n / least * (whole - of_columns - of_rows)


def expected(parts):
    """Of deviations that are exact, with means of 0: n for n − 1, and what white pixels would
    have left in the means of rows and columns is taken off, though these pixels left nothing."""
    row, column, pixel = parts
    single = pixel**2 * ROWS * COLUMNS / ((ROWS - 1) * (COLUMNS - 1))
    return (
        math.sqrt(row**2 * ROWS / (ROWS - 1) - single / COLUMNS),
        math.sqrt(column**2 * COLUMNS / (COLUMNS - 1) - single / ROWS),
        math.hypot(pixel, math.sqrt(single / COLUMNS), math.sqrt(single / ROWS)),
    )


def test_patterns_part_into_rows_columns_and_pixels(curve):
    """Shot noise of 12 frames leaves 0.02 % of PRNU in a row's mean: 1 % of the rows' 0.2 %."""
    emva = curve.emva
    dsnu = (emva.dsnu_row_e, emva.dsnu_column_e, emva.dsnu_pixel_e)
    prnu = (emva.prnu_row_percent, emva.prnu_column_percent, emva.prnu_pixel_percent)
    assert dsnu == pytest.approx(expected(DSNU), rel=0.02)
    assert prnu == pytest.approx(expected(PRNU), rel=0.03)
    assert math.hypot(*dsnu) == pytest.approx(curve.dsnu_e, rel=1e-12)
    assert math.hypot(*prnu) == pytest.approx(curve.prnu_percent, rel=1e-12)


def test_the_split_is_that_of_the_standard(stacks):
    dark, _ = stacks
    measured = field(dark)
    own = (measured.rows_dn2, measured.columns_dn2, measured.single_pixels_dn2)
    assert own == pytest.approx(split(dark), rel=0.012)  # n for n − 1, of 96 rows


def test_saturation_capacity_is_the_level_of_the_largest_variance(curve):
    """0.96 of the range: 21 deviations below its end, where the next level is cut off."""
    assert curve.emva.saturation_capacity_e == pytest.approx(0.96 * FULL_E, rel=0.01)
    assert curve.emva.snr_max == pytest.approx(math.sqrt(0.96 * FULL_E), rel=0.005)
    assert curve.full_well_e == pytest.approx(FULL_E, rel=0.01)
    assert curve.emva.system_gain_dn_per_e == pytest.approx(1 / GAIN, rel=0.01)


def test_at_the_sensitivity_threshold_snr_is_one(curve):
    """µ/√(µ + σd² + K²/12) = 1 has µ = ½ + √(¼ + σd² + K²/12); the standard leaves out the ¼."""
    dark = READ_E**2 + GAIN**2 / 12
    exact = 0.5 + math.sqrt(0.25 + dark)
    left_out = 0.125 / math.sqrt(dark)
    threshold = curve.emva.sensitivity_threshold_e
    assert exact - threshold == pytest.approx(left_out, abs=0.005 * exact)
    assert curve.emva.dynamic_range == pytest.approx(curve.emva.saturation_capacity_e / threshold)


def test_a_dark_that_rounding_hides_counts_as_the_standard_has_it():
    """Frames of one number in the dark: a variance of 0.24 DN² is put in its place."""
    dark = np.full((4, ROWS, COLUMNS), 7.0)
    lit = [np.random.default_rng(s).poisson(m, (4, ROWS, COLUMNS)) + 7.0 for s, m in
           enumerate((50, 200, 500))]  # fmt: skip
    found = photon_transfer(levels=[field(frames) for frames in lit], dark=field(dark))
    least = math.sqrt(0.24) * found.gain_e_per_dn + 0.5
    assert found.emva.sensitivity_threshold_e == pytest.approx(least, rel=1e-12)
    assert found.emva.saturation_capacity_e is None
    assert found.emva.dynamic_range is None


def test_without_dark_frames_what_needs_none_is_there(stacks):
    _, lit = stacks
    found = photon_transfer(levels=[field(frames) for frames in lit], offset_dn=OFFSET).emva
    assert found.snr_max is not None
    assert (found.sensitivity_threshold_e, found.dynamic_range) == (None, None)
    assert (found.dsnu_row_e, found.prnu_row_percent) == (None, None)
