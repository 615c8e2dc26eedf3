"""Unsaved work survives: crashes, kills, full disks; and nobody's living work is taken for lost."""

import subprocess
import sys

import pytest

from app.editor.recovery_files import Autosave, recoverable
from child_process import PATIENCE_S, ROOT, kill_program
from core.editing.document import Document
from core.editing.operations import remove_nodes
from core.network.network import Network, Node

# Leaves work behind, as a process that ends without a word.
CRASH = """
import os, sys
from pathlib import Path
from app.run.shipped import shipped_networks
from app.editor.recovery_files import Autosave
from core.editing.document import Document
from core.editing.operations import remove_nodes
from core.network.file import read_network
from nodes.library import standard_library
library = standard_library()
network = read_network(shipped_networks()["kodak_kir310"], library=library)
path = Path(sys.argv[2])
document = Document(network, library=library, path=path)
document.do(remove_nodes(("slices",)))
Autosave(document, Path(sys.argv[1])).write_if_changed()
print("written", flush=True)
sys.stdin.read()
os._exit(1)
"""

# Writes state after state as fast as it can, until it is killed. Each fills more than a block.
BUSY = """
import sys
from pathlib import Path
from app.editor.recovery_files import Autosave
from core.editing.document import Document
from core.editing.operations import set_network_field
from core.network.network import Network, Node
document = Document(Network("busy"), library={})
autosave = Autosave(document, Path(sys.argv[1]))
for number in range(10**9):
    document.do(set_network_field("description", f"{number} " * 40_000))
    autosave.write_if_changed()
    if number == 0:
        print("writing", flush=True)
"""


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "state" / "recovery"


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


def test_file_names_of_unsaved_work_point_at_the_same_files(folder, library, tmp_path, monkeypatch):
    """The new process may have been started in another folder."""
    nodes = {"a": Node("a", "read_image", {"path": "scene.npy"})}
    document = Document(Network(nodes=nodes), library=library, saved=False)
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "first")
    autosave = Autosave(document, folder)
    autosave.write_if_changed()
    file = folder / "left.recovery"
    autosave.path.rename(file)
    monkeypatch.chdir(tmp_path / "second")
    (work,) = recoverable(folder)
    assert work.document(library).network.nodes["a"].params["path"] == "../first/scene.npy"


def test_work_is_recovered_once_its_process_has_crashed(folder, kodak, library, tmp_path):
    command = [sys.executable, "-c", CRASH, str(folder), str(tmp_path / "a.json")]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=ROOT, **pipes) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "written\n"
        assert len(list(folder.glob("*.recovery"))) == 1
        assert recoverable(folder) == ()
        child.communicate("", timeout=PATIENCE_S)
    (work,) = recoverable(folder)
    assert work.original == tmp_path / "a.json"
    assert not work.problem
    document = work.document(library)
    expected = Document(kodak, library=library)
    expected.do(remove_nodes(("slices",)))
    assert document.text() == expected.text() == work.text
    assert document.path == work.original
    assert document.modified
    work.discard()
    assert recoverable(folder) == ()
    assert list(folder.iterdir()) == []


def test_a_kill_leaves_the_last_state_or_the_one_before_never_half_of_one(folder):
    kill_program(BUSY, str(folder), says="writing", after_s=0.11)
    (work,) = recoverable(folder)
    assert not work.problem
    number, _, rest = work.document({}).network.description.partition(" ")
    assert rest == f"{number} " * 39_999
    work.discard()
    assert list(folder.iterdir()) == []  # what was half written is gone, too


def test_a_saved_document_has_no_recovery_file(folder, document, tmp_path):
    autosave = Autosave(document, folder)
    assert not autosave.write_if_changed()
    assert not folder.exists()
    document.do(remove_nodes(("slices",)))
    assert autosave.write_if_changed()
    document.save(tmp_path / "a.json")
    assert not autosave.write_if_changed()
    assert list(folder.iterdir()) == []
    document.undo()
    assert autosave.write_if_changed()  # the same autosave goes on
    document.redo()
    assert not autosave.write_if_changed()
    assert list(folder.iterdir()) == []
