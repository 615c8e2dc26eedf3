"""What the README says one can run, run as it stands there."""

from __future__ import annotations

import re
import shlex
import tomllib

import pytest

from app.options.command_options import parse
from child_process import ROOT
from command_line import run_here

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)
LINES = [
    line
    for kind, block in BLOCKS
    if kind == "sh"
    for line in block.replace("\\\n", "").splitlines()
]
COMMANDS = [shlex.split(line, comments=True)[1:] for line in LINES if line.startswith("imagechain")]


def test_there_are_commands():
    assert {words[0] for words in COMMANDS} == {
        *("run", "tradeoff", "study", "solve", "check", "networks", "modules", "bench")
    }


@pytest.mark.parametrize(
    "words", [words for words in COMMANDS if words[0] != "bench"], ids=" ".join
)
def test_a_command_line(words, tmp_path):
    done = run_here(*words, folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    written = [
        word.rpartition("=")[2]
        for word in words
        if word.endswith((".tif", ".npy", ".html", ".csv")) and "{" not in word
    ]
    assert all((tmp_path / name).stat().st_size for name in written)


def test_the_benchmark_is_read_and_measured_by_other_tests():
    (words,) = [words for words in COMMANDS if words[0] == "bench"]
    assert parse(words).bench_html is not None


def test_the_network_to_begin_with_is_sound(tmp_path):
    (document,) = [block for kind, block in BLOCKS if kind == "json"]
    (tmp_path / "mine.json").write_text(document, encoding="utf-8")
    (tmp_path / "scene.img").write_bytes(bytes(2 * 3 * 4))
    header = (
        "ENVI\nsamples = 3\nlines = 2\nbands = 1\ndata type = 4\ninterleave = bsq\nbyte order = 0\n"
    )
    (tmp_path / "scene.hdr").write_text(header, encoding="ascii")
    done = run_here("check", "mine.json", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


def test_extras_that_are_named_exist():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(re.findall(r"install [^'`]*'\.\[(\w+)\]'", TEXT)) <= {
        *project["optional-dependencies"]
    }
