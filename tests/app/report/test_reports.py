from __future__ import annotations

import base64
import json
import os
import re
from contextlib import contextmanager
from itertools import pairwise

import numpy as np
import pytest

from app.report import report_page
from app.report.blocks import MOST_ROWS, of_many
from app.report.drawing import picture_drawing
from app.report.drawing.curves import panel
from app.report.drawing.picture_drawing import figure, histogram, pictures_png
from app.report.drawing.printed_numbers import number
from app.report.drawing.pupils import ends
from app.run.responses import Response, Responses, StageResponse
from app.run.transfer_chain import Chain
from core.chain.wires import Image


@pytest.fixture
def published(small):
    return small | {
        "description": "A <slanted> edge & two blurs.",
        "published": [
            {
                "figure": "Nyquist",
                "where": "table 1",
                "value": 0.458,
                "unit": "cyc/mrad",
                "from": "init.nyquist_x",
                "within": 0.001,
            },
            {
                "figure": "MTF",
                "where": "table 2",
                "value": 0.5,
                "from": "total.mtf_nyquist_x",
                "within": 0.001,
                "reason": "a different blur",
            },
            {"figure": "NETD", "where": "table 3", "value": 0.1, "reason": "no electronics"},
            {
                "figure": "mean",
                "where": "fig. 4",
                "value": 1e9,
                "from": "scene.image.mean",
                "within": 1,
            },
        ],
        "conflicts": ["Page 1 says A, page 2 says B."],
    }


def test_json(imagechain, write, published, tmp_path):
    done = imagechain("run", write(published), "--report", "r.json")
    assert (done.returncode, done.stderr) == (0, "")
    report = json.loads((tmp_path / "r.json").read_text())
    verdicts = [row["verdict"] for row in report["published"]]
    assert verdicts == ["reproduced", "not reproduced", "not computed", "not reproduced"]
    assert report["conflicts"] == published["conflicts"]
    assert report["run"]["seed"] == 3
    assert report["run"]["precision"] == "single"
    assert report["nodes"]["blur"]["parameters"]["sigma_x_mrad"] == {"value": 0.5, "unit": "mrad"}
    assert [s["name"] for s in report["transfer"]["stages"]] == ["blur", "jitter"]
    assert len(report["transfer"]["products"][0]["mtf_x"]) == 25
    assert [p["port"] for p in report["pictures"]] == ["scene.image", "pixels.image"]
    readouts = json.loads((tmp_path / "net-output/readouts.json").read_text())
    assert (
        report["nodes"]["init"]["readouts"]["nyquist_x"]["value"] == readouts["init"]["nyquist_x"]
    )


def test_html_needs_no_other_file(imagechain, write, published, tmp_path):
    done = imagechain("run", write(published), "--report", "r.html", "--report", "r2.html")
    assert (done.returncode, done.stderr) == (0, "")
    page = (tmp_path / "r.html").read_text()
    assert "A &lt;slanted&gt; edge &amp; two blurs." in page
    sources = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert len(sources) == 5
    for source in sources:
        kind, _, data = source.partition("base64,")
        assert kind == "data:image/png;"
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG")
    for words in (
        "Comparison with published figures",
        "Conflicts within the source",
        "a different blur",
    ):
        assert words in page


def test_tables_too_long_for_a_page_are_cut_and_say_so(
    imagechain, write, small, monkeypatch, tmp_path
):
    monkeypatch.setattr(report_page, "MOST_ROWS", 2)
    done = imagechain("run", write(small), "--report", "r.html")
    assert (done.returncode, done.stderr) == (0, "")
    page = (tmp_path / "r.html").read_text()
    count = len(small["nodes"])
    assert f"The first 2 of {count} rows; readouts.json and mtf.csv contain all of them." in page
    assert re.search(r"The first 2 of \d+ nodes with read-outs; readouts.json and mtf.csv", page)
    assert max(len(re.findall("<tr", table)) for table in page.split("<table")[1:]) <= 14  # figures


def test_pictures_that_end_unlinked_without_a_chain(imagechain, write, tmp_path):
    scene = {"module": "test_scene", "params": {"kind": "point", "width": 9, "height": 9}}
    network = {"format": "imagechain-network", "version": 1, "name": "Two pictures"}
    network |= {"nodes": {"left": scene, "right": scene}, "links": []}
    done = imagechain("run", write(network), "--report", "r.html")
    assert (done.returncode, done.stderr) == (0, "")
    page = (tmp_path / "r.html").read_text()
    assert 'alt="other output pictures"' in page  # both, since neither is the network's output
    assert 'alt="input and output pictures"' not in page
    for port in ("left.image", "right.image"):
        assert f"<td>{port}</td>" in page


def test_noise_pictures(imagechain, write, small, tmp_path):
    small["nodes"]["noise"] = {"module": "poisson_noise"}
    small["links"][0] = ["scene.image", "noise.image"]
    small["links"].append(["noise.image", "init.image"])
    imagechain("run", write(small), "--report", "r.html", "--report", "r.json")
    page = (tmp_path / "r.html").read_text()
    assert 'alt="noise pictures and histograms"' in page
    report = json.loads((tmp_path / "r.json").read_text())
    assert [each["port"] for each in report["noise"]] == ["noise.noise"]


@pytest.mark.parametrize(
    ("published", "told"),
    [
        ({}, "list"),
        ([{"figure": "x"}], "figure and value"),
        ([{"figure": "x", "value": 1, "form": "a.b"}], "mean from?"),
        ([{"figure": "x", "value": 1, "within": 1, "from": "init.nyquist"}], "init.nyquist_"),
        ([{"figure": "x", "value": "1", "within": 1, "from": "init.nyquist_x"}], "numbers"),
    ],
)
def test_bad_published_figures(published, told, fails, write, small):
    write(small | {"published": published})
    assert told in fails("run", "net.json", "--report", "r.json")


def test_settings_of_others_do_not_matter(imagechain_process, write, small, tmp_path):
    (tmp_path / "matplotlibrc").write_bytes(b"\xff\xfe junk: : :")
    env = {
        "HOME": "/proc",
        "XDG_CACHE_HOME": "/proc/no",
        "MPLBACKEND": "foo",
        "MPLCONFIGDIR": "/proc/no",
        "MATPLOTLIBRC": str(tmp_path / "matplotlibrc"),
    }
    done = imagechain_process("run", write(small), "--report", "r.html", env=env)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "r.html").is_file()


def test_names_that_are_no_text(imagechain, write, small, tmp_path):
    name = os.fsdecode(b"scene\xff.npy")
    np.save(tmp_path / name, np.ones((40, 48)))
    small["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": "x.npy", "fov_x_deg": 3.0, "fov_y_deg": 2.5},
    }
    words = ["--set", f"scene.path={name}", "--report", "r.json", "--report", "r.html"]
    done = imagechain("run", write(small), *words)
    assert (done.returncode, done.stderr) == (0, "")
    report = json.loads((tmp_path / "r.json").read_text())
    # Bytes, as pytest-xdist cannot send this name where the test fails.
    found = report["nodes"]["scene"]["parameters"]["path"]["value"]
    assert os.fsencode(found) == os.fsencode(tmp_path / name)
    assert "scene\\udcff.npy" in (tmp_path / "r.html").read_text()


def test_total_with_electronics_at_nyquist(shipped_report):
    made = shipped_report("inframetrics")
    found = made.facts["transfer"]["at_nyquist"]
    wanted = found["total.mtf_nyquist_x"] * found["electronics.mtf_nyquist_x"]
    assert found["total_with_electronics.mtf_nyquist_x"] == pytest.approx(wanted, rel=1e-12)
    assert "<td>Total with electronics</td><td></td>" in made.page
    assert not re.search(r"\de-1[0-9]", re.sub(r"base64,[^\"]*", "", made.page))


def test_warnings_are_those_of_the_run(imagechain, shipped_report, tmp_path):
    found = shipped_report("kodak_kir310").facts["warnings"]
    assert len(found) == 3
    assert {caution["node"] for caution in found} <= set(
        shipped_report("kodak_kir310").facts["nodes"]
    )


def test_what_was_skipped_is_named_at_its_node(imagechain, write, small, tmp_path):
    def skipped():
        assert imagechain("run", write(small), "--report", "r.json").returncode == 0
        report = json.loads((tmp_path / "r.json").read_text())
        return [skip["kind"] for skip in report["skipped"]["blur"]]

    assert "identity" not in skipped()
    small["nodes"]["blur"]["params"] = {"sigma_x_mrad": 0.0, "sigma_y_mrad": 0.0}
    assert "identity" in skipped()


def test_pupils(shipped_report):
    page = shipped_report("pupils").page
    assert "<h2>Pupils</h2>" in page
    assert 'alt="exit pupils and autocorrelations"' in page


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-1.0, "−1"),
        (1e-7, "10⁻⁷"),
        (-1e-7, "−10⁻⁷"),
        (-2.5e12, "−2.5·10¹²"),
        (True, "yes"),
        (None, "–"),
        ("a-1", "a-1"),
        (-3, "−3"),
    ],
)
def test_printed_numbers(value, text):
    assert number(value) == text


@pytest.mark.parametrize(("count", "interval"), [(4, 0.5), (5, 0.5)])
def test_zero_frequency_is_in_the_middle_of_its_sample(count, interval):
    left, right = ends(count, interval)
    edges = np.linspace(left, right, count + 1)
    centres = (edges[1:] + edges[:-1]) / 2
    wanted = np.fft.fftshift(np.fft.fftfreq(count, 1 / (count * interval)))
    np.testing.assert_allclose(centres, wanted, atol=1e-15)


@pytest.mark.parametrize("centre", [0.0, 0.00025, 300.123456, 1e6])
def test_labels_of_histograms_do_not_meet(centre):
    samples = centre + 1e-4 * max(centre, 1) * np.random.default_rng(1).normal(size=(64, 64))
    image = Image(None, 64, 64, unit="W/m²/sr")
    with figure(10.0, 3.5) as (drawn, _):
        axis = drawn.subplots(1, 2)[1]
        histogram(axis, image, samples)
        drawn.canvas.draw()
        boxes = [label.get_window_extent() for label in axis.get_xticklabels() if label.get_text()]
        shown = sorted((box.x0, box.x1) for box in boxes)
        assert len(shown) >= 2
        assert all(one[1] < other[0] for one, other in pairwise(shown))


def test_a_single_other_picture_is_as_small_as_those_beside_it():
    image = Image(None, 8, 8, unit="W/m²/sr")
    samples = np.arange(64.0).reshape(8, 8)

    def width(count, beside):
        png = pictures_png([("a", image, samples)] * count, beside)
        return int.from_bytes(png[16:20], "big")

    assert width(1, 3) == pytest.approx(width(3, 2) / 3, abs=1)
    assert width(1, 1) == pytest.approx(width(2, 2) / 2, abs=1)


def test_a_noise_picture_stands_under_its_name_and_beside_its_histogram(monkeypatch):
    drawings = []

    @contextmanager
    def noted(*size):
        with figure(*size) as (drawn, out):
            drawings.append(drawn)
            yield drawn, out

    monkeypatch.setattr(picture_drawing, "figure", noted)
    image = Image(None, 8, 8, unit="W/m²/sr")
    samples = np.random.default_rng(2).normal(size=(8, 8))
    picture_drawing.noise_png([("photons.noise", image, samples), ("late.noise", image, samples)])
    (drawn,) = drawings
    titles = [axis.get_title("left") for axis in drawn.axes if axis.images]
    assert titles == ["photons.noise", "late.noise"]


def test_a_total_over_its_only_stage_lets_it_through():
    xi = np.linspace(0, 1, 9)
    blur = Response(np.exp(-(xi**2)), np.zeros(9))
    stage = StageResponse("blur", "Blur", blur, blur)
    total = StageResponse("total", "Total", blur, blur, is_product=True)
    found = Responses(xi, xi, (stage,), (), (total,))
    chain = Chain(None, (), None, None, (), (), ())
    with figure(5, 4) as (drawn, _):
        axis = drawn.subplots()
        panel(axis, found, chain, [stage], "mtf", "x")
        lines = {line.get_label(): line for line in axis.get_lines()}
        assert lines["Total"].get_linestyle() != "-"
        assert lines["Total"].get_zorder() > lines["Blur (blur)"].get_zorder()


def test_a_caption_says_where_all_stages_are():
    assert of_many(MOST_ROWS).endswith(
        " Only the 24 strongest of 500 stages are drawn; the table contains all of them."
    )
    assert of_many(5000).endswith(
        "24 strongest of 5,000 stages are drawn; readouts.json and mtf.csv contain all of them."
    )
