"""Bars and infinite values of curves as files."""

import csv
from typing import NamedTuple

import numpy as np
import pytest

from app.run.saving import save_value
from core.chain.engine import Engine
from core.chain.wires import Curve, CurveData, Series
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from core.modules.declaration import Module, NodeContext
from linked_network import linked_network
from nodes.input_output.write_matrix import WriteMatrix
from small_library import library_of

NAMES = ("optics, cold", 'detector "A"', "jitter")
BARS = CurveData(
    "Shares",
    "stage",
    "NETD (mK)",
    (
        Series("temporal", np.arange(3.0), np.array([0.1, 20.5, np.inf])),
        Series("fixed", np.arange(3.0), np.array([-1.0, 0.0, 1 / 3])),
    ),
    bars=NAMES,
)
FINITE = CurveData("", "stage", "mK", (Series("a", np.arange(3.0), np.arange(3.0) / 7),), NAMES)
MRTD = CurveData(
    "MRTD",
    "frequency (cyc/mrad)",
    "MRTD (K)",
    (Series("MRTD", np.array([0.5, 1.0]), np.array([0.2, np.inf])),),
    log_y=True,
)


class DrawnOutputs(NamedTuple):
    curve: Curve


def made(_work, *, which):
    return {"bars": BARS, "finite": FINITE, "mrtd": MRTD}[which]


class Drawn(Module, key="drawn", title="Drawn", group="Analysis"):
    """Make a curve."""

    def run(self, here: NodeContext) -> DrawnOutputs:
        """One of three, by the node's name."""
        return DrawnOutputs(Curve(Step.of(made, which=here.node)))


ENGINE = Engine(library_of([Drawn, WriteMatrix]))


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def written(folder, which, name):
    """By the module that writes, and by the command line's `--save`."""
    network = linked_network(
        {which: ("drawn", {}), "out": ("write_matrix", {"path": name})},
        [(f"{which}.curve", "out.image")],
    )
    plan = ENGINE.plan(network, folder=folder)
    work = ENGINE.work(Policy())
    planned = plan.nodes["out"]
    here = NodeContext("out", network.seed, folder)
    for target, write in planned.module.files(planned.inputs, here, work):
        write(target)
    return folder / name, plan, work


@pytest.mark.parametrize("by", ["module", "command line"])
def test_bars_are_written_with_their_names(tmp_path, by):
    path, plan, work = written(tmp_path, "bars", "b.csv")
    if by == "command line":
        path = tmp_path / "saved.csv"
        save_value(plan.output("bars.curve"), path, work, port="bars.curve")
    assert rows_of(path) == [
        ["stage", "temporal", "fixed"],
        [NAMES[0], "0.1", "-1.0"],
        [NAMES[1], "20.5", "0.0"],
        [NAMES[2], "inf", "0.3333333333333333"],
    ]


def test_an_infinite_value_is_written_as_csv(tmp_path):
    path, plan, work = written(tmp_path, "mrtd", "m.csv")
    wanted = [["frequency (cyc/mrad)", "MRTD"], ["0.5", "0.2"], ["1.0", "inf"]]
    assert rows_of(path) == wanted
    save_value(plan.output("mrtd.curve"), tmp_path / "s.csv", work, port="mrtd.curve")
    assert rows_of(tmp_path / "s.csv") == wanted
