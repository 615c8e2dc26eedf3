"""The open document: its history, its modified mark, what it tells, what it refuses, saving."""

from __future__ import annotations

import pytest

from child_process import run_program
from core.editing.document import Document
from core.editing.fields import set_node_field, set_parameter
from core.editing.links import Rewire
from core.editing.nodes import Add, Move, Placed, Remove
from core.editing.operation import ABSENT, Together
from core.errors import FileError, NetworkError
from core.network.file import read_network
from core.network.network import Link, Network, Node


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


def test_setting_the_present_value_is_no_step(document):
    present = document.network.nodes["init"].params["f_number"]
    for value in (present, int(present), 2.0):
        assert not document.do(set_parameter("init", "f_number", value))
    assert document.history.position == 0
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
    assert document.do(Together((Remove(("a",)), Add((Placed(Node("a", "back_transform")),)))))
    assert list(document.network.nodes) == ["b", "a"]
    document.undo()
    assert list(document.network.nodes) == ["a", "b"]


def test_one_drag_is_one_step(document):
    drag = object()
    for x in range(1, 40):
        assert document.do(Move({"init": (480.0 + x, 0)}), gesture=drag)
    assert document.history.position == 1
    document.undo()
    assert document.network.layout["init"] == (480, 0)
    document.redo()
    assert document.network.layout["init"] == (519, 0)


def test_steps_of_one_kind_are_apart_without_a_gesture_or_after_its_end(document):
    move = [Move({"init": (float(x), 0)}) for x in range(4)]
    document.do(move[0])
    document.do(move[1])
    document.do(move[2], gesture="drag")
    document.end_gesture()
    document.do(move[3], gesture="drag")
    assert document.history.position == 4


def test_after_an_undo_a_gesture_does_not_go_on(document):
    document.do(Move({"init": (1.0, 0)}), gesture="drag")
    document.do(Move({"scene": (1.0, 0)}))
    document.undo()
    document.do(Move({"init": (2.0, 0)}), gesture="drag")
    document.undo()
    assert document.network.layout["init"] == (1, 0)


def test_a_drag_back_to_where_it_began_is_no_step(document):
    for x in (481.0, 490.0, 480.0):
        document.do(Move({"init": (x, 0)}), gesture="drag")
    assert document.history.position == 0
    assert not document.modified
    assert document.network.layout["init"] == (480, 0)
    document.do(Move({"init": (500.0, 0)}), gesture="drag")
    assert document.history.position == 1


def test_a_drag_of_thousands_of_events_is_undone(document):
    """Its parts must neither pile up nor nest: Python's stack would end."""
    for x in range(3000):
        step = Together(
            (Move({"init": (float(x), 1.0)}), set_parameter("init", "range_m", x + 1.5))
        )
        document.do(step, gesture="drag")
    assert document.history.position == 1
    document.undo()
    assert document.network.layout["init"] == (480, 0)
    assert document.network.nodes["init"].params["range_m"] == 402.0
    document.redo()
    assert document.network.nodes["init"].params["range_m"] == 3000.5


def test_the_modified_mark_follows_undo_and_redo(document, tmp_path):
    document.do(Remove(("slices",)))
    assert document.modified
    document.save(tmp_path / "a.json")
    assert not document.modified
    document.undo()
    assert document.modified
    document.redo()
    assert not document.modified
    document.undo()
    document.do(Remove(("picture",)))  # the saved state can be reached no more
    document.undo()
    assert document.modified
    assert document.history.redo_text == "Delete picture"


def test_a_save_in_the_middle_of_a_drag_begins_a_new_step(document, tmp_path):
    document.do(Move({"init": (1.0, 0)}), gesture="drag")
    document.save(tmp_path / "a.json")
    document.do(Move({"init": (2.0, 0)}), gesture="drag")
    assert document.modified
    document.undo()
    assert not document.modified


def test_listeners_hear_every_change_and_only_those(document):
    heard = []
    document.listen(lambda before, after: heard.append((before, after)))
    first = document.network
    document.do(Move({"init": (480.0, 0)}))
    document.redo()
    assert heard == []
    document.do(Remove(("slices",)))
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
        document.do(Rewire(add=tuple(links)))
    assert document.network is before
    assert document.history.position == 0


def test_wiring_that_was_wrong_before_can_be_mended(library):
    nodes = {name: Node(name, "jitter_mtf") for name in "abc"}
    loop = (Link("a", "magnitude", "b", "magnitude"), Link("b", "magnitude", "a", "magnitude"))
    document = Document(Network(nodes=nodes, links=loop), library=library)
    assert document.do(Rewire(add=(Link("b", "magnitude", "c", "magnitude"),)))
    assert document.do(Rewire(remove=loop[:1]))


def test_a_refused_operation_leaves_the_redo_steps(document):
    document.do(Remove(("slices",)))
    document.undo()
    with pytest.raises(NetworkError):
        document.do(Remove(("nobody",)))
    document.redo()
    assert "slices" not in document.network.nodes


def test_saving_writes_what_is_opened_again(document, library, tmp_path):
    document.do(set_parameter("init", "f_number", ABSENT))
    document.save(tmp_path / "a.json")
    assert document.path == tmp_path / "a.json"
    assert document.folder == tmp_path
    assert read_network(tmp_path / "a.json", library=library) == document.network


def test_a_document_without_a_file_asks_for_one(document):
    with pytest.raises(NetworkError, match="say where"):
        document.save()


def test_a_save_that_fails_loses_nothing(document, tmp_path):
    document.do(Remove(("slices",)))
    with pytest.raises(FileError):
        document.save(tmp_path / "no such folder" / "a.json")
    assert document.modified
    assert document.path is None
    document.undo()
    assert "slices" in document.network.nodes


FULL_DISK = """
import resource, signal, sys
from pathlib import Path
from core.editing.document import Document
from core.editing.fields import set_network_field
from core.errors import FileError
from core.network.network import Network
document = Document(Network("a"), library={})
path = Path(sys.argv[1]) / "a.json"
document.save(path)
old = path.read_bytes()
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))
document.do(set_network_field("description", "x" * 100_000))
try:
    document.save()
except FileError as error:
    assert document.modified and path.read_bytes() == old
    assert [each.name for each in path.parent.iterdir()] == ["a.json"]
    print("kept:", error)
"""


def test_a_full_disk_leaves_the_old_file_and_the_modified_mark(tmp_path):
    assert run_program(FULL_DISK, str(tmp_path)).stdout.startswith("kept: cannot write")


def test_points_of_nodes_that_are_not_there_are_dropped(library):
    network = Network(nodes={"a": Node("a", "x")}, layout={"a": (0, 0), "b": (1, 1)})
    document = Document(network, library=library)
    assert document.network.layout == {"a": (0, 0)}
    assert not document.modified
