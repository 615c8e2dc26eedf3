"""Statistics of 400 frames of a focal plane, against the distribution of its numbers.

The truth shares nothing with the code under test: of each pair of pattern deviates a number's
probabilities are differences of the normal distribution function, cut off at the well, and summed
over whole numbers; the patterns are integrated by Gauss and Hermite.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.special import ndtr

from core.chain.random_fields import at_frame
from node_bench import NodeBench

FRAMES, ROWS, COLUMNS = 400, 30, 40
# camera-shared-0 of the reference: electrons of 4 ms.
SIGNAL_E_PER_S = 453078.91635770707839 / 0.004
WELL, GAIN, OFFSET, READ, PRNU, DSNU = 60_000.0, 60.0, 20.0, 40.0, 0.01, 60.0
CAMERA = {
    "optics_transmission": 0.765, "quantum_efficiency": 0.7, "full_well_e": WELL, "bits": 12,
    "gain_e_per_dn": GAIN, "offset_dn": OFFSET, "read_noise_e": READ,
    "prnu_percent": 100 * PRNU, "dsnu_e": DSNU,
}  # fmt: skip
INIT = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.9025, "platform": "array",
}  # fmt: skip
SCENE = {
    "kind": "uniform", "width": COLUMNS, "height": ROWS, "fov_x_deg": 0.34, "fov_y_deg": 0.26,
    "temperature_K": 293.15, "cut_on_um": 3.7, "cut_off_um": 4.8,
}  # fmt: skip
LEVELS = (0.0, 0.1, 0.4, 0.8, 1.0)  # of the full well, from dark to saturation


@dataclass(frozen=True)
class Moments:
    """Of a number: its mean and variance in time, and what these are among pixels."""

    mean: float
    temporal: float
    fixed: float
    mean_error: float
    temporal_error: float
    fixed_error: float


def expected(electrons: float) -> Moments:
    """Moments of the numbers, and standard errors of what the frames estimate of them."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(40)
    share = np.outer(weights, weights).ravel() / weights.sum() ** 2
    gains, darks = (grid.ravel() for grid in np.meshgrid(nodes, nodes, indexing="ij"))
    level = (1 + PRNU * gains) * electrons + DSNU * darks
    spread = np.sqrt((1 + PRNU * gains) ** 2 * electrons + READ**2)
    top = np.rint(WELL / GAIN + OFFSET)
    numbers = np.arange(max(0.0, np.floor((level - 9 * spread).min() / GAIN + OFFSET)), top + 1)
    edges = (np.append(numbers - 0.5, np.inf) - OFFSET) * GAIN
    below = ndtr((edges - level[:, None]) / spread[:, None])
    below[:, 0] = 0.0
    chance = np.diff(below, axis=1)  # what is beyond the well is at the last number
    means = chance @ numbers
    away = numbers - means[:, None]
    second, fourth = (np.sum(chance * away**power, axis=1) for power in (2, 4))
    mean, temporal = share @ means, share @ second
    fixed = share @ (means - mean) ** 2
    pixels = ROWS * COLUMNS
    # Of the sample variance of n numbers: (μ4 − σ⁴·(n − 3)/(n − 1))/n.
    scatter = (fourth - second**2 * (FRAMES - 3) / (FRAMES - 1)) / FRAMES
    among = share @ (second - temporal) ** 2
    seen = fixed + temporal / FRAMES
    kurtosis = share @ (means - mean) ** 4 + 6 * fixed * temporal / FRAMES
    kurtosis += 3 * (temporal / FRAMES) ** 2
    return Moments(
        mean,
        temporal,
        fixed,
        math.sqrt(seen / pixels),
        math.sqrt((share @ scatter + among) / pixels),
        math.sqrt((kurtosis - seen**2) / pixels),
    )


def bench_of(folder, camera, scene=None, *, precision="single"):
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", INIT),
        "fpa": ("focal_plane", {**CAMERA, **camera}),
    }
    return NodeBench(folder, nodes, precision=precision)


def frames_of(bench, count, port="fpa.image"):
    recipe = bench.port(port).recipe
    recipes = (at_frame(recipe, number) for number in range(count))
    made = bench.work.one_by_one(recipes, forgetting=True)
    return np.stack([np.asarray(frame, np.float64) for frame in made])


@pytest.fixture(scope="module")
def taken(tmp_path_factory):
    """Frames, read-outs and truth at each level; the same patterns at all of them."""
    made = {}
    for fill in LEVELS:
        time = max(fill * WELL / SIGNAL_E_PER_S, 1e-12)
        bench = bench_of(tmp_path_factory.mktemp("level"), {"integration_time_s": time})
        made[fill] = frames_of(bench, FRAMES), bench.readouts("fpa"), expected(fill * WELL)
    return made


@pytest.mark.parametrize("fill", LEVELS)
class TestLevels:
    def test_mean_and_variances_in_time_and_among_pixels(self, taken, fill):
        frames, _, truth = taken[fill]
        temporal = frames.var(axis=0, ddof=1).mean()
        fixed = frames.mean(axis=0).var(ddof=1) - truth.temporal / FRAMES
        assert abs(frames.mean() - truth.mean) < 4 * truth.mean_error
        assert abs(temporal - truth.temporal) < 4 * truth.temporal_error
        assert abs(fixed - truth.fixed) < 4 * truth.fixed_error

    @pytest.mark.parametrize("axis", [1, 2])
    def test_covariance_between_neighbours(self, taken, fill, axis):
        """None, in time and among pixels."""
        frames, _, truth = taken[fill]
        means = frames.mean(axis=0)
        moving = frames - means
        fixed = means - means.mean()
        ahead, behind = (np.take(moving, range(*ends), axis=axis) for ends in _ends(moving, axis))
        pairs = ahead[0].size
        in_time = (ahead * behind).sum() / ((FRAMES - 1) * pairs)
        assert abs(in_time) < 4 * truth.temporal / math.sqrt((FRAMES - 1) * pairs)
        one, other = (np.take(fixed, range(*e), axis=axis - 1) for e in _ends(fixed, axis - 1))
        spread = truth.fixed + truth.temporal / FRAMES
        assert abs((one * other).mean()) < 4 * spread / math.sqrt(pairs) + spread / pairs


@pytest.mark.parametrize("fill", LEVELS[:-1])
def test_what_the_readouts_predict(taken, fill):
    """Shot, read, PRNU, DSNU and rounding, where the well cuts nothing off.

    Beyond, the figures go on as if it did not: they are those of the picture's mean.
    """
    _, found, truth = taken[fill]
    total = fill * WELL
    assert found["mean_dn"] == pytest.approx(truth.mean, abs=0.01)
    parts = {
        "shot_noise_e": math.sqrt(total), "read_noise_e": READ,
        "quantization_noise_e": GAIN / math.sqrt(12),
    }  # fmt: skip
    for name, value in parts.items():
        assert found[name] == pytest.approx(value, rel=1e-6, abs=0.2), name
    # PRNU makes shot noise a share of p² larger.
    temporal = found["temporal_noise_e"] / GAIN
    assert temporal**2 == pytest.approx(truth.temporal, rel=1.1 * PRNU**2 + 1e-3)
    assert (found["fixed_pattern_e"] / GAIN) ** 2 == pytest.approx(truth.fixed, rel=2e-3)


def _ends(array, axis):
    size = array.shape[axis]
    return (0, size - 1), (1, size)
