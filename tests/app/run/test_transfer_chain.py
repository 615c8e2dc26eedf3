"""Which picture is the final one, and which stages lead to it."""

import json
from pathlib import Path

import pytest

from app.run.transfer_chain import find_chain, find_output, how_to_choose
from core.chain.engine import Engine
from core.errors import NetworkError
from core.network.file import parse_network
from core.network.validation import problems
from nodes.library import standard_library


def chain_of(document):
    return find_chain(plan_of(document))


def plan_of(document):
    network = parse_network(json.dumps(document), library=LIBRARY)
    plan = Engine(LIBRARY).plan(network, folder=ROOT / "networks")
    assert not plan.errors()
    return plan


def test_a_plain_chain(small):
    chain = chain_of(small)
    assert chain.final == "pixels.image"
    assert chain.sources == ("scene.image",)
    assert [stage.node for stage in chain.stages] == ["blur", "jitter"]
    assert (chain.grid.rows, chain.grid.columns) == (40, 48)
    assert chain.combined.nyquist_x == pytest.approx(chain.grid.nyquist_x / 2)


def test_only_combined_pixels_count_as_such(small):
    del small["nodes"]["pixels"], small["links"][-1]
    small["nodes"]["grabber"] = {"module": "interpolate", "params": {"width": 24, "height": 20}}
    small["links"].append(["back.image", "grabber.image"])
    chain = chain_of(small)
    assert chain.final == "grabber.image"
    assert chain.combined is None


def test_a_viewer_on_the_input_is_not_the_end(small):
    small["nodes"]["look"] = {"module": "examine_image"}
    small["links"].append(["scene.image", "look.image"])
    assert chain_of(small).final == "pixels.image"


def test_the_network_may_name_it(small):
    assert chain_of(small | {"final": "back.image"}).final == "back.image"
    for wrong in ("back.picture", "init.magnitude", "nothing.image", 3):
        with pytest.raises(NetworkError, match="final"):
            chain_of(small | {"final": wrong})


def test_stages_of_another_branch_are_beside(small):
    small["nodes"]["other"] = {"module": "jitter_mtf"}
    small["links"] += [["init.context", "other.context"], ["init.magnitude", "other.magnitude"]]
    chain = chain_of(small)
    assert [stage.node for stage in chain.stages] == ["blur", "jitter"]
    assert [stage.node for stage in chain.beside] == ["other"]


def test_without_an_inverse_transform_stages_have_no_product(small):
    del small["nodes"]["back"], small["nodes"]["pixels"]
    small["links"] = small["links"][:5]
    chain = chain_of(small)
    assert not chain.cascade
    assert [stage.node for stage in chain.stages] == ["blur", "jitter"]
    assert chain.final == "scene.image"


# Which picture a network delivers: the marked one, else the only one there can be.


ROOT = Path(__file__).parents[3]
LIBRARY = standard_library()


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
