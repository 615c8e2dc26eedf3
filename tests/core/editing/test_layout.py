"""Nodes laid out along their wires, and in line."""

import itertools
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.editing.layout import (
    EDGES,
    GAP_X,
    GAP_Y,
    WAYS,
    aligned,
    arranged,
    boxes_of,
    distributed,
    free_places,
    made_way,
)
from core.editing.operations import move_nodes
from core.network.network import Link, Network, Node
from thorough import examples

SIZES = {"small": (150.0, 60.0), "large": (240.0, 190.0)}


def drawn(random, count, wires):
    """A network without cycles whose nodes are in no particular order."""
    names = [f"n{number}" for number in range(count)]
    random.shuffle(names)
    rank = {name: place for place, name in enumerate(random.sample(names, count))}
    links = set()
    for number in range(wires if count > 1 else 0):
        one, other = sorted(random.sample(names, 2), key=rank.__getitem__)
        links.add(Link(one, "out", other, f"in{number}"))
    layout = {name: (random.uniform(-90, 90), random.uniform(-90, 90)) for name in names[::2]}
    return Network(nodes={n: Node(n, "gone") for n in names}, links=tuple(links), layout=layout)


def boxes(network, sizes):
    return {name: (*network.layout[name], *sizes[name]) for name in network.nodes}


def overlap(one, other):
    return (
        one[0] < other[0] + other[2]
        and other[0] < one[0] + one[2]
        and one[1] < other[1] + other[3]
        and other[1] < one[1] + one[3]
    )


def assert_sound(network, sizes):
    found = boxes(network, sizes)
    for link in network.links:
        assert found[link.source][0] + found[link.source][2] < found[link.target][0], link
    ordered = sorted(found.values())
    for number, one in enumerate(ordered):
        for other in ordered[number + 1 :]:
            assert not overlap(one, other)


@settings(max_examples=examples(150), deadline=None)
@given(seed=st.integers(0, 2**32), count=st.integers(0, 25), wires=st.integers(0, 60))
def test_wires_lead_to_the_right_and_nothing_overlaps(seed, count, wires):
    random = Random(seed)
    network = drawn(random, count, wires)
    sizes = {name: random.choice(list(SIZES.values())) for name in network.nodes}
    after = move_nodes(arranged(network, sizes)).apply(network)
    assert_sound(after, sizes)
    assert after.links == network.links
    again = move_nodes(arranged(after, sizes)).apply(after)
    assert again == after


def test_the_kodak_chain_stays_one_row(kodak):
    """All but what hangs on it, which no row has room for."""
    after = move_nodes(arranged(kodak, {})).apply(kodak)
    beside = {"pupil", "charge_phase", "slices"}
    assert {after.layout[name][1] for name in kodak.nodes if name not in beside} == {0.0}
    assert after.layout["pupil"][0] == after.layout["init"][0]  # right before what it feeds


def test_only_the_chosen_nodes_move(kodak):
    chosen = {"aberration", "detector", "charge"}
    places = arranged(kodak, {}, chosen)
    assert places.keys() == chosen
    after = move_nodes(places).apply(kodak)
    assert after.layout["aberration"] == kodak.layout["aberration"]
    assert {after.layout[name][1] for name in chosen} == {kodak.layout["detector"][1]}


def test_nodes_without_wires_stand_in_rows():
    network = Network(nodes={f"n{number}": Node(f"n{number}", "gone") for number in range(100)})
    after = move_nodes(arranged(network, {})).apply(network)
    assert len({x for x, _ in after.layout.values()}) == 10
    assert len(set(after.layout.values())) == 100


@pytest.mark.parametrize("count", [5000])
def test_long_chains_and_cycles_need_no_recursion(count):
    names = [f"n{number}" for number in range(count)]
    nodes = {name: Node(name, "gone") for name in names}
    links = [Link(one, "o", other, "i") for one, other in itertools.pairwise(names)]
    network = Network(nodes=nodes, links=tuple(links))
    places = arranged(network, {})
    xs = [places[name][0] for name in names]
    assert xs == sorted(set(xs))
    looped = Network(nodes=nodes, links=(*links, Link(names[-1], "o", names[0], "i")))
    assert len(set(arranged(looped, {}).values())) == count


UNEQUAL = {"a": (100.0, 50.0), "b": (200.0, 80.0), "c": (60.0, 120.0), "d": (90.0, 40.0)}
POINTS = {"a": (0.0, 10.0), "b": (300.0, 5.0), "c": (130.0, 400.0), "d": (700.0, 90.0)}
LINE = {"left": 0.0, "right": 790.0, "top": 5.0, "bottom": 520.0}


@pytest.fixture
def network():
    nodes = {name: Node(name, "x") for name in (*POINTS, "lost")}
    return Network("n", nodes=nodes, layout=POINTS)


def edge_of(name, at, edge):
    width, height = UNEQUAL[name]
    return {"left": at[0], "right": at[0] + width, "top": at[1], "bottom": at[1] + height}[edge]


@pytest.mark.parametrize("edge", EDGES)
def test_edges_in_line(network, edge):
    places = aligned(network, [*POINTS, "lost"], UNEQUAL, edge)
    assert {edge_of(name, at, edge) for name, at in places.items()} == {LINE[edge]}
    other = 1 if edge in ("left", "right") else 0
    assert all(at[other] == POINTS[name][other] for name, at in places.items())


@pytest.mark.parametrize("way", WAYS)
def test_gaps_are_equal(network, way):
    places = distributed(network, POINTS, UNEQUAL, way)
    axis = WAYS.index(way)
    order = sorted(places, key=lambda name: POINTS[name][axis])
    assert order == sorted(places, key=lambda name: places[name][axis])
    gaps = [
        places[b][axis] - places[a][axis] - UNEQUAL[a][axis] for a, b in itertools.pairwise(order)
    ]
    assert gaps == pytest.approx([gaps[0]] * 3)
    assert places[order[0]] == POINTS[order[0]]
    assert places[order[-1]][axis] == pytest.approx(POINTS[order[-1]][axis])


def test_one_node_stays(network):
    for names in ([], ["a"], ["a", "lost"]):
        assert all(aligned(network, names, UNEQUAL, edge) == {} for edge in EDGES)
        assert all(distributed(network, names, UNEQUAL, way) == {} for way in WAYS)


# Room for new nodes: nothing stands on anything, and nothing moves farther than it must.

SIZE = (180.0, 100.0)


def network_at(points):
    nodes = {name: Node(name, "x") for name in points}
    return Network("n", nodes=nodes, layout=points)


def sizes_of(names):
    return dict.fromkeys(names, SIZE)


def apart(one, other, gap_x=0.0, gap_y=0.0):
    return (
        one[0] >= other[2] + gap_x
        or other[0] >= one[2] + gap_x
        or one[1] >= other[3] + gap_y
        or other[1] >= one[3] + gap_y
    )


def drawn_of_layout_room(random, count, span=600):
    return {
        f"n{k}": (float(random.randint(-span, span)), float(random.randint(-span, span)))
        for k in range(count)
    }


def free(network, points):
    return free_places(points, sizes_of(points), network, sizes_of(network.nodes))


@pytest.mark.parametrize("seed", range(40))
def test_new_nodes_stand_free_and_are_moved_straight_together(seed):
    random = Random(seed)
    network = network_at(drawn_of_layout_room(random, random.randint(1, 9), 300))
    points = drawn_of_layout_room(random, random.randint(1, 3), 200)
    moved = free(network, points)
    there = boxes_of(network.layout, sizes_of(network.nodes)).values()
    boxes = boxes_of(moved, {}).values()
    assert all(apart(a, b, 0.99 * GAP_X, 0.99 * GAP_Y) for a in boxes for b in there)
    shift = {(moved[n][0] - points[n][0], moved[n][1] - points[n][1]) for n in points}
    (way,) = {(round(x, 6), round(y, 6)) for x, y in shift}
    assert 0.0 in way


def pushed(points, at, behind=()):
    network = network_at({**points, "new": at})
    places = made_way(network, sizes_of(network.nodes), "new", at, behind)
    return {**network.layout, **places}


@pytest.mark.parametrize("seed", range(30))
def test_afterwards_the_node_and_what_it_pushed_stand_free(seed):
    random = Random(seed)
    points = drawn_of_layout_room(random, 12, 500)
    at = (float(random.randint(-300, 300)), float(random.randint(-300, 300)))
    behind = set(random.sample(sorted(points), 5))
    after = pushed(points, at, behind)
    boxes = boxes_of(after, sizes_of(after))
    moved = [name for name in after if after[name] != {**points, "new": at}[name]]
    for name in {*moved, "new"}:
        for other in after:
            if other != name:
                assert apart(boxes[name], boxes[other]), (name, other)
    for name in points:
        assert after[name][0] >= points[name][0]
        assert after[name][1] == points[name][1]
