"""3-D Noise: 200 frames of one sensor, its prediction, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from core.evaluation.work import Policy
from core.network.network import Link, Node
from noisy_sensors import noisy_sensor

ALL = ("photons", "gain", "bias", "detector", "amplifier", "quantization", "periodic")


def measured(folder, kinds, frames=200, seed=11, **settings):
    """Plan, table as a dictionary and bars of the node behind a sensor with these noises."""
    engine, network = noisy_sensor(folder, *kinds, **settings)
    node = Node("noise", "noise_3d", {"frames": frames})
    network = replace(
        network,
        seed=seed,
        nodes={**network.nodes, "noise": node},
        links=(*network.links, Link.between("out.image", "noise.image")),
    )
    plan = engine.plan(network, folder=folder)
    work = engine.work(Policy(precision="double"))
    if plan.errors():
        return plan, None, None, None
    table = engine.value(plan, "noise.table", work).as_dict()
    return (
        plan,
        table,
        engine.value(plan, "noise.curve", work),
        engine.readouts(plan, "noise", work),
    )


@pytest.mark.parametrize("kinds", [("photons",), ("detector",), ("amplifier", "quantization"), ALL])
def test_temporal_noise_of_200_frames(tmp_path, kinds):
    """Within four of the standard errors told, each widened by its neighbours' correlation.

    White noise of these chains is filtered to no less than a tenth of its samples' number, which
    widens standard errors by at most √10; the components beside tvh hang on few averages.
    """
    _, table, _, _ = measured(tmp_path, kinds)
    for name in ("tvh", "tv", "th", "t"):
        off = table[f"sigma_{name}_measured"] - table[f"sigma_{name}"]
        assert abs(off) < 4 * np.sqrt(10) * table[f"sigma_{name}_error"], name


def test_fixed_pattern_of_one_sensor(tmp_path):
    """Detectors of a staring array: 60 × 48 deviates tell σ to 1/√(2·2880) = 1.3 %."""
    _, table, _, _ = measured(tmp_path, ("gain", "bias"), frames=2, resize=False)
    assert table["fixed_measured"] == pytest.approx(table["fixed"], rel=4 * 0.014)
    # What sums of squares of doubles leave of the pattern where nothing changes: the root of 1e-16.
    assert table["temporal_measured"] < 1e-7 * table["fixed"]
    assert table["temporal"] < 1e-9


def test_a_single_frame_is_refused(tmp_path):
    plan, *_ = measured(tmp_path, (), frames=1)
    assert [str(error) for error in plan.errors()] == [
        "noise: frames = 1 is not allowed: 0, or at least 2"
    ]


def test_the_literal_gain_error_is_refused(tmp_path):
    engine, network = noisy_sensor(tmp_path, "gain")
    network = network.with_parameter("electronics", "gain_model", "literal")
    network = replace(
        network,
        nodes={**network.nodes, "noise": Node("noise", "noise_3d", {"frames": 4})},
        links=(*network.links, Link.between("out.image", "noise.image")),
    )
    plan = engine.plan(network, folder=tmp_path)
    assert "gain_model = literal multiplies the picture" in str(plan.errors()[0])
