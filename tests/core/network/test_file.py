"""Tests."""

import json
import os
import threading
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest

from child_process import PATIENCE_S
from core.errors import FileError, NetworkError, ParameterError
from core.modules.declaration import Module, declaration
from core.network.file import (
    format_network,
    load_network,
    migrate,
    parse_network,
    read_network,
    read_unchanged,
    save_network,
)
from core.network.network import Link, Network, Node, cycles, passed_through, topological
from core.network.validation import NetworkProblems


def _parse(document, library):
    return parse_network(json.dumps(document), library=library, name_of_source="n.json")


def test_saved_is_loaded_equal_and_the_text_is_stable(document, formatted, small_library, tmp_path):
    network = _parse(document, small_library)
    path = tmp_path / "n.json"
    save_network(network, path, library=small_library)
    assert load_network(path, library=small_library) == network
    assert path.read_text("utf-8") == formatted
    assert list(tmp_path.iterdir()) == [path]


def test_values_keep_what_was_given(small_library):
    # An empty number, the text of a path and a value yet to be mended are not rewritten.
    given = {"width": 3.0, "path": "./a//b.img", "spots": [1, -0.0]}
    nodes = {
        "s": Node("s", "scene_maker", given),
        "i": Node("i", "init", {"focal_length_mm": 0, "near_m": "far", "far_m": 10**30}),
        "u": Node("u", "unknown", {"b": 1, "a": 1.0, "deep": {"z": [1, {"y": None}], "a": []}}),
    }
    network = Network(nodes=nodes)
    text = format_network(network, library=small_library)
    assert parse_network(text, library=small_library) == network
    plain = {name: node.get("params") for name, node in json.loads(text)["nodes"].items()}
    assert json.dumps(plain["s"]) == '{"path": "./a//b.img", "spots": [1.0, 0.0], "width": 3}'
    assert json.dumps(plain["i"]["focal_length_mm"]) == "0"
    assert plain["i"]["near_m"] == "far"
    assert json.dumps(plain["u"]) == '{"a": 1.0, "b": 1, "deep": {"z": [1, {"y": null}], "a": []}}'


def test_unknown_modules_round_trip_when_kept(document, small_library, tmp_path):
    raw = {"module": "from_the_future", "params": {"x": [1, {"y": None}]}, "auto": True, "k": {}}
    document["nodes"]["new"] = raw
    document["links"].append(["new.wire", "new2.wire"])
    document["nodes"]["new2"] = {"module": "from_the_future"}
    path = tmp_path / "n.json"
    path.write_text(json.dumps(document))
    with pytest.raises(NetworkProblems, match="new: there is no module from_the_future"):
        load_network(path, library=small_library)
    network = load_network(path, library=small_library, keep_unknown=True)
    again = json.loads(format_network(network, library=small_library))
    assert again["nodes"]["new"] == raw
    assert ["new.wire", "new2.wire"] in again["links"]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe{\x00}", "not UTF-8 text (byte 1)"),
        (b"", "not JSON: Expecting value (line 1, column 1)"),
        (b" " * (16 * 2**20 + 1), "larger than 16 MiB, the limit for a network file"),
    ],
)
def test_files_that_hold_no_text(content, message, small_library, tmp_path):
    path = tmp_path / "n.json"
    path.write_bytes(content)
    with pytest.raises(NetworkError) as caught:
        load_network(path, library=small_library)
    assert str(caught.value) == f"{path}: {message}"


def test_files_that_cannot_be_read(small_library, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name, reason in [
        ("gone", "No such file or directory"),
        ("", "it is not a regular file"),
        ("pipe", "it is not a regular file"),
        ("a\0b", "not a valid file name"),
        ("x" * 300, "File name too long"),
    ]:
        with pytest.raises(FileError, match=reason) as caught:
            load_network(tmp_path / name, library=small_library)
        assert caught.value.exit_code == 2
    with pytest.raises(FileError, match="not a regular file"):
        load_network("/dev/zero", library=small_library)


@pytest.mark.parametrize(
    "change",
    [
        {"extra": {"x": float("nan")}},
        {"extra": {"x": {1, 2}}},
        {"extra": {"x": {1: 2}}},
        {"name": "\ud800"},
        {"extra": {"x": json.loads("[" * 70 + "]" * 70)}},
        {"extra": {"x": "x" * (16 * 2**20)}},
    ],
)
def test_what_could_not_be_opened_again_is_not_saved(change, document, small_library, tmp_path):
    path = tmp_path / "n.json"
    path.write_text("old")
    network = replace(_parse(document, small_library), **change)
    with pytest.raises(NetworkError):
        save_network(network, path, library=small_library)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def write(path, text):
    save_network(Network(name=text), path, library={})


def test_it_is_read_again_only_when_it_has_changed(small_library, tmp_path):
    path = tmp_path / "one.json"
    write(path, "first")
    first = read_unchanged(path, library=small_library)
    assert first == read_network(path, library=small_library)
    assert read_unchanged(path, library=small_library) is first
    write(path, "other")  # of the same length: an atomic write is another inode
    assert read_unchanged(path, library=small_library).name == "other"


def _fault(text, library):
    with pytest.raises(NetworkError) as caught:
        parse_network(text, library=library, name_of_source="n.json")
    line = str(caught.value)
    assert "\n" not in line
    assert line.startswith("n.json: ")
    return line.removeprefix("n.json: ")


HEAD = '{"format": "imagechain-network", "version": 1, "nodes": {}, '


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nodes: {}", "not JSON: Expecting value (line 1, column 1)"),
        ("[]", "a network must be an object, not a list"),
        (
            "{}",
            "not an Imagechain network: its format must be 'imagechain-network', but none is given",
        ),
        (HEAD + '"seed": NaN}', "NaN is not a valid JSON number"),
        (HEAD + '"x": 1e999}', "the number 1e999 is too large"),
        (HEAD + f'"x": {"9" * 10**6}}}', "a number of 1000000 digits is too large"),
        (HEAD + '"x": {"a\\n": 1, "a\\n": 2}}', "the key 'a\\n' occurs twice in one object"),
        (HEAD + '"x": ["\\ud800"]}', "'\\ud800' is not valid Unicode text"),
        (HEAD + '"x": ' + "[" * 65 + "]" * 65 + "}", "nested more than 64 levels deep"),
        ("[" * 10**6, "nested more than 64 levels deep"),
    ],
)
def test_text_that_is_no_network(text, message, small_library):
    assert _fault(text, small_library) == message


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (["version"], "1", "version must be a whole number, not a string"),
        (["version"], 0, "version = 0 is not allowed: must be a whole number, 1 or more"),
        (
            ["version"],
            99,
            "version 99 is from a newer Imagechain; this Imagechain reads versions up to 2",
        ),
        (["description"], None, "description must be a string, not null"),
        (["seed"], 1.0, "seed must be a whole number, not a number"),
        (
            ["seed"],
            -1,
            "seed = -1 is not allowed: must be a whole number from 0 to 9223372036854775807",
        ),
        (["nodes", "init"], "init", "nodes.init must be an object, not a string"),
        (["nodes", "init", "module"], 1, "nodes.init.module must be a string, not a whole number"),
        (["nodes", "init", "module"], "", "nodes.init.module must not be empty"),
        (["nodes", "init", "params"], [], "nodes.init.params must be an object, not a list"),
        (["links"], {}, "links must be a list, not an object"),
        (["links", 2], "a.b", "link 3 must be a list, not a string"),
        (["links", 0], ["a.b", 1], 'link 1 must be two strings, ["NODE.PORT", "NODE.PORT"]'),
        (["links", 0], ["a.b", "c"], "link 1: 'c' is not a port: write NODE.PORT"),
        (["layout"], [], "layout must be an object, not a list"),
        (["layout", "init"], [1], "layout.init must be two numbers, [x, y]"),
    ],
)
def test_wrong_types_and_values(path, value, message, document, small_library):
    target = document
    for step in path[:-1]:
        target = target[step]
    target[path[-1]] = value
    assert _fault(json.dumps(document), small_library) == message


@pytest.mark.parametrize("name", ["", " ", "a.b", "a=b", "a\tb", "a\x7f", "a\x85b", "a\u2028b"])
def test_node_ids_that_are_not_allowed(name, document, small_library):
    document["nodes"][name] = {"module": "back"}
    line = _fault(json.dumps(document), small_library)
    assert line.startswith(f"{name!r} is not allowed as a node's id: ")
    assert line.isprintable()


def test_migrations_run_in_turn_from_the_version_of_the_file():
    steps = tuple(
        lambda document, name=name: document | {"steps": document["steps"] + name} for name in "abc"
    )
    assert migrate({"steps": ""}, 1, steps) == {"steps": "abc"}
    assert migrate({"steps": ""}, 3, steps) == {"steps": "c"}
    assert migrate({"steps": ""}, 4, steps) == {"steps": ""}


def test_old_names_of_modules_parameters_and_ports(document, small_library):
    new = parse_network(json.dumps(document), library=small_library)
    scene = document["nodes"]["scene"]
    scene["module"] = "old_scene"
    scene["params"]["columns"] = scene["params"].pop("width")
    document["links"][0][0] = "scene.picture"
    assert parse_network(json.dumps(document), library=small_library) == new


def test_an_unknown_output_is_not_taken_for_the_name_of_the_input(document, small_library):
    """`scene` has renamed ports and an output of the input's name; none of them is `sketch`."""
    document["links"][0] = ["scene.sketch", "init.image"]
    network = parse_network(json.dumps(document), library=small_library)
    assert Link("scene", "sketch", "init", "image") in network.links


def test_a_key_still_in_use_is_not_replaced(document, small_library):
    class Other(Module, key="other", title="Other", group="Test", replaces=("scene_maker",)):
        """Claims a key that is in use."""

        renamed: ClassVar[dict[str, str]] = {}

        def run(self) -> None:
            raise NotImplementedError

    library = {"other": Other, **small_library}
    network = parse_network(json.dumps(document), library=library)
    assert network.nodes["scene"].module == "scene_maker"


def test_reading_a_long_file_from_a_small_stack(small_library):
    # A thread of the editor has a small stack: deep files must not end the process.
    found = []

    def work():
        try:
            parse_network('{"a":' * 10**5, library=small_library)
        except NetworkError as error:
            found.append(error.message)

    threading.stack_size(256 * 1024)
    try:
        thread = threading.Thread(target=work)
        thread.start()
    finally:
        threading.stack_size(0)
    thread.join(PATIENCE_S)
    assert found == ["network: nested more than 64 levels deep"]


@pytest.fixture
def network(document, small_library):
    return parse_network(json.dumps(document), library=small_library)


def test_a_seed_of_numpy_is_a_seed():
    assert type(Network().with_seed(np.int64(3)).seed) is int


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
