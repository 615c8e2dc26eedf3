"""Curves and bars of nodes in reports."""

import base64
import json
import re

import numpy as np
import pytest

from app.report.drawing.node_curves import _draw_bars, _draw_curves, curves_png
from app.report.drawing.picture_drawing import figure
from core.chain.results import CurveData, Series

NAMES = ("optics", "detector", "jitter")
BARS = CurveData(
    "Shares", "stage", "NETD (mK)",
    (
        Series("temporal", np.arange(3.0), np.array([0.5, 20.25, np.inf])),
        Series("fixed", np.arange(3.0), np.array([-1.0, 0.0, 0.125])),
    ),
    NAMES,
)  # fmt: skip
X = np.linspace(0, 2, 21)
MRTD = CurveData(
    "MRTD", "frequency (cyc/mrad)", "MRTD (K)",
    (Series("MRTD", X, np.where(X < 1.5, 10.0**X, np.inf)),), log_y=True,
)  # fmt: skip


@pytest.fixture
def axis():
    with figure(4.0, 3.0) as (drawn, _):
        yield drawn.subplots()


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


def test_a_report_without_curves_has_no_such_section(imagechain, write, small, tmp_path):
    assert imagechain("run", write(small), "--report", "r.html").returncode == 0
    assert "<h2>Curves</h2>" not in (tmp_path / "r.html").read_text()


def test_bars_have_names_lengths_and_values(axis):
    _draw_bars(axis, BARS)
    assert [label.get_text() for label in axis.get_yticklabels()] == list(NAMES)
    widths = [bar.get_width() for bar in axis.patches]
    np.testing.assert_array_equal(widths, [0.5, 20.25, np.nan, -1.0, 0.0, 0.125])
    texts = [text.get_text() for text in axis.texts]
    assert texts == ["0.5", "20.25", "∞", "−1", "0", "0.125"]
    first, second = axis.patches[0].get_y(), axis.patches[1].get_y()
    assert axis.transData.transform((0, first))[1] > axis.transData.transform((0, second))[1]


def test_a_logarithmic_curve_has_gaps(axis):
    _draw_curves(axis, MRTD)
    assert axis.get_yscale() == "log"
    (line,) = axis.lines
    y = line.get_ydata()
    assert np.isnan(y[X >= 1.5]).all()
    np.testing.assert_array_equal(y[X < 1.5], 10.0 ** X[X < 1.5])
    assert axis.get_ylim()[1] < 100


def test_a_figure_of_many_kinds_is_drawn():
    logarithmic = CurveData("", "", "share", BARS.series, NAMES, log_y=True)
    empty = CurveData("empty", "x", "y", ())
    png = curves_png([("a.curve", BARS), ("b.curve", MRTD), ("c.curve", logarithmic), ("d", empty)])
    assert png.startswith(b"\x89PNG")
