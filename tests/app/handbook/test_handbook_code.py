"""Every line of code of the handbook, run as it stands there, page by page in a folder of its own.

Commands must succeed without a word on stderr. Where a page shows what is printed, it must be
printed: a line that ends in … stands for all that begin so, one that is … alone for any lines.
"""

import contextlib
import io
import json
import re
import shlex
import socket
import subprocess
import sys
import threading
import tomllib
import types
from itertools import pairwise

import pytest

from app.handbook.example_figures import PAGES, PARTS
from child_process import ROOT
from command_line import read_words, run_here
from page_blocks import blocks_of

NAMES = [name for pages in PARTS.values() for name in pages]
TEXTS = {name: (PAGES / f"{name}.md").read_text(encoding="utf-8") for name in NAMES}
KINDS = {"sh", "python", "json", "csv", "toml", "output", "math", "figure"}
# What opens a window or a browser, or measures for minutes, is read, and run by other tests.
READ = {"edit", "bench", "handbook"}


def command(line, folder):
    """What a command of a page prints."""
    words = shlex.split(line.replace("$PWD", str(folder)), comments=True)[1:]
    if words[0] in READ:
        assert read_words(*words).info_name == words[0]
        return ""
    done = run_here(*words, folder=folder)
    assert (done.returncode, done.stderr) == (0, ""), line
    return done.stdout


class Background:
    """What a page has running beside its commands: a scheduler and its workers."""

    def __init__(self, folder):
        self.folder, self.port, self.processes = folder, free_port(), []

    def start(self, line):
        """Begin, and wait until what it is to say first is said."""
        words = shlex.split(self.here(line))
        process = subprocess.Popen(
            [sys.executable, "-m", *words],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
        )
        self.processes.append(process)
        ready = {"scheduler": "Scheduler at", "worker": "Registered to"}[words[1]]
        assert any(ready in said for said in process.stderr), line
        # Nobody reads on; a full pipe would hold it.
        threading.Thread(target=process.stderr.read, daemon=True).start()

    def here(self, line):
        """With a port of its own, as other tests run beside this one."""
        return line.replace(":8786", f":{self.port}").replace("--port 8786", f"--port {self.port}")

    def end(self):
        for process in reversed(self.processes):
            process.terminate()
            process.wait(30)
            process.stderr.close()


def free_port():
    with socket.socket() as end:
        end.bind(("127.0.0.1", 0))
        return end.getsockname()[1]


@pytest.fixture
def background(tmp_path):
    beside = Background(tmp_path)
    yield beside
    beside.end()


def program(text, folder, names):
    """What a program of a page prints; it goes on with the names of those before it."""
    out = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(out):
        exec(compile(text, "a page of the handbook", "exec"), names)
    return out.getvalue()


def is_as_shown(printed, shown):
    """Whether what is printed is what a page shows."""
    pattern = "".join(
        r"(?:.*\n)*" if line == "…" else re.escape(line).replace("…", ".*") + r"\n"
        for line in shown.strip("\n").splitlines()
    )
    return re.fullmatch(pattern, printed.strip("\n") + "\n") is not None


def files_saved(text):
    """The files that the commands of a page are to write."""
    words = shlex.split(text.replace("\\\n", ""), comments=True)
    return {
        word.rpartition("=")[2]
        for option, word in pairwise(words)
        if option in ("--save", "--report", "--output")
    }


def test_what_is_printed_is_compared_as_it_is_shown():
    assert is_as_shown("a 1\nb\nc\n", "a …\n…\n")
    assert is_as_shown("a 1\n\nb\n", "a 1\n\nb\n")
    assert not is_as_shown("a 1\nb\n", "a 1\n")
    assert not is_as_shown("a 12\n", "a 1\n")


SLOW = {"fitting", "infrared_camera", "satellite"}  # more than ten seconds each


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.thorough) if name in SLOW else name for name in NAMES],
)
def test_a_page(name, tmp_path, monkeypatch, background):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = tmp_path / "own"
    folder.mkdir()
    page = types.ModuleType("a_page")  # where classes look for the names in their annotations
    monkeypatch.setitem(sys.modules, page.__name__, page)
    printed = ""
    for block in blocks_of(TEXTS[name]):
        if name == "plug_ins" and block.kind in ("bash", "text"):
            continue  # needs the installed package: tests/nodes/plug_ins/test_installed_package.py
        if name == "cluster_study" and block.kind == "bash":  # needs certificates: it is read
            words = shlex.split(block.text)
            assert words[0] in ("dask", "export") or read_words(*words[1:]).info_name == "study"
            continue
        assert block.kind in KINDS, block
        if block.kind == "sh":
            lines = block.text.replace("\\\n", "").splitlines()
            assert all(line.startswith(("imagechain ", "dask ")) for line in lines), block
            for line in lines:
                if line.startswith("dask "):
                    background.start(line)
            lines = [line for line in lines if line.startswith("imagechain ")]
            printed = "".join(command(background.here(line), folder) for line in lines)
            done = [line for line in lines if line.split()[1] not in READ]
            written = {file for line in done for file in files_saved(line)}
            for file in written:
                found = list(folder.glob(re.sub(r"\{.*?\}", "*", file)))
                assert found, (file, block)
                assert all(path.stat().st_size for path in found), block
        elif block.kind == "python":
            printed = program(block.text, folder, vars(page))
        elif block.kind == "output":
            assert is_as_shown(printed, block.text), printed
        elif block.kind == "toml":
            tomllib.loads(block.text)
        elif block.kind in ("json", "csv"):
            assert block.name, block
            if block.kind == "json":
                json.loads(block.text)
            (folder / block.name).write_text(block.text, encoding="utf-8")


def test_commands_of_all_kinds_are_shown():
    lines = "\n".join(TEXTS.values())
    shown = set(re.findall(r"^imagechain ([a-z-]+)", lines, re.MULTILINE))
    assert {"run", "edit", "check", "tradeoff", "solve", "fit", "photon-transfer"} <= shown
    assert {"networks", "modules", "bench", "handbook"} <= shown


def test_extras_that_are_named_exist():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    named = set(re.findall(r"install [^'`]*'\.\[([\w,]+)\]'", "\n".join(TEXTS.values())))
    assert named
    assert {part for names in named for part in names.split(",")} <= {
        *project["optional-dependencies"]
    }
