"""`ic.study`: a chain at many points, as columns, a DataFrame and a table in a notebook."""

import json

import distributed
import numpy as np
import pandas as pd
import pytest
import xarray as xr

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


def test_warnings_are_kept_by_point(chain):
    chain.set("electronics.cut_on_um", 3.0)
    chain.set("electronics.cut_off_um", 5.0)
    found = ic.study(chain, vary={"scene.cut_off_um": [5.0, 12.0]}, figures="electronics.ner")
    assert list(found.warnings) == [2]
    assert "overlap by 22 % of their total width" in found.warnings[2][0]
    assert found["warnings"] == ["", found.warnings[2][0]]
    assert "1 of 2 points with warnings:" in repr(found)
    assert "1 of 2 points with warnings:" in found._repr_html_()


SIGMA = {"blur.sigma_x_mrad": [0.0, 1.0]}
KINDS = {
    "chain": ({"chain": pd.DataFrame()}, "chain: DataFrame is not allowed; give a Chain, a"),
    "callable": ({"vary": {"blur.sigma_x_mrad": np.sin}}, "ufunc is not allowed; give a list or"),
    "over": ({"over": {"scene.path": ["a.img"]}}, "over: dict is not allowed; give a mapping of"),
    "jobs": ({"jobs": "2"}, "jobs = '2' is not allowed: must be a whole number, 0 or more"),
    "none": ({"scheduler": None}, "scheduler: NoneType is not allowed; give the address of a Dask"),
}


@pytest.mark.parametrize(("words", "why"), KINDS.values(), ids=KINDS.keys())
def test_other_kinds_are_refused_in_one_line(chain, words, why):
    given = {"chain": chain, "vary": SIGMA, **words}
    with pytest.raises(ic.UsageError) as refused:
        ic.study(given.pop("chain"), **given)
    assert why in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "values",
    [range(2), pd.Series([0, 1]), xr.DataArray([0.0, 1.0])],
    ids=lambda values: type(values).__name__,
)
def test_values_in_other_sequences(chain, values):
    found = ic.study(chain, vary={"blur.sigma_x_mrad": values}, figures=["total.mtf_nyquist_x"])
    assert found["blur.sigma_x_mrad"] == [0.0, 1.0]


@pytest.mark.filterwarnings("ignore:.*:ResourceWarning")  # what Dask leaves to the collector
def test_a_client_is_taken_and_one_without_tls_warned_of(chain, monkeypatch):
    """`inproc` is within this process; the warning goes by the address alone."""
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        words = {"vary": SIGMA, "figures": ["total.mtf_nyquist_x"]}
        found = ic.study(chain, scheduler=client, **words)
        assert client.status == "running"
        assert (
            found["total.mtf_nyquist_x"] == ic.study(chain, jobs=1, **words)["total.mtf_nyquist_x"]
        )
        monkeypatch.setattr("app.study.study_rows._INNER", ())
        with pytest.warns(
            UserWarning, match=r"inproc://.* has no TLS: anyone who can reach its port"
        ):
            ic.study(chain, scheduler=client, **words)


def test_a_point_that_fails_is_a_row(chain):
    chain.set("electronics.d_star", None)
    found = ic.study(chain, vary={"electronics.material": ["PtSi", "manual"]}, over=None,
                     figures=["electronics.ner"])  # fmt: skip
    assert 2 in found.failed
    assert found["electronics.ner"][1] is None
