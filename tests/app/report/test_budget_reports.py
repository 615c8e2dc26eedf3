"""The budget of noise and blur in reports, and what they say where it cannot be told."""

import json
import math

import numpy as np
import pytest

from budget_chain import ELECTRONICS, SENSOR


def test_it_is_in_both_reports(shipped_report):
    made = shipped_report("inframetrics")
    found = made.facts["budget"]
    noise, sources = found["noise"], found["noise"]["sources"]
    names = ["photons", "gain", "bias", "detector", "amplifier", "quantization"]
    assert [each["name"] for each in sources] == names
    assert sum(each["share"] for each in sources) == pytest.approx(1)
    assert noise["together"] == pytest.approx(noise["summed"], rel=0.02)
    for axis in ("x", "y"):
        shares = [each[f"share_{axis}"] for each in found["blur"]["stages"]]
        assert sum(shares) == pytest.approx(1)
    # One detector reads every line: its error of bias shifts the picture and spreads nothing.
    (bias,) = [each for each in sources if each["name"] == "bias"]
    assert (bias["fixed"], bias["temporal"]) == (0.0, None)
    assert abs(noise["together_mean"]) > 0.01
    page = made.page
    assert 'alt="shares of noise and blur"' in page
    for words in (
        "Contributions to noise and blur",
        "Quantization",
        "All together",
        "Detector MTF",
    ):
        assert words in page


def test_a_picture_of_nothing_but_noise_is_shared_out(works, write, tmp_path):
    np.save(tmp_path / "dark.npy", np.zeros((32, 32)))
    np.save(tmp_path / "glow.npy", np.tile([29.0, 31.0], (32, 16)))
    document = {
        "format": "imagechain-network",
        "version": 1,
        "nodes": {
            "scene": {
                "module": "read_image",
                "params": {"path": "dark.npy", "fov_x_deg": 3.0, "fov_y_deg": 3.0},
            },
            "glow": {"module": "noise_file", "params": {"path": "glow.npy"}},
            "init": {"module": "init_trans", "params": {**SENSOR}},
            "back": {"module": "back_transform"},
            "electronics": {
                "module": "electronics_noise",
                "params": {
                    **ELECTRONICS, "amplifier_snr": 30.0, "cut_on_um": 8.0, "cut_off_um": 12.0,
                },
            },
        },
        "links": [
            ["scene.image", "glow.image"], ["glow.image", "init.image"],
            ["init.magnitude", "back.magnitude"], ["init.phase", "back.phase"],
            ["back.image", "electronics.image"], ["init.context", "electronics.context"],
        ],
    }  # fmt: skip
    works("run", write(document), "--report", "r.json", "--report", "r.html")
    found = json.loads((tmp_path / "r.json").read_text())["budget"]
    by_name = {each["name"]: each for each in found["noise"]["sources"]}
    # ±1 about 30, as the estimate of 32 columns about their mean that is right on average.
    assert by_name["file"]["fixed"] == pytest.approx(math.sqrt(32 / 31), rel=1e-6)
    assert by_name["amplifier"]["temporal"] == pytest.approx(1.0, rel=0.01)  # 30 over 30
    assert "Noise file" in (tmp_path / "r.html").read_text()
