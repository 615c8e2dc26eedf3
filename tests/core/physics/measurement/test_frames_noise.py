"""Noise of frames of one scene whose random parts are known."""

import math

import numpy as np
import pytest

from core.errors import DataError
from core.physics.measurement.picture_noise import SceneFrames

ROWS, COLUMNS, GAIN, READ_E = 120, 160, 5.0, 30.0


def scene():
    """Texture everywhere, from dark to bright: one frame shows no noise of it."""
    random = np.random.default_rng(1)
    return np.linspace(500, 20_000, COLUMNS) * random.uniform(0.3, 1.0, (ROWS, COLUMNS))


def measured(frames=8, *, rows=0.0, flicker=0.0, moved=False, offset=0.0, scale=1.0):
    random = np.random.default_rng(2)
    taken = SceneFrames(ROWS, COLUMNS)
    electrons = scene()
    for frame in range(frames):
        light = np.roll(electrons, frame, axis=1) if moved else electrons
        numbers = random.poisson(light) + READ_E * random.standard_normal(light.shape)
        numbers = numbers / GAIN + offset + flicker * random.standard_normal()
        numbers += rows * random.standard_normal((ROWS, 1))
        taken.add(np.rint(numbers * scale))
    return taken.measured(offset=offset)


@pytest.mark.parametrize("frames", [2, 8])
def test_gain_and_read_noise_of_a_textured_scene(frames):
    noise = measured(frames, rows=3.0, flicker=10.0, offset=100.0)
    mean = scene().mean()
    truth = math.sqrt((mean + READ_E**2) / GAIN**2 + 1 / 12)
    assert noise.sigma == pytest.approx(truth, rel=0.02)
    assert noise.gain_e_per_dn == pytest.approx(GAIN, rel=0.05)
    assert abs(noise.gain_e_per_dn - GAIN) < 3 * noise.gain_error
    assert abs(noise.read_noise_dn - READ_E / GAIN) < 3 * noise.read_noise_error
    assert noise.components.frames == frames
    if frames > 2:
        assert noise.components.variances.sigma("tv") == pytest.approx(3.0, rel=0.1)


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
        noise = taken.measured()
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
        noise = taken.measured()
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
        in measured(moved=True).sigma_reason
    )
    assert measured(scale=0.002).sigma_reason == "rounding hides the noise"
    one = SceneFrames(ROWS, COLUMNS)
    one.add(scene())
    with pytest.raises(DataError, match="at least 2 frames"):
        one.measured()
    with pytest.raises(DataError, match="not finite"):
        one.add(np.full((ROWS, COLUMNS), math.nan))
