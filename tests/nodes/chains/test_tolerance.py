"""The error budget over random networks: what a tolerance may change, and that 0 changes nothing.

Stages are drawn about as faint as the budget, so that some are left out and some are kept.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from core.chain.back_transformed import Delivered
from core.evaluation.policy import Policy
from drawn_networks import ON_SPECTRUM, SMALL, Drawn, drawn
from faint_modules import FaintModules
from slow_comparison import Comparison, network_of

CHUNKS, NETWORKS = 2, 250
PASSIVE = {
    "combine_pixels": {"mode": "mean"},
    "interpolate": {"order": 1},
    "anti_alias": {},
    "periodic_noise": {},
    "noise_file": {},
}


def faint(random: Random, comparison: Comparison, budget: float, *, keys) -> Drawn:
    modules = FaintModules(random, comparison.names, budget)
    network = drawn(
        random,
        comparison.names,
        most=9,
        modules=modules,
        of_picture=(*PASSIVE, "electronics_noise"),
    )
    items = [
        replace(item, params={**without_apply(item.params), **PASSIVE.get(item.key, {})})
        for item in network.items
        if item.key in keys
    ]
    return replace(network, items=tuple(items))


def without_apply(params):
    """A transfer function on its own is no picture whose range could be told."""
    return {name: value for name, value in params.items() if name != "apply"}


def cascades(plan):
    """Delivered pictures by the node that delivers them."""
    found = {}
    for name, node in plan.nodes.items():
        recipe = getattr(node.outputs.get("image"), "recipe", None)
        if isinstance(recipe, Delivered) and recipe.node == name:
            found[name] = recipe
    return found


@pytest.mark.thorough(but=1)
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_one_cascade_changes_by_less_than_its_tolerance(tmp_path, chunk):
    """rms ≤ t·(max − min) of the picture that came in."""
    comparison, random = Comparison(tmp_path, SMALL, threads=1), Random(f"one cascade {chunk}")
    engine, skipping = comparison.engine, 0
    for number in range(NETWORKS):
        budget = 10 ** random.uniform(-8, -1)
        network = faint(random, comparison, budget, keys=ON_SPECTRUM)
        document = network.document()
        plan = engine.plan(network_of(document), folder=tmp_path)
        exact, within = (
            engine.work(Policy(precision="double", tolerance=t, threads=1)) for t in (0.0, budget)
        )
        (recipe,) = cascades(plan).values()
        kept, none = recipe.spent(exact)
        assert len(kept) == len(recipe.magnitude.factors) + len(recipe.phase.factors)
        assert none == ()
        left_out = recipe.spent(within)[1]
        assert sum(stage.bound for stage in left_out) <= budget
        skipping += bool(left_out)
        source = engine.value(plan, "file.image", exact)
        full, less = (engine.value(plan, document["last"], work) for work in (exact, within))
        rms = np.sqrt(np.mean((less - full) ** 2))
        rounding = 1e-14 * np.abs(source).max()
        assert rms <= budget * np.ptp(source) + rounding, (number, document)
    assert skipping > NETWORKS / 3


@pytest.mark.thorough(but=1)
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_each_cascade_of_a_network_has_the_tolerance_for_its_own_picture(tmp_path, chunk):
    """One after the other: rms ≤ Σ t·(max − min) of what comes into each.

    Means, interpolation and added patterns between them keep an rms from growing by more than the
    factor of two that a mean square leaves below the square of a range.
    """
    comparison, random = Comparison(tmp_path, SMALL, threads=1), Random(f"cascades {chunk}")
    engine, several = comparison.engine, 0
    for number in range(NETWORKS):
        budget = 10 ** random.uniform(-8, -1)
        network = faint(random, comparison, budget, keys={*ON_SPECTRUM, *PASSIVE})
        document = network.document()
        plan = engine.plan(network_of(document), folder=tmp_path)
        exact, within = (
            engine.work(Policy(precision="double", tolerance=t, threads=1)) for t in (0.0, budget)
        )
        found = cascades(plan)
        several += len(found) > 1
        sources = [
            exact.value((recipe.magnitude.image or recipe.phase.image).recipe)
            for recipe in found.values()
        ]
        full, less = (engine.value(plan, document["last"], work) for work in (exact, within))
        rms = np.sqrt(np.mean((less - full) ** 2))
        rounding = 1e-14 * max((np.abs(source).max() for source in sources), default=0)
        allowed = budget * sum(np.ptp(source) for source in sources)
        assert rms <= allowed + rounding, (number, document)
    assert several > NETWORKS / 3
