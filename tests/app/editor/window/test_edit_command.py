"""``imagechain edit`` as a person starts it: screenshots, a real window, signals."""

import json
import os
import signal
import struct
import subprocess
import sys

import pytest

from app.run.shipped import shipped_networks
from child_process import PATIENCE_S, ROOT, finished, wait_for
from virtual_screen import virtual_screen


def environment(folder, base=os.environ):
    homes = {"XDG_CONFIG_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
    return {**base, **homes, "PYTHONPATH": str(ROOT)}


def size_of_png(path):
    head = path.read_bytes()[:24]
    assert head.startswith(b"\x89PNG")
    return struct.unpack(">II", head[16:])


SHOTS = {
    "window.png": (("small.json",), (1600, 900)),
    "part.png": (
        ("small.json", "--part", "picture", "--size", "320x320", "--look", "light"),
        (320, 240),
    ),
}
FAULTS = {
    "no such network": (("nowhere.json", "w.png"), "neither a file nor the name of an example"),
    "no such folder": (("first_steps", "no/folder/w.png"), "there is no folder"),
    "broken": (("broken.json", "w.png"), "broken.json"),
}
# One application for all of them: the screenshots are tested, not its start.
IN_A_ROW = """
import contextlib, io, json, sys
from app.command.cli import main
ends = []
for words in json.loads(sys.argv[1]):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        ends.append([main(["edit", *words]), out.getvalue(), err.getvalue()])
print(json.dumps(ends))
"""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """The folder of the screenshots, and how each command ended."""
    folder = tmp_path_factory.mktemp("drawn")
    (folder / "broken.json").write_text("[1, 2")
    small = json.loads(shipped_networks()["first_steps"].read_text())
    small["nodes"]["scene"]["params"] |= {"width": 512, "height": 384, "fov_y_deg": 7.5}
    (folder / "small.json").write_text(json.dumps(small))
    asked = {name: [*words, "--screenshot", name] for name, (words, _) in SHOTS.items()}
    for name, ((network, file), _) in FAULTS.items():
        asked[name] = [network, "--screenshot", file]
    program = [sys.executable, "-c", IN_A_ROW, json.dumps(list(asked.values()))]
    done = finished(program, folder=folder, env=environment(folder))
    assert (done.returncode, done.stderr) == (0, "")
    return folder, dict(zip(asked, json.loads(done.stdout), strict=True))


def test_screenshots_and_what_cannot_be_drawn(drawn):
    folder, ends = drawn
    for name, (_, wanted) in SHOTS.items():
        assert ends[name] == [0, "", ""]
        # A part is no larger than asked for, and as wide as the picture is.
        assert size_of_png(folder / name) == wanted, name
    for name, (_, why) in FAULTS.items():
        code, out, err = ends[name]
        assert (code, out) == (2, "")
        assert why in err
        assert err.count("\n") == 1
    assert {path.name for path in folder.iterdir()} == {*SHOTS, "broken.json", "small.json"}


def test_without_words_the_first_page_opens_and_told_to_end_closes_quietly(tmp_path):
    with virtual_screen(1366, 768) as screen:
        env = environment(tmp_path, screen)
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        command = [sys.executable, "-m", "app.command.cli"]
        run = subprocess.Popen(command, cwd=tmp_path, env=env, **pipes)
        search = ["xdotool", "search", "--onlyvisible", "--name", "Imagechain"]
        wait_for(lambda: finished(search, env=env).returncode == 0, "a window came", child=run)
        run.send_signal(signal.SIGINT)
        told = run.communicate(timeout=PATIENCE_S)
        assert (run.returncode, *told) == (0, "", "")
