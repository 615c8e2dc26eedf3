"""3-D Noise Source: what is set comes back from simulated frames and in the budgets."""

import math

import numpy as np
import pytest
from scipy import special

from core.chain.random_fields import at_frame
from node_bench import NodeBench

SCENE = {"kind": "uniform", "width": 96, "height": 72, "fov_x_deg": 2, "fov_y_deg": 1.5}
SIGMAS = {
    "sigma_tvh": 0.5, "sigma_vh": 0.4, "sigma_v": 0.3, "sigma_h": 0.35, "sigma_t": 0.2,
    "sigma_tv": 0.25, "sigma_th": 0.15,
}  # fmt: skip
FRAMES = 40


def bench_of(folder, params, *, frames=FRAMES, behind=None):
    nodes = {
        "scene": ("test_scene", SCENE),
        "noise": ("noise_3d_source", params),
        **({"behind": behind} if behind else {}),
        "cube": ("noise_3d", {"frames": frames}),
        "budget": ("noise_budget", {}),
    }
    return NodeBench(folder, nodes)


def frame(bench, number, port="noise.image"):
    return bench.work.value(at_frame(bench.port(port).recipe, number))


def test_the_components_are_predicted_as_they_are_set(tmp_path):
    table = bench_of(tmp_path, SIGMAS, frames=0).value("cube.table").as_dict()
    for name, value in SIGMAS.items():
        assert table[name] == pytest.approx(value, rel=1e-9), name


def test_the_components_are_measured_as_they_are_set(tmp_path):
    """One pattern is measured: of few rows or columns it scatters by √(2/(n − 1))."""
    table = bench_of(tmp_path, SIGMAS).value("cube.table").as_dict()
    lines = {"v": 72, "h": 96, "t": FRAMES}
    for name, value in SIGMAS.items():
        count = math.prod(lines[letter] - 1 for letter in name.removeprefix("sigma_"))
        # The variances that ride on a mean square: those of averages of the other components.
        error = max(table[f"{name}_error"], value / math.sqrt(2 * count))
        assert table[f"{name}_measured"] == pytest.approx(value, abs=3.5 * error), name


def test_fixed_patterns_stay_and_temporal_ones_are_new(tmp_path):
    fixed = {name: value for name, value in SIGMAS.items() if "t" not in name[6:]}
    bench = bench_of(tmp_path, fixed, frames=2)
    assert at_frame(bench.port("noise.image").recipe, 3).key == bench.port("noise.image").recipe.key
    bench = bench_of(tmp_path, {"sigma_tv": 1.0}, frames=2)
    first, second = (frame(bench, n, "noise.noise") for n in (0, 1))
    assert np.ptp(first, axis=1).max() == 0.0
    assert abs(np.corrcoef(first[:, 0], second[:, 0])[0, 1]) < 0.5
    np.testing.assert_array_equal(second, frame(bench_of(tmp_path, {"sigma_tv": 1.0}), 1,
                                                "noise.noise"))  # fmt: skip


def test_combined_pixels_average_each_component_over_what_it_varies_with(tmp_path):
    behind = ("combine_pixels", {"factor_x": 4, "factor_y": 3})
    table = bench_of(tmp_path, SIGMAS, frames=0, behind=behind).value("cube.table").as_dict()
    over = {"v": 3, "h": 4, "t": 1}
    for name, value in SIGMAS.items():
        count = math.prod(over[letter] for letter in name.removeprefix("sigma_"))
        assert table[name] == pytest.approx(value / math.sqrt(count), rel=1e-9), name


def test_the_noise_budget_names_each(tmp_path):
    bench = bench_of(tmp_path, {**SIGMAS, "corner_Hz": 1.0}, frames=0)
    found = bench.readouts("budget")
    own = bench.readouts("noise")
    assert found["sigma_temporal"] == pytest.approx(own["temporal"], rel=1e-9)
    assert found["sigma_fixed"] == pytest.approx(own["fixed"], rel=0.02)  # less their mean
    assert len(bench.value("budget.noise").bars) == 8


PINK = {"sigma_tvh": 0.2, "corner_Hz": 8.0, "frame_rate_Hz": 50.0, "longest_period_s": 40.0}


def test_what_is_slower_than_the_frames_is_measured_as_fixed(tmp_path):
    """Of 1/f between two frequencies the covariance is known: cosine integrals."""
    bench = bench_of(tmp_path, PINK, frames=30)
    white, low, high = 0.2**2, 1 / 40.0, 25.0
    density = white / high * 8.0  # times 1/f
    lags = 2 * np.pi * np.arange(1, 30) / 50.0
    covariance = density * (special.sici(lags * high)[1] - special.sici(lags * low)[1])
    common = 2.0 / (30 * 29) * np.sum((30 - np.arange(1, 30)) * covariance)
    whole = density * math.log(high / low)
    table = bench.value("cube.table").as_dict()
    assert bench.readouts("noise")["flicker"] == pytest.approx(math.sqrt(whole), rel=1e-12)
    assert table["sigma_tvh_measured"] ** 2 == pytest.approx(white + whole - common, rel=0.03)
    assert table["sigma_vh_measured"] ** 2 == pytest.approx(common, rel=0.06)


def test_a_typed_seed_and_a_region_give_the_same_samples(tmp_path):
    from core.evaluation.recipes import Region

    bench = bench_of(tmp_path, {**SIGMAS, **PINK, "seed_mode": "typed", "seed": 3}, frames=2)
    whole = bench.value("noise.image")
    region = Region(11, 7, 20, 31)
    part = bench.engine.value(bench.plan, "noise.image", bench.engine.work(bench.work.policy),
                              region)  # fmt: skip
    np.testing.assert_array_equal(part, whole[11:31, 7:38])


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"corner_Hz": 1.0}, "sigma_tvh"),
        ({"corner_Hz": 1.0, "sigma_tvh": 1.0, "longest_period_s": 0.01}, "longest_period_s"),
        ({"sigma_v": -1.0}, "sigma_v"),
    ],
)
def test_faults(tmp_path, params, words):
    error = bench_of(tmp_path, params, frames=0).error("noise")
    assert words in str(error)
    assert "\n" not in str(error)


def test_a_single_row_is_warned_of(tmp_path):
    nodes = {"scene": ("test_scene", {**SCENE, "height": 1}),
             "noise": ("noise_3d_source", {"sigma_v": 1.0})}  # fmt: skip
    bench = NodeBench(tmp_path, nodes)
    found = [caution for caution in bench.plan.checks() if caution.node == "noise"]
    assert "sigma_v" in found[0].message
