"""The seven noise components of a sequence against sums written out and against known noise."""

import numpy as np
import pytest

from core.physics.noise.noise_components import (
    COMPONENTS,
    NoiseCube,
    components_of_moments,
)


def measured(cube):
    found = NoiseCube(*cube.shape[1:])
    for frame in cube:
        found.add(frame)
    return found.measured()


@pytest.mark.parametrize("present", [*COMPONENTS, "all"])
def test_estimates_are_unbiased(present):
    """The mean of 400 sequences' estimates, none of which is clipped, is the truth."""
    rng = np.random.default_rng(COMPONENTS.index(present) if present != "all" else 99)
    shape = (6, 9, 8)
    sigmas = {name: 1.0 + COMPONENTS.index(name) / 4 for name in COMPONENTS}
    if present != "all":
        sigmas = {name: sigmas[name] * (name == present) for name in COMPONENTS}
    found, told = [], []
    for _ in range(400):
        cube = np.zeros(shape)
        for name, sigma in sigmas.items():
            size = [n if axis in name else 1 for axis, n in zip("tvh", shape, strict=True)]
            cube = cube + sigma * rng.standard_normal(size)
        each = measured(cube)
        found.append([each.variances.variance(name) for name in COMPONENTS])
        told.append([each.errors.variance(name) for name in COMPONENTS])
    mean, spread = np.mean(found, axis=0), np.std(found, axis=0, ddof=1)
    truth = np.array([sigmas[name] ** 2 for name in COMPONENTS])
    assert np.all(np.abs(mean - truth) < 4 * spread / np.sqrt(400) + 1e-12)
    # The standard errors told are those that the estimates have.
    alive = spread > 1e-9
    assert np.mean(told, axis=0)[alive] == pytest.approx(spread[alive], rel=0.25)


def test_what_frames_have_in_common_takes_no_digits():
    """On a pedestal of 2^30, of which a sample keeps 2^−22: squares would lose all below 2^8."""
    rng = np.random.default_rng(6)
    cube = np.round(rng.standard_normal((4, 6, 5)) * 256) / 256
    plain, lifted = measured(cube), measured(cube + 2.0**30)
    for name in COMPONENTS:
        expected = plain.variances.variance(name)
        assert lifted.variances.variance(name) == pytest.approx(expected, abs=1e-9), name
    assert lifted.mean == pytest.approx(2.0**30 + cube.mean(), rel=1e-15)


@pytest.mark.parametrize("temporal", [True, False])
def test_components_of_correlated_noise_are_what_estimates_have_on_average(temporal):
    """Estimates are quadratic, so that their mean is a sum over the covariance's own patterns."""
    rng = np.random.default_rng(8)
    rows, columns, frames = 4, 5, 3
    root = rng.standard_normal((rows * columns, rows * columns))
    moments = np.zeros(4)
    expected = np.zeros(len(COMPONENTS))
    for pattern in root.T:  # noise = Σ of independent unit deviates × patterns
        frame = pattern.reshape(rows, columns)
        moments += [
            np.mean(frame**2),
            np.mean(frame.mean(axis=1) ** 2),
            np.mean(frame.mean(axis=0) ** 2),
            frame.mean() ** 2,
        ]
        for t in range(frames):
            cube = np.zeros((frames, rows, columns))
            cube[t if temporal else slice(None)] = frame
            each = measured(cube).variances
            expected += [each.variance(name) for name in COMPONENTS]
            if not temporal:
                break
    names = ("sample", "row_mean", "column_mean", "frame_mean")
    size = {"rows": rows, "columns": columns}
    found = components_of_moments(
        **dict(zip(names, moments, strict=True)), **size, temporal=temporal
    )
    assert [found.variance(n) for n in COMPONENTS] == pytest.approx(list(expected), abs=1e-10)
