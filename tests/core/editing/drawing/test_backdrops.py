"""Backdrops, as the network's file has them."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from core.editing.document import Document
from core.editing.drawing.backdrops import (
    Backdrop,
    add,
    around,
    backdrops_of,
    change,
    following,
    nodes_on,
    remove,
)
from core.errors import NetworkError
from core.network.file import read_network
from core.network.network import Network, Node

OPTICS = Backdrop("Optics", 700.0, -50.0, 420.0, 300.0)
OF_A_FILE = [
    {"title": "Optics", "x": 1, "y": 2.5, "width": 30, "height": 20, "tint": "blue"},
    "what is this",
    {"title": "no size", "x": 1, "y": 2},
    {"title": 5, "x": 1, "y": 2, "width": 3, "height": 4},
    {"x": True, "y": 2, "width": 3, "height": 4},
    {"x": 1, "y": 2, "width": 0, "height": 4},
    {"x": 1, "y": 2, "width": -3, "height": 4},
    None,
    {"x": -1.5, "y": 0, "width": 3, "height": 4, "title": "Detector"},
    {"x": 5, "y": 5, "width": 5, "height": 5},
]


@pytest.fixture
def network(kodak):
    return replace(kodak, extra={**kodak.extra, "backdrops": OF_A_FILE})


def entries(network):
    text = json.dumps(network.extra["backdrops"], default=dict)
    return json.loads(text)


def test_what_is_no_backdrop_is_passed_over(network):
    assert backdrops_of(network) == (
        Backdrop("Optics", 1.0, 2.5, 30.0, 20.0),
        Backdrop("Detector", -1.5, 0.0, 3.0, 4.0),
        Backdrop("", 5.0, 5.0, 5.0, 5.0),
    )


@pytest.mark.parametrize("strange", [None, 5, "text", {"title": "x"}, [], [[]]])
def test_a_strange_field_has_none(kodak, strange):
    network = replace(kodak, extra={"backdrops": strange})
    assert backdrops_of(network) == ()
    assert backdrops_of(add(network, OPTICS).apply(network)) == (OPTICS,)


def test_no_field_has_none(kodak):
    assert backdrops_of(kodak) == ()


def test_adding(kodak):
    after = add(kodak, OPTICS).apply(kodak)
    assert entries(after) == [{"title": "Optics", "x": 700, "y": -50, "width": 420, "height": 300}]
    assert add(kodak, OPTICS).text == "Add backdrop"


def test_changing_keeps_what_else_the_file_says(network):
    after = change(network, 0, replace(OPTICS, x=0.5)).apply(network)
    assert entries(after)[0] == {
        "title": "Optics", "x": 0.5, "y": -50, "width": 420, "height": 300, "tint": "blue",
    }  # fmt: skip
    assert entries(after)[1:] == OF_A_FILE[1:]


def test_changing_the_second_passes_over_what_is_none(network):
    after = change(network, 1, OPTICS).apply(network)
    assert entries(after)[8] == {
        "title": "Optics", "x": 700, "y": -50, "width": 420, "height": 300,
    }  # fmt: skip
    assert entries(after)[:8] == OF_A_FILE[:8]


def test_removing(network, kodak):
    after = remove(network, 1).apply(network)
    assert entries(after) == OF_A_FILE[:8] + OF_A_FILE[9:]
    one = add(kodak, OPTICS).apply(kodak)
    assert remove(one, 0).apply(one) == kodak  # no empty list is left behind


@pytest.mark.parametrize("index", [-1, 3])
def test_a_backdrop_that_is_not_there(network, index):
    for attempt in (
        lambda: change(network, index, OPTICS),
        lambda: remove(network, index),
        lambda: nodes_on(network, index, {}),
    ):
        with pytest.raises(NetworkError, match="there is no backdrop"):
            attempt()


@pytest.mark.parametrize(
    "changes", [{"x": float("nan")}, {"height": float("inf")}, {"width": 0.0}, {"height": -1.0}]
)
def test_impossible_ones_are_refused(kodak, changes):
    with pytest.raises(NetworkError, match="a backdrop cannot have"):
        add(kodak, replace(OPTICS, **changes))


def test_around_nodes_they_lie_on_it_and_no_others():
    nodes = {name: Node(name, "gone") for name in "abc"}
    layout = {"a": (0.0, 0.0), "b": (300.0, 50.0), "c": (900.0, 0.0)}
    network = Network(nodes=nodes, layout=layout)
    sizes = {"a": (100.0, 80.0), "b": (200.0, 120.0), "c": (100.0, 80.0)}
    after = around(network, ["a", "b"], sizes, "Front").apply(network)
    (ground,) = backdrops_of(after)
    assert ground.title == "Front"
    assert ground.x < 0
    assert ground.y < 0
    assert ground.x + ground.width > 500
    assert ground.y + ground.height > 170
    assert nodes_on(after, 0, sizes) == ("a", "b")
    assert nodes_on(after, 0, {**sizes, "b": (600.0, 120.0)}) == ("a",)  # it juts out


def test_around_nothing(kodak):
    with pytest.raises(NetworkError, match="no nodes"):
        around(replace(kodak, layout={}), ["init"], {})


def test_they_survive_saving_and_undo(network, library, tmp_path):
    document = Document(network, library=library)
    document.do(change(document.network, 2, OPTICS))
    document.do(add(document.network, replace(OPTICS, title="Last")))
    document.save(tmp_path / "a.json")
    again = read_network(tmp_path / "a.json", library=library)
    assert [each.title for each in backdrops_of(again)] == ["Optics", "Detector", "Optics", "Last"]
    assert entries(again)[1:8] == OF_A_FILE[1:8]
    assert again == document.network
    document.undo()
    document.undo()
    assert document.network == network


def _row(**layout):
    nodes = {name: Node(name, "jitter_mtf") for name in layout}
    made = Network(nodes=nodes, layout={name: (x, 0.0) for name, x in layout.items()})
    sizes = dict.fromkeys(layout, (100.0, 60.0))
    return around(made, ["a", "b"], sizes, "Optics").apply(made), sizes


def test_a_backdrop_goes_with_its_nodes_when_all_are_pushed_alike():
    network, sizes = _row(a=0.0, b=140.0, far=400.0)
    (before,) = backdrops_of(network)
    pushed = following(network, {"a": (60.0, 0.0), "b": (200.0, 0.0)}, sizes)
    assert pushed is not None
    assert backdrops_of(pushed.apply(network)) == (replace(before, x=before.x + 60.0),)


def test_a_backdrop_grows_by_what_its_last_node_is_pushed():
    network, sizes = _row(a=0.0, b=140.0, far=400.0)
    (before,) = backdrops_of(network)
    places = {"b": (225.0, 0.0), "far": (480.0, 0.0)}
    pushed = following(network, places, sizes)
    assert pushed is not None
    grown = pushed.apply(network)
    assert backdrops_of(grown) == (replace(before, width=before.width + 85.0),)
    moved = replace(grown, layout={**grown.layout, **places})
    assert set(nodes_on(moved, 0, sizes)) == {"a", "b"}


def test_a_backdrop_stays_where_what_lies_on_it_stays():
    network, sizes = _row(a=0.0, b=140.0, far=400.0)
    assert following(network, {"far": (480.0, 0.0)}, sizes) is None


def test_a_growing_backdrop_begins_where_its_first_node_is_pushed_to():
    network, sizes = _row(a=0.0, b=140.0, far=400.0)
    (before,) = backdrops_of(network)
    pushed = following(network, {"a": (30.0, 0.0), "b": (225.0, 0.0)}, sizes)
    assert pushed is not None
    (after,) = backdrops_of(pushed.apply(network))
    assert after == replace(before, x=before.x + 30.0, width=before.width + 55.0)
