"""Curves and bars of nodes in reports."""

import base64
import json
import re

import numpy as np


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
