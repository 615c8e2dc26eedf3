"""Recovery files as they may be found: without locks, damaged, strange, among other files."""

import json

import pytest

from app.editor.recovery_files import recoverable
from core.atomic import take
from core.errors import NetworkError
from core.network.network import Network


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
