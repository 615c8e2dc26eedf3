"""What the engine makes of a drawn network beside what the slow reference does."""

import json
from dataclasses import replace
from typing import Any

import numpy as np

from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.network import Link, Network, Node
from drawn_networks import CAMERA, Drawn, frames
from module_defaults import DEFAULTS
from nodes.analysis.lineage import noise_free
from nodes.library import standard_library
from slow_reference.network import IllConditionedError, Picture, SlowReference

LIBRARY = standard_library()
TOLERANCE = {"double": 1e-12, "single": 2e-6}


class UndecidedError(Exception):
    """A quantizer on the way stood at the turn between two levels: either is right."""


class Comparison:
    """An engine and a slow reference over the same frames."""

    def __init__(self, folder, sizes, kind=np.longdouble, **policy: Any) -> None:
        self.folder, self.policy = folder, policy
        files = frames(sizes)
        for name, samples in files.items():
            np.save(folder / name, samples)
        self.arrays = {name: samples.astype(kind) for name, samples in files.items()}
        self.names: dict[Any, list[str]] = {
            size: [n for n in files if n.endswith(f"_{size[0]}x{size[1]}.npy")] for size in sizes
        }
        self.names["pupil", 0] = [name for name in files if name.startswith("pupil")]
        self.engine = Engine(LIBRARY)

    def expected(self, document: dict[str, Any]) -> Picture:
        """By the slow reference; IllConditionedError where there is no right number."""
        nodes = {
            name: {**node, "params": {**DEFAULTS[node["module"]], **node["params"]}}
            for name, node in document["nodes"].items()
        }
        slow = SlowReference({**document, "nodes": nodes}, self.arrays)
        return slow.value(document["last"])

    def found(self, document: dict[str, Any], *precisions: str, **policy: Any) -> list[np.ndarray]:
        plan = self.engine.plan(network_of(document), folder=self.folder)
        assert plan.errors() == []
        works = [
            self.engine.work(Policy(precision=one, **self.policy, **policy)) for one in precisions
        ]
        if any(node["module"] in CAMERA for node in document["nodes"].values()):
            without = noise_free(plan.output(document["last"]).recipe)
            return [work.value(without) for work in works]
        return [self.engine.value(plan, document["last"], work) for work in works]


def network_of(document: dict[str, Any]) -> Network:
    return Network(
        nodes={
            name: Node(name, node["module"], node["params"], disabled="disabled" in node)
            for name, node in document["nodes"].items()
        },
        links=tuple(Link.between(*link) for link in document["links"]),
    )


def error(found: np.ndarray, expected: Picture, precision: str) -> float:
    """Largest difference over the tolerance times the scale; beside a turn, either level will do.

    Raises
    ------
    UndecidedError
        If another step followed a quantizer that stood at a turn.
    """
    allowed = TOLERANCE[precision] * expected.scale
    for choice in expected.decisions:
        near = TOLERANCE[precision] * choice.scale
        if choice.step > near / 10 and choice.distance.min() <= near:
            raise UndecidedError
    assert found.shape == expected.samples.shape
    difference = np.abs(found - expected.samples)
    if expected.last is not None:
        either = expected.last.distance <= allowed
        turned = np.minimum(difference, np.abs(difference - expected.last.step))
        difference = np.where(either, turned, difference)
        if expected.last.step <= allowed:
            difference = difference - expected.last.step
    return float(np.max(difference, initial=0) / allowed) if allowed else float(difference.max())


def fault(comparison: Comparison, drawn: Drawn) -> tuple[str, str] | None:
    """What is wrong with a network: of which kind, and in words."""
    document = drawn.document()
    try:
        expected = comparison.expected(document)
    except IllConditionedError:
        return None
    for precision in TOLERANCE:
        try:
            (found,) = comparison.found(document, precision)
            size = error(found, expected, precision)
        except UndecidedError:
            continue
        except Exception as failure:
            return f"{failure!r:.60}", f"{precision}: {failure!r}"
        if not size <= 1:
            return "number", f"{precision}: {size:.3g} times the tolerance"
    return None


def reduced(comparison: Comparison, drawn: Drawn) -> str:
    """The fault with as few modules as still show one of its kind, and that network's text."""
    found = fault(comparison, drawn) or ("", "not again when tried alone")
    smaller = bool(found[0])
    while smaller:
        smaller = False
        for place in range(len(drawn.items)):
            less = replace(drawn, items=drawn.items[:place] + drawn.items[place + 1 :])
            try:
                other = fault(comparison, less)
            except Exception:
                continue  # what is left over makes no network
            if other and other[0] == found[0]:
                drawn, found, smaller = less, other, True
                break
    return f"{found[1]}\n{json.dumps(drawn.document(), ensure_ascii=False)}"
