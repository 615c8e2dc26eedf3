"""Noise predicted from the chain against the noise of 200 simulated frames."""

import numpy as np
import pytest

from core.chain.frame_sequence import at_frame
from core.physics.noise.noise_components import COMPONENTS, NoiseCube
from nodes.analysis.lineage import NoiseOf, noise_free
from noisy_sensors import SOURCES, noisy_sensor, picture_of

KINDS = ("photons", "published photons", *SOURCES, "periodic")
ALL = ("photons", "gain", "bias", "detector", "amplifier", "quantization", "periodic")
SENSORS, FRAMES = 20, 10
SETTINGS = {
    "staring": {"platform": "array"},
    "pushbroom": {"platform": "push", "edges": "periodic", "resize": False},
    "scanner": {"platform": "line", "factor": 5},
}


def simulated(folder, kinds, **settings):
    """Estimates of 20 sensors with 10 frames each, and the prediction for the last sensor."""
    engine, network = noisy_sensor(folder, *kinds, **settings)
    found = []
    for seed in range(SENSORS):
        image, work = picture_of(engine, network, folder, seed)
        clean = work.value(noise_free(image.recipe))
        cube = NoiseCube(*image.shape)
        for frame in range(FRAMES):
            cube.add(work.value(at_frame(image.recipe, frame)) - clean)
        variances = cube.measured().variances
        found.append([variances.variance(name) for name in COMPONENTS])
    total = work.value(NoiseOf(image)).total
    return np.array(found), np.array([total.variance(name) for name in COMPONENTS])


@pytest.mark.thorough(but=14)
@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("kinds", [*((kind,) for kind in KINDS), ALL], ids=[*KINDS, "all"])
def test_prediction_is_the_mean_of_estimates(tmp_path, setting, kinds):
    """Within four standard errors of 200 frames, which the sensors' own scatter tells.

    The samples, of 30, are rounded to 2^−48 in each step: below 1e−14 squared nothing is told.
    """
    found, predicted = simulated(tmp_path, kinds, **SETTINGS[setting])
    error = found.std(axis=0, ddof=1) / np.sqrt(SENSORS)
    largest = predicted.max()
    off = np.abs(found.mean(axis=0) - predicted)
    assert np.all(off < 4.0 * error + 1e-9 * largest + 1e-28), dict(
        zip(COMPONENTS, zip(found.mean(axis=0), predicted, error, strict=True), strict=True)
    )
    assert largest > 0 or (setting, kinds) == ("scanner", ("bias",))


def test_each_source_has_its_term(tmp_path):
    image, work = picture_of(*noisy_sensor(tmp_path, *ALL), tmp_path, 1)
    noise = work.value(NoiseOf(image))
    told = {(term.node, term.name): term for term in noise.terms}
    assert [(t.node, t.name, t.temporal) for t in noise.terms] == [
        ("photons", "photons", True),
        ("periodic", "periodic", False),
        ("electronics", "gain", False),
        ("electronics", "bias", False),
        ("electronics", "detector", True),
        ("electronics", "amplifier", True),
        ("electronics", "quantization", True),
        ("electronics", "quantization", False),
    ]
    assert noise.mean == pytest.approx(30.0, rel=0.01)
    assert noise.unknown == ()
    summed = sum(term.variances.total for term in noise.terms)
    assert noise.total.total == pytest.approx(summed)
    # 8 levels of noise stir a step of 80/63 fully: q²/12, less what interpolation averages.
    stirred = told["electronics", "quantization"].variances
    assert stirred.total == 0.0 or stirred.total < (80 / 63) ** 2 / 12


def test_prediction_of_a_uniform_field_in_closed_form(tmp_path, monkeypatch):
    """Unfiltered amplifier noise and gain of a uniform 30: σ = 30/SNR and 30 × 2 %."""
    import noisy_sensors

    monkeypatch.setattr(noisy_sensors, "scene", lambda: np.full((96, 120), 30.0))
    quiet = {**noisy_sensors.QUIET, "use_mtf": False}
    monkeypatch.setattr(noisy_sensors, "QUIET", quiet)
    engine, network = noisy_sensor(tmp_path, "amplifier", "gain", resize=False)
    image, work = picture_of(engine, network, tmp_path, 1)
    found = work.value(NoiseOf(image)).total
    assert found.sigma("tvh") == pytest.approx(30.0 / 40.0, rel=1e-9)
    assert found.sigma("vh") == pytest.approx(30.0 * 0.02, rel=1e-6)
    for name in ("t", "v", "h", "tv", "th"):
        assert abs(found.sigma(name)) < 1e-6
