"""Every fault of a command line: exit code 2, one line that names it, nothing written."""

import os
import sys

import pytest

from child_process import ROOT, finished

USAGE = {
    "unknown command": (["evaluate", "net.json"], "evaluate"),
    "command like another": (["chekc", "net.json"], "chekc; did you mean check?"),
    "option before the command": (["--vesrion"], "--vesrion; did you mean --version?"),
    "no network": (["run"], "NETWORK (imagechain run --help)"),
    "run a preset": (["run", "light_sunlit"], "in Python, add ic.preset('light_sunlit') after a"),
    "check no such network": (["check", "nosuch"], "nosuch is neither a file nor the name of"),
    "negative seed": (["run", "net.json", "--seed", "-1"], "seed = -1"),
    "tolerance of all": (["run", "net.json", "--tolerance", "1"], "of at least 0 and below 1"),
    "no certificate for TLS": (
        [
            "study",
            "first_steps",
            "--vary",
            "blur.sigma_x_mrad=1,2",
            "--output",
            "rows.csv",
            "--scheduler",
            "tls://127.0.0.1:8786",
        ],
        "Dask's settings have no TLS client certificate. Set distributed.comm.tls.ca-file, ",
    ),
    "part of a name": (["run", "kodak"], "did you mean kodak_kir310 or kodak_kir310_1996?"),
    "a cube that is not there": (
        ["check", "a b.img"],
        "a b.img: there is no such file; to send a "
        "picture through a camera: imagechain run mwir_camera --scene 'a",
    ),
    "help of no command": (["help", "rnu"], "there is no command rnu; did you mean run?"),
    "impossible name": (["run", "a" * 5000], "aaa"),
    "disable a source": (["run", "net.json", "--disable", "scene"], "has no input to pass on"),
    "set out of range": (["run", "net.json", "--set", "blur.sigma_x_mrad=-1"], "at least 0"),
    "set not finite": (["run", "net.json", "--set", "blur.sigma_x_mrad=NaN"], "nan mrad"),
    "set needless": (["run", "net.json", "--set", "pixels.factor_x=100"], "100 × 2"),
    "save unknown suffix": (["run", "net.json", "--save", "pixels.image=a.jpg"], "'a.jpg'"),
    "save context": (["run", "net.json", "--save", "init.context=a.npy"], "context"),
    "save over the network": (["run", "net.json", "--report", "net.json"], "input of this run"),
    "final without a port": (
        ["run", "net.json", "--final", "back"],
        "--final back is not allowed: must be NODE.P",
    ),
    "output folder is a file": (["run", "net.json", "--output-dir", "net.json"], "not a folder"),
    "device": (["run", "net.json", "--save", "pixels.image=pipe.npy"], "not a regular file"),
    "long folder, seen from the root": (
        ["run", "net.json", "--output-dir", "a/" * 2045],
        "a/a: File name too long",
    ),
    "long folder to allow": (
        ["run", "net.json", "--allow-writes-to", "a" * 300],
        "a: there is no such folder",
    ),
    "seed twice": (["run", "net.json", "--seed", "1", "--seed", "1"], "--seed is given more"),
    "an option for a value": (["run", "net.json", "--disable", "--json"], "expected one argument"),
    "one number of two": (["run", "net.json", "--scene-fov-deg", "2"], "expected 2 arguments"),
    "value of a flag": (["run", "net.json", "--all=3"], "takes no value, but '3' is given"),
}


@pytest.fixture(autouse=True)
def _network(write, small):
    write(small)


def test_a_picture_in_place_of_a_network(fails, imagechain, write, small, tmp_path):
    (tmp_path / "photo.png").write_bytes(b"\x89PNG")
    line = "photo.png: a picture, not a network; to send a picture through a camera: "
    assert line + "imagechain run mwir_camera --scene photo.png" in fails("run", "photo.png")
    assert imagechain("check", write(small, "net.txt")).returncode == 0


@pytest.mark.parametrize(("words", "told"), USAGE.values(), ids=USAGE.keys())
def test_usage(words, told, fails, tmp_path):
    if "pipe.npy" in words[-1]:
        # Not one of the files compared: reading a pipe would wait for ever.
        (tmp_path / "pipe.npy").symlink_to("/dev/null")
    assert told in fails(*words)


NO_DISPLAY = {"DISPLAY": "", "WAYLAND_DISPLAY": "", "QT_QPA_PLATFORM": ""}


@pytest.mark.parametrize("words", [(), ("edit", "kodak_kir310")])
def test_the_editor_without_a_display(imagechain, words):
    done = imagechain(*words, env=NO_DISPLAY)
    assert done.returncode == 2
    assert done.stderr.startswith("imagechain: the editor needs a display: DISPLAY and WAYLAND_")
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize("display", [":4711", ":x"])
def test_the_editor_with_a_display_that_does_not_answer(imagechain, display):
    done = imagechain("edit", env={**NO_DISPLAY, "DISPLAY": display})
    assert done.returncode == 2
    assert done.stderr == (
        f"imagechain: the editor needs a display: no response from DISPLAY = {display}\n"
    )


@pytest.mark.parametrize("words", [["check", "nosuch"]])
def test_a_process_ends_as_the_command_in_this_one(words, imagechain, imagechain_process):
    """The other tests of this kind start none."""
    here, process = imagechain(*words), imagechain_process(*words)
    assert process.returncode == here.returncode == 2
    assert (process.stdout, process.stderr) == (here.stdout, here.stderr)
    assert here.stderr.count("\n") == 1


@pytest.mark.parametrize("size", ["1600", "16x9", "1e3x900", "٣٢٠x٣٢٠"])
def test_the_size_of_a_window(fails, size):
    assert "whole numbers from 320 to 16384" in fails("edit", "--size", size)


def test_a_screenshot_is_a_png(fails):
    assert "end in .png" in fails("edit", "--screenshot", "window.jpg")


def test_line_breaks_and_escapes_stay_out_of_the_line(fails):
    line = fails("run", "a\nb\x1b[31m\u2028.json")
    assert "\x1b" not in line


def shell(line, folder):
    """Run a line of shell in which ``imagechain`` is the command."""
    command = f'imagechain() {{ "{sys.executable}" -m app.command.cli "$@"; }}; {line}'
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return finished(["bash", "-c", command], folder=folder, env=environment)


@pytest.mark.parametrize(
    ("line", "code", "out", "errors"),
    [
        ("imagechain modules >/dev/full", 1, "", 1),
        ("imagechain run net.json >&-", 0, "", 0),
        ("imagechain run net.json 2>&-", 0, "net-output: ", 0),
        ("imagechain run nothing 2>&-", 2, "", 0),
        ("imagechain run nothing >&- 2>&-", 2, "", 0),
        ("imagechain check nothing >/dev/full", 2, "", 1),  # which prints nothing there
    ],
)
def test_streams_closed_or_full(line, code, out, errors, tmp_path):
    done = shell(line, tmp_path)
    assert done.returncode == code, done.stderr
    assert done.stderr.count("\n") == errors
    assert out in done.stdout
    assert out or not done.stdout
    assert (tmp_path / "net-output/final.png").is_file() == ("run net.json" in line)


def test_what_is_written_is_said_where_it_cannot_be_printed(tmp_path):
    """As `cp -v` does: the files stand, and the exit code is no fault of the input's."""
    done = shell("imagechain run net.json --report r.json >/dev/full", tmp_path)
    assert done.returncode == 1
    assert done.stderr == (
        "imagechain: cannot write to standard output: No space left on device; "
        "the files were written\n"
    )
    assert (tmp_path / "r.json").is_file()
    done = shell("imagechain modules >/dev/full", tmp_path)
    assert done.stderr == ("imagechain: cannot write to standard output: No space left on device\n")
