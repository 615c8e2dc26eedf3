import json

import pytest

from core.errors import NetworkError, ParameterError
from core.modules.declaration import declaration
from core.network.file import parse_network
from core.network.network import Link, Network, Node, cycles, passed_through, topological


@pytest.fixture
def network(document, small_library):
    return parse_network(json.dumps(document), library=small_library)


@pytest.mark.parametrize("seed", [-1, 2**63, 1.0, True, None, "1"])
def test_seeds_that_are_not_allowed(network, seed):
    with pytest.raises(ParameterError, match=r"seed .* from 0 to 9223372036854775807"):
        network.with_seed(seed)


def test_ids_and_extra_fields_are_checked():
    with pytest.raises(NetworkError, match="is not allowed as a node's id"):
        Node("a.b", "x")
    with pytest.raises(NetworkError, match="is stored under the id b"):
        Network(nodes={"b": Node("a", "x")})
    with pytest.raises(NetworkError, match="the field params is reserved"):
        Node("a", "x", extra={"params": {}})
    with pytest.raises(NetworkError, match="the field seed is reserved"):
        Network(extra={"seed": 3})


def test_order_follows_links_then_the_document(network):
    assert network.order() == ("scene", "init", "jitter", "back", "add noise", "look")
    turned = Network(nodes=dict(reversed(network.nodes.items())), links=network.links)
    assert turned.order() == network.order()
    assert Network(nodes=network.nodes).order() == tuple(network.nodes)


def test_order_of_a_cycle_is_refused():
    nodes = {name: Node(name, "noise") for name in "abc"}
    links = tuple(Link(*pair) for pair in [("b", "image", "c", "image"), ("c", "image", "b", "x")])
    with pytest.raises(NetworkError, match="b: the links form a cycle: b → c → b"):
        Network(nodes=nodes, links=links).order()


def test_unlinked_outputs(network, small_library):
    # "add noise" is disabled and makes no noise
    assert network.unlinked_outputs(small_library) == (("jitter", "mtf"),)
    alone = Network(nodes={"n": Node("n", "noise"), "u": Node("u", "unknown")})
    assert alone.unlinked_outputs(small_library) == (("n", "image"), ("n", "noise"))


def test_a_disabled_module_passes_on_the_first_of_each_type(small_library):
    found = {key: passed_through(declaration(module)) for key, module in small_library.items()}
    assert found == {
        "scene_maker": {},
        "init": {},
        "jitter_mtf": {"magnitude": "magnitude"},
        "noise": {"image": "image"},
        "back": {},
        "look": {},
    }


def test_cycles_are_all_found_and_start_at_the_first_node():
    graph = {"a": "b", "b": "c", "c": "bd", "d": "e", "e": "d", "f": "f", "g": "a"}
    assert cycles(graph) == [("b", "c"), ("d", "e"), ("f",)]
    assert topological(graph) == ("g", "a")


def test_long_chains_and_loops_need_no_recursion():
    size = 20_000
    nodes = {f"n{k}": Node(f"n{k}", "noise") for k in range(size)}
    links = [Link(f"n{k}", "image", f"n{k + 1}", "image") for k in range(size - 1)]
    assert len(Network(nodes=nodes, links=tuple(links)).order()) == size
    links.append(Link(f"n{size - 1}", "image", "n0", "image"))
    with pytest.raises(NetworkError, match=r"n0 → n1 → .* → … → n19999 → n0; remove one"):
        Network(nodes=nodes, links=tuple(links)).order()
