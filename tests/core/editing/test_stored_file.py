"""Two that work on one file: neither overwrites the other unknowingly."""

from __future__ import annotations

import json
import os

import pytest

from app.editor.recovery.recovery_files import Autosave, recoverable
from child_process import run_program
from core.editing.document import Document
from core.editing.fields import set_network_field
from core.editing.stored_file import GONE, mark, mark_of
from core.errors import ChangedFileError
from core.network.file import read_text
from core.network.network import Network


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


def test_the_second_to_save_is_refused_and_the_first_ones_work_stands(file, library):
    one, two = opened(file, library), opened(file, library)
    one.do(set_network_field("name", "one"))
    two.do(set_network_field("name", "two"))
    one.save()
    with pytest.raises(ChangedFileError, match=r"mine.json has been changed since it was opened"):
        two.save()
    assert named(file) == "one"
    assert two.modified
    two.save(over=True)
    assert named(file) == "two"
    assert two.disagreement() == ""
    assert one.disagreement() == "changed"


def test_one_alone_saves_again_and_again(file, library):
    document = opened(file, library)
    for number in range(5):
        document.do(set_network_field("name", f"version {number}"))
        document.save()
        assert named(file) == f"version {number}"


def test_another_file_is_written_whatever_became_of_the_own_one(file, library, tmp_path):
    one, two = opened(file, library), opened(file, library)
    one.do(set_network_field("name", "one"))
    one.save()
    two.do(set_network_field("name", "two"))
    two.save(tmp_path / "other.json")
    assert named(file) == "one"
    assert named(tmp_path / "other.json") == "two"


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


def test_a_file_that_was_only_touched_is_no_other(file, library):
    document = opened(file, library)
    os.utime(file)
    document.do(set_network_field("name", "mine"))
    document.save()
    assert named(file) == "mine"


def test_a_file_changed_and_changed_back_is_no_other(file, library):
    document, content = opened(file, library), file.read_bytes()
    file.write_text("{}")
    file.write_bytes(content)
    document.do(set_network_field("name", "mine"))
    document.save()


def test_a_removed_file_is_noticed_and_can_be_made_anew(file, library):
    document = opened(file, library)
    file.unlink()
    document.do(set_network_field("name", "mine"))
    with pytest.raises(ChangedFileError, match="has been removed"):
        document.save()
    document.save(over=True)
    assert named(file) == "mine"


def test_another_name_of_its_own_file_is_its_own_file(file, library):
    document = opened(file, library)
    link = file.with_name("link.json")
    link.symlink_to(file)
    file.write_text("{}")
    document.do(set_network_field("name", "mine"))
    with pytest.raises(ChangedFileError):
        document.save(link)


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


def test_a_save_that_is_refused_keeps_the_mark_and_the_path(file, library):
    document = opened(file, library)
    file.write_text("{}")
    document.do(set_network_field("name", "mine"))
    for _ in range(2):
        with pytest.raises(ChangedFileError):
            document.save()
    assert document.path == file
    assert document.modified


def test_what_is_no_file_never_agrees(tmp_path, file, library):
    document = opened(file, library)
    file.unlink()
    file.mkdir()
    assert document.disagreement() == "changed"
    assert mark_of(tmp_path / "nothing") == GONE
    os.mkfifo(tmp_path / "pipe")
    assert mark_of(tmp_path / "pipe") not in ("", GONE)


def test_a_file_longer_than_any_network_is_another(file, library):
    document, content = opened(file, library), file.read_bytes()
    with file.open("ab") as stream:
        stream.truncate(2**26)
    assert document.disagreement() == "changed"
    file.write_bytes(content)
    assert document.disagreement() == ""


CRASHED = """
import sys
from pathlib import Path
from app.editor.recovery.recovery_files import Autosave
from core.editing.document import Document
from core.editing.fields import set_network_field
from core.network.network import Network
path, folder = map(Path, sys.argv[1:])
document = Document(Network("first"), library={}, path=path)
document.do(set_network_field("name", "lost"))
Autosave(document, folder).write_if_changed()
"""


def test_recovered_work_does_not_overwrite_what_came_after_the_crash(file, tmp_path, library):
    run_program(CRASHED, str(file), str(tmp_path / "recovery"))
    file.write_text(file.read_text().replace("first", "later"))
    (work,) = recoverable(tmp_path / "recovery")
    document = work.document(library)
    with pytest.raises(ChangedFileError):
        document.save()
    assert named(file) == "later"


def test_recovered_work_is_saved_where_nothing_came_between(file, tmp_path, library):
    run_program(CRASHED, str(file), str(tmp_path / "recovery"))
    (work,) = recoverable(tmp_path / "recovery")
    document = work.document(library)
    document.save()
    assert named(file) == "lost"


def test_recovery_files_of_earlier_versions_still_open(file, tmp_path, library):
    run_program(CRASHED, str(file), str(tmp_path / "recovery"))
    (left,) = (tmp_path / "recovery").glob("*.recovery")
    content = json.loads(left.read_text())
    del content["stored"]
    left.write_text(json.dumps(content))
    (work,) = recoverable(tmp_path / "recovery")
    work.document(library).save()
    assert named(file) == "lost"


def test_what_is_kept_says_what_the_file_held(file, tmp_path, library):
    document = opened(file, library)
    document.do(set_network_field("name", "mine"))
    kept = Autosave(document, tmp_path / "recovery")
    kept.write_if_changed()
    assert json.loads(kept.path.read_text())["stored"] == mark(file.read_bytes())
    kept.finish()
