"""Output files appear together or not at all."""

import os
from functools import partial

import pytest

import app.run.staging as staging_module
from app.run.staging import Staging
from child_process import kill_program
from core.atomic import write_text
from core.errors import FileError


def names(folder):
    return sorted(path.name for path in folder.rglob("*"))


def test_nothing_before_commit_and_all_after(tmp_path):
    with Staging(tmp_path / "out/deep") as staging:
        staging.write(tmp_path / "a.txt", partial(write_text, content="a"))
        staging.write(tmp_path / "out/deep/b.txt", partial(write_text, content="b"))
        assert not (tmp_path / "a.txt").exists()
        assert not (tmp_path / "out").exists()
        staging.commit()
    assert names(tmp_path) == ["a.txt", "b.txt", "deep", "out"]
    assert (tmp_path / "out/deep/b.txt").read_text() == "b"


def test_without_commit_nothing_stays(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with Staging(tmp_path) as staging:
        staging.write(tmp_path / "a.txt", partial(write_text, content="new"))
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_a_failing_commit_takes_back_what_it_did(tmp_path, monkeypatch):
    put = staging_module._put

    def failing(file, target, undo):
        if target.name == "late":
            raise OSError(28, "No space left on device")
        put(file, target, undo)

    monkeypatch.setattr(staging_module, "_put", failing)
    (tmp_path / "a.txt").write_text("old")
    with Staging(tmp_path / "out") as staging:
        for name in ("a.txt", "new.txt", "out/c.txt", "late"):
            staging.write(tmp_path / name, partial(write_text, content="new"))
        with pytest.raises(FileError, match="late: No space left"):
            staging.commit()
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_refuses_what_it_may_not_write(tmp_path, monkeypatch):
    (tmp_path / "input.txt").touch()
    (tmp_path / "same.txt").symlink_to(tmp_path / "input.txt")
    (tmp_path / "old.txt").touch()
    staging = Staging(tmp_path / "out", [tmp_path / "input.txt"])
    for name in ("input.txt", "same.txt", "no/file.txt", "old.txt/file.txt", "."):
        with pytest.raises(FileError, match="cannot write"):
            staging.claim(tmp_path / name)
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(FileError, match="read-only"):
        staging.claim(tmp_path / "old.txt")
    with pytest.raises(FileError, match="permission"):
        staging.claim(tmp_path / "new.txt")


def test_a_target_that_leads_elsewhere_since_it_was_claimed(tmp_path):
    """Both before it is prepared and once it is; nothing is written either way."""
    for before in (True, False):
        here, there = tmp_path / f"here{before}", tmp_path / f"there{before}"
        there.mkdir()
        with Staging(here) as staging:
            staging.claim(here / "a.txt")
            writing = partial(staging.write, here / "a.txt", partial(write_text, content="new"))
            if not before:
                writing()
            here.symlink_to(there, target_is_directory=True)
            with pytest.raises(FileError, match=f"since the run began, .* a link to {there}/a.txt"):
                (writing if before else staging.commit)()
        assert not list(there.iterdir())


KILLED = """
import sys, time
from functools import partial
from pathlib import Path
from app.run.staging import Staging
from core.atomic import write_text
folder = Path(sys.argv[1])
with Staging(folder / "out/deep") as staging:
    for target in (folder / "a.txt", folder / "out/deep/b.txt"):
        staging.write(target, partial(write_text, content="new"))
    print("prepared", flush=True)
    time.sleep(600)
"""


def test_the_next_run_clears_away_what_a_killed_one_left(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    kill_program(KILLED, str(tmp_path), says="prepared")
    assert len(names(tmp_path)) > 2
    with Staging(tmp_path / "out/deep") as staging:
        staging.claim(tmp_path / "out/deep/b.txt")
    assert names(tmp_path) == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"
