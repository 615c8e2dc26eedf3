"""Nodes in line, with equal gaps: as a person would check with a ruler."""

from __future__ import annotations

import itertools

import pytest

from core.editing.layout.align import EDGES, WAYS, aligned, distributed
from core.network.network import Network, Node

SIZES = {"a": (100.0, 50.0), "b": (200.0, 80.0), "c": (60.0, 120.0), "d": (90.0, 40.0)}
POINTS = {"a": (0.0, 10.0), "b": (300.0, 5.0), "c": (130.0, 400.0), "d": (700.0, 90.0)}
LINE = {"left": 0.0, "right": 790.0, "top": 5.0, "bottom": 520.0}


@pytest.fixture
def network():
    nodes = {name: Node(name, "x") for name in (*POINTS, "lost")}
    return Network("n", nodes=nodes, layout=POINTS)


def edge_of(name, at, edge):
    width, height = SIZES[name]
    return {"left": at[0], "right": at[0] + width, "top": at[1], "bottom": at[1] + height}[edge]


@pytest.mark.parametrize("edge", EDGES)
def test_edges_in_line(network, edge):
    places = aligned(network, [*POINTS, "lost"], SIZES, edge)
    assert {edge_of(name, at, edge) for name, at in places.items()} == {LINE[edge]}
    other = 1 if edge in ("left", "right") else 0
    assert all(at[other] == POINTS[name][other] for name, at in places.items())


@pytest.mark.parametrize("way", WAYS)
def test_gaps_are_equal(network, way):
    places = distributed(network, POINTS, SIZES, way)
    axis = WAYS.index(way)
    order = sorted(places, key=lambda name: POINTS[name][axis])
    assert order == sorted(places, key=lambda name: places[name][axis])
    gaps = [
        places[b][axis] - places[a][axis] - SIZES[a][axis] for a, b in itertools.pairwise(order)
    ]
    assert gaps == pytest.approx([gaps[0]] * 3)
    assert places[order[0]] == POINTS[order[0]]
    assert places[order[-1]][axis] == pytest.approx(POINTS[order[-1]][axis])


def test_one_node_stays(network):
    for names in ([], ["a"], ["a", "lost"]):
        assert all(aligned(network, names, SIZES, edge) == {} for edge in EDGES)
        assert all(distributed(network, names, SIZES, way) == {} for way in WAYS)
