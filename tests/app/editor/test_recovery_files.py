"""Recovery files as they may be found: without locks, damaged, strange, among other files."""

import json
import subprocess
import sys

import pytest

from app.editor.recovery_files import Autosave, recoverable
from app.run.shipped import shipped_networks
from child_process import PATIENCE_S, ROOT, kill_program
from core.atomic import take
from core.editing.document import Document
from core.editing.operations import remove_nodes
from core.errors import NetworkError
from core.network.file import read_network
from core.network.network import Network, Node


@pytest.fixture
def kodak(library):
    return read_network(shipped_networks()["kodak_kir310"], library=library)


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "state" / "recovery"


def left_behind(folder, name="0123", **changes):
    """A recovery file without a lock, as on a file system that knows none."""
    fields = {
        "format": "imagechain-recovery", "version": 1, "original": None, "time": 1e9,
        "network": '{"format": "imagechain-network", "version": 1, "nodes": {}}',
    }  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.recovery"
    file.write_text(json.dumps({**fields, **changes}))
    return file


def test_a_living_process_is_told_by_its_lock(folder, library):
    file = left_behind(folder)
    (work,) = recoverable(folder)
    assert work.document(library).network == Network()
    let_go = take(file.with_suffix(".lock"))
    assert let_go is not None
    assert recoverable(folder) == ()
    let_go()
    file.with_suffix(".lock").touch()
    assert len(recoverable(folder)) == 1


@pytest.mark.parametrize("content", [b"{", b"[" * 200_000])
def test_a_damaged_file_is_told_and_can_be_discarded(folder, library, content):
    good = left_behind(folder, "good")
    bad = folder / "bad.recovery"
    bad.write_bytes(content)
    works = {work.file: work for work in recoverable(folder)}
    assert works.keys() == {good, bad}
    assert not works[good].problem
    assert "damaged" in works[bad].problem
    assert works[bad].original is None
    with pytest.raises(NetworkError, match=r"bad\.recovery: the recovery file is damaged"):
        works[bad].document(library)
    works[bad].discard()
    assert [work.file for work in recoverable(folder)] == [good]


@pytest.mark.parametrize("changes", [{"format": "other"}, {"time": 1e300}])
def test_strange_fields_are_told(folder, changes):
    left_behind(folder, **changes)
    (work,) = recoverable(folder)
    assert work.problem
    assert "\n" not in work.problem


@pytest.mark.parametrize(
    "network",
    [
        "no network",
        '{"format": "imagechain-network", "version": 1, "nodes": {}, "links": [["a.b", "c.d"]]}',
    ],
)
def test_a_network_that_cannot_be_worked_on_is_refused(folder, library, network):
    left_behind(folder, network=network)
    (work,) = recoverable(folder)
    with pytest.raises(NetworkError):
        work.document(library)


# Unsaved work survives: crashes, kills, full disks; and nobody's living work is taken for lost.


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
from core.network.file import read_network
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
