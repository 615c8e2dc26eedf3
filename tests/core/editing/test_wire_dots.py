"""Dots of wires as the file has them: they go with their wires, and nothing computes with them."""

import json
from dataclasses import replace

import pytest

from core.editing.backdrops import (
    add_dot,
    dots_of,
    move_dot,
    moved_with_dots,
    remove_dot,
    straighten,
)
from core.editing.clipboard import copied, pasted
from core.editing.macros import group, ungroup
from core.editing.operations import move_nodes, remove_nodes, rename_node, rewire
from core.network.file import format_network
from core.network.network import Link, Network, Node

FIRST = Link.between("scene.image", "init.image")
SECOND = Link.between("init.magnitude", "back.magnitude")


@pytest.fixture
def network():
    nodes = {
        name: Node(name, key)
        for name, key in (
            ("scene", "test_scene"),
            ("init", "init_trans"),
            ("back", "back_transform"),
        )
    }
    layout = {"scene": (0, 0), "init": (200, 0), "back": (600, 0)}
    links = (FIRST, SECOND, Link.between("init.phase", "back.phase"))
    return Network(nodes=nodes, links=links, layout=layout)


@pytest.fixture
def bent(network):
    """The second wire through two dots."""
    once = add_dot(network, SECOND, 0, (300.0, 80.0)).apply(network)
    return add_dot(once, SECOND, 1, (500.0, 80.5)).apply(once)


def test_they_stand_in_the_file_beside_all_else(bent, network, library):
    stored = json.loads(format_network(bent, library=library))
    assert stored.pop("wire_dots") == [
        {"link": ["init.magnitude", "back.magnitude"], "points": [[300, 80], [500, 80.5]]}
    ]
    assert stored == json.loads(format_network(network, library=library))


def test_moving_and_deleting(bent):
    moved = move_dot(bent, SECOND, 1, (510.0, 90.0)).apply(bent)
    assert dots_of(moved)[SECOND] == ((300.0, 80.0), (510.0, 90.0))
    one = remove_dot(moved, SECOND, 0).apply(moved)
    assert dots_of(one)[SECOND] == ((510.0, 90.0),)
    none = remove_dot(one, SECOND, 0).apply(one)
    assert "wire_dots" not in none.extra
    assert "wire_dots" not in straighten(bent, [SECOND]).apply(bent).extra


@pytest.mark.parametrize(
    ("operation", "left"),
    [
        (rename_node("back", "to the image"), 2),
        (remove_nodes(("back",)), 0),
        (remove_nodes(("scene",)), 2),
        (rewire(remove=(SECOND,)), 0),
        (rewire(remove=(FIRST,)), 2),
        (rewire(add=(Link.between("scene.image", "back.magnitude"),)), 0),
        (move_nodes({"back": (700.0, 50.0)}), 2),
    ],
)
def test_they_go_with_their_wire_and_come_back_with_it(bent, operation, left, library):
    after = operation.apply(bent)
    assert sum(map(len, dots_of(after).values())) == left
    assert ("wire_dots" in after.extra) == bool(left)


def test_copied_nodes_bring_the_dots_of_the_wires_among_them(bent, library):
    text = copied(bent, ["init", "back"], library)
    names, operation = pasted(text, bent, library, at=(400.0, 1000.0))
    after = operation.apply(bent)
    new = Link(names[0], "magnitude", names[1], "magnitude")
    x, y = (after.layout[names[0]][axis] - bent.layout["init"][axis] for axis in (0, 1))
    assert dots_of(after)[new] == ((300.0 + x, 80.0 + y), (500.0 + x, 80.5 + y))
    assert dots_of(after)[SECOND] == dots_of(bent)[SECOND]
    assert "wire_dots" not in copied(bent, ["scene", "init"], library)


def test_they_move_along_where_both_nodes_move(bent):
    both = moved_with_dots(bent, {"init": (210.0, 5.0), "back": (610.0, 5.0)})
    assert dots_of(both.apply(bent))[SECOND] == ((310.0, 85.0), (510.0, 85.5))
    one = moved_with_dots(bent, {"init": (210.0, 5.0)})
    assert dots_of(one.apply(bent)) == dots_of(bent)
    apart = moved_with_dots(bent, {"init": (210.0, 5.0), "back": (700.0, 5.0)})
    assert dots_of(apart.apply(bent)) == dots_of(bent)


def test_a_macro_takes_the_dots_inside_and_gives_them_back(bent, library):
    other = add_dot(bent, FIRST, 0, (120.0, 40.0)).apply(bent)
    name, grouping = group(other, library, ["init", "back"])
    grouped = grouping.apply(other)
    body = grouped.nodes[name].macro
    assert dots_of(body) == {SECOND: dots_of(bent)[SECOND]}
    assert "wire_dots" not in grouped.extra, "the wire from the scene has another end now"
    _, ungrouping = ungroup(grouped, library, name)
    after = ungrouping.apply(grouped)
    assert dots_of(after) == dots_of(bent)


@pytest.mark.parametrize(
    "strange",
    [
        "what is this",
        [1, None, {"link": "x", "points": [[1, 2]]}],
        [{"link": ["init.magnitude", "back.magnitude"], "points": [[1, "2"]]}],
        [{"link": ["init", 3], "points": [[1, 2]]}],
        [{"link": ["gone.a", "back.magnitude"], "points": [[1, 2]]}],
    ],
)
def test_what_else_a_file_has_there_are_no_dots_and_stays(network, library, strange):
    network = replace(network, extra={"wire_dots": strange})
    assert dots_of(network) == {}
    for operation in (rename_node("scene", "s"), remove_nodes(("scene",)), rewire(remove=(FIRST,))):
        assert operation.apply(network).extra == network.extra
    bent = add_dot(network, FIRST, 0, (1.0, 2.0)).apply(network)
    assert dots_of(bent) == {FIRST: ((1.0, 2.0),)}
