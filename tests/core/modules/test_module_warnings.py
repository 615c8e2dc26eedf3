"""How a module's warnings are declared, asked for and gathered."""

from typing import Annotated, NamedTuple

import numpy as np
import pytest

from core.chain.engine import Engine
from core.chain.wires import Image
from core.errors import ParameterError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Policy
from core.modules.declaration import Module, warning
from core.modules.parameters import Caution, Param, PendingCheck
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


class Failing(Module, key="failing", title="Failing", group="Test"):
    """Its checks fail themselves."""

    how: Annotated[str, Param("at what")] = "index"
    seen: Annotated[bool, Param("with samples")] = False

    def run(self, image: Image) -> Outputs:
        return Outputs(image)

    @warning
    def broken(self, image: Image) -> Caution | Recipe | None:
        """Never comes to an end."""
        if self.seen:
            return Step.of(_failing, image.recipe, how=self.how)
        raise FAULTS[self.how]

    @warning
    def sound(self, given: frozenset[str]) -> Caution | None:
        """What the network sets."""
        return Caution(f"sets {', '.join(sorted(given))}", "set less")


class Looking(Maker, key="looking", title="Looking", group="Test"):
    """Looks at its samples."""

    level: Annotated[float, Param("level")] = 1.0

    def run(self) -> Outputs:
        return Outputs(Image(Step.of(_level, level=self.level), 2, 2))

    @warning
    def bright(self, outputs: Outputs) -> Recipe:
        """A mean above 10."""
        return Step.of(_bright, outputs.image.recipe)


def _level(work, *, level):
    CALLS.append("level")
    return np.full((2, 2), level)


def _bright(work, samples):
    mean = float(samples.mean())
    return Caution(f"mean {mean:g}", "dim it") if mean > 10 else None


def _failing(work, samples, *, how):
    raise FAULTS[how]


FAULTS = {
    "index": IndexError("tuple index\nout of range"),
    "parameter": ParameterError("width", 3, "2"),
}
CALLS: list[str] = []
LIBRARY = {each.key: each for each in (Maker, Taker, Stricter, Failing, Looking)}


def _pixels(work) -> Recipe:
    raise AssertionError("nothing is to be computed")


@pytest.fixture(autouse=True)
def _forget():
    CALLS.clear()


def plan(key="taker", previous=None, **params):
    nodes = {"make": ("maker", {}), "take": (key, params), "after": ("taker", {"limit": 9.0})}
    document = linked_network(nodes, [("make.image", "take.image"), ("take.image", "after.image")])
    return Engine(LIBRARY).plan(document, previous=previous)


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


def failing(first="looking", level=3.0, **params):
    nodes = {"make": (first, {"level": level} if level else {}), "bad": ("failing", params)}
    return Engine(LIBRARY), linked_network(nodes, [("make.image", "bad.image")])


@pytest.mark.parametrize("seen", [False, True])
@pytest.mark.parametrize(
    ("how", "line"),
    [
        (
            "index",
            "the check 'broken' failed (IndexError: tuple index out of range), so its warning may "
            "be missing",
        ),
        ("parameter", "the check 'broken' could not run: width = 3 is not allowed: must be 2"),
    ],
)
def test_a_check_that_fails_is_a_warning_of_its_node_and_keeps_nothing_from_running(
    how, line, seen
):
    engine, network = failing(how=how, seen=seen)
    found = engine.plan(network)
    assert found.errors() == []
    broken, sound = engine.warnings(found, engine.work(Policy()))
    assert (broken.node, broken.check, broken.message) == ("bad", "broken", line)
    assert (sound.check, sound.message) == ("sound", "sets how, seen")
    assert [each.check for each in found.warnings()] == ([] if seen else ["broken"]) + ["sound"]


@pytest.mark.parametrize(("level", "lines"), [(10.0, []), (11.0, ["make: mean 11. Dim it"])])
def test_a_check_of_samples_is_planned_and_made_when_asked_for(level, lines):
    engine = Engine(LIBRARY)
    network = linked_network({"make": ("looking", {"level": level})}, [])
    found, work = engine.plan(network), engine.work(Policy())
    (pending,) = found.checks()
    assert isinstance(pending, PendingCheck)
    assert (pending.node, pending.check, found.warnings()) == ("make", "bright", [])
    assert engine.warnings(found, work, known_only=True) == []
    assert CALLS == []
    assert list(map(str, engine.warnings(found, work))) == lines
    assert list(map(str, engine.warnings(found, work, known_only=True))) == lines
    assert CALLS == ["level"]
