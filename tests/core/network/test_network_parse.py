import json
import threading
from typing import ClassVar

import pytest

from child_process import PATIENCE_S
from core.errors import NetworkError
from core.modules.declaration import Module
from core.network.file import migrate, parse_network
from core.network.network import Link


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
            "not an Imagechain network: its format must be 'imagechain-network', but it has none",
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
        (["version"], 0, "version = 0 is not allowed: a whole number, 1 or more"),
        (["version"], 99, "version 99 is from a newer Imagechain: this one reads versions up to 2"),
        (["description"], None, "description must be a string, not null"),
        (["seed"], 1.0, "seed must be a whole number, not a number"),
        (["seed"], -1, "seed = -1 is not allowed: a whole number from 0 to 9223372036854775807"),
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
