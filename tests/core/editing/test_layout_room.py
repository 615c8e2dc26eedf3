"""Room for new nodes: nothing stands on anything, and nothing moves farther than it must."""

from random import Random

import pytest

from core.editing.layout import GAP_X, GAP_Y, boxes_of, free_places, made_way
from core.network.network import Network, Node

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


def drawn(random, count, span=600):
    return {
        f"n{k}": (float(random.randint(-span, span)), float(random.randint(-span, span)))
        for k in range(count)
    }


def free(network, points):
    return free_places(points, sizes_of(points), network, sizes_of(network.nodes))


@pytest.mark.parametrize("seed", range(40))
def test_new_nodes_stand_free_and_are_moved_straight_together(seed):
    random = Random(seed)
    network = network_at(drawn(random, random.randint(1, 9), 300))
    points = drawn(random, random.randint(1, 3), 200)
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
    points = drawn(random, 12, 500)
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
