"""A person builds the Inframetrics camera in a real window, loses power, and starts again."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from child_process import PATIENCE_S, ROOT, wait_for
from command_line import run_here
from core.network.file import load_network
from inframetrics_by_hand import wanted_network
from nodes.library import standard_library
from virtual_screen import screenshot_folder, virtual_screen

SCRIPT = ROOT / "tests" / "support" / "inframetrics_by_hand.py"
BUILDING_S = 1000  # a hundred gestures, each waited for


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder that the hands leave behind, their process having been killed."""
    folder = tmp_path_factory.mktemp("by_hand")
    with virtual_screen(1920, 1080) as environment:
        run = start("build", folder, environment)
        wait_for((folder / "ready").exists, "all is built", child=run, seconds=BUILDING_S)
        run.send_signal(signal.SIGKILL)
        run.communicate(timeout=PATIENCE_S)
        again = start("recover", folder, environment)
        told, _ = again.communicate(timeout=PATIENCE_S)
        assert again.returncode == 0, told
    return folder


def start(what, folder, environment):
    path = os.pathsep.join([str(ROOT), str(SCRIPT.parent)])
    return subprocess.Popen(
        [sys.executable, str(SCRIPT), what, str(folder), str(screenshot_folder())],
        env={**environment, "PYTHONPATH": path, "XDG_CONFIG_HOME": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def evaluated(file, folder):
    """What the command line makes of it."""
    words = ["--save", "frame_grabber.image=run.npy", "--output-dir", "run"]
    done = run_here("run", file, *words, folder=folder)
    assert done.returncode == 0, done.stderr
    return np.load(folder / "run.npy"), json.loads((folder / "run" / "readouts.json").read_text())


def test_a_camera_built_by_hand_outlives_a_kill(built):
    # But for values that are the defaults: to choose what is chosen already is no change.
    library = standard_library()
    saved = load_network(built / "by_hand.json", library=library)
    wanted = wanted_network(library)
    assert saved.nodes.keys() == wanted.nodes.keys() == saved.layout.keys()
    for name, node in wanted.nodes.items():
        module = library[node.module]
        assert saved.nodes[name].module == node.module
        assert module.build(saved.nodes[name].params) == module.build(node.params)
    assert set(saved.links) == set(wanted.links)
    assert (saved.seed, saved.name) == (wanted.seed, wanted.name)
    # Picture and figures are those of the command line.
    picture, readouts = evaluated(built / "by_hand.json", built)
    np.testing.assert_array_equal(np.load(built / "shown.npy"), picture)
    figures = json.loads((built / "figures.json").read_text())
    assert figures
    for name, told in figures.items():
        assert f" {readouts['electronics'][name]!r}" in told, name
    # Work that no file held comes back after a kill.
    recovered = (built / "recovered.json").read_text()
    assert recovered == (built / "unsaved.json").read_text()
    assert recovered != (built / "by_hand.json").read_text()
    assert json.loads(recovered)["nodes"]["jitter"]["params"]["sigma_mrad"] == 0.5
    # Screenshots are left to be looked at.
    left = {path.name for path in screenshot_folder().glob("*.png")}
    assert {"1_welcome.png", "5_picture.png", "7_recovered_work.png"} <= left
