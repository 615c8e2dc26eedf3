"""Marking the output: one node at most, undone with the network's own field, never copied."""

from __future__ import annotations

import json

import pytest

from core.editing.copying.clipboard import copied, duplicated, pasted
from core.editing.document import Document
from core.editing.nodes import Remove, Rename
from core.editing.output_mark import SetOutput, output_toggled
from core.errors import NetworkError
from core.network.file import format_network, parse_network
from core.network.network import Network


def marked(network):
    return [name for name, node in network.nodes.items() if node.final]


@pytest.fixture
def fresh(kodak, library):
    """The Kodak network as it was shipped: the network's own field names the output."""
    assert kodak.extra["final"] == "frame_grabber.image"
    return Document(kodak, library=library)


def test_the_networks_own_field_counts_as_a_mark(fresh):
    assert fresh.network.output_nodes == ("frame_grabber",)
    assert marked(fresh.network) == []


def test_a_mark_takes_the_place_of_every_other(fresh):
    before = fresh.text()
    fresh.do(SetOutput(("back",)))
    assert marked(fresh.network) == ["back"]
    assert "final" not in fresh.network.extra
    fresh.do(SetOutput(("electronics",)))
    assert marked(fresh.network) == ["electronics"]
    fresh.undo()
    assert marked(fresh.network) == ["back"]
    fresh.undo()
    assert fresh.text() == before
    fresh.redo()
    assert marked(fresh.network) == ["back"]


def test_it_stands_in_the_file_beside_the_parameters(fresh, library):
    fresh.do(SetOutput(("back",)))
    node = json.loads(fresh.text())["nodes"]["back"]
    assert node == {"module": "back_transform", "final": True}
    read = parse_network(fresh.text(), library=library)
    assert marked(read) == ["back"]
    assert format_network(read, library=library) == fresh.text()


@pytest.mark.parametrize("wrong", [1, "true", None])
def test_only_true_or_false_is_a_mark(kodak, library, wrong):
    document = json.loads(format_network(kodak, library=library))
    document["nodes"]["back"]["final"] = wrong
    with pytest.raises(NetworkError, match=r"nodes\.back\.final must be true or false"):
        parse_network(json.dumps(document), library=library)


def test_toggling(fresh, library):
    fresh.do(output_toggled(fresh.network, library, "back"))
    assert marked(fresh.network) == ["back"]
    fresh.do(output_toggled(fresh.network, library, "back"))
    assert marked(fresh.network) == []
    fresh.undo()
    fresh.undo()
    fresh.do(output_toggled(fresh.network, library, "frame_grabber"))  # marked by the network
    assert fresh.network.output_nodes == ()


@pytest.mark.parametrize("name", ["init", "detector"])
def test_what_makes_no_picture_cannot_be_marked(fresh, library, name):
    with pytest.raises(NetworkError, match="makes no picture"):
        output_toggled(fresh.network, library, name)


def test_two_marks_made_by_hand_are_mended_by_one(fresh, library):
    document = json.loads(fresh.text())
    for name in ("back", "electronics"):
        document["nodes"][name]["final"] = True
    network = parse_network(json.dumps(document), library=library)
    operation = output_toggled(network, library, "frame_grabber")
    assert marked(operation.apply(network)) == ["frame_grabber"]


def test_a_copy_is_not_marked(fresh, library):
    fresh.do(SetOutput(("back",)))
    text = copied(fresh.network, ["back", "detector"], library)
    for operation in (
        pasted(text, fresh.network, library)[1],
        duplicated(fresh.network, ["back"], library)[1],
    ):
        assert marked(operation.apply(fresh.network)) == ["back"]
    assert marked(pasted(text, Network(), library)[1].apply(Network())) == []


def test_a_mark_goes_and_comes_with_its_node(fresh):
    fresh.do(SetOutput(("back",)))
    fresh.do(Rename("back", "inverse"))
    assert marked(fresh.network) == ["inverse"]
    fresh.do(Remove(("inverse",)))
    assert marked(fresh.network) == []
    fresh.undo()
    assert marked(fresh.network) == ["inverse"]
    fresh.undo()
    assert marked(fresh.network) == ["back"]
