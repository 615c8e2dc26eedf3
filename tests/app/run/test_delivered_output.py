"""Which picture a network delivers: the marked one, else the only one there can be."""

import json
from pathlib import Path

import pytest

from app.run.transfer_chain import find_chain, find_output, how_to_choose
from core.chain.engine import Engine
from core.errors import NetworkError
from core.network.file import parse_network
from core.network.validation import problems
from nodes.library import standard_library

ROOT = Path(__file__).parents[3]
LIBRARY = standard_library()


def plan_of(document):
    network = parse_network(json.dumps(document), library=LIBRARY)
    return Engine(LIBRARY).plan(network, folder=ROOT / "networks")


def shipped(name):
    return json.loads((ROOT / "networks" / f"{name}.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", sorted(p.stem for p in (ROOT / "networks").glob("*.json")))
def test_a_picture_dropped_beside_the_chain_changes_nothing(name):
    document = shipped(name)
    before = find_output(plan_of(document)).port
    assert before is not None
    document["nodes"]["dropped"] = {"module": "test_scene", "params": {"width": 64, "height": 48}}
    document["nodes"]["look"] = {"module": "examine_image"}
    document["links"].append(["dropped.image", "look.image"])
    chain = find_chain(plan_of(document))
    assert chain.final == before
    assert chain.missing == find_chain(plan_of(shipped(name))).missing


@pytest.fixture
def two(small):
    """Two ends: the pixels, and noise on a picture of its own."""
    small["nodes"] |= {
        "other": {"module": "test_scene", "params": {"width": 16, "height": 16}},
        "noisy": {"module": "poisson_noise"},
    }
    small["links"].append(["other.image", "noisy.image"])
    return small


def test_of_several_ends_none_is_chosen(two):
    plan = plan_of(two)
    found = find_output(plan)
    assert found.port is None
    assert found.choices == ("pixels.image", "noisy.image")
    assert "pixels.image, noisy.image" in found.missing
    assert how_to_choose(found).startswith(
        "this network ends in 2 pictures (pixels.image, noisy.image)"
    )
    assert "--final NODE.PORT" in how_to_choose(found)
    chain = find_chain(plan)
    assert not chain.cascade
    assert chain.missing == found.missing
    assert [stage.node for stage in chain.stages] == ["blur", "jitter"]  # side by side


def test_a_marked_sink_is_the_picture_it_takes(two):
    two["nodes"]["look"] = {"module": "examine_image", "final": True}
    two["links"].append(["back.image", "look.image"])
    assert find_output(plan_of(two)).port == "back.image"


def test_the_mark_of_a_node_goes_before_that_of_the_network(two):
    two["final"] = "noisy.noise"
    assert find_output(plan_of(two)).port == "noisy.noise"
    two["nodes"]["back"]["final"] = True
    assert find_output(plan_of(two)).port == "back.image"


def test_a_mark_on_what_has_no_picture_is_refused(small):
    small["nodes"]["init"]["final"] = True
    with pytest.raises(NetworkError, match=r"init.*no picture"):
        find_output(plan_of(small))


def test_two_marks_are_refused(two):
    for name in ("pixels", "noisy"):
        two["nodes"][name]["final"] = True
    network = parse_network(json.dumps(two), library=LIBRARY)
    told = "2 nodes are marked as the output (pixels, noisy); only one is allowed"
    assert [str(each) for each in problems(network, library=LIBRARY)] == [told]
    assert problems(network, library=LIBRARY, unfinished=True) == []  # to be mended in the editor
    with pytest.raises(NetworkError, match="2 nodes are marked"):
        find_output(plan_of(two))
