"""What has changed since a snapshot, in words."""

import pytest

from app.editor.docks.snapshots_view import changes, in_short
from app.run.shipped import shipped_networks
from core.editing.operations import (
    ABSENT,
    Move,
    Remove,
    Rename,
    Rewire,
    set_node_field,
    set_parameter,
)
from core.modules.declaration import declaration
from core.network.file import load_network
from nodes.library import standard_library

LIBRARY = standard_library()


@pytest.fixture
def network():
    return load_network(shipped_networks()["first_steps"], library=LIBRARY)


def declared(node):
    return declaration(LIBRARY[node.module])


def said(before, *operations):
    after = before
    for operation in operations:
        after = operation.apply(after)
    return changes(before, after, declared)


def test_nothing(network):
    assert said(network) == ()
    assert in_short(()) == "as now"


def test_a_parameter_with_its_unit_and_both_values(network):
    before = set_parameter("blur", "sigma_x_mrad", 0.5).apply(network)
    assert said(before, set_parameter("blur", "sigma_x_mrad", 3.0)) == ("blur σ x 0.5 → 3 mrad",)


def test_a_parameter_left_at_its_default(network):
    before = set_parameter("blur", "sigma_x_mrad", 0.5).apply(network)
    default = declaration(LIBRARY[network.nodes["blur"].module]).parameter("sigma_x_mrad").default
    after = said(before, set_parameter("blur", "sigma_x_mrad", ABSENT))
    assert after == (f"blur σ x 0.5 → {default:g} mrad",)
    back = set_parameter("blur", "sigma_x_mrad", ABSENT).apply(network)
    assert said(back, set_parameter("blur", "sigma_x_mrad", default)) == ()  # the same value


def test_a_linked_parameter(network):
    linked = {"expression": "2 * 0.25"}
    before = set_parameter("blur", "sigma_x_mrad", 0.5).apply(network)
    assert said(before, set_parameter("blur", "sigma_x_mrad", linked)) == (
        "blur σ x 0.5 → = 2 * 0.25 mrad",
    )


def test_nodes_and_wires(network):
    assert said(network, Rename("blur", "haze")) == ("blur renamed haze",)
    assert said(network, set_node_field("blur", "disabled", True)) == ("blur disabled",)
    assert "blur removed" in said(network, Remove(("blur",)))
    added = changes(Remove(("blur",)).apply(network), network, declared)
    assert "blur added" in added
    assert not [text for text in added if "wired" in text and "blur" in text]
    link = next(link for link in network.links if link.target == "back")
    assert said(network, Rewire((), (link,))) == (f"{link} no longer wired",)


def test_places_are_said_last(network):
    x, y = network.layout["blur"]
    assert said(network, Move({"blur": (x + 5, y)})) == ("places on the canvas",)


def test_many_changes_in_short():
    texts = tuple(f"change {number}" for number in range(5))
    assert in_short(texts) == "change 0; change 1; change 2; and 2 more"
    assert in_short(texts[:3]) == "change 0; change 1; change 2"
