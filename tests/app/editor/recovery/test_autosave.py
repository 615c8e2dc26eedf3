"""Unsaved work survives: crashes, kills, full disks; and nobody's living work is taken for lost."""

from __future__ import annotations

import subprocess
import sys

import pytest

from app.editor.recovery_files import Autosave, recoverable
from child_process import PATIENCE_S, ROOT, finished, kill_program
from core.atomic import own_token
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
path = Path(sys.argv[2]) if len(sys.argv) > 2 else None
document = Document(network, library=library, path=path)
document.do(remove_nodes(("slices",)))
Autosave(document, Path(sys.argv[1])).write_if_changed()
print("written", flush=True)
if len(sys.argv) > 3:
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
from core.atomic import own_token
from core.network.network import Network, Node
document = Document(Network("busy"), library={})
autosave = Autosave(document, Path(sys.argv[1]))
for number in range(10**9):
    document.do(set_network_field("description", f"{number} " * 40_000))
    autosave.write_if_changed()
    if number == 0:
        print("writing", flush=True)
"""

FULL_DISK = """
import resource, signal, sys
from pathlib import Path
from app.editor.recovery_files import Autosave
from core.editing.document import Document
from core.editing.operations import set_network_field
from core.errors import FileError
from core.atomic import own_token
from core.network.network import Network, Node
document = Document(Network("a"), library={})
autosave = Autosave(document, Path(sys.argv[1]))
document.do(set_network_field("description", "first"))
autosave.write_if_changed()
old = autosave.path.read_bytes()
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
document.do(set_network_field("description", "x" * 100_000))
try:
    autosave.write_if_changed()
except FileError as error:
    assert autosave.path.read_bytes() == old
    print("kept:", error, flush=True)
document.do(set_network_field("description", "short again"))
assert autosave.write_if_changed()
import os
os._exit(1)
"""


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "state" / "recovery"


@pytest.fixture
def document(kodak, library):
    return Document(kodak, library=library)


def crashed(folder, *more):
    program = [sys.executable, "-c", CRASH, str(folder), *map(str, more)]
    done = finished(program)
    assert (done.returncode, done.stderr) == (1, "")


def test_work_is_recovered_after_a_crash(folder, shipped, library, tmp_path):
    crashed(folder, tmp_path / "mine.json")
    (work,) = recoverable(folder)
    assert work.original == tmp_path / "mine.json"
    assert not work.problem
    document = work.document(library)
    expected = Document(shipped["kodak_kir310"], library=library)
    expected.do(remove_nodes(("slices",)))
    assert document.text() == expected.text() == work.text
    assert document.path == work.original
    assert document.modified
    work.discard()
    assert recoverable(folder) == ()
    assert list(folder.iterdir()) == []


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
    content = file.read_text().replace(own_token(), "another process")
    file.write_text(content)
    (work,) = recoverable(folder)
    assert work.document(library).network.nodes["a"].params["path"] == "../first/scene.npy"


def test_a_living_process_keeps_its_work_to_itself(folder, tmp_path):
    command = [sys.executable, "-c", CRASH, str(folder), str(tmp_path / "a.json"), "wait"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=ROOT, **pipes) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "written\n"
        assert len(list(folder.glob("*.recovery"))) == 1
        assert recoverable(folder) == ()
        child.communicate("", timeout=PATIENCE_S)
    assert len(recoverable(folder)) == 1


@pytest.mark.parametrize("after_s", [0.0, 0.11])
def test_a_kill_leaves_the_last_state_or_the_one_before_never_half_of_one(folder, after_s):
    kill_program(BUSY, str(folder), says="writing", after_s=after_s)
    (work,) = recoverable(folder)
    assert not work.problem
    number, _, rest = work.document({}).network.description.partition(" ")
    assert rest == f"{number} " * 39_999
    work.discard()
    assert list(folder.iterdir()) == []  # what was half written is gone, too


def test_a_full_disk_is_told_and_the_work_kept_before_stays(folder):
    """The child exits with 1, as one that crashed, after it has written once more."""
    command = [sys.executable, "-c", FULL_DISK, str(folder)]
    done = finished(command)
    assert done.stdout.startswith("kept: cannot write"), done.stderr
    (work,) = recoverable(folder)
    assert work.document({}).network.description == "short again"
    assert sorted(path.suffix for path in folder.iterdir()) == [".lock", ".recovery"]


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
