"""How a module's warnings are declared, asked for and gathered."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Annotated, NamedTuple

import pytest

from core.chain.engine import Engine
from core.chain.wires import Image
from core.evaluation.recipes import Recipe, Step
from core.modules.caution import Caution
from core.modules.declaration import Module, declaration, warning
from core.modules.parameters import Param
from linked_network import linked_network


class Outputs(NamedTuple):
    image: Image


class Maker(Module, key="maker", title="Maker", group="Test"):
    """A picture in a unit."""

    unit: Annotated[str, Param("unit")] = "K"

    def run(self) -> Outputs:
        return Outputs(Image(Step.of(_pixels), 2, 2, unit=self.unit))


class Taker(Module, key="taker", title="Taker", group="Test"):
    """Takes a picture for radiance."""

    limit: Annotated[float, Param("limit")] = 1.0

    def run(self, image: Image, other: Image | None = None) -> Outputs:
        return Outputs(image if other is None else other)

    @warning
    def unit(self, image: Image) -> Caution | None:
        """A picture in kelvin."""
        CALLS.append("unit")
        return Caution(f"in {image.unit}", "convert it") if image.unit == "K" else None

    @warning
    def size(self, other: Image | None, outputs: Outputs) -> Caution | None:
        """A picture above the limit."""
        rows = outputs.image.rows + (0 if other is None else other.rows)
        return Caution(f"{rows} rows", "cut it") if rows > self.limit else None


class Stricter(Taker, key="stricter", title="Stricter", group="Test"):
    """Takes kelvin, too."""

    @warning
    def unit(self) -> Caution | None:
        """Nothing to warn of."""
        return None


CALLS: list[str] = []
LIBRARY = {each.key: each for each in (Maker, Taker, Stricter)}


def _pixels(work) -> Recipe:
    raise AssertionError("nothing is to be computed")


@pytest.fixture(autouse=True)
def _forget():
    CALLS.clear()


def plan(key="taker", previous=None, **params):
    nodes = {"make": ("maker", {}), "take": (key, params), "after": ("taker", {"limit": 9.0})}
    document = linked_network(nodes, [("make.image", "take.image"), ("take.image", "after.image")])
    return Engine(LIBRARY).plan(document, previous=previous)


def test_they_are_derived_from_the_class():
    found = declaration(Taker).warnings
    assert [(each.name, each.meaning, each.needs) for each in found] == [
        ("unit", "A picture in kelvin.", ("image",)),
        ("size", "A picture above the limit.", ("other", "outputs")),
    ]
    assert declaration(Maker).warnings == ()
    assert declaration(Taker).readouts == ()


def test_each_carries_its_node_and_check_and_what_to_do():
    assert plan().warnings() == [
        Caution("in K", "convert it", "take", "unit"),
        Caution("2 rows", "cut it", "take", "size"),
        Caution("in K", "convert it", "after", "unit"),
    ]
    assert str(plan().warnings()[0]) == "take: in K: convert it"
    assert plan().warnings()[0].text == "in K: convert it"


def test_a_subclass_may_warn_of_less():
    assert [each.check for each in plan("stricter").nodes["take"].warnings] == ["size"]
    assert plan("stricter", limit=2.0).nodes["take"].warnings == ()


def test_they_are_asked_for_once_and_only_when_wanted():
    found = plan()
    assert CALLS == []
    found.warnings()
    found.warnings()
    assert CALLS == ["unit", "unit"]  # of two nodes


def test_they_keep_no_node_from_running_and_are_no_part_of_its_key():
    loud, quiet = plan(limit=1.0), plan(limit=3.0)
    assert loud.errors() == []
    assert loud.output("take.image").key == quiet.output("take.image").key


def test_a_disabled_node_and_one_with_an_error_warn_of_nothing():
    found = plan()
    off = found.network.with_node(replace(found.network.nodes["take"], disabled=True))
    assert Engine(LIBRARY).plan(off).nodes["take"].warnings == ()
    wrong = plan(limit="wrong")
    assert wrong.nodes["take"].error is not None
    assert wrong.warnings() == []


def test_they_pickle():
    (caution, *_) = plan().warnings()
    assert pickle.loads(pickle.dumps(caution)) == caution
