"""Nodes added with another one selected."""

from __future__ import annotations

import pytest

from core.editing.wiring.continuing import continued
from core.errors import NetworkError
from core.network.network import Network, Node
from core.network.validation import problems


def changed(network, library, node, module):
    """New links and gone ones, by their text; None where nothing fits."""
    onward = continued(network, library, node, module, (0.0, 0.0))
    if onward is None:
        return None
    _, operation = onward
    after = operation.apply(network)
    assert not problems(after, library=library, keep_unknown=True, unfinished=True)
    new, gone = set(after.links) - set(network.links), set(network.links) - set(after.links)
    return {str(link) for link in new}, {str(link) for link in gone}


def test_it_comes_between_the_node_and_what_that_leads_to(kodak, library):
    assert changed(kodak, library, "detector", "jitter_mtf") == (
        {"detector.magnitude → jitter_mtf.magnitude", "jitter_mtf.magnitude → charge.magnitude",
         "init.context → jitter_mtf.context"},
        {"detector.magnitude → charge.magnitude"},
    )  # fmt: skip


def test_behind_the_last_node_it_goes_on(shipped, library):
    network = shipped["first_steps"]
    last = next(name for name in network.nodes if not network.followers[name])
    source = next(link.source for link in network.links if link.target == last)
    new, gone = changed(network, library, source, "measured_mtf")
    assert gone == set()
    assert any("→ measured_mtf.image" in link for link in new)


def test_an_output_with_several_wires_gets_a_branch(kodak, library):
    """The charge's magnitude leads to two nodes: neither wire is the one to be taken."""
    new, gone = changed(kodak, library, "charge", "mtf_slices")
    assert gone == set()
    assert new == {"charge.magnitude → mtf_slices.transfer"}


def test_a_source_feeds_what_is_empty(library):
    network = Network("n", nodes={"init": Node("init", "init_trans")})
    assert changed(network, library, "init", "test_scene") == (
        {"test_scene.image → init.image"},
        set(),
    )


def test_what_does_not_fit_is_left_to_be_added_plainly(kodak, library):
    assert continued(kodak, library, "picture", "test_scene", None) is None
    strange = Network("n", nodes={"s": Node("s", "of another version")})
    assert continued(strange, library, "s", "jitter_mtf", None) is None
    with pytest.raises(NetworkError, match="no module"):
        continued(kodak, library, "scene", "jitter", None)


def test_whatever_is_added_to_whatever_the_network_stays_sound(kodak, library):
    for node in kodak.nodes:
        for module in library:
            onward = continued(kodak, library, node, module, None)
            if onward is not None:
                after = onward[1].apply(kodak)
                assert not problems(after, library=library, unfinished=True), (node, module)
                assert any(
                    {link.source, link.target} == {node, onward[0]} for link in after.links
                ), (node, module)
