"""What killed processes leave is cleared away, and nothing else."""

import os
import shutil
import time

import pytest

from child_process import kill_program
from core.atomic import ABANDONED_S, FOLDER_PREFIX, LOCK, new_mark, sweep, take, write_text

LEAVING = """
import sys, time
from pathlib import Path
from core.atomic import atomic_file
from core.atomic import take
from core.atomic import FOLDER_PREFIX, LOCK, new_mark
folder = Path(sys.argv[1])
place = folder / (FOLDER_PREFIX + new_mark())
place.mkdir()
lock = take(place / LOCK)
(place / "0.png").write_bytes(b"half")
with atomic_file(folder / "net.json") as half:
    half.write_text("half")
    print("written", flush=True)
    time.sleep(600)
"""


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def aged(path, days):
    moment = time.time() - days * 24 * 3600
    os.utime(path, (moment, moment))


def dead(mark):
    """The mark of a process that has ended: the number is one too high for any."""
    host, _, start, rest = mark.split("-")
    return f"{host}-99999999-{start}-{rest}"


def foreign(mark):
    """The mark of a process of another machine."""
    return f"{int(mark[:8], 16) ^ 1:08x}{mark[8:]}"


def test_what_a_killed_process_leaves_is_gone_with_the_next_write(tmp_path):
    (tmp_path / "net.json").write_text("old")
    kill_program(LEAVING, str(tmp_path), says="written")
    left = names(tmp_path)
    assert len(left) == 3
    assert all(name.startswith((".imagechain-", ".net.", "net.json")) for name in left)
    assert (tmp_path / "net.json").read_text() == "old"
    write_text(tmp_path / "other.txt", "new")
    assert names(tmp_path) == ["net.json", "other.txt"]


def test_what_a_living_process_needs_stays(tmp_path):
    (tmp_path / f"{FOLDER_PREFIX}{new_mark()}").mkdir()
    (tmp_path / f".net.{new_mark()}.json").touch()
    before = names(tmp_path)
    for path in tmp_path.iterdir():
        aged(path, 400)
    sweep(tmp_path)
    assert names(tmp_path) == before


def test_a_number_given_to_another_process_does_not_keep_it(tmp_path):
    host, pid, start, rest = new_mark().split("-")
    (tmp_path / f"{FOLDER_PREFIX}{host}-{pid}-{int(start, 16) ^ 1:08x}-{rest}").mkdir()
    sweep(tmp_path)
    assert names(tmp_path) == []


def test_a_lock_that_is_held_keeps_it(tmp_path):
    """As on a drive that two machines share that are copies of each other."""
    place = tmp_path / f"{FOLDER_PREFIX}{dead(new_mark())}"
    place.mkdir()
    lock = take(place / LOCK)
    sweep(tmp_path)
    assert place.is_dir()
    lock.let_go()
    sweep(tmp_path)
    assert names(tmp_path) == []


@pytest.mark.parametrize("name", [foreign(dead(new_mark())), "0123456789ab"], ids=["marked", "old"])
def test_what_nobody_here_can_know_stays_for_a_month(name, tmp_path):
    place = tmp_path / f"{FOLDER_PREFIX}{name}"
    place.mkdir()
    aged(place, ABANDONED_S / 24 / 3600 - 1)
    sweep(tmp_path)
    assert place.is_dir()
    aged(place, ABANDONED_S / 24 / 3600 + 1)
    sweep(tmp_path)
    assert names(tmp_path) == []


def test_links_and_other_names_are_left_alone(tmp_path):
    mark = dead(new_mark())
    kept, folder = tmp_path / "kept", tmp_path / "folder"
    kept.mkdir()
    folder.mkdir()
    (kept / "work.txt").write_text("work")
    (folder / f"{FOLDER_PREFIX}{mark}").symlink_to(kept, target_is_directory=True)
    (folder / f".net.{mark}.json").symlink_to(kept / "work.txt")
    (folder / f".net.{mark}").mkdir()  # a folder by the name of a file
    (folder / f"{FOLDER_PREFIX}{mark[:-1]}").mkdir()
    (folder / f"{FOLDER_PREFIX}{mark}0").mkdir()
    (folder / f"imagechain-{mark}").mkdir()
    (folder / f"net.{mark}.json").touch()
    before = names(folder)
    sweep(folder)
    assert names(folder) == before
    assert (kept / "work.txt").read_text() == "work"


def test_a_folder_that_is_swept_takes_nothing_along_that_it_links_to(tmp_path):
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept/work.txt").touch()
    place = tmp_path / f"{FOLDER_PREFIX}{dead(new_mark())}"
    place.mkdir()
    (place / "link").symlink_to(tmp_path / "kept", target_is_directory=True)
    os.mkfifo(place / LOCK)  # opening it would wait
    sweep(tmp_path)
    assert names(tmp_path) == ["kept"]
    assert names(tmp_path / "kept") == ["work.txt"]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may give files away")
def test_what_another_user_left_stays(tmp_path):
    place = tmp_path / f"{FOLDER_PREFIX}{dead(new_mark())}"
    place.mkdir()
    shutil.chown(place, 65534)
    sweep(tmp_path)
    assert place.is_dir()
