"""The queue with its real processes: one after the other, stopped, failed, and none left over."""

import pytest
from PySide6.QtCore import QObject

from app.editor.docks.runs import RunQueue, job_of, proposed_folder
from core.editing.document import Document
from core.editing.operations import set_network_field, set_parameter


@pytest.fixture
def queue(qtbot):
    parent = QObject()
    made = RunQueue(parent)
    yield made
    made.close()
    parent.deleteLater()


@pytest.fixture
def small(opened):
    """First steps, small."""
    session = opened("first_steps")
    session.open(Document(session.network, library=session.library))
    for name in ("width", "height"):
        session.do(set_parameter("scene", name, 64))
    return session


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_runs_go_one_after_the_other_and_reports_at_once(queue, qtbot, small, tmp_path):
    states = []
    queue.changed.connect(lambda run: states.append((run.title, run.state)))
    for title, kind, output in (
        ("1", "run", "one"),
        ("2", "run", "two"),
        ("3", "report", "r.html"),
        ("4", "run", "four"),
    ):
        queue.add(title, job_of(small, kind, tmp_path / output))
    assert [run.state for run in queue.runs] == ["running", "waiting", "running", "waiting"]
    for run in queue.runs[2:]:  # one that waits never begins
        run.stop()
    qtbot.waitUntil(lambda: not queue.unfinished)
    assert [run.state for run in queue.runs] == ["done", "done", "cancelled", "cancelled"]
    assert states.index(("1", "done")) < states.index(("2", "running"))
    assert ("4", "running") not in states
    assert names(tmp_path) == ["one", "two"]
    assert names(tmp_path / "two") == ["final.png", "mtf.csv", "readouts.json"]
    assert queue.runs[0].seconds > 0
    queue.clear()
    assert queue.runs == []


def test_folders_are_proposed_that_are_free(small, tmp_path):
    small.save(tmp_path / "mine.json")
    first = proposed_folder(small, "sweep", set())
    assert first == tmp_path / "mine-sweep"
    first.mkdir()
    taken = {tmp_path / "mine-sweep-2"}
    assert proposed_folder(small, "sweep", taken) == tmp_path / "mine-sweep-3"


@pytest.mark.parametrize(("name", "folder"), [("Band 3/5 (µ)", "band_3_5__µ_"), ("", "network")])
def test_what_is_not_saved_goes_by_its_name(small, tmp_path, monkeypatch, name, folder):
    monkeypatch.chdir(tmp_path)
    small.do(set_network_field("name", name))
    assert proposed_folder(small, "run", set()) == tmp_path / f"{folder}-run"
