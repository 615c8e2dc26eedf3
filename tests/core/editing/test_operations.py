"""What each operation does to a network: the values written here come from no operation."""

import json

import pytest

from core.editing.clipboard import copied, duplicated, pasted
from core.editing.document import Document
from core.editing.operations import (
    add_nodes,
    fresh_name,
    mark_output,
    output_toggled,
    remove_nodes,
    rename_node,
    rewire,
    set_network_field,
    set_node_field,
    set_parameter,
)
from core.errors import NetworkError
from core.network.file import parse_network
from core.network.network import Link, Network, Node


@pytest.fixture
def network(document, small_library):
    document["final"] = "back.image"
    document["published"] = [
        {"figure": "rms", "from": "jitter.sigma", "value": 1},
        {"figure": "level", "from": "look.level", "value": 2},
        {"figure": "of the whole", "value": 3},
    ]
    return parse_network(json.dumps(document), library=small_library)


def test_a_link_that_comes_with_a_node_takes_the_place_of_another(network):
    link = Link("more", "image", "look", "picture")
    adding = add_nodes(((Node("more", "back"), None),), (link,))
    after = adding.apply(network)
    assert [each for each in after.links if each.target == "look"] == [link]


def test_removing_takes_links_points_and_every_mention_along(network):
    after = remove_nodes(("back", "look")).apply(network)
    assert list(after.nodes) == ["scene", "init", "jitter", "add noise"]
    assert not [each for each in after.links if {each.source, each.target} & {"back", "look"}]
    assert "final" not in after.extra
    assert [row["figure"] for row in after.extra["published"]] == ["rms", "of the whole"]
    assert remove_nodes(("init",)).apply(network).layout == {"scene": (0, 0)}


def test_renaming_follows_every_mention(network):
    after = rename_node("back", "to the image").apply(network)
    assert list(after.nodes)[3] == "to the image"
    assert Link("to the image", "image", "add noise", "image") in after.links
    assert Link("jitter", "magnitude", "to the image", "magnitude") in after.links
    assert after.extra["final"] == "to the image.image"
    moved = rename_node("jitter", "shake").apply(network)
    assert [row.get("from") for row in moved.extra["published"]] == [
        "shake.sigma",
        "look.level",
        None,
    ]
    assert rename_node("init", "trans").apply(network).layout["trans"] == (220, -12.5)


@pytest.mark.parametrize("new", ["init", "a.b", "", "a=b", "line\nbreak", "\ud800"])
def test_names_that_are_taken_or_not_allowed_are_refused(network, new):
    with pytest.raises(NetworkError):
        rename_node("look", new).apply(network)


def test_a_link_that_is_there_stays_one_link(network):
    link = network.links[0]
    assert rewire(add=(link,)).apply(network) == network


def test_a_link_that_is_not_there_cannot_be_taken_away(network):
    with pytest.raises(NetworkError, match=r"there is no link scene\.image → look\.picture"):
        rewire(remove=(Link("scene", "image", "look", "picture"),)).apply(network)


@pytest.mark.parametrize(
    "value", [float("nan"), float("-inf"), [1, {"a": float("nan")}], "\ud800", {1}, b"x"]
)
def test_what_no_file_can_hold_is_refused_when_it_is_set(network, value):
    """Else it would be in the document, and every attempt to save would fail."""
    for operation in (
        set_parameter("init", "focal_length_mm", value),
        set_node_field("init", "note", value),
        set_network_field("note", value),
        set_network_field("description", value),
    ):
        with pytest.raises(NetworkError, match="only finite numbers, strings"):
            operation.apply(network)


@pytest.mark.parametrize(
    ("wanted", "taken", "fresh"),
    [
        ("jitter", [], "jitter"),
        ("jitter", ["jitter"], "jitter_2"),
        ("jitter", ["jitter", "jitter_2"], "jitter_3"),
        ("jitter_2", ["jitter_2"], "jitter_3"),
        ("jitter_5", ["jitter_5"], "jitter_2"),
        ("jitter_mtf", ["jitter_mtf"], "jitter_mtf_2"),
        ("_2", ["_2"], "_2_2"),
    ],
)
def test_fresh_names(wanted, taken, fresh):
    assert fresh_name(wanted, taken) == fresh


def marked(network):
    return [name for name, node in network.nodes.items() if node.final]


@pytest.fixture
def fresh(kodak, library):
    """The Kodak network as it was shipped: the network's own field names the output."""
    assert kodak.extra["final"] == "frame_grabber.image"
    return Document(kodak, library=library)


def test_a_mark_takes_the_place_of_every_other(fresh):
    before = fresh.text()
    fresh.do(mark_output(("back",)))
    assert marked(fresh.network) == ["back"]
    assert "final" not in fresh.network.extra
    fresh.do(mark_output(("electronics",)))
    assert marked(fresh.network) == ["electronics"]
    fresh.undo()
    assert marked(fresh.network) == ["back"]
    fresh.undo()
    assert fresh.text() == before
    fresh.redo()
    assert marked(fresh.network) == ["back"]


@pytest.mark.parametrize("name", ["init", "detector"])
def test_what_makes_no_picture_cannot_be_marked(fresh, library, name):
    with pytest.raises(NetworkError, match="it has no picture"):
        output_toggled(fresh.network, library, name)


def test_a_copy_is_not_marked(fresh, library):
    fresh.do(mark_output(("back",)))
    text = copied(fresh.network, ["back", "detector"], library)
    for operation in (
        pasted(text, fresh.network, library)[1],
        duplicated(fresh.network, ["back"], library)[1],
    ):
        assert marked(operation.apply(fresh.network)) == ["back"]
    assert marked(pasted(text, Network(), library)[1].apply(Network())) == []
