"""Every fault of a command line: exit code 2, one line that names it, nothing written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

USAGE = {
    "unknown command": (["evaluate", "net.json"], "evaluate"),
    "no network": (["run"], "NETWORK"),
    "unknown option": (["run", "net.json", "--fast"], "--fast"),
    "abbreviated option": (["run", "net.json", "--prec", "double"], "--prec"),
    "precision": (["run", "net.json", "--precision", "half"], "half"),
    "seed is no number": (["run", "net.json", "--seed", "x"], "--seed"),
    "negative seed": (["run", "net.json", "--seed", "-1"], "seed = -1"),
    "huge seed": (["run", "net.json", "--seed", "9" * 500], "--seed"),
    "threads": (["run", "net.json", "--threads", "100000"], "threads = 100000"),
    "no such network": (["run", "nothing.json"], "nothing.json"),
    "a folder": (["run", "."], "folder"),
    "empty name": (["run", ""], "''"),
    "impossible name": (["run", "a" * 5000], "aaa"),
    "set without value": (["run", "net.json", "--set", "blur"], "NODE.PARAM=VALUE"),
    "set unknown node": (["run", "net.json", "--set", "blurr.sigma_x_mrad=1"], "mean blur?"),
    "set unknown parameter": (["run", "net.json", "--set", "blur.sigma_x=1"], "sigma_x_mrad?"),
    "set wrong kind": (["run", "net.json", "--set", "blur.sigma_x_mrad=soft"], "'soft' mrad"),
    "set out of range": (["run", "net.json", "--set", "blur.sigma_x_mrad=-1"], "at least 0"),
    "set not finite": (["run", "net.json", "--set", "blur.sigma_x_mrad=NaN"], "nan mrad"),
    "set deep": (["run", "net.json", "--set", "blur.sigma_x_mrad=" + "[" * 9000], "sigma_x"),
    "set needless": (["run", "net.json", "--set", "pixels.factor_x=100"], "100 × 2"),
    "save without file": (["run", "net.json", "--save", "pixels.image"], "NODE.PORT=FILE"),
    "save unknown suffix": (["run", "net.json", "--save", "pixels.image=a.jpg"], "'a.jpg'"),
    "save unknown node": (["run", "net.json", "--save", "pixel.image=a.npy"], "mean pixels?"),
    "save unknown port": (["run", "net.json", "--save", "pixels.imag=a.npy"], "mean image?"),
    "save context": (["run", "net.json", "--save", "init.context=a.npy"], "context"),
    "save into nothing": (["run", "net.json", "--save", "pixels.image=no/a.npy"], "no folder no"),
    "save twice": (
        ["run", "net.json", "--save", "pixels.image=a.npy", "--save", "back.image=./a.npy"],
        "two outputs",
    ),
    "save over the network": (["run", "net.json", "--report", "net.json"], "input of this run"),
    "report suffix": (["run", "net.json", "--report", "a.pdf"], "'a.pdf'"),
    "output folder is a file": (["run", "net.json", "--output-dir", "net.json"], "not a folder"),
    "output below a file": (["run", "net.json", "--output-dir", "net.json/x"], "not a folder"),
    "output folder empty": (["run", "net.json", "--output-dir", ""], "--output-dir"),
    "device": (["run", "net.json", "--save", "pixels.image=pipe.npy"], "not a regular file"),
    "check nothing": (["check"], "NETWORK"),
    "modules too much": (["modules", "x"], "x"),
}


@pytest.fixture(autouse=True)
def _network(write, small):
    write(small)


@pytest.mark.parametrize(("words", "told"), USAGE.values(), ids=USAGE.keys())
def test_usage(words, told, fails, tmp_path):
    if "pipe.npy" in words[-1]:
        # Not one of the files compared: reading a pipe would wait for ever.
        (tmp_path / "pipe.npy").symlink_to("/dev/null")
    assert told in fails(*words)


def test_without_arguments(imagechain):
    done = imagechain()
    assert done.returncode == 2
    assert "run" in done.stdout
    assert done.stderr == "imagechain: say what to do: run, check or modules\n"


def test_line_breaks_and_escapes_stay_out_of_the_line(fails):
    line = fails("run", "a\nb\x1b[31m\u2028.json")
    assert "\x1b" not in line


def test_standard_output_full():
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "app.cli", "modules"],
            stdout=full,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
            text=True,
            check=False,
        )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
