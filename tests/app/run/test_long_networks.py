"""Networks of hundreds of modules in series: evaluated, budgeted and shown."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from app.report.drawing.curves import drawn_stages
from app.report.drawing.picture_drawing import MOST_DRAWN
from app.report.html_page import of_many
from app.run.evaluation import TimedWork, evaluate, needed_later, planned
from app.run.responses import Response, Responses, StageResponse
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.evaluation.store import Store
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


def stage(number: int) -> StageResponse:
    line = Response(np.full(5, 1.0 - 0.001 * number), np.zeros(5))
    return StageResponse(f"n{number}", "Blur", line, line)


def test_of_many_stages_those_are_drawn_that_do_most():
    axis = np.arange(5.0)
    many = Responses(axis, axis, tuple(stage(number) for number in range(60)), (), ())
    drawn = drawn_stages(many, "mtf")
    assert [each.name for each in drawn] == [f"n{number}" for number in range(36, 60)]
    assert drawn_stages(many, "ptf") == []
    assert str(MOST_DRAWN) in of_many(59)
    assert "59" in of_many(59)
    assert of_many(MOST_DRAWN) == ""
