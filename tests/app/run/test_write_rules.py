"""What a network that came from elsewhere may write."""

import os
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from app.command.cli import main
from app.run.staging import Staging, WriteRecord, WriteRules, read_record, remember_chosen
from core.atomic import write_text
from core.errors import FileError
from nodes.files.formats import read_pixels

OWN = ["final.png", "mtf.csv", "readouts.json"]
CHANGED = "the existing file was not written by this network, or has changed since"


@pytest.fixture(autouse=True)
def _place(tmp_path, monkeypatch):
    """The network in a folder of its own, below the one where the command is given."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "nets").mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def network(small, write):
    """Write a network with a sink of that path."""

    def save(path, module="write_image"):
        small["nodes"]["out"] = {"module": module, "params": {"path": str(path)}}
        small["links"] = [link for link in small["links"] if link[1] != "out.image"]
        small["links"].append(["back.image", "out.image"])
        return write(small, "nets/net.json")

    return save


@pytest.fixture
def run(capsys):
    """Run in this process: exit code, what it printed, and its line of error."""

    def command(*words):
        code = main(list(map(str, words)))
        done = capsys.readouterr()
        return code, done.out, done.err

    return command


@pytest.fixture
def refused(run, tmp_path):
    """A run that must be refused, and leave everything as it is."""

    def command(*words):
        before = contents(tmp_path)
        code, _, line = run("run", *words)
        assert code == 2, line
        assert line.count("\n") == 1
        assert contents(tmp_path) == before
        return line

    return command


def contents(folder):
    return {
        str(path): path.read_bytes() if path.is_file() else path.is_symlink()
        for path in folder.rglob("*")
    }


OUTSIDE = "the file lies outside the network's folder and the output folder"


@pytest.mark.parametrize(
    ("module", "way"),
    [
        ("write_matrix", "in full"),
        ("write_image", "upwards"),
        ("write_image", "through a link"),
        ("write_matrix", "as a link"),
    ],
)
def test_outside_is_refused_unless_allowed(way, module, network, run, refused, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    name = {"write_image": "a.tif", "write_matrix": "a.csv"}[module]
    target = {"in full": elsewhere / name, "upwards": f"../elsewhere/{name}"}.get(way)
    if way == "through a link":
        (tmp_path / "nets/sub").symlink_to(elsewhere, target_is_directory=True)
        target = f"sub/{name}"
    if way == "as a link":
        (tmp_path / "nets" / name).symlink_to(elsewhere / name)
        target = name
    net = network(target, module)
    line = refused(net)
    assert line.startswith("imagechain: out: cannot write ")
    assert str(target) in line
    assert OUTSIDE in line
    assert f"--allow-writes-to {elsewhere} allows writing there" in line
    refused(net, "--allow-writes-to", tmp_path / "nets")
    words = ("--allow-writes-to", tmp_path / "nets", "--allow-writes-to", elsewhere)
    assert run("run", net, *words)[::2] == (0, "")
    assert (elsewhere / name).is_file()


def test_an_existing_file_is_refused_unless_allowed_or_written_before(
    network, run, refused, tmp_path
):
    target = tmp_path / "nets/a.csv"
    target.write_text("my own work")
    net = network("a.csv", "write_matrix")
    assert CHANGED in refused(net)
    assert run("run", net, "--allow-writes-to", "nets")[0] == 0
    assert "my own" not in target.read_text()
    for _ in range(2):  # it is the network's from now on, also with other content
        assert run("run", net)[::2] == (0, "")
        assert run("run", net, "--set", "blur.sigma_x_mrad=2")[0] == 0
    target.write_text("my own work again")
    assert CHANGED in refused(net)


def test_a_store_is_refused_unless_written_before(network, run, refused, tmp_path):
    path, store = network("a.zarr"), tmp_path / "nets" / "a.zarr"
    for _ in range(2):
        code, _, line = run("run", path)
        assert (code, line) == (0, "")
    first = read_pixels(store)
    assert run("run", path, "--memory", "40kB")[0] == 0
    np.testing.assert_array_equal(read_pixels(store), first)
    (store / "c" / "0" / "0").write_bytes(b"other")
    assert CHANGED in refused(path)
    (store / "zarr.json").unlink()
    assert "a file that is not a Zarr store already has this name" in refused(path)


def test_another_network_s_file_is_refused(network, run, refused, tmp_path):
    assert run("run", network("a.tif"))[0] == 0
    (tmp_path / "nets/net.json").rename(tmp_path / "nets/other.json")
    assert CHANGED in refused("nets/other.json")


def test_a_record_that_came_along_counts_nothing(network, run, refused, tmp_path):
    """All that an archive can bring lies in its own folder."""
    net = network("a.tif")
    assert run("run", net)[0] == 0
    (tmp_path / "state").rename(tmp_path / "nets/.local")
    assert CHANGED in refused(net)


def test_a_file_named_on_the_command_line_is_the_user_s_word(network, run, tmp_path):
    target = tmp_path / "elsewhere/a.tif"
    target.write_bytes(b"old")
    assert run("run", network("b.tif"), "--set", f"out.path={target}")[::2] == (0, "")
    assert read_pixels(target).shape == (40, 48)


def test_a_file_chosen_in_a_dialog_is_the_user_s_word(network, run, refused, tmp_path):
    target = tmp_path / "elsewhere/a.tif"
    net = network(target)
    remember_chosen(Path(net), [target])
    assert run("run", net)[::2] == (0, "")
    assert run("run", net)[::2] == (0, "")
    target.write_bytes(b"retouched")
    assert run("run", net)[::2] == (0, "")
    assert OUTSIDE in refused(network(tmp_path / "elsewhere/b.tif"))
    assert OUTSIDE in refused(network(tmp_path / "b.tif"))
    (tmp_path / "nets/net.json").rename(tmp_path / "nets/other.json")
    network(target)
    (tmp_path / "nets/net.json").rename(tmp_path / "nets/third.json")
    assert OUTSIDE in refused("nets/third.json")


def test_an_output_that_is_a_link_is_not_followed(network, run, refused, tmp_path):
    net, name = network("a.tif"), OWN[0]
    (tmp_path / "net-output").mkdir()
    kept = tmp_path / "elsewhere/kept.txt"
    kept.write_text("my own work")
    (tmp_path / "net-output" / name).symlink_to(kept)
    line = refused(net)
    assert f"cannot write net-output/{name} (a link to {kept}): {OUTSIDE}" in line
    kept.unlink()
    assert OUTSIDE in refused(net)  # nor is a new file made there
    assert run("run", net, "--allow-writes-to", "elsewhere")[0] == 0
    assert kept.stat().st_size


def test_an_output_folder_that_is_a_link_is_not_followed_unless_named(
    network, run, refused, tmp_path
):
    net = network("a.tif")
    (tmp_path / "net-output").symlink_to(tmp_path / "elsewhere", target_is_directory=True)
    line = refused(net)
    assert f"cannot write to net-output: it is a link to {tmp_path}/elsewhere" in line
    assert "--output-dir net-output allows writing there" in line
    assert run("run", net, "--output-dir", "net-output")[0] == 0
    assert sorted(path.name for path in (tmp_path / "elsewhere").iterdir()) == OWN


def test_the_other_name_of_a_replaced_file_keeps_what_it_holds(network, run, tmp_path):
    """A file is replaced and never written through, so a hard link leads nowhere."""
    kept = tmp_path / "elsewhere/kept.csv"
    kept.write_text("my own work")
    os.link(kept, tmp_path / "nets/a.csv")
    net = network("a.csv", "write_matrix")
    assert run("run", net)[0] == 2
    assert run("run", net, "--allow-writes-to", "nets")[0] == 0
    assert kept.read_text() == "my own work"
    assert np.loadtxt(tmp_path / "nets/a.csv", delimiter=",").shape == (40, 48)


@pytest.mark.parametrize("paths", [("same.tif", "sub/../same.tif"), ("../net-output/final.png",)])
def test_two_outputs_in_one_file_are_told_by_check_too(paths, small, write, run, refused, tmp_path):
    (tmp_path / "nets/sub").mkdir()
    for number, path in enumerate(paths):
        small["nodes"][f"out{number}"] = {"module": "write_image", "params": {"path": path}}
        small["links"].append(["back.image", f"out{number}.image"])
    net = write(small, "nets/net.json")
    line = f"out{len(paths) - 1}: cannot write: two outputs would be written to nets/{paths[-1]}"
    assert refused(net) == f"imagechain: {line}\n"
    code, out, _ = run("check", net)
    assert (code, out.splitlines()[-1]) == (2, line)


def make_folder(path):
    path.mkdir(parents=True)


def make_pipe(path):
    path.parent.mkdir(exist_ok=True)
    os.mkfifo(path)


FOLDER = "the path is a folder; give a file name, for example one in that folder"
PIPE = (
    "the path is a named pipe (FIFO), not a regular file; "
    "allowed: a new name, or a regular file to replace"
)
BAD_TARGETS = {
    "nets/a.tif": (make_pipe, f"out: cannot write nets/a.tif: {PIPE}"),
    "net-output/mtf.csv": (make_folder, f"cannot write net-output/mtf.csv: {FOLDER}"),
    "net-output": (Path.touch, "cannot write to net-output: it is not a folder"),
}


@pytest.mark.parametrize("place", BAD_TARGETS)
def test_check_lists_what_run_refuses_in_the_same_words(place, network, run, refused, tmp_path):
    make, line = BAD_TARGETS[place]
    make(tmp_path / place)
    net = network("a.tif")
    assert refused(net) == f"imagechain: {line}\n"
    code, out, _ = run("check", net)
    assert (code, out.splitlines()[-1]) == (2, line)


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
        rules = WriteRules((tmp_path,), (), frozenset(), read_record(record.network))
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
        return WriteRules((tmp_path,), (), frozenset(), read_record(network))

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
    rules = WriteRules((tmp_path / "nets",), (), frozenset(), WriteRecord(tmp_path))

    def disturbed(change):
        with Staging(None) as staging:
            staging.claim(target, partial(rules.check, "out"))
            staging.write(target, partial(write_text, content="new"))
            change()
            with pytest.raises(FileError) as caught:
                staging.commit()
        return str(caught.value)

    assert "become a link to" in disturbed(lambda: target.symlink_to(tmp_path / "elsewhere/a.txt"))
    target.unlink()
    assert CHANGED in disturbed(lambda: target.write_text("my own work"))
    assert target.read_text() == "my own work"
    assert not list((tmp_path / "elsewhere").iterdir())
