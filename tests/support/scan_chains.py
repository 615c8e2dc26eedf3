"""Chains of a wide line scanner that end in Back Transform and in Line by Line."""

import math

import numpy as np

from core.chain.engine import Engine
from core.evaluation.work import Policy
from delivered_chains import LIBRARY
from linked_network import in_order, linked_network
from scan_truth import ACROSS, ALONG, INIT, PUPILS, STAGES

EXACT = Policy(precision="double", tolerance=0.0)
CHAINS = {
    "separable": ("blur", "pixel"),
    "phase": ("blur", "left", "late"),
    "optics": ("optics", "pixel"),
    "optics and phase": ("optics", "pixel", "left", "late"),
    "line smear": ("smear", "blur"),
    "line smear and phase": ("smear", "pixel", "left", "late"),
}
DEFAULT_CHAINS = {**CHAINS, "coma and phase": ("coma", "left", "late"), "nothing": ()}


def network(stages, shape, edges="reflect", init=None, **params):
    """A picture file through the stages, to Back Transform and to Line by Line."""
    fields = {"fov_x_deg": math.degrees(ACROSS * shape[1]) / 1000,
              "fov_y_deg": math.degrees(ALONG * shape[0]) / 1000}  # fmt: skip
    nodes = {
        "file": ("read_image", {"path": "in.npy"}),
        "init": ("init_trans", {**INIT, **fields, "edges": edges, **(init or {})}),
    }
    for stage in stages:
        if stage in PUPILS:
            nodes[f"{stage} pupil"] = ("exit_pupil", PUPILS[stage])
        nodes[stage] = STAGES[stage]
    nodes |= {"back": ("back_transform", {}), "lines": ("line_by_line", params)}
    return linked_network(nodes, in_order(nodes, LIBRARY))


def planned(folder, picture, document):
    np.save(folder / "in.npy", picture)
    engine = Engine(LIBRARY)
    plan = engine.plan(document, folder=folder)
    assert plan.errors() == []
    return engine, plan


def values(folder, picture, stages, ports=("image",), policy=EXACT, **settings):
    engine, plan = planned(folder, picture, network(stages, picture.shape, **settings))
    work = engine.work(policy)
    return tuple(engine.value(plan, port if "." in port else f"lines.{port}", work)
                 for port in ports)  # fmt: skip
