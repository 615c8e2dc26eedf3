import base64
import json
import re

import pytest

from app.report.drawing.picture_drawing import number


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


def test_json(works, write, published, tmp_path):
    works("run", write(published), "--report", "r.json")
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


def test_html_needs_no_other_file(works, write, published, tmp_path):
    works("run", write(published), "--report", "r.html")
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


@pytest.mark.parametrize(
    ("published", "told"),
    [
        ({}, "list"),
        ([{"figure": "x", "value": 1, "form": "a.b"}], "mean from?"),
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


def test_total_with_electronics_at_nyquist(shipped_report):
    made = shipped_report("inframetrics")
    found = made.facts["transfer"]["at_nyquist"]
    wanted = found["total.mtf_nyquist_x"] * found["electronics.mtf_nyquist_x"]
    assert found["total_with_electronics.mtf_nyquist_x"] == pytest.approx(wanted, rel=1e-12)
    assert "<td>Total with electronics</td><td></td>" in made.page
    assert not re.search(r"\de-1[0-9]", re.sub(r"base64,[^\"]*", "", made.page))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-1.0, "−1"),
        (-1e-7, "−10⁻⁷"),
        (-2.5e12, "−2.5·10¹²"),
        (None, "–"),
    ],
)
def test_printed_numbers(value, text):
    assert number(value) == text
