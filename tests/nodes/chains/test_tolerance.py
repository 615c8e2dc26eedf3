"""The error budget over random networks: what a tolerance may change, and that 0 changes nothing.

Stages are drawn about as faint as the budget, so that some are left out and some are kept.
"""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from random import Random
from typing import Any

import numpy as np
import pytest

from core.chain.back_transformed import Delivered
from core.evaluation.policy import Policy
from drawn_modules import Item, Modules, Params, Sampling, short
from drawn_networks import ON_SPECTRUM, SMALL, Drawn, drawn
from slow_comparison import Comparison, network_of


class FaintModules(Modules):
    """Largest |1 − H| of a fiftieth to twenty times the budget, each stage by itself."""

    def __init__(self, random: Random, frames: Any, budget: float) -> None:
        super().__init__(random, frames)
        self.budget = budget

    def size(self) -> float:
        return self.budget * self.log(-1.7, 1.3)

    def width(self, interval: float) -> float:
        """1 − H goes with the square of a blur's width."""
        return 0.0 if self.random.random() < 0.1 else short(interval * sqrt(self.size()))

    def detector_mtf(self, at: Sampling) -> Params:
        return {
            "detector_x_um": short(100 * at.interval_x * sqrt(self.size())),
            "detector_y_um": short(100 * at.interval_y * sqrt(self.size())),
            "focal_length_mm": 100.0,
        }

    def charge_eff_mtf(self, at: Sampling) -> Params:
        return {
            **super().charge_eff_mtf(at),
            "detectors_per_line": 1,
            "efficiency": max(1 - self.size(), 0.0),
        }

    charge_eff_phase = charge_eff_mtf

    def atmosphere_mtf(self, at: Sampling) -> Params:
        params = super().atmosphere_mtf(at)
        if params["turbulence"].endswith("exposure"):
            params.pop("cn2", None)
            lag_mm = params["wavelength_um"] * 0.5 / at.interval_x
            params["fried_r0_m"] = short(lag_mm / 1000 * self.size() ** -0.6)
        params |= {"turbidity": "custom", "scatter_depth": short(self.size())}
        return params

    def exit_pupil_mtf(self, at: Sampling) -> Item:
        """1 − H goes with frequency over cutoff."""
        made = super().exit_pupil_mtf(at)
        for axis in "xy":
            made.params[f"size_{axis}_cm"] *= 1 / self.size()
        return made


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
