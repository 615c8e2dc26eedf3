"""Noise of a network at given levels, against the sum of its sources by hand."""

import json

import numpy as np
import pytest

from app.fit.chain_transfer import NoiseProblem
from core.chain.engine import Engine
from core.errors import DataError
from core.evaluation.work import Policy
from core.network.file import parse_network
from core.physics.measurement.sample_noise import LevelVariance
from edge_truth import blur_network
from nodes.library import standard_library

GAIN, READ, DSNU, PRNU = 400.0, 300.0, 150.0, 0.002


@pytest.fixture(scope="module")
def camera():
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.05}))
    network["nodes"]["fpa"] = {
        "module": "focal_plane",
        "params": {
            "bits": 14, "gain_e_per_dn": GAIN, "read_noise_e": READ, "dsnu_e": DSNU,
            "prnu_percent": 100 * PRNU, "full_well_e": 7e6, "integration_time_s": 2e-4,
        },
    }  # fmt: skip
    network["links"] += [["init.context", "fpa.context"], ["back.image", "fpa.image"]]
    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="camera")
    engine = Engine(library)
    measured = [
        LevelVariance(level, by_hand(level) * off, error * by_hand(level), 500)
        for level, off, error in ((2000.0, 1.02, 0.02), (5000.0, 1.0, 0.01))
    ]
    plan, work = engine.plan(made), engine.work(Policy("double", None, 1))
    return NoiseProblem(engine, plan, work, measured), plan


def by_hand(level):
    """Shot noise of level·gain electrons, read noise, patterns and rounding, in DN²."""
    return level / GAIN + (READ / GAIN) ** 2 + (DSNU / GAIN) ** 2 + (PRNU * level) ** 2 + 1 / 12


def test_the_variance_at_levels_that_the_scene_has_not(camera):
    noise, plan = camera
    levels = [600.0, 1500.0, 9000.0]
    assert noise.at(plan, levels) == pytest.approx([by_hand(v) for v in levels], rel=1e-4)
    assert noise.at(plan, [3000.0]) == pytest.approx([by_hand(3000.0)], rel=2e-2)


def test_a_level_below_no_light_is_refused(camera):
    noise, plan = camera
    with pytest.raises(DataError, match="a level of -500"):
        noise.at(plan, [-500.0, -400.0])


def test_residuals_are_in_standard_errors(camera):
    noise, plan = camera
    assert noise.residual(plan) == pytest.approx([-np.log(1.02) / (0.02 / 1.02), 0.0], abs=0.05)
