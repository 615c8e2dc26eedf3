"""`check`, `modules`, help, and ends that are not the user's fault."""

import contextlib
import json
import os
import pty
import select
import signal
import subprocess
import sys

import pytest

from app.command.cli import main
from child_process import PATIENCE_S, ROOT, catches, finished, wait_for
from core.modules.declaration import declaration
from core.network.file import load_network
from nodes.library import standard_library

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


def test_modules_for_programs(capsys):
    assert main(["modules", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [each["key"] for each in listed] == list(standard_library())
    for each in listed:
        declared = declaration(standard_library()[each["key"]])
        assert each["title"] == declared.title
        assert [p["name"] for p in each["parameters"]] == [p.name for p in declared.parameters]
        assert [p["name"] for p in each["inputs"]] == [p.name for p in declared.inputs]
        assert [r["name"] for r in each["readouts"]] == [r.name for r in declared.readouts]
    jitter = next(each for each in listed if each["key"] == "jitter_mtf")
    sigma = next(each for each in jitter["parameters"] if each["name"] == "sigma_mrad")
    assert (sigma["unit"], sigma["low"], sigma["low_exclusive"]) == ("mrad", 0, False)
    assert sigma["default"] == 0.02


def test_modules_that_a_word_finds(capsys):
    assert main(["modules", "Noise"]) == 0
    found = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert found == [
        key
        for key, module in standard_library().items()
        if "noise" in f"{key} {module.title} {declaration(module).summary}".lower()
    ]
    assert {"poisson_noise", "focal_plane"} < set(found)
    assert main(["modules", "noise", "--json"]) == 0
    assert [each["key"] for each in json.loads(capsys.readouterr().out)] == found


def test_check(capsys, write, small, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["check", write(small)]) == 0
    assert capsys.readouterr().out == (
        "net: no errors (6 nodes, 8 links)\n"
        "run writes net-output/final.png, net-output/mtf.csv, net-output/readouts.json\n"
    )
    assert not (tmp_path / "net-output").exists()


@pytest.mark.parametrize("path", sorted((ROOT / "networks").glob("*.json")), ids=lambda p: p.stem)
def test_shipped_networks_are_valid(path, capsys):
    load_network(path, library=standard_library())
    assert main(["check", path.stem]) == 0
    capsys.readouterr()


@pytest.mark.parametrize("words", [["--help"], ["run", "--help"], ["--version"]])
def test_help_goes_to_stdout(words, capsys):
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert out
    assert not err


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("mea", "plain,measure"),
        ("run mwi", "plain,mwir_camera"),
        ("run a --thr", "plain,--threads"),
        ("run a --report r", "file,r"),
    ],
)
def test_words_completed_in_a_shell(words, completed, tmp_path):
    typed = f"imagechain {words}"
    shell = {"COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    names = {**ENVIRONMENT, **shell, "_IMAGECHAIN_COMPLETE": "bash_complete"}
    done = finished([sys.executable, "-m", "app.command.cli"], folder=tmp_path, env=names)
    assert done.stdout.split() == [completed]


def test_a_bug_is_one_line_and_exit_1(capsys, write, small, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for kind, told in ((MemoryError, "memory"), (ZeroDivisionError, "internal error")):

        def broken(*_, kind=kind):
            raise kind("of\ntwo lines")

        monkeypatch.setattr("app.run.evaluation.evaluate", broken)
        assert main(["run", write(small)]) == 1
        err = capsys.readouterr().err
        assert err.count("\n") == 1
        assert told in err
    assert [path.name for path in tmp_path.iterdir()] == ["net.json"]


# Frames without number: nothing but a signal ends it, and its one file stays small.
ENDLESS = ["run", "kodak_kir310", "--frames", "1000000", "--save"]


@pytest.mark.parametrize(
    ("number", "moment"), [(signal.SIGINT, "starting"), (signal.SIGHUP, "writing")]
)
def test_stopped(number, moment, tmp_path):
    words = [sys.executable, "-m", "app.command.cli", *ENDLESS, "frame_grabber.image[:1,:1]=a.npy"]
    process = subprocess.Popen(
        words, cwd=tmp_path, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    last = signal.SIGHUP  # of those it listens to
    wait_for(lambda: catches(process.pid, last), "it listens to signals", child=process)
    if moment == "writing":
        wait_for(lambda: [*tmp_path.rglob("*.npy")], "a file is begun", child=process)
    process.send_signal(number)
    _, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert err == b"imagechain: cancelled; nothing was written\n"
    assert not [*tmp_path.iterdir()]


def test_presets_are_listed_by_a_word_of_name_module_or_text(capsys):
    assert main(["presets", "sentinel-2", "--json"]) == 0
    found = {each["preset"]: each for each in json.loads(capsys.readouterr().out)}
    assert list(found) == ["satellite_sentinel2_b2", "satellite_sentinel2_b8"]
    assert found["satellite_sentinel2_b2"]["source"].startswith("ESA 2015")
    assert main(["presets", "reflected_light"]) == 0
    text = capsys.readouterr().out
    assert "light_full_moon · Full moon, 0.1 lx (reflected_light)\n" in text
    assert "camera_" not in text
    assert text.endswith("; in Python, chain.add(ic.preset('NAME')).\n")
    assert main(["presets", "nosuch"]) == 2
    assert "no preset has nosuch in its name, description or module" in capsys.readouterr().err


def test_networks_are_listed(capsys):
    assert main(["networks"]) == 0
    text = capsys.readouterr().out
    for path in (ROOT / "networks").glob("*.json"):
        told = json.loads(path.read_text(encoding="utf-8"))
        assert f"{path.stem} · {told['name']}\n" in text
        assert told["description"] in " ".join(text.split())


def test_reader_that_has_seen_enough():
    line = f"{sys.executable} -m app.command.cli modules | head -n 1; echo ${{PIPESTATUS[0]}}"
    done = finished(["bash", "-c", line], env=ENVIRONMENT)
    assert done.stdout.endswith("\n0\n")
    assert done.stderr == ""


PATIENT = """
import sys
import app.command.options
from app.command.cli import main
app.command.options.PATIENCE_S = float(sys.argv[1])
sys.exit(main(["run", "net.json"]))
"""


@pytest.mark.parametrize(("patience_s", "shown"), [("0", True), ("inf", False)])
def test_progress_on_a_terminal(patience_s, shown, write, small, tmp_path):
    """A terminal sees a bar once work takes long, and nothing of it stays."""
    write(small)
    outer, inner = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", PATIENT, patience_s],
        cwd=tmp_path,
        env={**ENVIRONMENT, "TERM": "xterm"},
        stdout=subprocess.DEVNULL,
        stderr=inner,
    )
    os.close(inner)
    seen = b""
    with contextlib.suppress(OSError):  # the terminal's other end is closed
        while select.select([outer], [], [], PATIENCE_S)[0] and (part := os.read(outer, 4096)):
            seen += part
    os.close(outer)
    assert process.wait(timeout=PATIENCE_S) == 0
    assert (b"/6" in seen) is shown
    assert seen.endswith(b"\x1b[2K") if shown else not seen  # the line is cleared
