"""The seven noise components of a sequence against sums written out and against known noise."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.noise.noise_components import (
    COMPONENTS,
    Moments,
    NoiseCube,
    NoiseVariances,
    components_of_moments,
)

AXES = {"t": 0, "v": 1, "h": 2}


def measured(cube):
    found = NoiseCube(*cube.shape[1:])
    for frame in cube:
        found.add(frame)
    return found.measured()


def by_loops(cube):
    """The unbiased estimates of a small cube in fractions, mean by mean, as in a textbook.

    A mean square is n/(degrees of freedom) × the sum of squared interactions, an interaction the
    inclusion–exclusion of cell means; the components solve E[MS] = Σ of n·σ² from the top down.
    """
    sizes = {axis: cube.shape[place] for axis, place in AXES.items()}
    cells = {
        place: Fraction(int(cube[place])) for place in product(*(range(n) for n in cube.shape))
    }

    def mean(axes, place):
        inside = [
            value
            for key, value in cells.items()
            if all(key[AXES[a]] == place[AXES[a]] for a in axes)
        ]
        return sum(inside) / len(inside)

    def mean_square(axes):
        total, freedom = Fraction(0), 1
        for place in cells:
            deviation = sum(
                (-1) ** (len(axes) - len(sub)) * mean(sub, place)
                for size in range(len(axes) + 1)
                for sub in {tuple(x) for x in _subsets(axes, size)}
            )
            total += deviation**2
        for axis in axes:
            freedom *= sizes[axis] - 1
        return total / freedom

    squares = {axes: mean_square(axes) for axes in COMPONENTS}
    found = {"tvh": squares["tvh"]}
    for pair, other in (("tv", "h"), ("th", "v"), ("vh", "t")):
        found[pair] = (squares[pair] - squares["tvh"]) / sizes[other]
    for one, (a, b) in {"t": ("tv", "th"), "v": ("tv", "vh"), "h": ("th", "vh")}.items():
        rest = squares[one] - squares[a] - squares[b] + squares["tvh"]
        others = [n for axis, n in sizes.items() if axis != one]
        found[one] = rest / (others[0] * others[1])
    return found


def _subsets(axes, size):
    from itertools import combinations

    return combinations(axes, size)


def test_estimates_are_those_of_the_textbook():
    cube = np.random.default_rng(3).integers(-9, 10, (3, 4, 5))
    found, expected = measured(cube.astype(float)).variances, by_loops(cube)
    for name in COMPONENTS:
        assert found.variance(name) == pytest.approx(float(expected[name]), abs=1e-12), name


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


def test_too_few_frames_or_samples_are_refused():
    with pytest.raises(DataError, match="2 × 2 samples or more, not 5 × 1"):
        NoiseCube(1, 5)
    cube = NoiseCube(3, 4)
    cube.add(np.zeros((3, 4)))
    with pytest.raises(DataError, match="2 frames or more, not 1"):
        cube.measured()
    with pytest.raises(DataError, match="4 × 5 samples does not match the earlier frames, 4 × 3"):
        cube.add(np.zeros((5, 4)))


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
    found = components_of_moments(
        moments=Moments(*moments), rows=rows, columns=columns, temporal=temporal
    )
    assert [found.variance(n) for n in COMPONENTS] == pytest.approx(list(expected), abs=1e-10)


def test_variances():
    a, b = NoiseVariances(tvh=4.0, v=1.0), NoiseVariances(tvh=5.0, h=-0.25)
    assert (a + b).sigma("tvh") == 3.0
    assert (a + b).sigma("h") == -0.5
    assert (a + b).temporal == 9.0
    assert (a + b).fixed == 0.75
    assert (a + b).total == 9.75
    with pytest.raises(ParameterError, match="component = 'x'"):
        a.sigma("x")
