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


def test_pixels_combined_after_the_transform(small):
    small["nodes"]["pixels"]["params"]["factor_x"] = 5  # does not divide the width
    chain = chain_of(small)
    assert chain.combined.nyquist_x == pytest.approx(chain.grid.nyquist_x / 5)


def test_a_viewer_on_the_input_is_not_the_end(small):
    small["nodes"]["look"] = {"module": "examine_image"}
    small["links"].append(["scene.image", "look.image"])
    assert chain_of(small).final == "pixels.image"


def test_a_comparison_is_not_the_end(small):
    small["nodes"]["compare"] = {"module": "compare_images"}
    small["links"] += [["back.image", "compare.image"], ["scene.image", "compare.reference"]]
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


def test_a_network_under_construction_has_its_chain_up_to_the_fault(small):
    """Nodes of unknown modules, with values not allowed, or not wired yet are no stages."""
    small["nodes"] |= {
        "star": {"module": "starlight"},
        "wrong": {"module": "write_image", "params": {"format": "gif"}},
        "loose": {"module": "jitter_mtf"},
    }
    small["links"] += [["pixels.image", "star.image"], ["pixels.image", "wrong.image"]]
    library = standard_library()
    plan = Engine(library).plan(parse_network(json.dumps(small), library=library))
    assert len(plan.errors()) == 3
    chain = find_chain(plan)
    assert chain.final == "pixels.image"
    assert [stage.node for stage in chain.stages] == ["blur", "jitter"]


@pytest.mark.parametrize("binning", ["charge", "digital"])
def test_bins_of_a_focal_plane_are_combined_pixels(small, binning):
    bins = {"binning": binning, "binning_x": 2, "bits": 12, "full_well_e": 1e6}
    small["nodes"]["pixels"] = {"module": "focal_plane", "params": bins}
    small["nodes"]["init"]["params"] |= {"detector_x_um": 30, "detector_y_um": 30, "f_number": 2}
    small["links"].append(["init.context", "pixels.context"])
    chain = chain_of(small)
    assert chain.combined.nyquist_x == pytest.approx(chain.grid.nyquist_x / 2)
    assert chain.combined.nyquist_y == pytest.approx(chain.grid.nyquist_y)
