"""Every step of the product says what becomes of a picture in it; nothing knows one by identity."""

from __future__ import annotations

import pytest

from battery_settings import EXAMPLES
from child_process import ROOT
from core.chain.engine import Engine
from core.evaluation.recipes import Recipe, Step
from core.network.file import load_network
from library_battery import LIBRARY, planned

SHIPPED = sorted((ROOT / "networks").glob("*.json"))


def made_of(recipes: list[Recipe]) -> set[object]:
    """Functions of all steps that recipes are made of."""
    seen: set[str] = set()
    functions = set()
    while recipes:
        recipe = recipes.pop()
        if recipe.key in seen:
            continue
        seen.add(recipe.key)
        if isinstance(recipe, Step):
            functions.add(recipe.function)
        recipes += [*recipe.made_of, *recipe.inputs]
    return functions


def of_plan(engine, plan) -> set[object]:
    recipes = []
    for name, node in plan.nodes.items():
        for value in (node.outputs or {}).values():
            recipes += getattr(value, "recipes", ())
            recipes += [one for one in vars(value).values() if isinstance(one, Recipe)]
        figures = engine.planned_readouts(plan, name) if node.outputs else {}
        recipes += [one for one in figures.values() if isinstance(one, Recipe)]
    return made_of(recipes)


def undeclared(functions) -> list[str]:
    return sorted(f"{f.__module__}.{f.__qualname__}" for f in functions if not _declares(f))


def _declares(function) -> bool:
    return callable(getattr(function, "lineage", None))


@pytest.mark.parametrize("key", LIBRARY)
def test_every_step_of_a_module(key, folder):
    plan = planned(key, EXAMPLES[key], folder)
    assert not undeclared(of_plan(Engine(LIBRARY), plan))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_step_of_a_shipped_network(path):
    engine = Engine(LIBRARY)
    plan = engine.plan(load_network(path, library=LIBRARY), folder=path.parent)
    functions = of_plan(engine, plan)
    assert functions
    assert not undeclared(functions)
