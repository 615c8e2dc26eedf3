"""What a network has written is on record, also where runs meet or are killed."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from app.permission import write_rules
from app.permission.state_folder import state_folder
from app.permission.write_record import WriteRecord, read_record, remember_chosen, write_record
from app.run.shipped import find_network
from app.run.staging import Staging
from core.atomic import write_text
from core.errors import FileError

OWN = ["final.png", "mtf.csv", "readouts.json"]

CHANGED = "the file that is there was not written by this network, or has changed since"


def test_a_run_killed_while_it_put_files_in_place_is_known(tmp_path):
    """Whichever of the two files is there afterwards, the network has written it."""
    target = tmp_path / "nets/a.txt"
    record = WriteRecord(tmp_path / "nets/net.json")
    found = []

    class Killed(Staging):
        def commit(self):
            found.append(read_record(record.network))
            super().commit()

    for text in ("one", "two"):
        rules = write_rules.WriteRules((tmp_path,), (), frozenset(), read_record(record.network))
        with Killed(None) as staging:
            staging.claim(target, partial(rules.check, "out"))
            staging.write(target, partial(write_text, content=text))
            assert rules.commit(staging) == ""
    assert found[1].holds(target)
    target.write_text("one")
    assert found[1].holds(target)
    assert not read_record(record.network).holds(target)
    target.write_text("six")
    assert not found[1].holds(target)


def test_runs_of_one_network_at_once_do_not_disown_each_other(tmp_path):
    """Neither refuses what the other wrote meanwhile, nor forgets it, nor what was chosen."""
    network, target, other = (tmp_path / "nets" / name for name in ("net.json", "a.txt", "b.txt"))
    chosen = tmp_path / "elsewhere/c.txt"

    def rules():
        return write_rules.WriteRules((tmp_path,), (), frozenset(), read_record(network))

    def prepare(known, staging, path, text):
        staging.claim(path, partial(known.check, "out"))
        staging.write(path, partial(write_text, content=text))

    late, early = rules(), rules()
    with Staging(None) as last, Staging(None) as first:
        prepare(late, last, target, "late")
        prepare(early, first, target, "early")
        prepare(early, first, other, "other")
        assert early.commit(first) == ""
        remember_chosen(network, [chosen])
        assert late.commit(last) == ""
    known = read_record(network)
    assert target.read_text() == "late"
    assert known.holds(target)
    assert known.holds(other)
    assert known.chosen == {chosen}


def test_records_are_changed_in_turn(tmp_path):
    """None of the files that many choose at once is lost."""
    network = tmp_path / "nets/net.json"
    files = {tmp_path / f"elsewhere/{number}.txt" for number in range(20)}
    with ThreadPoolExecutor(len(files)) as workers:
        list(workers.map(lambda file: remember_chosen(network, [file]), files))
    assert read_record(network).chosen == files


def test_what_changes_while_it_computes_is_seen(tmp_path):
    target = tmp_path / "nets/a.txt"
    rules = write_rules.WriteRules((tmp_path / "nets",), (), frozenset(), WriteRecord(tmp_path))

    def disturbed(change):
        with Staging(None) as staging:
            staging.claim(target, partial(rules.check, "out"))
            staging.write(target, partial(write_text, content="new"))
            change()
            with pytest.raises(FileError) as caught:
                staging.commit()
        return str(caught.value)

    assert "become a link to another place" in disturbed(
        lambda: target.symlink_to(tmp_path / "elsewhere/a.txt")
    )
    target.unlink()
    assert CHANGED in disturbed(lambda: target.write_text("my own work"))
    assert target.read_text() == "my own work"
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.parametrize(
    ("platform", "environment", "place"),
    [
        ("linux", {"HOME": "/h"}, "/h/.local/state/imagechain"),
        ("linux", {"HOME": "/h", "XDG_STATE_HOME": "/s"}, "/s/imagechain"),
        ("linux", {"HOME": "/h", "XDG_STATE_HOME": "s"}, "/h/.local/state/imagechain"),
        ("darwin", {"HOME": "/h"}, "/h/Library/Application Support/imagechain"),
        ("win32", {"LOCALAPPDATA": "/l"}, "/l/imagechain"),
        ("win32", {}, None),
        ("linux", {"HOME": "h"}, None),
        ("linux", {}, None),
    ],
)
def test_where_records_lie(platform, environment, place):
    found = state_folder(environment, platform)
    assert (found and found.as_posix()) == place


def test_a_record_comes_back_as_it_was(tmp_path):
    place = find_network("first_steps")
    odd = Path(os.fsdecode(b"/odd\xff name"))
    kept = WriteRecord(place.path.resolve(), {odd: ((3, "a"), (4, "b"))}, frozenset([odd]))
    write_record(kept)
    assert read_record(place.path) == kept
