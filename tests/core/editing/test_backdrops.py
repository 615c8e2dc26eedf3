"""Backdrops, and laying out that keeps them round their nodes."""

import itertools
import json
from dataclasses import replace
from random import Random

import pytest

from core.editing.backdrops import (
    Backdrop,
    add,
    around,
    backdrops_of,
    change,
    following,
    laid_out,
    nodes_on,
    remove,
)
from core.editing.layout import arranged, boxes_of
from core.editing.operations import move_nodes
from core.errors import NetworkError
from core.network.network import Link, Network, Node

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
    with pytest.raises(NetworkError, match="select the nodes"):
        around(replace(kodak, layout={}), ["init"], {})


def _row(**layout):
    nodes = {name: Node(name, "jitter_mtf") for name in layout}
    made = Network(nodes=nodes, layout={name: (x, 0.0) for name, x in layout.items()})
    sizes = dict.fromkeys(layout, (100.0, 60.0))
    return around(made, ["a", "b"], sizes, "Optics").apply(made), sizes


@pytest.mark.parametrize(
    ("places", "moved", "grown"),
    [
        ({"a": 60.0, "b": 200.0}, 60.0, 0.0),  # all alike: it goes with them
        ({"b": 225.0, "far": 480.0}, 0.0, 85.0),
        ({"a": 30.0, "b": 225.0}, 30.0, 55.0),  # it begins where its first node goes
    ],
)
def test_a_backdrop_follows_its_nodes_that_are_pushed(places, moved, grown):
    network, sizes = _row(a=0.0, b=140.0, far=400.0)
    (before,) = backdrops_of(network)
    points = {name: (x, 0.0) for name, x in places.items()}
    after = following(network, points, sizes).apply(network)
    new = replace(before, x=before.x + moved, width=before.width + grown)
    assert backdrops_of(after) == (new,)
    assert set(nodes_on(move_nodes(points).apply(after), 0, sizes)) == {"a", "b"}


SIZE = (180.0, 120.0)
ROOM = (900.0, 600.0)


def sizes_of(network):
    return dict.fromkeys(network.nodes, SIZE)


def overlapping(network):
    boxes = boxes_of(network.layout, sizes_of(network)).values()
    return [
        (a, b)
        for a, b in itertools.combinations(boxes, 2)
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
    ]


def held(network):
    """Which nodes stand on which backdrop."""
    sizes = sizes_of(network)
    return [set(nodes_on(network, k, sizes)) for k in range(len(backdrops_of(network)))]


def chain(count, extra=0, seed=0):
    """A chain in which the first node also feeds some of the others."""
    random = Random(seed)
    names = [f"n{k}" for k in range(count)]
    links = [Link(a, "out", b, "in") for a, b in itertools.pairwise(names)]
    links += [Link("n0", "context", random.choice(names[1:]), f"c{k}") for k in range(extra)]
    layout = {name: (240.0 * k, 0.0) for k, name in enumerate(names)}
    return Network(
        "chain", nodes={n: Node(n, "x") for n in names}, links=tuple(links), layout=layout
    )


def zoom(network, room):
    """How large the whole can be shown."""
    left, top, right, bottom = zip(
        *boxes_of(network.layout, sizes_of(network)).values(), strict=True
    )
    return min(room[0] / (max(right) - min(left)), room[1] / (max(bottom) - min(top)))


@pytest.mark.parametrize("count", [12, 40, 200])
@pytest.mark.parametrize("room", [ROOM, (1000.0, 250.0), (300.0, 900.0)])
def test_a_long_chain_is_broken_to_the_shape_of_the_canvas(count, room):
    network = chain(count, extra=count // 2)
    in_one_row = move_nodes(arranged(network, sizes_of(network))).apply(network)
    in_rows = move_nodes(arranged(network, sizes_of(network), room=room)).apply(network)
    assert overlapping(in_rows) == []
    assert zoom(in_rows, room) > 1.5 * zoom(in_one_row, room)
    # In the order of reading: each wire of the chain to the right, or to the next row.
    for k in range(count - 1):
        (x, y), (x2, y2) = in_rows.layout[f"n{k}"], in_rows.layout[f"n{k + 1}"]
        assert x2 > x + SIZE[0] or y2 > y + SIZE[1]


@pytest.mark.parametrize("room", [None, ROOM, (2000.0, 300.0)])
def test_shipped_networks_keep_their_stages(shipped, library, room):
    for name, network in shipped.items():
        sizes = sizes_of(network)
        before = held(network)
        operation = laid_out(network, sizes, room)
        after = operation.apply(network)
        assert held(after) == before, name
        assert overlapping(after) == [], name
        again = laid_out(after, sizes, room).apply(after)
        assert again.layout == after.layout, name


def test_grounds_on_grounds_and_empty_ones():
    network = chain(8)
    for title, first, last, margin in (
        ("outer", 1, 5, 90),
        ("inner", 2, 3, 40),
        ("later", 6, 7, 40),
    ):
        x = 240.0 * first - margin
        width = 240.0 * (last - first) + SIZE[0] + 2 * margin
        network = add(network, Backdrop(title, x, -margin - 10.0, width, 300.0)).apply(network)
    network = add(network, Backdrop("empty", 9000, 9000, 100, 100)).apply(network)
    before = held(network)
    assert before == [{f"n{k}" for k in range(1, 6)}, {"n2", "n3"}, {"n6", "n7"}, set()]
    for room in (None, ROOM):
        after = laid_out(network, sizes_of(network), room).apply(network)
        assert held(after) == before
        assert overlapping(after) == []
        outer, inner, _, empty = backdrops_of(after)
        assert outer.y < inner.y
        assert outer.x < inner.x
        assert inner.x + inner.width < outer.x + outer.width
        assert (empty.x, empty.y) == (9000, 9000)
