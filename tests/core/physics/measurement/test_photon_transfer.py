"""Photon transfer of frames that numpy has drawn: gain, noise, full well and patterns known."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from core.errors import DataError
from core.physics.measurement.photon_transfer import FlatFrames, photon_transfer


@dataclass(frozen=True)
class Camera:
    """A camera by numpy alone: Poisson electrons, patterns, read noise, well, converter."""

    gain: float = 4.0
    read_e: float = 25.0
    well_e: float = 50_000.0
    offset: float = 200.0
    prnu: float = 0.01
    dsnu_e: float = 15.0
    bits: int = 16
    bad: float = 0.0
    flicker: float = 0.0
    shape: tuple[int, int] = (96, 128)

    def frames(self, electrons, count, seed):
        pattern = np.random.default_rng(99)
        factor = 1 + self.prnu * pattern.standard_normal(self.shape)
        dark = self.dsnu_e * pattern.standard_normal(self.shape)
        bad = pattern.random(self.shape) < self.bad
        random = np.random.default_rng(seed)
        for _ in range(count):
            lamp = electrons * (1 + self.flicker * random.standard_normal())
            n = random.poisson(lamp * factor) + dark
            n = np.minimum(n + self.read_e * random.standard_normal(self.shape), self.well_e)
            n = np.where(bad, np.where(factor > 1, self.well_e, 0.0), n)
            numbers = np.rint(n / self.gain + self.offset)
            yield np.clip(numbers, 0, 2**self.bits - 1).astype(np.uint16)


def field(camera, electrons, count=40, seed=1):
    return measured(camera.frames(electrons, count, seed), camera.shape)


def measured(frames, shape=None):
    taken = FlatFrames(*(shape or frames.shape[1:]))
    for frame in frames:
        taken.add(frame)
    return taken.measured()


LEVELS = (500, 2000, 5000, 10_000, 20_000, 30_000, 40_000, 49_000, 70_000)


def curve(camera, levels=LEVELS, *, dark=True, offset=None, count=40):
    fields = [field(camera, level, count, seed) for seed, level in enumerate(levels, start=5)]
    return photon_transfer(
        levels=fields, dark=field(camera, 0, count) if dark else None, offset_dn=offset
    )


CAMERAS = {
    "usual": Camera(),
    "fine": Camera(gain=0.25, read_e=1.5, well_e=12_000.0, dsnu_e=0.5, prnu=0.005),
    "coarse": Camera(gain=450.0, read_e=400.0, well_e=7e6, dsnu_e=300.0, bits=14, offset=20.0,
                     prnu=0.003),
    "with bad pixels": Camera(bad=0.004),
    "with a lamp that flickers": Camera(flicker=0.01),
    "without patterns": Camera(prnu=0.0, dsnu_e=0.0),
}  # fmt: skip


@pytest.mark.parametrize("name", CAMERAS)
def test_within_two_percent(name):
    camera = CAMERAS[name]
    scale = camera.well_e / 50_000
    made = curve(camera, [level * scale for level in LEVELS])
    assert made.gain_e_per_dn == pytest.approx(camera.gain, rel=0.02)
    assert abs(made.gain_e_per_dn - camera.gain) < 5 * made.gain_error
    assert made.full_well_e == pytest.approx(camera.well_e, rel=0.02)
    assert made.read_noise_e == pytest.approx(camera.read_e, rel=0.02)
    assert made.offset_dn == pytest.approx(camera.offset, abs=0.5)
    if camera.prnu:
        assert made.prnu_percent == pytest.approx(100 * camera.prnu, rel=0.05)
        assert made.dsnu_e == pytest.approx(camera.dsnu_e, rel=0.05)
    else:
        assert made.prnu_percent < 0.02


@pytest.mark.parametrize("dark", [True, False], ids=["dark frames", "offset"])
def test_the_standard_errors_are_the_spread_of_measurements_made_anew(dark):
    """Of 80 measurements the spread is known to 1/√160 = 8 %; three times that is allowed."""
    camera = Camera(read_e=60.0, prnu=0.0, dsnu_e=0.0, shape=(24, 32))
    made = []
    for anew in range(80):
        fields = [
            field(camera, level, 8, 1000 * anew + place)
            for place, level in enumerate((500, 2000, 5000, 10_000), start=1)
        ]
        zero = {"dark": field(camera, 0, 60, 1000 * anew), "offset_dn": None}
        made.append(
            photon_transfer(levels=fields, **(zero if dark else {"dark": None, "offset_dn": 200.0}))
        )
    for value, error in (("gain_e_per_dn", "gain_error"), ("read_noise_e", "read_noise_error")):
        spread = np.std([getattr(one, value) for one in made], ddof=1)
        stated = np.mean([getattr(one, error) for one in made])
        assert stated == pytest.approx(spread, rel=0.24), value


def test_read_noise_is_the_foot_of_the_line_where_only_the_offset_is_known():
    made = curve(Camera(read_e=60.0), dark=False, offset=200.0)
    assert made.read_noise_e == pytest.approx(60.0, rel=0.02)
    assert made.full_well_e == pytest.approx(50_000, rel=0.02)
    assert (made.dsnu_e, made.prnu_percent) == (None, None)


@pytest.mark.parametrize("offset", [40.0, 40.25, 40.5])
@pytest.mark.parametrize("noise", [0.5, 0.85, 5.0])
def test_temporal_noise_where_the_level_lies_between_two_whole_numbers(noise, offset):
    """Bennett's rounding, 1/12, holds within 3e-2 from 0.5 on; σ² is known to √(2/760,000)."""
    random = np.random.default_rng(11)
    taken = FlatFrames(200, 200)
    frames = [np.rint(offset + noise * random.standard_normal((200, 200))) for _ in range(20)]
    for frame in frames:
        taken.add(frame)
    pairs = [  # EMVA 1288: half the variance of the difference of two frames
        0.5 * np.var(first - second)
        for first, second in zip(frames[::2], frames[1::2], strict=True)
    ]
    measured = taken.measured()
    assert measured.temporal_dn2 == pytest.approx(float(np.mean(pairs)), rel=0.012)
    assert measured.temporal_dn2 == pytest.approx(noise**2 + 1 / 12, rel=0.03)


@pytest.mark.parametrize("apart", [1, 16])
def test_rounding_is_taken_off_by_the_converters_step(apart):
    """12 bits of 2.6 electrons stored as 16 bits: K/16, the same read noise of 2.3 electrons.

    Without its step, the rounding of 0.75 electrons would leave 2.42; σ is known to 0.15 %.
    """
    camera = Camera(gain=2.6, read_e=2.3, well_e=10_500.0, dsnu_e=0.5, prnu=0.004, bits=12)

    def stored(electrons, seed):
        taken = FlatFrames(*camera.shape)
        for frame in camera.frames(electrons, 40, seed):
            taken.add(frame.astype(np.int64) * apart)
        return taken.measured()

    dark, lit = stored(0, 3), [stored(level, level) for level in (200, 1000, 3000, 6000)]
    made = photon_transfer(levels=lit, dark=dark)
    assert dark.step_dn == apart
    assert made.gain_e_per_dn == pytest.approx(2.6 / apart, rel=0.01)
    assert made.read_noise_e == pytest.approx(2.3, rel=0.015)
    assert made.sensitivity_threshold_e == pytest.approx(
        np.sqrt(2.3**2 + 2.6**2 / 12) + 0.5, rel=0.015
    )


def test_dark_frames_that_end_at_zero_count_for_nothing():
    """Of read noise of 6 numbers about 2, half of what is below is cut off."""
    camera = Camera(offset=2.0)
    made = curve(camera)
    assert made.dark_cut_off
    assert made.gain_e_per_dn == pytest.approx(4.0, rel=0.02)
    assert (made.read_noise_e, made.offset_dn, made.full_well_e) == (None, None, None)
    assert curve(camera, offset=2.0).full_well_e == pytest.approx(50_000, rel=0.02)


def test_what_is_refused():
    with pytest.raises(DataError, match="2 frames or more, not 1"):
        field(Camera(), 100, count=1)
    with pytest.raises(DataError, match="2 or more different signal levels, or one level"):
        curve(Camera(), (5000,), dark=False)
    quiet = field(Camera(offset=10_000.0), 20_000)
    loud = field(Camera(read_e=5000.0, offset=10_000.0), 0)
    with pytest.raises(DataError, match="does not rise with the mean"):
        photon_transfer(levels=[quiet], dark=loud)
    taken = FlatFrames(4, 5)
    with pytest.raises(DataError, match="5 × 3 samples does not match the earlier frames, 5 × 4"):
        taken.add(np.zeros((3, 5)))
    levels = [field(Camera(), electrons) for electrons in (500, 5000)]
    with pytest.raises(DataError, match="dark frames' mean, 1450"):
        photon_transfer(levels=levels, dark=levels[1])
    huge = replace(levels[0], temporal_dn2=float("nan"))  # as of numbers about 1e308
    with pytest.raises(DataError, match="too large for their variance to be computed"):
        photon_transfer(levels=[levels[1], huge])
    still = [measured(np.full((4, 8, 8), number)) for number in (5.0, 9.0)]
    with pytest.raises(DataError, match="no level has noise"):
        photon_transfer(levels=still)


# Figures of EMVA 1288 of frames that numpy has drawn, beside the standard's own sums.

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


@pytest.fixture(scope="module")
def stacks():
    dark = stack(0.0, 40, 90)
    return dark, [stack(share * FULL_E, 12, number) for number, share in enumerate(SHARES)]


@pytest.fixture(scope="module")
def curve_of_emva_figures(stacks):
    dark, lit = stacks
    return photon_transfer(levels=[measured(frames) for frames in lit], dark=measured(dark))


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


def test_patterns_part_into_rows_columns_and_pixels(curve_of_emva_figures):
    """Shot noise of 12 frames leaves 0.02 % of PRNU in a row's mean: 1 % of the rows' 0.2 %."""
    emva = curve_of_emva_figures
    dsnu = (emva.dsnu_row_e, emva.dsnu_column_e, emva.dsnu_pixel_e)
    prnu = (emva.prnu_row_percent, emva.prnu_column_percent, emva.prnu_pixel_percent)
    assert dsnu == pytest.approx(expected(DSNU), rel=0.02)
    assert prnu == pytest.approx(expected(PRNU), rel=0.03)
    assert math.hypot(*dsnu) == pytest.approx(curve_of_emva_figures.dsnu_e, rel=1e-12)
    assert math.hypot(*prnu) == pytest.approx(curve_of_emva_figures.prnu_percent, rel=1e-12)


def test_the_split_is_that_of_the_standard(stacks):
    dark, _ = stacks
    made = measured(dark)
    own = (made.rows_dn2, made.columns_dn2, made.single_pixels_dn2)
    assert own == pytest.approx(split(dark), rel=0.012)  # n for n − 1, of 96 rows


def test_saturation_capacity_is_the_level_of_the_largest_variance(curve_of_emva_figures):
    """0.96 of the range: 21 deviations below its end, where the next level is cut off."""
    assert curve_of_emva_figures.saturation_capacity_e == pytest.approx(0.96 * FULL_E, rel=0.01)
    assert curve_of_emva_figures.snr_max == pytest.approx(math.sqrt(0.96 * FULL_E), rel=0.005)
    assert curve_of_emva_figures.full_well_e == pytest.approx(FULL_E, rel=0.01)
    assert curve_of_emva_figures.system_gain_dn_per_e == pytest.approx(1 / GAIN, rel=0.01)


def test_at_the_sensitivity_threshold_snr_is_one(curve_of_emva_figures):
    """µ/√(µ + σd² + K²/12) = 1 has µ = ½ + √(¼ + σd² + K²/12); the standard leaves out the ¼."""
    dark = READ_E**2 + GAIN**2 / 12
    exact = 0.5 + math.sqrt(0.25 + dark)
    left_out = 0.125 / math.sqrt(dark)
    threshold = curve_of_emva_figures.sensitivity_threshold_e
    assert exact - threshold == pytest.approx(left_out, abs=0.005 * exact)
    assert curve_of_emva_figures.dynamic_range == pytest.approx(
        curve_of_emva_figures.saturation_capacity_e / threshold
    )


def test_a_dark_that_rounding_hides_counts_as_the_standard_has_it():
    """Frames of one number in the dark: a variance of 0.24 DN² is put in its place."""
    dark = np.full((4, ROWS, COLUMNS), 7.0)
    lit = [np.random.default_rng(s).poisson(m, (4, ROWS, COLUMNS)) + 7.0 for s, m in
           enumerate((50, 200, 500))]  # fmt: skip
    found = photon_transfer(levels=[measured(frames) for frames in lit], dark=measured(dark))
    least = math.sqrt(0.24) * found.gain_e_per_dn + 0.5
    assert found.sensitivity_threshold_e == pytest.approx(least, rel=1e-12)
    assert found.saturation_capacity_e is None
    assert found.dynamic_range is None


def test_without_dark_frames_what_needs_none_is_there(stacks):
    _, lit = stacks
    found = photon_transfer(levels=[measured(frames) for frames in lit], offset_dn=OFFSET)
    assert found.snr_max is not None
    assert (found.sensitivity_threshold_e, found.dynamic_range) == (None, None)
    assert (found.dsnu_row_e, found.prnu_row_percent) == (None, None)
