"""A network file is parsed once, until it is another file or another library is to read it."""

import os

import pytest

from core.errors import FileError
from core.network.file import read_network, read_unchanged, save_network
from core.network.network import Network, Node
from nodes.library import standard_library

LIBRARY = standard_library()


def write(path, text):
    save_network(Network(name=text, nodes={"a": Node("a", "test_scene")}), path, library=LIBRARY)


def test_it_is_read_again_only_when_it_has_changed(tmp_path):
    path = tmp_path / "one.json"
    write(path, "first")
    first = read_unchanged(path, library=LIBRARY)
    assert first == read_network(path, library=LIBRARY)
    assert read_unchanged(path, library=LIBRARY) is first
    write(path, "other")  # of the same length: an atomic write is another inode
    assert read_unchanged(path, library=LIBRARY).name == "other"


def test_a_file_written_in_place_is_read_again(tmp_path):
    path = tmp_path / "one.json"
    write(path, "first")
    assert read_unchanged(path, library=LIBRARY).name == "first"
    before = path.stat()
    path.write_text(path.read_text(encoding="utf-8").replace("first", "other"), encoding="utf-8")
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + 1))
    assert read_unchanged(path, library=LIBRARY).name == "other"


def test_another_library_reads_it_for_itself(tmp_path):
    path = tmp_path / "one.json"
    write(path, "first")
    first = read_unchanged(path, library=LIBRARY)
    assert read_unchanged(path, library=dict(LIBRARY)) is not first


def test_what_cannot_be_read_is_tried_again(tmp_path):
    path = tmp_path / "one.json"
    for _ in range(2):
        with pytest.raises(FileError, match="No such file"):
            read_unchanged(path, library=LIBRARY)
    write(path, "first")
    assert read_unchanged(path, library=LIBRARY).name == "first"
