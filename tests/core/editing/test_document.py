"""The open document: what it tells, what it refuses, saving, its file and folder."""

import json
import os

import pytest

from app.run.shipped import shipped_networks
from core.editing.document import Document, mark, rebased
from core.editing.operations import (
    ABSENT,
    add_nodes,
    move_nodes,
    remove_nodes,
    restored,
    rewire,
    set_network_field,
    set_node_field,
    set_parameter,
    together,
)
from core.errors import ChangedFileError, FileError, NetworkError
from core.network.file import load_network, read_text
from core.network.linked_values import expression
from core.network.network import Link, Network, Node


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


def test_setting_the_present_value_is_no_step(document):
    present = document.network.nodes["init"].params["f_number"]
    for value in (present, int(present), 2.0):
        assert not document.do(set_parameter("init", "f_number", value))
    assert document.position == 0
    assert not document.modified


def test_true_is_not_the_number_one(document):
    document.do(set_node_field("init", "note", 1))
    assert document.do(set_node_field("init", "note", True))
    document.undo()
    assert document.network.nodes["init"].extra["note"] == 1
    assert document.network.nodes["init"].extra["note"] is not True


def test_another_order_of_the_nodes_is_a_change(document):
    network = Network(nodes={name: Node(name, "back_transform") for name in "ab"})
    document = Document(network, library=document.library)
    assert document.do(
        together((remove_nodes(("a",)), add_nodes(((Node("a", "back_transform"), None),))))
    )
    assert list(document.network.nodes) == ["b", "a"]
    document.undo()
    assert list(document.network.nodes) == ["a", "b"]


def test_one_drag_is_one_step(document):
    drag = object()
    for x in range(1, 40):
        assert document.do(move_nodes({"init": (480.0 + x, 0)}), gesture=drag)
    assert document.position == 1
    document.undo()
    assert document.network.layout["init"] == (480, 0)
    document.redo()
    assert document.network.layout["init"] == (519, 0)


def test_steps_of_one_kind_are_apart_without_a_gesture_or_after_its_end(document):
    move = [move_nodes({"init": (float(x), 0)}) for x in range(4)]
    document.do(move[0])
    document.do(move[1])
    document.do(move[2], gesture="drag")
    document.end_gesture()
    document.do(move[3], gesture="drag")
    assert document.position == 4


def test_listeners_hear_every_change_and_only_those(document):
    heard = []
    document.listen(lambda before, after: heard.append((before, after)))
    first = document.network
    document.do(move_nodes({"init": (480.0, 0)}))
    document.redo()
    assert heard == []
    document.do(remove_nodes(("slices",)))
    second = document.network
    document.undo()
    assert [tuple(map(id, pair)) for pair in heard] == [
        (id(first), id(second)),
        (id(second), id(document.network)),
    ]
    assert heard[0][1].nodes["init"] is first.nodes["init"]


@pytest.mark.parametrize(
    ("links", "reason"),
    [
        ([Link("init", "phase", "charge", "magnitude")], "gives phase, but"),
        ([Link("charge", "magnitude", "aberration", "magnitude")], "form a cycle"),
        ([Link("init", "nothing", "charge", "magnitude")], "has no output nothing"),
        (
            [Link(name, "image", "picture", "image") for name in ("scene", "back")],
            "more than one link",
        ),
    ],
)
def test_no_operation_brings_links_that_no_file_may_have(document, links, reason):
    before = document.network
    with pytest.raises(NetworkError, match=reason):
        document.do(rewire(add=tuple(links)))
    assert document.network is before
    assert document.position == 0


def test_a_document_without_a_file_asks_for_one(document):
    with pytest.raises(NetworkError, match="choose where to save it"):
        document.save()


def test_a_save_that_fails_loses_nothing(document, tmp_path):
    document.do(remove_nodes(("slices",)))
    with pytest.raises(FileError):
        document.save(tmp_path / "no such folder" / "a.json")
    assert document.modified
    assert document.path is None
    document.undo()
    assert "slices" in document.network.nodes


@pytest.fixture
def file(tmp_path, library):
    """A saved network."""
    path = tmp_path / "mine.json"
    Document(Network("first"), library=library).save(path)
    return path


def opened(path, library):
    text = read_text(path)
    return Document(Network("first"), library=library, path=path, stored=mark(text.encode()))


def named(path):
    return json.loads(path.read_text())["name"]


def test_a_change_within_one_tick_of_the_clock_is_noticed(file, library):
    """Of the same size, and at the same time to the nanosecond."""
    document = opened(file, library)
    before = file.stat()
    file.write_text(file.read_text().replace('"first"', '"other"'))
    os.utime(file, ns=(before.st_atime_ns, before.st_mtime_ns))
    after = file.stat()
    assert (after.st_size, after.st_mtime_ns) == (before.st_size, before.st_mtime_ns)
    document.do(set_network_field("name", "mine"))
    with pytest.raises(ChangedFileError):
        document.save()


def test_another_file_is_not_looked_at(file, library):
    """Whoever chooses a name has confirmed it."""
    document = opened(file, library)
    file.write_text("{}")
    other = file.with_name("other.json")
    other.write_text("old")
    document.do(set_network_field("name", "mine"))
    document.save(other)
    assert named(other) == "mine"
    document.do(set_network_field("name", "mine again"))
    document.save()
    assert named(other) == "mine again"


def network_of(**paths):
    nodes = {name: Node(name, "read_image", {"path": path}) for name, path in paths.items()}
    return Network(nodes=nodes)


def moved(network, library, old, new):
    after = rebased(network, library, old, new)
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


def test_through_a_folder_that_is_a_link(library, tmp_path):
    """The system leaves a linked folder by its real parent."""
    (tmp_path / "real/deep").mkdir(parents=True)
    (tmp_path / "work").mkdir()
    (tmp_path / "work/scene.npy").write_bytes(b"here")
    (tmp_path / "link").symlink_to(tmp_path / "real/deep")
    found = moved(network_of(a="scene.npy"), library, tmp_path / "work", tmp_path / "link")
    assert (tmp_path / "link" / found["a"]).read_bytes() == b"here"


def test_every_file_name_of_every_module(library, tmp_path):
    """Those that write and the pupil's, too; one step, undone at once."""
    keys = ("read_image", "write_image", "write_matrix", "exit_pupil", "noise_file")
    nodes = {key: Node(key, key, {"path": "x.npy"}) for key in keys}
    document = Document(Network(nodes=nodes), library=library)
    before = document.text()
    after = rebased(document.network, library, tmp_path / "a", tmp_path)
    document.do(restored(after, "Adjust file names"))
    assert {node.params["path"] for node in document.network.nodes.values()} == {"a/x.npy"}
    assert document.undo_text == "Adjust file names"
    document.undo()
    assert document.text() == before


# Undo, redo, going to any position, the lines of the steps, and the modified mark.


def test_lines_say_what_a_value_was_and_is(document):
    had = document.network.nodes["init"].params.get("f_number", "default")
    steps = [
        (set_parameter("init", "f_number", 3.5), f"Set init.f_number: {had} → 3.5"),
        (set_parameter("init", "f_number", expression("2*2")), "Link init.f_number: 3.5 → = 2*2"),
        (set_parameter("init", "f_number", ABSENT), "Reset init.f_number: = 2*2 → default"),
        (remove_nodes(("init",)), "Delete init"),
    ]
    for operation, _ in steps:
        document.do(operation)
    lines = [document.line(position) for position in range(len(steps) + 1)]
    assert lines == ["", *(line for _, line in steps)]


def test_going_back_is_one_step(library):
    kept = load_network(shipped_networks()["first_steps"], library=library)
    document = Document(kept, library=library)
    document.do(set_parameter("blur", "sigma_x_mrad", 3.0))
    document.do(remove_nodes(("blur",)))
    changed = document.text()
    steps = document.position
    assert document.do(restored(kept, "Go back to Snapshot 1"))
    assert document.network is kept
    assert document.position == steps + 1
    assert document.undo_text == "Go back to Snapshot 1"
    document.undo()
    assert document.text() == changed
    document.redo()
    assert document.network == kept
    assert not document.do(restored(kept, "Go back to Snapshot 1"))  # it is there already
