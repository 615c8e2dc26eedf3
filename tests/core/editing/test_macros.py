"""Grouping, ungrouping, and what a macro shows: by hand, and the picture is the same to the bit."""

import json

import numpy as np
import pytest

from core.chain.engine import Engine
from core.editing.clipboard import copied, pasted
from core.editing.document import Document
from core.editing.macros import at_level, expose, group, hide, rename_exposed, ungroup
from core.editing.operations import (
    ABSENT,
    exposed_as,
    inside,
    output_toggled,
    remove_nodes,
    rename_node,
    set_parameter,
)
from core.editing.wiring import check_new_wires
from core.errors import NetworkError
from core.evaluation.work import Policy
from core.network.file import format_network, parse_network
from core.network.macro import expanded, unfolded
from core.network.network import Link, Network
from core.network.validation import problems
from region_checks import image_ports

NOISY = ("kodak_kir310", "inframetrics", "poisson_two_panel", "noise_budget")
SMALL = {"width": 64, "height": 64}


@pytest.fixture
def small(shipped):
    """A shipped network on a small scene."""

    def of(name):
        network = shipped[name]
        for node in network.nodes.values():
            for side, size in SMALL.items():
                if node.module == "test_scene":
                    network = network.with_parameter(node.id, side, size)
        return network

    return of


def picture(network, library, port):
    engine = Engine(library)
    plan = engine.plan(expanded(network, library))
    return engine.value(plan, port, engine.work(Policy("double")))


def images(network, library):
    """Ports of the network's pictures."""
    return image_ports(Engine(library).plan(network))


def grouped(network, library, names, name="camera"):
    fresh, operation = group(network, library, names, name)
    return operation.apply(network), fresh


@pytest.mark.parametrize("name", NOISY)
def test_grouping_and_ungrouping_change_no_bit(name, small, library):
    network = small(name)
    order = list(network.order())
    members = [
        each for each in order if network.nodes[each].module not in ("test_scene", "read_image")
    ]
    macro, _ = grouped(network, library, members)
    back = ungroup(macro, library, "camera")[1].apply(macro)
    assert back == network
    noisy = [n for n in members if library[network.nodes[n].module].draws_noise]
    assert noisy
    for port in images(network, library):
        inner = f"camera/{port}" if port.rpartition(".")[0] in members else port
        before = picture(network, library, port)
        assert np.array_equal(before, picture(macro, library, inner))
    renamed = rename_node("camera", "sensor").apply(macro)
    for each in noisy:  # what draws noise says so in the file: another name changes nothing
        assert renamed.nodes["sensor"].macro.nodes[each].noise == each


def test_a_copy_of_a_macro_draws_its_own_noise(small, library):
    network = small("kodak_kir310")
    macro, _ = grouped(network, library, ["electronics"])
    (name,), pasting = pasted(copied(macro, ["camera"], library), macro, library)
    assert name == "camera_2"
    after = pasting.apply(macro)
    assert after.nodes["camera_2"].macro.nodes["electronics"].noise == ""
    links = [
        Link(link.source, link.output, "camera_2", link.input)
        for link in macro.links
        if link.target == "camera"
    ]
    after = parse_network(
        json.dumps(
            json.loads(format_network(after, library=library))
            | {"links": [each.text() for each in (*after.links, *links)]}
        ),
        library=library,
    )
    first = picture(after, library, "camera.image")
    assert not np.array_equal(first, picture(after, library, "camera_2.image"))


def test_a_way_out_and_back_in_is_refused(shipped, library):
    with pytest.raises(NetworkError, match="a path of wires leaves them and returns"):
        group(shipped["kodak_kir310"], library, ["init", "back"])


def test_output_and_mentions_follow_into_a_macro(small, library):
    network = small("kodak_kir310")
    assert network.extra["published"]
    mentioned = {row["from"].rpartition(".")[0] for row in network.extra["published"]}
    macro, _ = grouped(network, library, [each for each in network.nodes if each != "scene"])
    assert mentioned <= set(macro.nodes["camera"].macro.nodes)
    rows = macro.extra["published"]
    assert {row["from"].split("/")[0] for row in rows} == {"camera"}
    assert not problems(macro, library=library)
    marked = output_toggled(network, library, "electronics").apply(network)
    inside, _ = grouped(marked, library, ["electronics"])
    assert inside.marked == ("camera/electronics",)
    assert expanded(inside, library).marked == ("camera/electronics",)
    assert output_toggled(inside, library, "pixels").apply(inside).marked == ("pixels",)
    chip, _ = grouped(network, library, ["pixels", "electronics"])
    assert output_toggled(chip, library, "camera").apply(chip).marked == ("camera/electronics",)


@pytest.fixture
def camera(shipped, library):
    """A document with a macro that shows the relative aperture."""
    network, _ = grouped(shipped["kodak_kir310"], library, ["init", "pupil", "optics"])
    document = Document(network, library=library)
    document.do(expose(document.network, "camera/init", "f_number"))
    return document


def value(document, end):
    node, _, name = end.rpartition(".")
    return expanded(document.network, document.library).nodes[node].params.get(name)


def test_a_parameter_is_exposed_set_renamed_and_hidden(camera):
    assert exposed_as(camera.network, "camera/init", "f_number") == "f_number"
    before = value(camera, "camera/init.f_number")
    camera.do(set_parameter("camera", "f_number", 4.0))
    assert value(camera, "camera/init.f_number") == 4.0
    camera.do(rename_exposed(camera.network, "camera", "f_number", "aperture"))
    assert camera.network.nodes["camera"].params == {"aperture": 4.0}
    camera.do(hide(camera.network, "camera", "aperture", None))
    assert camera.network.nodes["camera"].params == {}
    assert value(camera, "camera/init.f_number") == 4.0
    for _ in range(3):
        camera.undo()
    assert camera.network.nodes["camera"].params == {}
    assert value(camera, "camera/init.f_number") == before


def test_a_value_set_inside_takes_the_place_of_that_outside(camera):
    camera.do(set_parameter("camera", "f_number", 4.0))
    camera.do(set_parameter("camera/init", "f_number", 5.0))
    assert value(camera, "camera/init.f_number") == 5.0
    assert camera.network.nodes["camera"].params == {}
    camera.do(set_parameter("camera", "f_number", 6.0))
    camera.do(set_parameter("camera", "f_number", ABSENT))
    assert value(camera, "camera/init.f_number") == 5.0


def test_exposing_twice_or_renaming_to_a_name_that_is_taken_is_refused(camera):
    with pytest.raises(NetworkError, match=r"already shows camera/init\.f_number as f_number"):
        expose(camera.network, "camera/init", "f_number")
    camera.do(expose(camera.network, "camera/init", "focal_length_mm"))
    with pytest.raises(NetworkError, match="camera already has a parameter f_number"):
        camera.do(rename_exposed(camera.network, "camera", "focal_length_mm", "f_number"))
    with pytest.raises(NetworkError, match="scene is not inside a macro"):
        expose(camera.network, "scene", "width")


def test_removing_inside_takes_ports_wires_and_values_along(camera, library):
    camera.do(set_parameter("camera", "f_number", 4.0))
    text = camera.text()
    camera.do(at_level(("camera",), remove_nodes(("init",))))
    network = camera.network
    assert network.nodes["camera"].params == {}
    assert not [
        link for link in network.links if link.source == "scene" and link.target == "camera"
    ]
    assert "inputs" not in network.nodes["camera"].macro.extra
    camera.undo()
    assert camera.text() == text


def test_removing_deep_inside_takes_the_ports_of_every_macro_around_along(camera, library):
    nested, outer = grouped(camera.network, library, ["camera"], "outer")
    after = at_level((outer, "camera"), remove_nodes(("init", "pupil", "optics"))).apply(nested)
    check_new_wires(Network(nodes=after.nodes), after, library)
    assert not {"inputs", "outputs", "parameters"} & set(after.nodes[outer].macro.extra)
    assert [link for link in nested.links if outer in (link.source, link.target)]
    assert not [link for link in after.links if outer in (link.source, link.target)]


def test_inside_of_what_is_no_macro(camera):
    with pytest.raises(NetworkError, match="back is not a macro"):
        camera.do(inside("back", remove_nodes(("a",))))
    with pytest.raises(NetworkError, match="back is not a macro"):
        ungroup(camera.network, camera.library, "back")


def test_removing_and_renaming_a_macro_follows_mentions_of_its_inside(small, library):
    macro, _ = grouped(small("kodak_kir310"), library, ["electronics", "pixels"])
    rows = [row["from"] for row in macro.extra["published"]]
    assert any(row.startswith("camera/electronics.") for row in rows)
    after = rename_node("camera", "chip").apply(macro)
    assert any(row["from"].startswith("chip/electronics.") for row in after.extra["published"])
    gone = remove_nodes(("camera",))
    assert not [r for r in gone.apply(macro).extra.get("published", ()) if "camera/" in r["from"]]
    assert "camera/electronics" in unfolded(macro).nodes
