"""Each recipe is made once in an evaluation, whatever the store can hold."""

from collections import Counter
from pathlib import Path

import pytest

from app.run.evaluation import TimedWork, evaluate, needed_later, planned
from core.chain.engine import Engine
from core.chain.skipped import skips
from core.evaluation.recipes import Store
from core.evaluation.work import Policy
from core.network.file import load_network
from core.network.network import Network
from linked_network import linked_network
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.library import standard_library

NETWORKS = Path(__file__).parents[3] / "networks"
LIBRARY = standard_library()
SMALL = 256
# The camera needs a large scene, and the sampled pupil of 1996 takes long: its sibling has one too.
# The means of a cube's bands, and the wavelengths that stand for them, are small values that only
# laws read: a store that holds nothing at all makes them anew for each curve.
SPECTRAL = ("dirsig_cube", "swir_camera", "visible_camera")
LEFT_OUT = ("camera_and_sensor", "kodak_kir310_1996", *SPECTRAL)
NAMES = sorted(path.stem for path in NETWORKS.glob("*.json") if path.stem not in LEFT_OUT)


class Counting(TimedWork):
    """Work that counts how often each recipe is computed."""

    def __init__(self, store: Store) -> None:
        super().__init__(Policy(threads=1), store)
        self.times: Counter[str] = Counter()

    def _compute(self, recipe, region=None):
        name = getattr(recipe, "function", type(recipe)).__name__
        self.times[f"{recipe.node}: {name} {recipe.key}"] += 1
        return super()._compute(recipe, region)


def shipped(name: str) -> Network:
    """A shipped network with a small scene, and references of few frames."""
    network = load_network(NETWORKS / f"{name}.json", library=LIBRARY)
    for node in network.nodes.values():
        if node.module == "test_scene":
            network = network.with_parameter(node.id, "width", SMALL)
            network = network.with_parameter(node.id, "height", SMALL)
        if node.module == "nuc":
            network = network.with_parameter(node.id, "reference_frames", 2)
    return network


@pytest.mark.thorough(but=4)
@pytest.mark.parametrize("name", NAMES)
def test_with_a_store_of_one_byte(name):
    store = Store(capacity_bytes=1)
    engine = Engine(LIBRARY, store)
    plan = planned(engine, shipped(name), NETWORKS)
    work = Counting(store)
    with work.hold(needed_later(plan, [], report=False)):
        evaluate(engine, plan, work)
        skips(plan, work)
    assert {name: count for name, count in work.times.items() if count > 1} == {}
    assert len(work.times) > 5
    assert store.used_bytes <= 1


def test_with_what_reports_show():
    from app.report.report_facts import report_facts

    store = Store(capacity_bytes=1)
    engine = Engine(LIBRARY, store)
    plan = planned(engine, shipped("kodak_kir310"), NETWORKS)
    work = Counting(store)
    with work.hold(needed_later(plan, [], report=True)):
        found = evaluate(engine, plan, work)
        report_facts(found, skips(plan, work))
    assert {name: count for name, count in work.times.items() if count > 1} == {}
    assert store.used_bytes <= 1


# --- long networks ---

LONG = 300


def test_pictures_in_series():
    """Each is made of the one before: no recursion is as deep as the chain."""
    scene = {"kind": "uniform", "width": 8, "height": 8}
    nodes = {"scene": ("test_scene", scene)}
    nodes |= {f"n{k}": ("poisson_noise", {"percent": 0.01}) for k in range(LONG)}
    engine = Engine(standard_library(), Store(capacity_bytes=1))
    plan = planned(engine, linked_network(nodes), Path())
    work = TimedWork(Policy(threads=1), engine.store)
    image = plan.output(f"n{LONG - 1}.image")
    with work.hold(needed_later(plan, [], report=True)):
        found = evaluate(engine, plan, work)
        noise = work.value(NoiseOf(image))
    assert found.chain.final == f"n{LONG - 1}.image"
    assert len(noise.terms) == LONG
    assert len(transfer_of(image).stages) == 0
    assert noise_free(image.recipe).key != image.key
    assert engine.store.pinned == 0
