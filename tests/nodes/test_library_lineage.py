"""Every step that makes a picture says what becomes of one in it; nothing knows one by identity."""

import pytest

from battery_settings import EXAMPLES
from child_process import ROOT
from core.chain.engine import Engine
from core.chain.wires import Image
from core.evaluation.recipes import Step
from core.network.file import load_network
from library_battery import LIBRARY, planned

SHIPPED = sorted((ROOT / "networks").glob("*.json"))


def of_plan(plan) -> set[object]:
    """Functions of the steps that pictures are made by, and of those that they stem from."""
    functions = set()
    for node in plan.nodes.values():
        for value in (node.outputs or {}).values():
            recipe = value.recipe if isinstance(value, Image) else None
            while recipe is not None:
                functions |= {recipe.function} if isinstance(recipe, Step) else set()
                recipe = recipe.lineage and recipe.lineage.picture
    return functions


def undeclared(functions) -> list[str]:
    return sorted(f"{f.__module__}.{f.__qualname__}" for f in functions if not _declares(f))


def _declares(function) -> bool:
    return callable(getattr(function, "lineage", None))


@pytest.mark.parametrize("key", LIBRARY)
def test_every_step_of_a_module(key, folder):
    plan = planned(key, EXAMPLES[key], folder)
    assert not undeclared(of_plan(plan))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_step_of_a_shipped_network(path):
    engine = Engine(LIBRARY)
    plan = engine.plan(load_network(path, library=LIBRARY), folder=path.parent)
    functions = of_plan(plan)
    assert functions
    assert not undeclared(functions)
