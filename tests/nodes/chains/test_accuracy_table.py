"""Promises of accuracy that no other test has: shifts, uniform radiance, every reference value."""

import ast
import json
from pathlib import Path

import numpy as np
import pytest

from delivered_chains import PRECISIONS, SHIFT_ERROR
from node_bench import NodeBench
from planck_truth import band_radiance
from reference_cases import REFERENCE
from short_chain import short_chain


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize(("transfers", "efficiency"), [(3, 0.8), (1, 0.5), (20, 0.97)])
def test_centroid_is_the_mean_lag(tmp_path, transfers, efficiency, edges, precision):
    """Charge left behind lags by N(1 − ε)/ε samples in the mean, as a negative binomial."""
    picture = np.zeros((5, 129))
    picture[2, 64] = 1.0
    params = {"detectors_per_line": transfers, "efficiency": efficiency}
    stages = (("charge_eff_mtf", params), ("charge_eff_phase", params))
    bench, last = short_chain(tmp_path, picture, stages, init={"edges": edges}, precision=precision)
    found = bench.value(last).astype(float)
    centroid = (found * (np.arange(129) - 64)).sum() / found.sum()
    assert abs(centroid - transfers * (1 - efficiency) / efficiency) <= SHIFT_ERROR[precision]


@pytest.mark.parametrize(("precision", "tolerance"), [("double", 1e-12), ("single", 1e-7)])
@pytest.mark.parametrize(
    ("cut_on", "cut_off", "temperature"),
    [(8, 12, 303.15), (3, 5, 77), (0.3, 30, 6000), (14, 30, 20), (3, 5, 300), (0.4, 0.7, 2856)],
)
def test_radiance_of_a_uniform_scene(tmp_path, cut_on, cut_off, temperature, precision, tolerance):
    scene = {
        "kind": "uniform", "width": 3, "height": 2, "cut_on_um": cut_on, "cut_off_um": cut_off,
        "temperature_K": temperature, "delta_K": 0.0,
    }  # fmt: skip
    bench = NodeBench(tmp_path, {"scene": ("test_scene", scene)}, precision=precision)
    found, expected = bench.value("scene.image"), band_radiance(cut_on, cut_off, temperature)
    assert np.abs(found / expected - 1).max() <= tolerance


@pytest.mark.skipif(
    not REFERENCE.exists(),
    reason="the file of reference values, which is not part of the repository, is not beside it",
)
def test_every_reference_value_is_a_test():
    """Each quantity of the file is named where cases are taken from it."""
    cases = json.loads(REFERENCE.read_text(encoding="utf-8"))["cases"]
    named = {
        node.value
        for path in (Path(__file__).parents[2] / "core" / "physics").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    assert {case["quantity"] for case in cases} <= named
