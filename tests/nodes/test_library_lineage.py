"""Every step of the product says what becomes of a picture in it; nothing knows one by identity."""

from __future__ import annotations

import ast
import re
from importlib import import_module

import pytest

from battery_settings import EXAMPLES
from child_process import ROOT
from core.chain.engine import Engine
from core.chain.step_lineage import lineage_of, picture_step, source_step
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.network.file import load_network
from import_arrows import modules
from library_battery import LIBRARY, planned

SHIPPED = sorted((ROOT / "networks").glob("*.json"))
PLANNED = ("Step.of", "here.step")
SWITCH = re.compile(r"\.function (?:is\b|==|!=|in\b|not in\b)")


def planned_steps(source: str, names: dict[str, object]) -> list[tuple[int, object]]:
    """Functions of every step planned in a file, by their lines; of a choice, all of them."""
    tree = ast.parse(source)
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return [step for function in functions for step in _planned_in(function, names)]


def _planned_in(function: ast.FunctionDef, names: dict[str, object]) -> list[tuple[int, object]]:
    chosen: dict[str, list[ast.expr]] = {}
    for node in ast.walk(function):
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            value = node.value
            either = [value.body, value.orelse] if isinstance(value, ast.IfExp) else [value]
            chosen.setdefault(node.targets[0].id, []).extend(either)
    found = []
    for node in ast.walk(function):
        if not isinstance(node, ast.Call) or ast.unparse(node.func) not in PLANNED:
            continue
        given = [node.args[0]]
        if isinstance(given[0], ast.Name) and given[0].id not in names:
            given = chosen[given[0].id]
        found += [(node.lineno, eval(ast.unparse(each), names)) for each in given]
    return found


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


def test_every_step_that_is_planned_in_the_source():
    found = [
        (name, line, function)
        for name, path in modules().items()
        if any(f"{way}(" in (source := path.read_text(encoding="utf-8")) for way in PLANNED)
        and name not in ("core.evaluation.recipes", "core.modules.declaration")
        for line, function in planned_steps(source, vars(import_module(name)))
    ]
    assert len({function for _, _, function in found}) > 90
    assert not [
        f"{name}:{line} {function.__name__}"
        for name, line, function in found
        if not _declares(function)
    ]


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


def test_a_step_without_a_word_is_seen():
    def silent(work):
        return None

    assert undeclared({silent}) == [f"{__name__}.{silent.__qualname__}"]
    assert not undeclared({ends_lineage(silent)})
    source = "def plan(odd):\n    made = first if odd else second\n    return Step.of(made, x=1)\n"
    assert planned_steps(source, {"first": 1, "second": 2}) == [(3, 1), (3, 2)]


def test_no_step_is_known_by_its_function():
    assert SWITCH.search("if recipe.function is read_out:")
    assert not [
        f"{path.relative_to(ROOT)}:{number}"
        for path in modules().values()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if SWITCH.search(line)
    ]


def test_inputs_are_named_as_the_function_names_them():
    with pytest.raises(ValueError, match="'pictures' is not in list"):

        @picture_step(picture="pictures")
        def step(work, picture):
            return picture


def test_what_is_not_said_is_not_known():
    """A step of somebody else's is the end of what is known, not a picture passed on."""

    @source_step(area_means=True)
    def begun(work):
        return 1

    def silent(work, picture):
        return picture

    assert lineage_of(Step.of(begun)).area_means
    assert lineage_of(Step.of(silent, Step.of(begun))) is None
