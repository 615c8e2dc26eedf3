import copy
import json
import pickle
from dataclasses import replace
from pathlib import Path

import pytest

from core.errors import NetworkError, ParameterError
from core.modules.declaration import declaration
from core.network.network import Link, Network, Node, cycles, passed_through, topological
from core.network.parsing import parse_network


@pytest.fixture
def network(document, small_library):
    return parse_network(json.dumps(document), library=small_library)


def test_nothing_can_be_changed(network):
    with pytest.raises(TypeError):
        network.nodes["init"].params["focal_length_mm"] = 1.0
    with pytest.raises(TypeError):
        network.nodes["x"] = None
    with pytest.raises(AttributeError):
        network.extra["backdrops"].append(1)
    with pytest.raises(TypeError):
        network.extra["backdrops"][0]["title"] = "x"
    with pytest.raises(AttributeError):
        network.seed = 2


def test_copies_and_pickles(network):
    assert copy.deepcopy(network) == network
    assert pickle.loads(pickle.dumps(network)) == network


def test_with_parameter_and_seed_leave_the_old_one(network):
    changed = network.with_parameter("jitter", "sigma_mrad", 0.1).with_seed(7)
    assert changed.nodes["jitter"].params == {"sigma_mrad": 0.1}
    assert changed.seed == 7
    assert network.nodes["jitter"].params == {"sigma_mrad": 0.5}
    assert list(changed.nodes) == list(network.nodes)
    with pytest.raises(NetworkError, match=r"jiter is not a node.*did you mean jitter\?"):
        network.with_parameter("jiter", "sigma_mrad", 0.1)


def test_with_a_node_all_else_is_what_it_was(network):
    assert network.followers
    node = replace(network.nodes["jitter"], disabled=True, params={"sigma_mrad": [1.0]})
    changed = network.with_node(node)
    assert changed == replace(network, nodes={**network.nodes, "jitter": node})
    assert changed.nodes["jitter"].params == {"sigma_mrad": (1.0,)}
    assert not network.nodes["jitter"].disabled
    assert changed.extra is network.extra
    assert changed.order() == network.order()
    assert copy.deepcopy(changed) == changed
    with pytest.raises(TypeError):
        changed.nodes["x"] = None
    with pytest.raises(NetworkError, match="blur is not a node"):
        network.with_node(replace(node, id="blur"))


@pytest.mark.parametrize("seed", [-1, 2**63, 1.0, True, None, "1"])
def test_seeds_that_are_not_allowed(network, seed):
    with pytest.raises(ParameterError, match=r"seed .* from 0 to 9223372036854775807"):
        network.with_seed(seed)


def test_ids_and_extra_fields_are_checked():
    with pytest.raises(NetworkError, match="is not allowed as a node's id"):
        Node("a.b", "x")
    with pytest.raises(NetworkError, match="is stored under the id b"):
        Network(nodes={"b": Node("a", "x")})
    with pytest.raises(NetworkError, match="the extra field params"):
        Node("a", "x", extra={"params": {}})
    with pytest.raises(NetworkError, match="the extra field seed"):
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


def test_core_needs_no_file_beyond_the_one_named(monkeypatch, document, small_library):
    # A network names files; opening it must not touch them.
    document["nodes"]["scene"]["params"]["path"] = "/etc/hostname"

    def fail(*args, **options):
        raise AssertionError("a file was opened")

    for name in ("open", "stat", "exists", "read_bytes"):
        monkeypatch.setattr(Path, name, fail)
    monkeypatch.setattr("builtins.open", fail)
    parse_network(json.dumps(document), library=small_library)
