"""Random chains and networks."""

import json
from collections import Counter
from dataclasses import replace
from random import Random
from typing import Any

import numpy as np
import pytest

from chain_runs import arrays_of
from core.chain.engine import Engine
from core.evaluation.work import Policy
from drawn_networks import (
    CAMERA,
    LARGE,
    ON_PICTURE,
    ON_SPECTRUM,
    SMALL,
    Drawn,
    drawn,
    frames,
    network_of,
)
from module_defaults import DEFAULTS
from nodes.analysis.lineage import noise_free
from nodes.library import standard_library
from slow_reference.network import IllConditionedError, Picture, SlowReference
from thorough import examples

LIBRARY = standard_library()
TOLERANCE = {"double": 1e-12, "single": 2e-6}


class UndecidedError(Exception):
    """A quantizer on the way stood at the turn between two levels: either is right."""


class Comparison:
    """An engine and a slow reference over the same frames."""

    def __init__(self, folder, sizes, kind=np.longdouble, **policy: Any) -> None:
        self.folder, self.policy = folder, policy
        files, self.names = frames(folder, sizes)
        self.arrays = {name: samples.astype(kind) for name, samples in files.items()}
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


NETWORKS, CHUNKS = 2000, 8
LARGEST_SHARE = 0.05  # of networks left out


def check(comparison: Comparison, networks: list[Drawn]) -> None:
    """Every network in both precisions; the first one at fault is reduced."""
    left_out: Counter[str] = Counter()
    for number, network in enumerate(networks):
        document = network.document()
        try:
            expected = comparison.expected(document)
        except IllConditionedError:
            left_out.update(TOLERANCE)
            continue
        try:
            found = comparison.found(document, *TOLERANCE)
        except Exception:
            pytest.fail(f"network {number}: {reduced(comparison, network)}")
        for precision, one in zip(TOLERANCE, found, strict=True):
            try:
                right = error(one, expected, precision) <= 1
            except UndecidedError:
                left_out[precision] += 1
                continue
            assert right, f"network {number}: {reduced(comparison, network)}"
    assert max(left_out.values(), default=0) <= LARGEST_SHARE * len(networks) + 5, left_out


@pytest.mark.thorough(but=2)
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_small_frames_are_as_the_direct_sums_say(tmp_path, chunk):
    comparison = Comparison(tmp_path, SMALL, threads=1)
    random = Random(f"small frames {chunk}")
    networks = [drawn(random, comparison.names) for _ in range(NETWORKS // CHUNKS)]
    keys = {item.key for network in networks for item in network.items}
    assert keys == {*ON_SPECTRUM, *ON_PICTURE}
    check(comparison, networks)


@pytest.mark.parametrize("size", LARGE, ids=str)
def test_frames_of_several_blocks_are_as_the_direct_sums_say(tmp_path, size, request):
    """The sums in double precision; their own rounding is a hundredth of the tolerance."""
    comparison = Comparison(tmp_path, [size], kind=np.float64, threads=2)
    random = Random(f"large frames {size}")
    count = 10 if request.config.option.thorough else 4
    check(comparison, [drawn(random, comparison.names, most=5) for _ in range(count)])


def extremes(shape: tuple[int, int]) -> dict[str, np.ndarray]:
    """Pictures of every kind; some stand at the ends of what numbers can be."""
    random = np.random.default_rng(7)
    uniform = random.uniform(20, 60, shape)
    point = np.arange(uniform.size).reshape(shape) == uniform.size // 2
    return {
        "scene": uniform,
        "constant": np.full(shape, 37.25),
        "zero": np.zeros(shape),
        "huge": 1e30 * uniform,
        "tiny": 1e-30 * uniform,
        "edge of single": 5e36 * uniform,
        "edge of double": 2.9e306 * uniform,
        "least": 5e-324 * np.rint(uniform),
        "wide": 10.0 ** random.uniform(-6, 6, shape),
        "negative": uniform - 45.0,
        "below zero": -uniform,
        "point": point.astype(float),
    }


@pytest.mark.parametrize("kind", extremes((1, 1)))
def test_extreme_pictures(tmp_path, kind):
    """Noise of photons is added to the drawn network's picture, too."""
    files, names = frames(tmp_path, SMALL)
    for name, samples in files.items():
        if name not in names["pupil", 0]:
            np.save(tmp_path / name, extremes(samples.shape)[kind])
    random, engine = Random(f"extreme pictures {kind}"), Engine(LIBRARY)
    for _ in range(examples(25)):
        document = drawn(random, names).document()
        document["nodes"]["photons"] = {"module": "poisson_noise", "params": {"percent": 10}}
        document["links"].append([document["last"], "photons.image"])
        arrays_of(network_of(document), tmp_path, random.choice([*TOLERANCE]), engine)
