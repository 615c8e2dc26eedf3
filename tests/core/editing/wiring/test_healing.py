"""Nodes taken out of mid-chain: the chain goes on as it did with them disabled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.editing.wiring.healing import deleted, dissolved
from core.evaluation.policy import Policy
from core.network.network import Link, Network, Node
from core.network.validation import problems
from linked_network import linked_network


def links(*texts):
    return {Link.between(*text.split(" → ")) for text in texts}


def new_links(before, after):
    return set(after.links) - set(before.links)


def picture(network, library, port):
    engine = Engine(library)
    folder = shipped_networks()["kodak_kir310"].parent
    plan = engine.plan(network, folder=folder)
    return np.asarray(engine.value(plan, port, engine.work(Policy())))


@pytest.mark.parametrize(
    "gone",
    [("detector",), ("aberration", "detector"), ("electronics",), ("charge", "charge_phase")],
)
def test_the_picture_is_that_of_the_disabled_nodes(shipped, library, gone):
    """The engine passes a disabled node's input on; led past, the same wire does."""
    network = shipped["kodak_kir310"]
    small = (
        network.with_parameter("scene", "size", 64)
        if "size" in (network.nodes["scene"].params)
        else network
    )
    disabled = replace(
        small,
        nodes={
            name: replace(node, disabled=node.disabled or name in gone)
            for name, node in small.nodes.items()
        },
    )
    for operation in (dissolved(small, library, gone), deleted(small, library, gone)):
        led_past = operation.apply(small)
        assert not set(gone) & led_past.nodes.keys()
        one, other = (picture(n, library, "pixels.image") for n in (disabled, led_past))
        np.testing.assert_array_equal(one, other)


def test_both_wires_are_led_past_and_what_passes_nothing_on_goes(shipped, library):
    network = shipped["kodak_kir310"]
    after = deleted(network, library, ["optics"]).apply(network)
    assert new_links(network, after) == links(
        "init.magnitude → aberration.magnitude", "init.phase → charge_phase.phase"
    )
    after = deleted(network, library, ["init"]).apply(network)  # a picture is no spectrum
    assert new_links(network, after) == set()


@pytest.fixture
def compared():
    """The difference of two pictures, written: there are two ways through."""
    nodes = {
        "one": ("read_image", {}),
        "two": ("read_image", {}),
        "less": ("compare_images", {}),
        "last": ("write_image", {}),
    }
    return linked_network(
        nodes,
        [
            ("one.image", "less.image"),
            ("two.image", "less.reference"),
            ("less.difference", "last.image"),
        ],
    )


def test_of_two_ways_through_none_is_taken_but_by_dissolving(library, compared):
    assert new_links(compared, deleted(compared, library, ["less"]).apply(compared)) == set()
    dissolving = dissolved(compared, library, ["less"]).apply(compared)
    assert new_links(compared, dissolving) == links("one.image → last.image")


def test_what_is_unknown_or_in_a_ring_is_only_taken_out(library):
    nodes = {name: Node(name, "nobody_knows") for name in "abc"}
    ring = Network("n", nodes=nodes, links=tuple(links("a.x → b.x", "b.x → a.x", "b.x → c.x")))
    for names in (["b"], ["a", "b"]):
        after = dissolved(ring, library, names).apply(ring)
        assert new_links(ring, after) == set()


def test_every_node_of_every_network_leaves_a_sound_one(shipped, library):
    for network in shipped.values():
        before = {str(p) for p in problems(network, library=library, unfinished=True)}
        for name in network.nodes:
            after = dissolved(network, library, [name]).apply(network)
            found = {str(p) for p in problems(after, library=library, unfinished=True)}
            assert found <= before, name
