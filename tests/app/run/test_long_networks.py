"""Networks of hundreds of modules in series: evaluated, budgeted and shown."""

from itertools import pairwise
from pathlib import Path

from app.run.evaluation import TimedWork, evaluate, needed_later, planned
from core.chain.engine import Engine
from core.evaluation.store import Store
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.library import standard_library

LONG = 300


def test_pictures_in_series():
    """Each is made of the one before: no recursion is as deep as the chain."""
    scene = {"kind": "uniform", "width": 8, "height": 8}
    nodes = {"scene": ("test_scene", scene)}
    nodes |= {f"n{k}": ("poisson_noise", {"percent": 0.01}) for k in range(LONG)}
    names = list(nodes)
    links = [(f"{a}.image", f"{b}.image") for a, b in pairwise(names)]
    engine = Engine(standard_library(), Store(capacity_bytes=1))
    plan = planned(engine, linked_network(nodes, links), Path())
    work = TimedWork(Policy(threads=1), engine.store)
    image = plan.output(f"n{LONG - 1}.image")
    with work.hold(needed_later(plan, [], report=True)):
        found = evaluate(engine, plan, work, Path())
        noise = work.value(NoiseOf(image))
    assert found.chain.final == f"n{LONG - 1}.image"
    assert len(noise.terms) == LONG
    assert len(transfer_of(image).stages) == 0
    assert noise_free(image.recipe).key != image.key
    assert engine.store.pinned == 0
