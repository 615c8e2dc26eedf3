"""Tests."""

import os
import shutil
import stat
import time

import pytest

from child_process import kill_program, run_program
from core import atomic
from core.atomic import (
    ABANDONED_S,
    FOLDER_PREFIX,
    LOCK,
    OLD_S,
    _try,
    atomic_file,
    new_mark,
    sweep,
    write_bytes,
    write_text,
)
from core.errors import FileError

# As root nothing is forbidden: the child becomes an ordinary user first.
AS_ORDINARY_USER = """
import os, sys, tempfile
from pathlib import Path
from core.atomic import write_text
from core.errors import FileError
if os.getuid() == 0:
    os.setuid(65534)
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    case = sys.argv[1]
    target = folder / "a.txt"
    target.write_text("old")
    if case == "folder":
        folder.chmod(0o500)
        target = folder / "b.txt"
    else:
        target.chmod(0o400)
    try:
        write_text(target, "new")
        print("written")
    except FileError as error:
        print(error.message)
    folder.chmod(0o700)
    print(sorted(entry.name for entry in folder.iterdir()), (folder / "a.txt").read_text())
"""

HALF_WRITTEN = """
import sys, time
from core.atomic import atomic_file
with atomic_file(sys.argv[1]) as temporary, temporary.open("wb") as file:
    file.write(b"n" * 500_000)
    file.flush()
    print("half", flush=True)
    time.sleep(60)
"""

FULL_DISK = """
import resource, sys
from core.atomic import write_bytes
from core.errors import FileError
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    write_bytes(sys.argv[1], bytes(5000))
except FileError as error:
    print(error.message)
"""


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


def test_writes_a_new_file_and_leaves_nothing_else(tmp_path):
    write_text(tmp_path / "a.txt", "µm\n")
    assert (tmp_path / "a.txt").read_bytes() == b"\xc2\xb5m\n"
    assert names(tmp_path) == ["a.txt"]


def test_new_file_follows_the_umask_and_replaced_one_keeps_its_mode(tmp_path):
    old = os.umask(0o027)
    try:
        write_bytes(tmp_path / "new", b"1")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640
    (tmp_path / "new").chmod(0o604)
    write_bytes(tmp_path / "new", b"2")
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o604


def test_temporary_file_has_the_same_suffix_and_folder(tmp_path):
    with atomic_file(tmp_path / "a.exr") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".exr"
        temporary.write_bytes(b"x")


def test_symbolic_link_stays_a_link(tmp_path):
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_text(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


@pytest.mark.parametrize("fault", [ValueError("mine"), KeyboardInterrupt()])
def test_failure_in_the_block_leaves_the_old_file(tmp_path, fault):
    (tmp_path / "a").write_text("old")

    def write_half():
        with atomic_file(tmp_path / "a") as temporary:
            temporary.write_text("half")
            raise fault

    with pytest.raises(type(fault)):
        write_half()
    assert names(tmp_path) == ["a"]
    assert (tmp_path / "a").read_text() == "old"


def test_refuses_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    cases = {
        "": "path is empty",
        str(tmp_path): "path is a folder",
        f"{tmp_path}/new/": "names a folder",
        str(tmp_path / "none" / "a.txt"): "there is no folder",
        "/proc/a.txt": "files cannot be created in /proc",
        str(tmp_path / "pipe"): "not a regular file",
        "a\0b": "null character",
        str(tmp_path / "pipe" / "a"): "Not a directory",
        str(tmp_path / ("n" * 300)): "File name too long",
    }
    for path, message in cases.items():
        with pytest.raises(FileError, match=message) as caught:
            write_text(path, "x")
        assert "\n" not in caught.value.message
    assert names(tmp_path) == ["pipe"]


def test_read_only_file_is_not_replaced():
    message, left = run_program(AS_ORDINARY_USER, "file").stdout.splitlines()
    assert "read-only" in message
    assert left == "['a.txt'] old"


def test_full_disk_leaves_the_old_file(tmp_path):
    (tmp_path / "a").write_text("old")
    (message,) = run_program(FULL_DISK, str(tmp_path / "a")).stdout.splitlines()
    assert message.startswith(f"cannot write {tmp_path / 'a'}: File too large")
    assert names(tmp_path) == ["a"]
    assert (tmp_path / "a").read_text() == "old"


def test_killed_in_the_midst_of_writing_leaves_the_old_file(tmp_path):
    target = tmp_path / "a.bin"
    target.write_bytes(b"old" * 1000)
    kill_program(HALF_WRITTEN, str(target), says="half")
    assert target.read_bytes() == b"old" * 1000
    write_bytes(target, b"next")
    assert target.read_bytes() == b"next"


# What killed processes leave is cleared away, and nothing else.

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


def aged(path, days):
    moment = time.time() - days * 24 * 3600
    os.utime(path, (moment, moment))


def test_what_a_killed_process_leaves_is_gone_with_the_next_write(tmp_path):
    (tmp_path / "net.json").write_text("old")
    kill_program(LEAVING, str(tmp_path), says="written")
    left = names(tmp_path)
    assert len(left) == 3
    assert all(name.startswith((".imagechain-", ".net.imagechain-", "net.json")) for name in left)
    assert (tmp_path / "net.json").read_text() == "old"
    write_text(tmp_path / "other.txt", "new")
    (half,) = set(names(tmp_path)) - {"net.json", "other.txt"}
    assert half.startswith(".net.imagechain-")
    aged(tmp_path / half, OLD_S / 24 / 3600 + 1)
    sweep(tmp_path)
    assert names(tmp_path) == ["net.json", "other.txt"]


def test_a_lock_that_is_held_keeps_a_folder(tmp_path):
    place = tmp_path / f"{FOLDER_PREFIX}{new_mark()}"
    place.mkdir()
    descriptor = os.open(place / LOCK, os.O_RDWR | os.O_CREAT)
    _try(descriptor)
    aged(place, 400)
    sweep(tmp_path)
    assert place.is_dir()
    os.close(descriptor)  # as when its process ends
    sweep(tmp_path)
    assert names(tmp_path) == []


def test_what_was_never_locked_stays_for_a_while(tmp_path):
    """A folder may be locked in a moment, or lie where there are no locks; a file has none."""
    place, file = (
        tmp_path / f"{FOLDER_PREFIX}{new_mark()}",
        tmp_path / f".net{FOLDER_PREFIX}{new_mark()}",
    )
    place.mkdir()
    (place / LOCK).touch()
    file.touch()
    for path, age in ((place, ABANDONED_S), (file, OLD_S)):
        aged(path, age / 24 / 3600 - 0.5)
        sweep(tmp_path)
        assert path.exists()
        aged(path, age / 24 / 3600 + 0.5)
        sweep(tmp_path)
        assert not path.exists()


def test_links_and_other_names_are_left_alone(tmp_path):
    mark = new_mark()
    kept, folder = tmp_path / "kept", tmp_path / "folder"
    kept.mkdir()
    folder.mkdir()
    (kept / "work.txt").write_text("work")
    (folder / f"{FOLDER_PREFIX}{mark}").symlink_to(kept, target_is_directory=True)
    (folder / f".net.imagechain-{mark}.json").symlink_to(kept / "work.txt")
    (folder / f".net.imagechain-{mark}").mkdir()  # a folder by the name of a file
    (folder / f"{FOLDER_PREFIX}{mark[:-1]}").mkdir()
    (folder / f"{FOLDER_PREFIX}{mark}0").mkdir()
    (folder / f"imagechain-{mark}").mkdir()
    (folder / f"net.imagechain-{mark}.json").touch()
    before = names(folder)
    for path in folder.iterdir():
        if not path.is_symlink():
            aged(path, 400)
    sweep(folder)
    assert names(folder) == before
    assert (kept / "work.txt").read_text() == "work"


def test_a_folder_that_is_swept_takes_nothing_along_that_it_links_to(tmp_path):
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept/work.txt").touch()
    place = tmp_path / f"{FOLDER_PREFIX}{new_mark()}"
    place.mkdir()
    (place / "link").symlink_to(tmp_path / "kept", target_is_directory=True)
    os.mkfifo(place / LOCK)  # opening it would wait
    aged(place, 400)
    sweep(tmp_path)
    assert names(tmp_path) == ["kept"]
    assert names(tmp_path / "kept") == ["work.txt"]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may give files away")
def test_what_another_user_left_stays(tmp_path):
    place = tmp_path / f"{FOLDER_PREFIX}{new_mark()}"
    place.mkdir()
    aged(place, 400)
    shutil.chown(place, 65534)
    sweep(tmp_path)
    assert place.is_dir()


@pytest.mark.skipif(os.name == "nt", reason="an open file cannot be removed")
def test_a_lock_is_of_the_file_that_is_there(tmp_path, monkeypatch):
    """Between opening and locking it, the one who had it removes the file, as a study does."""
    path, tried = tmp_path / "a.lock", atomic._try

    def late(descriptor):
        if not made:
            path.unlink()
            made.append(path)
        tried(descriptor)

    made = []
    monkeypatch.setattr(atomic, "_try", late)
    let_go = atomic.take(path)
    assert made
    assert atomic.is_held(path)
    assert atomic.take(path) is None
    let_go()
    assert not path.exists()


def test_a_link_is_no_lock(tmp_path):
    (tmp_path / "data").write_text("important")
    (tmp_path / "a.lock").symlink_to("data")
    with pytest.raises(OSError, match="symbolic"):
        atomic.take(tmp_path / "a.lock")
    assert (tmp_path / "data").read_text() == "important"
