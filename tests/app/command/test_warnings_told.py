"""Warnings on the terminal, in the read-outs and in reports: told, and never a failure."""

import json
import re
from html import unescape

import pandas as pd
import pytest
import xarray as xr

WRITES = "run writes net-output/final.png, net-output/mtf.csv, net-output/readouts.json"
BAND = (
    "electronics: the picture's radiance covers 8 to 14 µm, but cut_on_um to cut_off_um is 3 "
    "to 5 µm: the bands do not overlap. Leave cut_on_um and cut_off_um empty to use the "
    "picture's band, or set the picture's band to match"
)


@pytest.fixture
def lwir(small, write):
    """An LWIR picture through electronics of 3 to 5 µm."""
    small["nodes"]["scene"]["params"] |= {"cut_on_um": 8.0, "cut_off_um": 14.0}
    small["nodes"]["init"]["params"] |= {
        "f_number": 2.0,
        "detector_x_um": 25.0,
        "detector_y_um": 25.0,
    }
    small["nodes"]["electronics"] = {
        "module": "electronics_noise",
        "params": {"cut_on_um": 3.0, "cut_off_um": 5.0, "region": "MWIR", "bandwidth_Hz": 1e4},
    }
    small["links"] += [
        ["pixels.image", "electronics.image"],
        ["init.context", "electronics.context"],
    ]
    write(small)
    return small


def test_check_tells_and_succeeds(lwir, works):
    done = works("check", "net.json")
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        f"warning: {BAND}",
        "net: no errors, 1 warning (7 nodes, 10 links)",
        WRITES,
    ]


def test_run_tells_on_the_terminal_in_the_readouts_and_in_reports(lwir, works, tmp_path):
    done = works("run", "net.json", "--report", "r.html", "--report", "r.json")
    assert done.stderr == ""
    assert f"warning: {BAND}" in done.stdout.splitlines()
    told = json.loads((tmp_path / "net-output/readouts.json").read_text())
    assert told["imagechain.warnings"] == {"electronics": [BAND.partition(": ")[2]]}
    (fact,) = json.loads((tmp_path / "r.json").read_text())["warnings"]
    assert fact["node"] == "electronics"
    assert fact["check"] == "band"
    remedy = fact["remedy"]
    assert f"{fact['node']}: {fact['message']}. {remedy[0].upper()}{remedy[1:]}" == BAND
    page = unescape((tmp_path / "r.html").read_text())
    box = re.search(r'<ul class="warnings">.*?</ul>', page, re.S)
    assert box is not None
    assert "the bands do not overlap" in box[0]
    assert page.index('<ul class="warnings">') < page.index("<h2>Input and output")


CAMERA = ["mwir_camera", "--set=scene.width=64", "--set=scene.height=64"]
CAMERA += ["--set=camera.aperture_mm=50", "--set=camera.f_number=4"]
FOCAL, CUTOFF = "--vary=camera.focal_length_mm=100:300:5", "--figure=optics.cutoff"


def contradiction(focal_mm):
    """What Camera says of F/4 and an aperture of 50 mm; nothing at 200 mm, where both agree."""
    if focal_mm == 200:
        return ""
    return f"camera: f_number = 4 here but {focal_mm / 50:g} from {focal_mm:g} mm / 50 mm. Leave"


@pytest.mark.parametrize("name", ["a.parquet", "a.nc"])
def test_a_study_tells_those_of_each_point(name, works, tmp_path):
    """An F-number that contradicts focal length over aperture: the cutoff does not change."""
    words = [FOCAL, CUTOFF, "--jobs=1", f"--output={name}", "--summary=a.html"]
    done = works("study", *CAMERA, *words)
    lines = done.stdout.splitlines()
    assert lines[1] == "5 of 5 points with warnings:"
    assert any(
        line.startswith(f"warning: {contradiction(100)}") and line.endswith(" (4 points)")
        for line in lines
    )
    if name == "a.parquet":
        table = pd.read_parquet(tmp_path / name)
    else:
        with xr.open_dataset(tmp_path / name) as data:
            table = data.to_dataframe()
    assert len(set(table.filter(like="optics.cutoff").iloc[:, 0])) == 1
    told = ["f_number" in text for text in table["warnings"]]
    assert told == [True, True, False, True, True]
    for focal, text in zip((100, 150, 200, 250, 300), table["warnings"], strict=True):
        assert contradiction(focal) in text
    assert "5 of 5 points with warnings" in (tmp_path / "a.html").read_text()


def test_a_trade_off_tells_those_of_varied_points(works, tmp_path):
    outputs = ["--output=a.csv", "--output=a.json", "--output=a.html"]
    done = works("tradeoff", *CAMERA, FOCAL, CUTOFF, *outputs)
    assert "5 of 5 points with warnings:" in done.stdout.splitlines()
    (curve,) = json.loads((tmp_path / "a.json").read_text())["curves"]
    told = ["; ".join(point["warnings"]) for point in curve["points"]]
    for focal, text in zip((100, 150, 200, 250, 300), told, strict=True):
        assert contradiction(focal) in text
        assert ("f_number" in text) == (focal != 200)
    assert list(pd.read_csv(tmp_path / "a.csv")["warnings"]) == told
    page = unescape((tmp_path / "a.html").read_text())
    assert "Warnings</h2>" in page
    assert contradiction(300) in page
    assert contradiction(100) in page


def test_solve_tells_those_of_the_value_that_it_finds(works):
    words = ["--for=camera.focal_length_mm=150:350", "--until=camera.pixel_x_mrad=0.05"]
    done = works("solve", *CAMERA, *words)
    assert done.stdout.startswith("camera.focal_length_mm = 300")
    assert f"warning: {contradiction(300)}" in done.stdout
