"""``imagechain tradeoff`` as a person runs it: tables, files, and faults in one line."""

import csv
import io
import json
import struct

import pytest

from tradeoff_network import DOCUMENT, mtf

SIGMA = "--vary=blur.sigma_x_mrad=0:1:3"
MTF = "--figure=total.mtf_nyquist_x"
NER = "--figure=electronics.ner"


@pytest.fixture(autouse=True)
def _network(write):
    write(DOCUMENT)


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_without_figures_those_that_change_are_told(imagechain):
    done = imagechain("tradeoff", "net.json", "--vary", "electronics.d_star=1e10:1e12:3:log")
    heads = done.stdout.splitlines()[1].split()
    assert heads == ["d_star", "nep_W", "ner", "netd_detector_K", "netd_system_K", "snr"]


def test_files_in_full_precision(works, tmp_path):
    words = [word for name in ("a.csv", "a.json", "a.png", "a.html") for word in ("--output", name)]
    done = works("tradeoff", "net.json", SIGMA, MTF, NER, *words)
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


def test_a_family_has_a_curve_for_each_second_value(works, tmp_path):
    words = ["--vary", "jitter.sigma_mrad=0,0.2", "--output", "a.csv", "--output", "a.json"]
    works("tradeoff", "net.json", SIGMA, *words, MTF, "--output", "a.png")
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert [row["jitter.sigma_mrad"] for row in rows] == ["0.0"] * 3 + ["0.2"] * 3
    for row in rows[3:]:
        expected = mtf(float(row["blur.sigma_x_mrad"]))
        assert float(row["total.mtf_nyquist_x"]) == pytest.approx(expected, rel=1e-12)
    found = json.loads((tmp_path / "a.json").read_text())
    assert [curve["second"] for curve in found["curves"]] == [0.0, 0.2]


def test_choices_have_a_place_each(works, tmp_path):
    words = ["--set", "electronics.region=MWIR", "--set", "electronics.d_star=null"]
    vary = ["--vary", "electronics.material=PtSi,InSb,manual"]
    files = ["--output", "a.png", "--output", "a.csv", "--output", "a.html"]
    done = works("tradeoff", "net.json", *words, *vary, NER, *files)
    rows = rows_of((tmp_path / "a.csv").read_text())
    assert [row["electronics.material"] for row in rows] == ["PtSi", "InSb", "manual"]
    assert rows[2]["electronics.ner"] == ""
    assert "give D*, because material is manual" in rows[2]["failed"]
    assert "electronics.material = manual: electronics: d_star (cm √Hz/W) is empty" in done.stdout
    assert "<h2>Gaps</h2>" in (tmp_path / "a.html").read_text()


def test_where_every_value_fails_nothing_is_written(fails):
    words = ["--vary", "blur.sigma_x_mrad=-2,-1", "--output", "a.csv"]
    for figures in ((MTF,), ()):
        assert "no figure could be computed at any value: blur: sigma_x_mrad = -2" in fails(
            "tradeoff", "net.json", *words, *figures
        )


USAGE = {
    "three varied": (
        [SIGMA, "--vary=jitter.sigma_mrad=0,1", "--vary=init.f_number=1,2"],
        "3 times",
    ),
    "too many together": (
        [SIGMA, "--vary=jitter.sigma_mrad=0:1:999"],
        "3 × 999 values; at most 1000",
    ),
    "unknown figure": (
        [SIGMA, "--figure=electronics.netd"],
        "no such read-out; allowed: electronics.bandwidth_Hz, electronics.g_number",
    ),
    "figure of no node": ([SIGMA, "--figure=electronic.ner"], "did you mean electronics.ner?"),
}


@pytest.mark.parametrize(("words", "told"), USAGE.values(), ids=USAGE.keys())
def test_usage(words, told, fails):
    assert told in fails("tradeoff", "net.json", *words)
