"""Further frames: temporal noise of their own, the sensor's patterns and all else the same."""

import numpy as np
import pytest

from core.chain.random_fields import at_frame
from noisy_sensors import noisy_sensor, picture_of

ALL = ("photons", "gain", "bias", "detector", "amplifier", "quantization", "periodic")


def frames(tmp_path, *kinds, count=2, **settings):
    engine, network = noisy_sensor(tmp_path, *kinds, **settings)
    image, work = picture_of(engine, network, tmp_path, seed=7)
    return image, work, [work.value(at_frame(image.recipe, n)) for n in range(count)]


@pytest.mark.parametrize("kind", ["photons", "published photons", "detector", "amplifier"])
def test_temporal_noise_is_drawn_anew(tmp_path, kind):
    _, _, (first, second, third) = frames(tmp_path, kind, count=3, resize=False)
    size = first.size
    a, b = second - first, third - second
    assert np.all(np.abs([a.mean(), b.mean()]) < 0.2)
    assert (a != 0).mean() > 0.99
    # Independent frames: neighbouring differences share one of three, so their correlation is −½.
    correlation = np.corrcoef(a.ravel(), b.ravel())[0, 1]
    assert correlation == pytest.approx(-0.5, abs=6 / np.sqrt(size))


def test_a_frame_repeats_to_the_bit_and_computes_no_more_than_noise(tmp_path):
    image, work, _ = frames(tmp_path, *ALL)
    computed = set(work.log.computed)
    again = work.value(at_frame(image.recipe, 5))
    new = [
        work.log.requested[key] for key in work.log.computed - computed if key in work.log.requested
    ]
    assert not [r for r in new if r.node in ("scene", "pupil")]
    fresh, other = picture_of(*noisy_sensor(tmp_path, *ALL), tmp_path, seed=7)
    assert np.array_equal(other.value(at_frame(fresh.recipe, 5)), again)


def test_a_typed_seed_has_frames_too(tmp_path):
    engine, network = noisy_sensor(tmp_path, "amplifier")
    network = network.with_parameter("electronics", "seed_mode", "typed")
    image, work = picture_of(engine, network, tmp_path, seed=7)
    assert not np.array_equal(work.value(image.recipe), work.value(at_frame(image.recipe, 1)))
