import base64
import json
import re

import numpy as np
import pytest

from app.report.drawing.picture_drawing import number
from command_line import run_here
from core.errors import printable
from cube_network import BANDS, write_cube_network
from nodes.library import standard_library


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
    [({}, "list"), ([{"figure": "x", "value": 1, "form": "a.b"}], "mean from?")],
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
    ("value", "text"), [(-1.0, "−1"), (-1e-7, "−10⁻⁷"), (-2.5e12, "−2.5·10¹²"), (None, "–")]
)
def test_printed_numbers(value, text):
    assert number(value) == text


# --- curves ---


def with_slices(small):
    """The network with a curve that no link leaves, and one that a link leaves."""
    small["nodes"]["slices"] = {"module": "mtf_slices"}
    small["nodes"]["look"] = {"module": "examine_image"}
    small["nodes"]["file"] = {"module": "write_matrix", "params": {"path": "h.csv"}}
    small["links"] += [
        ["blur.mtf", "slices.transfer"],
        ["scene.image", "look.image"],
        ["look.curve", "file.image"],
    ]
    return small


def test_a_report_draws_curves_that_no_link_leaves(works, write, small, tmp_path):
    works("run", write(with_slices(small)), "--report", "r.html", "--report", "r.json")
    page = (tmp_path / "r.html").read_text()
    assert "<h2>Curves</h2>" in page
    (drawn,) = re.findall(r'alt="curves of nodes" src="data:image/png;base64,([^"]*)"', page)
    assert base64.b64decode(drawn).startswith(b"\x89PNG")
    curves = json.loads((tmp_path / "r.json").read_text())["curves"]
    assert [each["port"] for each in curves] == ["slices.curve"]
    (series, *_) = curves[0]["series"]
    x, y = np.array(series["x"]), np.array(series["y"])
    np.testing.assert_allclose(y, np.exp(-2 * (np.pi * 0.5 * x) ** 2), atol=1e-5)


# --- texts ---

FORMULA = r"$\frac{$"  # begins a formula that never ends
ORDERS = "\x1b]0;title\x07\x1b[31mred\x9b2J\u202eback\u2028\x7f"


@pytest.fixture
def unruly(small):
    """The small network under names that are no formulas and give a terminal orders."""
    nodes = {f"{name}{FORMULA}": node for name, node in small["nodes"].items()}
    links = [
        [f"{node}{FORMULA}.{port}" for node, port in (end.split(".") for end in link)]
        for link in small["links"]
    ]
    nodes["slices"] = {"module": "mtf_slices"}
    links.append([f"blur{FORMULA}.mtf", "slices.transfer"])
    told = {"name": f"{FORMULA} {ORDERS}", "description": f"a{ORDERS}z\tand\nmore"}
    return {**small, **told, "nodes": nodes, "links": links}


def test_a_report_of_unruly_names(works, write, unruly, tmp_path):
    done = works("run", write(unruly), "--report", "r.html", "--report", "r.json")
    page, facts = (tmp_path / "r.html").read_text(), (tmp_path / "r.json").read_text()
    for text in (page, facts, done.stdout):
        assert not [letter for letter in text if letter in ORDERS and not letter.isprintable()]
    assert json.loads(facts)["network"]["description"] == unruly["description"]
    assert r"\u001b]0;title\u0007" in page


def test_what_a_terminal_would_obey_becomes_an_escape():
    assert printable("a\tb\nc\r\n") == "a\tb\nc\r\n"
    assert printable("é 視 🔭 µm²") == "é 視 🔭 µm²"
    assert printable("\x1b[31m") == r"\u001b[31m"
    assert printable(ORDERS).isprintable()
    assert json.loads(printable(json.dumps(ORDERS, ensure_ascii=False))) == ORDERS
    assert printable("\udc80") == r"\udc80"


# --- spectra ---

QE = "wavelength_um,qe\n3.0,0.4\n4.0,0.8\n5.0,0.2\n"


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """The cube, its wavelengths, the report's facts and its page."""
    folder = tmp_path_factory.mktemp("reported")
    (folder / "qe.csv").write_text(QE)
    given = {"response": "qe.csv", "cut_on_um": 3.4, "cut_off_um": 4.7}
    library = standard_library()
    cube, wavelengths, width = write_cube_network(
        folder, library, focal_plane=given, aperture_mm=100.0
    )
    reports = ("--report", "r.json", "--report", "r.html")
    done = run_here("run", "cube.json", "--tolerance", "1e-3", *reports, folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads((folder / "r.json").read_text())
    return cube, wavelengths, width, facts, (folder / "r.html").read_text()


def test_the_facts(reported):
    cube, wavelengths, width, facts, _ = reported
    (one,) = facts["spectra"]["means"]  # filters change no mean
    assert one["ports"] == ["read.image", "back.image"]
    assert one["bands"] == BANDS
    assert one["band_um"] == pytest.approx([3.0, 5.0])
    assert one["centres_um"] == pytest.approx(wavelengths)
    assert one["widths_um"] == pytest.approx([width] * BANDS)
    assert one["mean"] == pytest.approx(cube.mean(axis=(1, 2)), rel=1e-9)
    assert one["unit"] == "W/m²/sr/µm"
    (response,) = facts["spectra"]["responses"]
    assert (response["node"], response["name"]) == ("fpa", "quantum efficiency")
    values = np.interp([3.3, 3.5, 4.0, 4.5], response["wavelength_um"], response["values"])
    assert values == pytest.approx([0.0, 0.6, 0.8, 0.5], abs=1e-9)


def test_the_page(reported):
    *_, page = reported
    section = page[page.index("<h2>Spectrum</h2>") :]
    section = section[: section.index("<h2>", 5)]
    picture = re.search(r'src="data:image/png;base64,([^"]*)"', section)
    assert base64.b64decode(picture[1], validate=True).startswith(b"\x89PNG")
    for words in ("read.image, back.image", "3 to 5", "W/m²/sr/µm"):
        assert words in section
