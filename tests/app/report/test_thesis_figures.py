"""The thesis' figures in the reports of its two sensors, and the same for other networks."""

import base64
import json
from html.parser import HTMLParser

import numpy as np
import pytest

from app.run.shipped import shipped_networks
from command_line import run_here

FIGURES = {
    "inframetrics": ("fig. 5.26", "fig. 5.27", "figs. 5.56 and 5.57"),
    "kodak_kir310_1996": ("fig. 5.53", "fig. 5.54", "figs. 5.58 and 5.59"),
}


class Page(HTMLParser):
    """Figures as (alt, caption, picture's bytes), and headings."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.figures, self.heads, self._open, self._alt = [], [], "", ("", b"")
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self._open = tag
        given = dict(attrs)
        if tag == "img":
            self._alt = given["alt"], base64.b64decode(given["src"].partition("base64,")[2])

    def handle_data(self, data):
        if self._open == "figcaption":
            self.figures.append((self._alt[0], data, self._alt[1]))
        if self._open == "h2":
            self.heads.append(data)
        self._open = ""


@pytest.fixture(params=FIGURES)
def report(request, shipped_report):
    made = shipped_report(request.param)
    return request.param, made.facts, Page(made.page)


def test_the_figures_are_there(report):
    name, facts, page = report
    stages, total, judged = FIGURES[name]
    captions = {alt: (caption, picture) for alt, caption, picture in page.figures}
    for alt, figure in (
        ("MTF of every stage", stages),
        ("product of the MTFs", total),
        ("measured and expected MTF", judged),
    ):
        caption, picture = captions[alt]
        assert caption.startswith(f"As Tantalo 1996, {figure}. ")
        assert picture.startswith(b"\x89PNG")
    assert facts["drawn_as"]["judged"] == f"Tantalo 1996, {judged}"
    assert "Checked by measurement" in page.heads


def test_measured_and_expected_agree(report):
    """To what pixels alias that are too far apart for what they see."""
    name, facts, _ = report
    judged = facts["judged"]
    assert judged["reason"] is None
    assert judged["picture"] == "frame_grabber.image"
    assert judged["silenced"] == ["photons", "electronics"]
    assert len(judged["measurements"]) == 4
    within = {"row_average": 1e-4, "slanted_edge": 0.02 if "infra" in name else 0.01}
    for each in judged["measurements"]:
        assert each["reason"] is None
        measured, expected = np.array(each["mtf"]), np.array(each["expected"])
        away = measured - expected
        assert np.max(np.abs(away)) < within[each["method"]]
        assert each["largest_difference"] == pytest.approx(away[np.argmax(np.abs(away))])
        assert measured[0] == pytest.approx(1.0)
        assert each["at_nyquist"] == pytest.approx(measured[-1])
        assert each["frequency_cyc_per_sample"][-1] == pytest.approx(0.5, abs=0.01)


def test_what_the_thesis_says_of_its_curves(report):
    """Fig. 5.27: the horizontal MTF falls earlier. Fig. 5.54: nearly identical, it slightly so."""
    name, facts, _ = report
    total = facts["transfer"]["products"][-1]
    across, along = np.array(total["mtf_x"]), np.array(total["mtf_y"])
    positive = (across > 0.01) & (along > 0.01)
    positive[0] = False
    apart = along[: len(across)] - across
    assert np.all(apart[positive & (np.cumsum(~positive) <= 1)] > 0)
    if "infra" in name:
        assert np.max(apart) > 0.08
        minima = across.min(), along.min()  # the axis of fig. 5.26 goes down to −0.25
        assert all(-0.25 < each < -0.02 for each in minima)
    else:
        assert np.max(apart) < 0.02


@pytest.mark.parametrize(
    ("words", "compared"), [((), True), (("--set", "photons.percent=50"), False)]
)
def test_only_the_published_network_is_compared_with_the_thesis(words, compared, tmp_path):
    """By its content: here under another name, as a file of one's own."""
    document = json.loads(shipped_networks()["poisson_two_panel"].read_text("utf-8"))
    document |= {"name": "A copy", "description": "", "conflicts": ["Page 1 says A, page 2 B."]}
    (tmp_path / "copy.json").write_text(json.dumps(document))
    done = run_here("run", "copy.json", "--report", "r.json", *words, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    facts = json.loads((tmp_path / "r.json").read_text())
    assert bool(facts["published"]) == bool(facts["conflicts"]) == compared
