"""Which picture is the final one, and which stages lead to it."""

import json

import pytest

from app.run.transfer_chain import find_chain
from core.chain.engine import Engine
from core.errors import NetworkError
from core.network.file import parse_network
from nodes.library import standard_library


def chain_of(document):
    return find_chain(plan_of(document))


def plan_of(document):
    library = standard_library()
    plan = Engine(library).plan(parse_network(json.dumps(document), library=library))
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
