"""A network saved into another folder reads and writes the same files."""

from __future__ import annotations

import numpy as np
import pytest

from core.editing.document import Document
from core.editing.moved_folder import rebased
from core.network.network import Network, Node


def network_of(**paths):
    nodes = {name: Node(name, "read_image", {"path": path}) for name, path in paths.items()}
    return Network(nodes=nodes)


def moved(network, library, old, new):
    operation = rebased(network, library, old, new)
    after = network if operation is None else operation.apply(network)
    return {name: node.params.get("path") for name, node in after.nodes.items()}


@pytest.mark.parametrize(
    ("new", "expected"),
    [
        ("work/copy", "../scene.npy"),
        ("work", "scene.npy"),
        (".", "work/scene.npy"),
        ("other/deep", "../../work/scene.npy"),
    ],
)
def test_relative_names_follow(library, tmp_path, new, expected):
    old = tmp_path / "work"
    found = moved(network_of(a="scene.npy"), library, old, tmp_path / new)
    assert found == {"a": expected}


def test_the_same_file_is_read(library, tmp_path):
    for folder in ("work/pictures", "other/place"):
        (tmp_path / folder).mkdir(parents=True)
    np.save(tmp_path / "work/pictures/scene.npy", np.arange(6.0).reshape(2, 3))
    old, new = tmp_path / "work", tmp_path / "other/place"
    found = moved(network_of(a="pictures/scene.npy"), library, old, new)
    assert np.load(new / found["a"])[1, 2] == 5.0


def test_through_a_folder_that_is_a_link(library, tmp_path):
    """The system leaves a linked folder by its real parent."""
    (tmp_path / "real/deep").mkdir(parents=True)
    (tmp_path / "work").mkdir()
    (tmp_path / "work/scene.npy").write_bytes(b"here")
    (tmp_path / "link").symlink_to(tmp_path / "real/deep")
    found = moved(network_of(a="scene.npy"), library, tmp_path / "work", tmp_path / "link")
    assert (tmp_path / "link" / found["a"]).read_bytes() == b"here"


def test_up_from_a_linked_folder(library, tmp_path):
    (tmp_path / "real/deep").mkdir(parents=True)
    (tmp_path / "work").mkdir()
    (tmp_path / "real/scene.npy").write_bytes(b"here")
    (tmp_path / "work/link").symlink_to(tmp_path / "real/deep")
    found = moved(network_of(a="link/../scene.npy"), library, tmp_path / "work", tmp_path)
    assert (tmp_path / found["a"]).read_bytes() == b"here"


def test_what_needs_no_change_gets_none(library, tmp_path):
    old, new = tmp_path / "a", tmp_path / "b"
    assert rebased(network_of(a="/elsewhere/scene.npy"), library, old, new) is None
    assert rebased(network_of(a="scene.npy"), library, old, old) is None
    assert rebased(network_of(a="scene.npy"), library, old, tmp_path / "b/../a") is None
    assert rebased(Network(), library, old, new) is None


def test_what_is_no_file_name_stays(library, tmp_path):
    nodes = {
        "none": Node("none", "read_image", {"path": None}),
        "empty": Node("empty", "read_image", {"path": ""}),
        "strange": Node("strange", "read_image", {"path": 5}),
        "null": Node("null", "read_image", {"path": "a\0b"}),
        "scene": Node("scene", "test_scene", {"kind": "dormitory"}),
        "old": Node("old", "gone", {"path": "scene.npy"}),
    }
    assert rebased(Network(nodes=nodes), library, tmp_path / "a", tmp_path / "b") is None


def test_every_file_name_of_every_module(library, tmp_path):
    """Those that write and the pupil's, too; one step, undone at once."""
    keys = ("read_image", "write_image", "write_matrix", "exit_pupil", "noise_file")
    nodes = {key: Node(key, key, {"path": "x.npy"}) for key in keys}
    document = Document(Network(nodes=nodes), library=library)
    before = document.text()
    operation = rebased(document.network, library, tmp_path / "a", tmp_path)
    assert operation is not None
    document.do(operation)
    assert {node.params["path"] for node in document.network.nodes.values()} == {"a/x.npy"}
    assert document.history.undo_text == "Keep file names"
    document.undo()
    assert document.text() == before
