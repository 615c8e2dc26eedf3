"""`ic.study`: a chain at many points, as columns, a DataFrame and a table in a notebook."""

from __future__ import annotations

import json

import numpy as np
import pytest

import imagechain as ic
from tradeoff_network import DOCUMENT, mtf


@pytest.fixture
def chain(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sensor.json").write_text(json.dumps(DOCUMENT))
    return ic.open("sensor.json")


def test_a_study_of_a_chain(chain):
    chain.set("electronics.region", "MWIR")
    found = ic.study(
        chain,
        vary={"blur.sigma_x_mrad": np.linspace(0, 1, 3), "electronics.d_star": "1e10,1e11"},
        figures=["total.mtf_nyquist_x", "electronics.ner"],
    )
    expected = [mtf(value) for value in found["blur.sigma_x_mrad"]]
    assert found["total.mtf_nyquist_x"] == pytest.approx(expected, rel=1e-12)
    assert found.units["electronics.ner"] == "W/m²/sr"
    assert found["electronics.ner"][0] == pytest.approx(10 * found["electronics.ner"][1])
    assert found.failed == {}
    frame = found.to_frame()
    assert list(frame["electronics.ner (W/m²/sr)"]) == found["electronics.ner"]
    assert "6 points" in repr(found)
    assert "data:image/png" in found._repr_html_()
    with pytest.raises(ic.ParameterError, match=r"did you mean electronics\.ner"):
        found["electronics.nerr"]


def test_a_point_that_fails_is_a_row(chain):
    chain.set("electronics.d_star", None)
    found = ic.study(chain, vary={"electronics.material": ["PtSi", "manual"]}, over=None,
                     figures=["electronics.ner"])  # fmt: skip
    assert 2 in found.failed
    assert found["electronics.ner"][1] is None
