from __future__ import annotations

import base64
import json
import re

import pytest


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
    assert len(sources) == 3
    for source in sources:
        kind, _, data = source.partition("base64,")
        assert kind == "data:image/png;"
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG")
    for words in (
        "Beside the published figures",
        "Conflicts within the source",
        "a different blur",
    ):
        assert words in page


def test_says_what_was_skipped(imagechain, write, small, tmp_path):
    words = ["--set", "jitter.sigma_mrad=0", "--report", "r.json", "--report", "r.html"]
    imagechain("run", write(small), *words)
    report = json.loads((tmp_path / "r.json").read_text())
    assert report["skipped"] == {"neutral": ["jitter"], "disabled": []}
    assert "neutral: skipped" in (tmp_path / "r.html").read_text()


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
