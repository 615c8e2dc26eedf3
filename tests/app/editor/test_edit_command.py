"""``imagechain edit`` as a person starts it: screenshots, a real window, signals."""

import os
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest

from virtual_screen import virtual_screen

ROOT = Path(__file__).resolve().parents[3]


def words(*arguments):
    return [sys.executable, "-m", "app.cli", "edit", *map(str, arguments)]


def environment(folder, base=os.environ):
    homes = {"XDG_CONFIG_HOME": str(folder), "XDG_DATA_HOME": str(folder)}
    return {**base, **homes, "PYTHONPATH": str(ROOT)}


def edit(folder, *arguments):
    return subprocess.run(
        words(*arguments),
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def size_of_png(path):
    head = path.read_bytes()[:24]
    assert head.startswith(b"\x89PNG")
    return struct.unpack(">II", head[16:])


SHOTS = {
    "of the window": ((), (1600, 900)),
    "of a smaller window": (("--size", "1366x768", "--look", "light"), (1366, 768)),
}


@pytest.mark.parametrize(("choices", "size"), SHOTS.values(), ids=SHOTS)
def test_a_screenshot(choices, size, tmp_path):
    done = edit(tmp_path, "first_steps", "--screenshot", "window.png", *choices)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert size_of_png(tmp_path / "window.png") == size
    assert [path.name for path in tmp_path.iterdir()] == ["window.png"]


def test_a_screenshot_of_the_picture_is_no_larger_than_asked_for(tmp_path):
    choices = ("--part", "picture", "--size", "320x320")
    assert edit(tmp_path, "kodak_kir310", "--screenshot", "p.png", *choices).returncode == 0
    width, height = size_of_png(tmp_path / "p.png")
    assert max(width, height) == 320
    assert height / width == pytest.approx(486 / 512, abs=0.01)


FAULTS = {
    "no such network": (("nowhere.json",), "neither a file nor the name of a shipped network"),
    "no such folder": (("first_steps", "--screenshot", "no/folder/w.png"), "there is no folder"),
    "broken": (("broken.json", "--screenshot", "w.png"), "broken.json"),
}


@pytest.mark.parametrize(("arguments", "told"), FAULTS.values(), ids=FAULTS)
def test_what_cannot_be_drawn_is_one_line(arguments, told, tmp_path):
    (tmp_path / "broken.json").write_text("[1, 2")
    if "--screenshot" not in arguments:
        arguments = (*arguments, "--screenshot", "w.png")
    done = edit(tmp_path, *arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert told in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "w.png").exists()


@pytest.fixture(scope="module")
def screen():
    with virtual_screen(1366, 768) as found:
        yield found


def open_window(folder, screen, *arguments):
    """Start the editor; gives the process once its window is there."""
    env = environment(folder, screen)
    run = subprocess.Popen(
        words(*arguments),
        cwd=folder,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    search = ["xdotool", "search", "--onlyvisible", "--name", "Imagechain"]
    deadline = time.monotonic() + 30
    while subprocess.run(search, env=env, capture_output=True, check=False).returncode:
        assert run.poll() is None, run.communicate()
        assert time.monotonic() < deadline, "no window came"
        time.sleep(0.1)
    return run


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_told_to_end_the_window_closes_quietly(number, tmp_path, screen):
    run = open_window(tmp_path, screen, "first_steps")
    run.send_signal(number)
    told = run.communicate(timeout=20)
    assert (run.returncode, *told) == (0, "", "")


def test_a_network_that_cannot_be_opened_leaves_a_window_that_says_so(tmp_path, screen):
    (tmp_path / "broken.json").write_text("{")
    run = open_window(tmp_path, screen, "broken.json")
    run.send_signal(signal.SIGTERM)
    told = run.communicate(timeout=20)
    assert (run.returncode, *told) == (0, "", "")


def test_without_words_the_first_page_opens(tmp_path, screen):
    run = subprocess.Popen(
        [sys.executable, "-m", "app.cli"],
        cwd=tmp_path,
        env=environment(tmp_path, screen),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(4)
    assert run.poll() is None
    run.send_signal(signal.SIGTERM)
    assert run.communicate(timeout=20) == ("", "")
