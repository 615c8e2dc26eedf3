"""Noise of single pictures whose random parts are known."""

import io
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import special

from camera_scenes import box, turned
from core.errors import DataError
from core.physics.measurement.flat_blocks import variance_line
from core.physics.measurement.picture_noise import (
    SceneFrames,
    _common_variance,
    noise_of_picture,
)
from oversampled_camera import Camera, digitized, sampled, true_sigma
from oversampled_scene import Scene, Shape, render

LEVELS = (4000, 200, 12_000, 1000, 25_000, 7000, 18_000, 600)
CAMERA = Camera(gaussian=(0.5, 0.5), read_e=12.0, gain_e_per_dn=4.0, bits=14)
NOISY = replace(CAMERA, read_e=40.0)


def polygons(rows, columns, levels, seed=3):
    """Electrons of overlapping turned rectangles behind the camera's blur."""
    random, shapes = np.random.default_rng(seed), []
    for level in levels[1:]:
        angle, place = random.uniform(0, 180), random.uniform(0, 1, 2) * (columns, rows)
        size = random.uniform(0.3, 0.7, 2) * min(rows, columns)
        shapes.append(Shape(turned(box(*size), angle, place), level))
    scene = Scene(background=levels[0], shapes=tuple(shapes))
    return sampled(render(scene, rows, columns, fine=4, margin=8), CAMERA)


@pytest.fixture(scope="module")
def scene():
    return polygons(240, 320, LEVELS)


def test_sigma_gain_and_read_noise_of_polygons(scene):
    noise = noise_of_picture(picture=digitized(scene, NOISY, 1))
    truth = true_sigma(NOISY, scene.mean())
    assert noise.sigma == pytest.approx(truth, rel=0.03)
    assert abs(noise.sigma - truth) < 3 * noise.sigma_error
    assert noise.gain_e_per_dn == pytest.approx(4.0, rel=0.05)
    assert abs(noise.gain_e_per_dn - 4.0) < 3 * noise.gain_error
    assert abs(noise.read_noise_dn - 10.0) < 3 * noise.read_noise_error
    assert noise.step == 1.0
    expected = [true_sigma(NOISY, 4.0 * part.level) ** 2 for part in noise.levels]
    pulls = [
        (part.variance - truth) / part.variance_error
        for part, truth in zip(noise.levels, expected, strict=True)
    ]
    assert len(pulls) > 4
    assert np.abs(pulls).max() < 4


def test_rows_and_columns(scene):
    camera = replace(CAMERA, row_dn=6.0, column_dn=3.0, bits=None)
    noise = noise_of_picture(picture=digitized(scene, camera, 2))
    assert noise.sigma == pytest.approx(true_sigma(camera, scene.mean()), rel=0.03)
    for part, truth in ((noise.rows, 36.0), (noise.columns, 9.0)):
        assert part.significant
        assert abs(part.variance - truth) < 3 * part.variance_error
    without = noise_of_picture(picture=digitized(scene, CAMERA, 2))
    assert not without.rows.significant
    assert not without.columns.significant


@pytest.mark.parametrize("wave", [(0.35, -0.27), (0.43, 0.36), (0.2131, 0.1)])
def test_a_wave_all_over_the_picture(scene, wave):
    """A strong one leaves no noise to measure; a weak one does not change it."""
    strong = replace(NOISY, periodic=(20.0, *wave))
    noise = noise_of_picture(picture=digitized(scene, strong, 12))
    assert noise.sigma is None
    assert "frequencies" in noise.sigma_reason
    weak = replace(NOISY, periodic=(2.0, *wave))
    noise = noise_of_picture(picture=digitized(scene, weak, 12))
    assert noise.sigma == pytest.approx(true_sigma(weak, scene.mean()), rel=0.01)


def test_flat_areas_far_from_the_mean_level():
    random = np.random.default_rng(16)
    checks = np.sign(np.sin(np.arange(200)) * np.sin(np.arange(160))[:, None])
    picture = np.where(np.arange(200) < 80, 100.0, 4000.0 + 900.0 * checks)
    picture += 3 * random.standard_normal(picture.shape)
    noise = noise_of_picture(picture=picture)
    assert noise.sigma is None
    assert "the noise at the picture's mean level" in noise.sigma_reason


def test_one_level_has_no_gain():
    picture = 500 + 3 * np.random.default_rng(4).standard_normal((200, 240))
    noise = noise_of_picture(picture=picture)
    assert noise.sigma == pytest.approx(3.0, rel=0.03)
    assert noise.gain_e_per_dn is None
    assert "does not rise clearly with the level" in noise.gain_reason


def test_noise_hidden_by_rounding():
    picture = np.rint(100 + 0.2 * np.random.default_rng(5).standard_normal((200, 240)))
    noise = noise_of_picture(picture=picture)
    assert noise.sigma is None
    assert "smaller than the converter's step of 1" in noise.sigma_reason


def test_no_noise_and_no_flat_area():
    shading = np.add.outer(np.sqrt(np.arange(160.0)), 0.37 * np.arange(200.0))
    assert "no noise" in noise_of_picture(picture=shading).sigma_reason
    waves = np.cumsum(np.cumsum(np.random.default_rng(6).standard_normal((160, 200)), 0), 1)
    rough = noise_of_picture(picture=waves)
    assert rough.sigma is None
    assert "too few flat blocks of 8 × 8 samples" in rough.sigma_reason


def test_clipped_and_avoided_samples_do_not_count(scene):
    picture = digitized(scene, NOISY, 7).clip(0, 5000)
    picture[:40, :40] += 300 * np.random.default_rng(8).standard_normal((40, 40))
    avoid = np.zeros(picture.shape, bool)
    avoid[:40, :40] = True
    picture[3, 4] = math.nan
    noise = noise_of_picture(picture=picture, avoid=avoid)
    assert abs(noise.gain_e_per_dn - 4.0) < 3 * noise.gain_error
    assert max(part.level for part in noise.levels) < 4700
    picture[3, 4] = 0.0
    nothing = noise_of_picture(picture=picture, avoid=np.ones(picture.shape, bool))
    assert nothing.sigma_reason == "no samples are left to measure"


def smeared(picture, axis):
    """Mean of a sample and the one before along an axis: noise that was blurred later."""
    return 0.6 * picture + 0.4 * np.roll(picture, 1, axis)


def test_noise_blurred_after_it_arose(scene):
    picture = digitized(scene, replace(CAMERA, bits=None), 9)
    along_rows = noise_of_picture(picture=smeared(picture, 1))
    assert along_rows.sigma is None
    both = noise_of_picture(picture=smeared(smeared(picture, 0), 1))
    assert both.sigma is None
    doubled = picture.copy()
    doubled[1::2] = doubled[::2]
    assert noise_of_picture(picture=doubled).sigma is None
    for noise in (along_rows, both, noise_of_picture(picture=doubled)):
        assert "blurred" in noise.sigma_reason or "texture" in noise.sigma_reason


def test_noise_sharpened_after_it_arose(scene):
    picture = digitized(scene, replace(CAMERA, bits=None), 9)
    around = sum(np.roll(picture, step, axis) for step in (-1, 1) for axis in (0, 1))
    noise = noise_of_picture(picture=1.8 * picture - 0.2 * around)
    assert noise.sigma is None
    assert "rises towards high frequencies" in noise.sigma_reason


@pytest.mark.parametrize("cut", [(0, 0), (3, 5), (0, 6)])
def test_compressed_by_jpeg(scene, cut):
    image = pytest.importorskip("PIL.Image")
    picture = digitized(scene, replace(CAMERA, gain_e_per_dn=120.0, read_e=300.0), 14).clip(0, 255)
    for quality, known in ((90, False), (60, False), (None, True)):
        numbers = picture
        if quality is not None:
            file = io.BytesIO()
            image.fromarray(picture.astype(np.uint8)).save(file, "jpeg", quality=quality)
            numbers = np.asarray(image.open(file), float)
        noise = noise_of_picture(picture=numbers[cut[0] :, cut[1] :])
        assert (noise.sigma is not None) is known
        assert known or "compressed in blocks" in noise.sigma_reason


def test_texture_is_no_noise():
    random = np.random.default_rng(10)
    rows, columns = 240, 320
    y, x = np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(columns)
    radius = np.hypot(x, y)
    radius[0, 0] = np.inf
    # 1/f² power behind optics and pixel that leave next to nothing at Nyquist's corner.
    fall = np.exp(-8 * radius**2) / radius
    texture = np.fft.irfft2(fall * np.fft.rfft2(random.standard_normal((rows, columns))))
    texture /= texture.std()
    noise = random.standard_normal((rows, columns))
    for amplitude in (1.0, 5.0):
        measured = noise_of_picture(picture=200 + amplitude * texture + 3 * noise)
        assert measured.sigma == pytest.approx(3.0, rel=0.03)
        assert abs(measured.sigma - 3.0) < 3 * measured.sigma_error
    assert noise_of_picture(picture=200 + 20 * texture + 3 * noise).sigma is None


def test_noise_that_differs_from_place_to_place():
    random = np.random.default_rng(11)
    place = np.where(np.arange(320) < 160, 2.0, 5.0)
    noise = noise_of_picture(picture=300 + place * random.standard_normal((240, 320)))
    assert noise.sigma == pytest.approx(math.sqrt((4 + 25) / 2), rel=0.03)
    assert "varies across the picture" in noise.remarks[0]
    assert noise.gain_e_per_dn is None


def test_refusals():
    with pytest.raises(DataError, match="at least 8 × 8 samples, not 7 × 90"):
        noise_of_picture(picture=np.zeros((7, 90)))
    picture = np.zeros((50, 50))
    picture[3, 4] = math.nan
    with pytest.raises(DataError, match="not finite"):
        noise_of_picture(picture=picture)
    for factor in (1e200, 1e-200):
        with pytest.raises(DataError, match=r"between 1e-12 and 1e\+15"):
            noise_of_picture(picture=factor * (2.0 + np.eye(50)))


def test_noise_far_below_the_level():
    picture = 1e8 + np.random.default_rng(15).standard_normal((160, 200))
    assert noise_of_picture(picture=picture).sigma == pytest.approx(1.0, rel=0.03)
    assert "no noise" in noise_of_picture(picture=np.zeros((160, 200))).sigma_reason


def test_a_slope_is_no_steeper_than_light_makes_it():
    level, variance = np.repeat([100.0, 200.0], [400, 2]), np.repeat([4.0, 40.0], [400, 2])
    variance *= np.random.default_rng(17).chisquare(16, 402) / 16
    line = variance_line(level=level, variance=variance)
    assert line.slope > 0.2
    assert line.bounded(0.0).slope == pytest.approx(4.0 / 100.0, rel=0.1)


# Noise of frames of one scene whose random parts are known.

ROWS, COLUMNS, GAIN, READ_E = 120, 160, 5.0, 30.0


def scene_of_frames_noise():
    """Texture everywhere, from dark to bright: one frame shows no noise of it."""
    random = np.random.default_rng(1)
    return np.linspace(500, 20_000, COLUMNS) * random.uniform(0.3, 1.0, (ROWS, COLUMNS))


def measured(frames=8, *, rows=0.0, flicker=0.0, moved=False, offset=0.0, scale=1.0):
    random = np.random.default_rng(2)
    taken = SceneFrames(ROWS, COLUMNS)
    electrons = scene_of_frames_noise()
    for frame in range(frames):
        light = np.roll(electrons, frame, axis=1) if moved else electrons
        numbers = random.poisson(light) + READ_E * random.standard_normal(light.shape)
        numbers = numbers / GAIN + offset + flicker * random.standard_normal()
        numbers += rows * random.standard_normal((ROWS, 1))
        taken.add(np.rint(numbers * scale))
    return taken.measured(offset=offset)


@pytest.mark.parametrize("frames", [2, 8])
def test_gain_and_read_noise_of_a_textured_scene(frames):
    noise, components = measured(frames, rows=3.0, flicker=10.0, offset=100.0)
    mean = scene_of_frames_noise().mean()
    truth = math.sqrt((mean + READ_E**2) / GAIN**2 + 1 / 12)
    assert noise.sigma == pytest.approx(truth, rel=0.02)
    assert noise.gain_e_per_dn == pytest.approx(GAIN, rel=0.05)
    assert abs(noise.gain_e_per_dn - GAIN) < 3 * noise.gain_error
    assert abs(noise.read_noise_dn - READ_E / GAIN) < 3 * noise.read_noise_error
    assert components.frames == frames
    if frames > 2:
        assert components.variances.sigma("tv") == pytest.approx(3.0, rel=0.1)


def test_bright_parts_leave_dark_ones_beside_them_alone():
    """A bright square fills half of its rows: their means took 1.7 DN² of 85 into the dark beside.

    In the mean of 20 stacks gain and read noise are known to 0.2 of their errors: five times that.
    """
    random = np.random.default_rng(8)
    electrons = np.full((96, 96), 500.0)
    electrons[24:72, 24:72] = 20_000.0
    gains, reads = [], []
    for _ in range(20):
        taken = SceneFrames(96, 96)
        for _ in range(40):
            numbers = random.poisson(electrons) + 70.0 * random.standard_normal(electrons.shape)
            taken.add(np.rint(numbers / 8.0 + random.standard_normal((96, 1))))
        noise, _ = taken.measured()
        gains.append((noise.gain_e_per_dn - 8.0) / noise.gain_error)
        reads.append((noise.read_noise_dn - 70.0 / 8.0) / noise.read_noise_error)
    assert abs(np.mean(gains)) < 1.0
    assert abs(np.mean(reads)) < 1.0


def test_what_passes_through_the_scene_counts_for_nothing_beside_it():
    """A car of ten times the road's brightness; σ is that of the mean level, car included."""
    sigmas, gains = [], []
    for seed in range(8):
        random = np.random.default_rng(seed)
        road = np.full((96, 160), 3000.0)
        road[:, 100:] = 9000.0
        taken, mean = SceneFrames(96, 160), 0.0
        for frame in range(24):
            light = road.copy()
            light[30:60, 10 + 2 * frame : 20 + 2 * frame] = 30_000.0
            mean += light.mean() / 24
            numbers = random.poisson(light) + 50.0 * random.standard_normal(light.shape)
            taken.add(np.rint(numbers / 8.0 + random.standard_normal((96, 1))))
        noise, _ = taken.measured()
        truth = math.sqrt((mean + 50.0**2) / 64 + 1 / 12)
        sigmas.append((noise.sigma - truth) / noise.sigma_error)
        gains.append((noise.gain_e_per_dn - 8.0) / noise.gain_error)
        assert noise.sigma == pytest.approx(truth, rel=0.01)
    assert np.abs(sigmas).max() < 4.0
    assert np.abs(gains).max() < 4.0
    assert abs(np.mean(gains)) < 1.2


def test_what_frames_do_not_show():
    assert (
        "pixels change between the frames: the scene or the camera moved"
        in measured(moved=True)[0].sigma_reason
    )
    assert measured(scale=0.002)[0].sigma_reason == "rounding hides the noise"
    one = SceneFrames(ROWS, COLUMNS)
    one.add(scene_of_frames_noise())
    with pytest.raises(DataError, match="at least 2 frames"):
        one.measured()
    with pytest.raises(DataError, match="not finite"):
        one.add(np.full((ROWS, COLUMNS), math.nan))


# Errors of the noise from one picture, against what many pictures scatter by.


def pulls_of(pictures, truth):
    """Departures of sigma from the truth over its errors."""
    noises = [noise_of_picture(picture=picture) for picture in pictures]
    return np.array([(noise.sigma - truth) / noise.sigma_error for noise in noises])


@pytest.mark.parametrize("levels", [(4000, 1000, 9000, 2500)])
def test_sigma_has_no_bias_and_errors_that_hold(levels):
    scene = polygons(136, 176, levels)
    pictures = (digitized(scene, NOISY, seed) for seed in range(40))
    pulls = pulls_of(pictures, true_sigma(NOISY, scene.mean()))
    # Standard errors of the mean and of the root mean square are 0.16 and 0.11.
    assert abs(pulls.mean()) < 0.4
    assert 0.7 < math.sqrt((pulls**2).mean()) < 1.3


def variance_of_rounded(level, sigma):
    """Variance of a normal deviate rounded to whole numbers, by a sum over them."""
    whole = np.arange(math.floor(level - 12), math.ceil(level + 12))
    ends = special.ndtr((np.append(whole, whole[-1] + 1) - 0.5 - level) / sigma)
    share = np.diff(ends)
    mean = share @ whole
    return share @ (whole - mean) ** 2


@pytest.mark.parametrize("sigma", [0.5, 0.6])
def test_error_by_rounding_beyond_a_twelfth(sigma):
    phases = np.arange(50) / 50
    beyond = [variance_of_rounded(10 + phase, sigma) - sigma**2 - 1 / 12 for phase in phases]
    expected = math.sqrt(np.mean(np.square(beyond)))
    level = np.repeat([10.0, 30.0], 50)
    variance = np.full(100, sigma**2 + 1 / 12)
    line = variance_line(level=level, variance=variance).rounded(level=level, step=1.0)
    assert line.middle_error == pytest.approx(expected, rel=0.05)
    assert line.slope_error == pytest.approx(expected / 10.0, rel=0.05)
    twice = variance_line(level=2 * level, variance=4 * variance)
    assert twice.rounded(level=2 * level, step=2.0).middle_error == pytest.approx(
        4 * expected, rel=0.05
    )


def test_what_is_not_known_well_is_withheld_with_its_value():
    few = polygons(64, 72, (4000, 8000))
    noise = noise_of_picture(picture=digitized(few, NOISY, 1))
    assert noise.sigma is None
    assert "at 95 % confidence; allowed uncertainty: at most 3 %" in noise.sigma_reason
    more = polygons(240, 320, (4000, 6000))
    noise = noise_of_picture(picture=digitized(more, NOISY, 1))
    assert noise.sigma is not None
    assert noise.gain_e_per_dn is None
    assert "at 99 % confidence; allowed: at most 5 %" in noise.gain_reason


@pytest.mark.parametrize("own", [0.0, 0.5, 4.0, 100.0])
@pytest.mark.parametrize("outliers", [0, 60, 300])
def test_a_variance_common_to_lines_is_found_beyond_chance_and_despite_outliers(own, outliers):
    """Squares of evenly spread normal deviates, and of edges that are no noise."""
    many = 1000 + outliers
    deviate = special.ndtri((np.random.default_rng(1).permutation(many) + 0.5) / many)
    chance = np.linspace(1.0, 3.0, many)
    square = (own + chance) * deviate**2
    square[:outliers] = 1e4 * (own + 3.0)
    found, error = _common_variance(square, chance)
    expected = math.sqrt(2.0 / np.sum(1.0 / (own + chance) ** 2))
    assert found == pytest.approx(own, abs=2.0 * expected)
    assert error == pytest.approx(expected, rel=0.2)
