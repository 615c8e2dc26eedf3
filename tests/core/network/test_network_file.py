import json
import os
from dataclasses import replace

import pytest

from core.errors import FileError, NetworkError
from core.network.file import (
    format_network,
    load_network,
    parse_network,
    read_network,
    read_unchanged,
    save_network,
)
from core.network.network import Network, Node
from core.network.validation import NetworkProblems

FORMATTED = """{
  "format": "imagechain-network",
  "version": 1,
  "name": "Kodak KIR-310",
  "description": "µ-bolometer, 30°",
  "seed": 1996,
  "nodes": {
    "scene": {
      "module": "scene_maker",
      "params": {
        "kind": "point",
        "spots": [0.0, 1.5],
        "width": 1024
      }
    },
    "init": {
      "module": "init",
      "params": {
        "focal_length_mm": 200.0
      },
      "pinned": true
    },
    "jitter": {
      "module": "jitter_mtf",
      "params": {
        "sigma_mrad": 0.5
      },
      "auto": false
    },
    "back": {
      "module": "back"
    },
    "add noise": {
      "module": "noise",
      "disabled": true
    },
    "look": {
      "module": "look",
      "params": {
        "level": 1.0
      }
    }
  },
  "links": [
    ["scene.image", "init.image"],
    ["init.context", "jitter.context"],
    ["init.magnitude", "jitter.magnitude"],
    ["init.phase", "back.phase"],
    ["jitter.magnitude", "back.magnitude"],
    ["back.image", "add noise.image"],
    ["add noise.image", "look.picture"]
  ],
  "layout": {
    "scene": [0, 0],
    "init": [220, -12.5]
  },
  "backdrops": [
    {
      "title": "Optics",
      "nodes": ["init", "jitter"]
    }
  ]
}
"""


def _parse(document, library):
    return parse_network(json.dumps(document), library=library, name_of_source="n.json")


def test_saved_is_loaded_equal_and_the_text_is_stable(document, small_library, tmp_path):
    network = _parse(document, small_library)
    path = tmp_path / "n.json"
    save_network(network, path, library=small_library)
    assert load_network(path, library=small_library) == network
    assert path.read_text("utf-8") == FORMATTED
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
