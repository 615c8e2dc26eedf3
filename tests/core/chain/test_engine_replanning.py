"""Planning again from an earlier plan: what has not changed is taken over."""

from dataclasses import replace

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import UnconnectedError
from core.evaluation.work import Policy
from core.network.file import load_network
from nodes.library import standard_library


@pytest.fixture
def opened(request):
    library = standard_library()
    folder = request.config.rootpath / "networks"
    network = load_network(folder / "kodak_kir310.json", library=library)
    network = network.with_parameter("scene", "width", 64).with_parameter("scene", "height", 64)
    return Engine(library), network


def test_an_edit_plans_what_hangs_on_it(opened):
    engine, network = opened
    first = engine.plan(network)
    edited = network.with_parameter("aberration", "sigma_x_mrad", 0.3)
    again = engine.plan(edited, previous=first)
    kept = {name for name in network.nodes if again.nodes[name] is first.nodes[name]}
    assert {"scene", "photons", "init", "pupil", "optics", "charge_phase"} <= kept
    assert not kept & {"aberration", "detector", "charge", "back", "pixels", "electronics"}


@pytest.mark.parametrize(
    "edit",
    [
        lambda n: n.with_parameter("electronics", "amplifier_snr", 7),
        lambda n: n.with_seed(5),
        lambda n: replace(n, links=tuple(k for k in n.links if k.target != "slices")),
        lambda n: replace(
            n, nodes={**n.nodes, "charge": replace(n.nodes["charge"], disabled=True)}
        ),
    ],
)
def test_the_result_is_that_of_planning_afresh(opened, edit):
    engine, network = opened
    first = engine.plan(network)
    edited = edit(network)
    afresh, again = engine.plan(edited), engine.plan(edited, previous=first)
    assert [str(e) for e in again.errors()] == [str(e) for e in afresh.errors()]
    if not afresh.errors():
        work = engine.work(Policy())
        port = "frame_grabber.image"
        assert again.output(port).key == afresh.output(port).key
        assert np.isfinite(engine.value(again, port, work)).all()


def test_files_are_looked_at_again(opened, tmp_path):
    engine, network = opened
    path = tmp_path / "in.npy"
    np.save(path, np.ones((4, 5)))
    scene = replace(network.nodes["scene"], module="read_image", params={"path": str(path)})
    reading = replace(network, nodes={**network.nodes, "scene": scene})
    first = engine.plan(reading)
    np.save(path, np.ones((6, 5)))
    again = engine.plan(reading, previous=first)
    assert again.output("scene.image").shape == (6, 5)


def test_nodes_held_back_stay_as_they_were_and_the_rest_builds_on_them(opened):
    engine, network = opened
    first = engine.plan(network)
    held = {"aberration": first.nodes["aberration"]}
    edited = network.with_parameter("aberration", "sigma_x_mrad", 0.3)
    again = engine.plan(edited, previous=first, held=held)
    assert again.network is edited
    assert all(again.nodes[name] is first.nodes[name] for name in network.nodes)
    further = engine.plan(
        edited.with_parameter("charge", "efficiency", 0.9), previous=again, held=held
    )
    assert further.nodes["aberration"] is first.nodes["aberration"]
    own = {factor.node for factor in further.output("back.image").recipe.magnitude.factors}
    assert own >= {"aberration", "charge"}
    assert further.output("back.image").key != first.output("back.image").key
    freed = engine.plan(edited, previous=further)
    assert freed.output("back.image").key == engine.plan(edited).output("back.image").key
    assert freed.output("back.image").key != first.output("back.image").key


def test_an_input_without_a_wire_is_an_error_of_its_own_kind(opened):
    engine, network = opened
    cut = replace(network, links=tuple(k for k in network.links if k.target != "back"))
    plan = engine.plan(cut)
    assert isinstance(plan.nodes["back"].error, UnconnectedError)
    assert str(plan.nodes["back"].error) == "back: input magnitude is not connected"
