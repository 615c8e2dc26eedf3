"""Laying out with backdrops and in rows: who stood on a ground stands on it, and no one else."""

from __future__ import annotations

import itertools
from random import Random

import pytest

from core.editing.drawing.backdrops import Backdrop, add, backdrops_of, nodes_on
from core.editing.drawing.laying_out import laid_out
from core.editing.layout.arrange import arranged
from core.editing.layout.boxes import boxes_of
from core.editing.nodes import Move
from core.network.network import Link, Network, Node

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
    in_one_row = Move(arranged(network, sizes_of(network))).apply(network)
    in_rows = Move(arranged(network, sizes_of(network), room=room)).apply(network)
    assert overlapping(in_rows) == []
    assert zoom(in_rows, room) > 1.5 * zoom(in_one_row, room)
    # In the order of reading: each wire of the chain to the right, or to the next row.
    for k in range(count - 1):
        (x, y), (x2, y2) = in_rows.layout[f"n{k}"], in_rows.layout[f"n{k + 1}"]
        assert x2 > x + SIZE[0] or y2 > y + SIZE[1]


def test_what_fits_stays_in_one_row():
    network = chain(3)
    after = arranged(network, sizes_of(network), room=ROOM)
    assert after == arranged(network, sizes_of(network))


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


def test_a_ground_that_a_wire_leaves_and_comes_back_to_goes_round_its_nodes():
    network = chain(4)
    network = Move({"n1": (0.0, 400.0), "n2": (900.0, 900.0), "n3": (240.0, 400.0)}).apply(network)
    network = add(network, Backdrop("both", -50, 350, 600, 200)).apply(network)
    assert held(network) == [{"n1", "n3"}]
    after = laid_out(network, sizes_of(network)).apply(network)
    assert held(after)[0] >= {"n1", "n3"}
    assert overlapping(after) == []


def test_two_hundred_nodes_with_stages_are_laid_out():
    network = chain(200, extra=100)
    for k in range(0, 200, 20):
        ground = Backdrop(f"stage {k}", 240.0 * k - 40, -60, 240.0 * 10, 300)
        network = add(network, ground).apply(network)
    before = held(network)
    after = laid_out(network, sizes_of(network), (1400.0, 400.0)).apply(network)
    assert held(after) == before
    assert overlapping(after) == []
