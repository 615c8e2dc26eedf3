"""``imagechain tradeoff`` as a person runs it: tables, files, and faults in one line."""

from __future__ import annotations

import csv
import io
import json
import signal
import struct
import subprocess
import sys
import time

import pytest

from child_process import PATIENCE_S, ROOT, catches, wait_for
from tradeoff_network import DOCUMENT, mtf

SIGMA = "--vary=blur.sigma_x_mrad=0:1:3"
MTF = "--figure=total.mtf_nyquist_x"
NER = "--figure=electronics.ner"


@pytest.fixture(autouse=True)
def _network(write):
    write(DOCUMENT)


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_a_table_on_the_terminal(imagechain, tmp_path):
    done = imagechain("tradeoff", "net.json", SIGMA, MTF, NER)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    lines = [line.split() for line in done.stdout.splitlines()]
    assert lines[0] == ["blur", "total", "electronics"]
    assert lines[1] == ["sigma_x_mrad", "mtf_nyquist_x", "ner"]
    assert lines[2] == ["mrad", "W/m²/sr"]
    assert [float(line[0]) for line in lines[3:]] == [0.0, 0.5, 1.0]
    for value, told, _ in lines[3:]:
        assert float(told) == pytest.approx(mtf(float(value)), rel=1e-5)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["net.json"]


def test_without_figures_those_that_change_are_told(imagechain):
    done = imagechain("tradeoff", "net.json", "--vary", "electronics.d_star=1e10:1e12:3:log")
    heads = done.stdout.splitlines()[1].split()
    assert heads == ["d_star", "nep_W", "ner", "netd_detector_K", "netd_system_K", "snr"]


def test_files_in_full_precision(imagechain, tmp_path):
    words = [word for name in ("a.csv", "a.json", "a.png", "a.html") for word in ("--output", name)]
    done = imagechain("tradeoff", "net.json", SIGMA, MTF, NER, *words)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("\na.csv, a.json, a.png, a.html\n")
    rows = rows_of((tmp_path / "a.csv").read_text())
    for row in rows:
        expected = mtf(float(row["blur.sigma_x_mrad"]))
        assert float(row["total.mtf_nyquist_x"]) == pytest.approx(expected, rel=1e-12)
        assert row["failed"] == ""
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["network"] == "Sensor"
    assert found["vary"] == [
        {"parameter": "blur.sigma_x_mrad", "unit": "mrad", "values": [0.0, 0.5, 1.0]}
    ]
    assert found["present"] == 0.5
    assert [each["unit"] for each in found["figures"]] == ["", "W/m²/sr"]
    (curve,) = found["curves"]
    for point, row in zip(curve["points"], rows, strict=True):
        assert point["figures"]["electronics.ner"] == float(row["electronics.ner"])
        assert point["failed"] == {}
    png = (tmp_path / "a.png").read_bytes()
    assert png.startswith(b"\x89PNG")
    assert min(struct.unpack(">II", png[16:24])) > 300
    page = (tmp_path / "a.html").read_text()
    assert "data:image/png;base64," in page
    assert "oise-equivalent radiance" in page
    assert "<h2>Gaps</h2>" not in page


def test_settings_hold_before_the_parameter_moves(imagechain, tmp_path):
    words = ["--set", "jitter.sigma_mrad=0", "--output", "a.csv"]
    imagechain("tradeoff", "net.json", "--vary", "blur.sigma_x_mrad=0,1", MTF, *words)
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert float(rows[0]["total.mtf_nyquist_x"]) == 1.0


def test_a_family_has_a_curve_for_each_second_value(imagechain, tmp_path):
    words = ["--vary", "jitter.sigma_mrad=0,0.2", "--output", "a.csv", "--output", "a.json"]
    done = imagechain("tradeoff", "net.json", SIGMA, *words, MTF, "--output", "a.png")
    assert done.returncode == 0, done.stderr
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert [row["jitter.sigma_mrad"] for row in rows] == ["0.0"] * 3 + ["0.2"] * 3
    for row in rows[3:]:
        expected = mtf(float(row["blur.sigma_x_mrad"]))
        assert float(row["total.mtf_nyquist_x"]) == pytest.approx(expected, rel=1e-12)
    found = json.loads((tmp_path / "a.json").read_text())
    assert [curve["second"] for curve in found["curves"]] == [0.0, 0.2]


def test_choices_have_a_place_each(imagechain, tmp_path):
    words = ["--set", "electronics.region=MWIR", "--set", "electronics.d_star=null"]
    vary = ["--vary", "electronics.material=PtSi,InSb,manual"]
    files = ["--output", "a.png", "--output", "a.csv", "--output", "a.html"]
    done = imagechain("tradeoff", "net.json", *words, *vary, NER, *files)
    assert done.returncode == 0, done.stderr
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert [row["electronics.material"] for row in rows] == ["PtSi", "InSb", "manual"]
    assert rows[2]["electronics.ner"] == ""
    assert "`manual` needs it" in rows[2]["failed"]
    assert "electronics.material = manual: electronics: d_star is empty" in done.stdout
    assert "<h2>Gaps</h2>" in (tmp_path / "a.html").read_text()


def test_values_that_fail_are_gaps_with_their_reason(imagechain, tmp_path):
    vary = ["--vary", "blur.sigma_x_mrad=-1:1:5"]
    done = imagechain("tradeoff", "net.json", *vary, MTF, "--output", "a.csv", "--output", "a.png")
    assert done.returncode == 0
    reason = "blur: sigma_x_mrad = -1.0 mrad is not allowed: a number of at least 0"
    assert f"blur.sigma_x_mrad = -1 mrad: {reason}" in done.stdout
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert [bool(row["total.mtf_nyquist_x"]) for row in rows] == [False] * 2 + [True] * 3
    assert rows[0]["failed"] == reason


def test_where_every_value_fails_nothing_is_written(fails):
    words = ["--vary", "blur.sigma_x_mrad=-2,-1", "--output", "a.csv"]
    for figures in ((MTF,), ()):
        line = fails("tradeoff", "net.json", *words, *figures)
        assert "no value gives a figure: blur: sigma_x_mrad = -2" in line


USAGE = {
    "nothing varied": ([], "--vary"),
    "three varied": (
        [SIGMA, "--vary=jitter.sigma_mrad=0,1", "--vary=init.f_number=1,2"],
        "3 times",
    ),
    "the same twice": ([SIGMA, SIGMA], "vary another parameter"),
    "too many together": (
        [SIGMA, "--vary=jitter.sigma_mrad=0:1:999"],
        "3 × 999 values, at most 1000",
    ),
    "unknown node": (["--vary=blurr.sigma_x_mrad=0:1:3"], "did you mean blur?"),
    "unknown figure": (
        [SIGMA, "--figure=electronics.netd"],
        "no such read-out; it has electronics.bandwidth_Hz, electronics.g_number",
    ),
    "figure of no node": ([SIGMA, "--figure=electronic.ner"], "did you mean electronics.ner?"),
    "suffix": ([SIGMA, "--output=a.pdf"], "must end in .csv, .json, .png or .html"),
    "over the network": ([SIGMA, "--output=net.json"], "input of this run"),
    "one file twice": ([SIGMA, "--output=a.csv", "--output=./a.csv"], "two outputs"),
    "no folder": ([SIGMA, "--output=no/a.csv"], "no folder no"),
    "abbreviated": ([SIGMA, "--out=a.csv"], "--out"),
    "unknown setting": ([SIGMA, "--set=blur.sigma=1"], "--set blur.sigma"),
    "not a range": (["--vary=blur.sigma_x_mrad=0:x:3"], "write NODE.PARAM=FROM:TO:COUNT"),
}


@pytest.mark.parametrize(("words", "told"), USAGE.values(), ids=USAGE.keys())
def test_usage(words, told, fails):
    assert told in fails("tradeoff", "net.json", *words)


def test_stopped_in_the_middle_it_leaves_nothing(tmp_path):
    words = ["tradeoff", "net.json", "--set", "scene.width=2048", "--set", "scene.height=2048"]
    words += ["--vary", "scene.temperature_K=290:310:1000", NER, "--output", "a.csv"]
    command = [sys.executable, "-m", "app.command.cli", *words]
    running = subprocess.Popen(
        command,
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT), "PATH": ""},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    wait_for(lambda: catches(running.pid, signal.SIGHUP), "it listens", child=running)
    time.sleep(1.0)  # whatever it does then
    running.send_signal(signal.SIGINT)
    out, told = running.communicate(timeout=PATIENCE_S)
    assert (running.returncode, out) == (1, "")
    assert told == "imagechain: cancelled; nothing was written\n"
    assert [path.name for path in tmp_path.iterdir()] == ["net.json"]
