"""Shares of noise and blur against variances and laws written out here."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from app.budget import _shares, blur_budget, noise_budget
from app.evaluation import TimedWork, evaluate, planned
from app.report.budget import bars_png, budget
from app.report.budget_facts import budget_facts
from core.engine import Engine
from core.policy import Policy
from linked_network import linked_network
from nodes.library import standard_library

SIZE, FOV_DEG = 512, 10.0
INTERVAL = math.radians(FOV_DEG) * 1000 / SIZE
PITCH_UM, F_NUMBER, BANDWIDTH, D_STAR = 30.0, 2.0, 1e5, 1e10
BLUR_PX = 1.5
SCENE = {
    "kind": "uniform", "width": SIZE, "height": SIZE, "fov_x_deg": FOV_DEG, "fov_y_deg": FOV_DEG,
}  # fmt: skip
SENSOR = {
    "detector_x_um": PITCH_UM, "detector_y_um": PITCH_UM, "focal_length_mm": 50,
    "f_number": F_NUMBER, "platform": "array", "edges": "periodic",
}  # fmt: skip
ELECTRONICS = {
    "region": "LWIR", "material": "manual", "d_star": D_STAR, "bandwidth_Hz": BANDWIDTH,
    "amplifier_snr": 80.0, "gain_percent": 1.0, "bias_percent": 0.5,
}  # fmt: skip
PHOTONS = {"mode": "photon", "photons_per_unit": 40.0}


def network(photons=PHOTONS, electronics=ELECTRONICS, scene=SCENE, sigma_px=BLUR_PX):
    """Photon noise, a blur, the electronics, and pixels combined two by two."""
    sigma = sigma_px * INTERVAL
    nodes = {
        "scene": ("test_scene", scene),
        "photons": ("poisson_noise", photons),
        "init": ("init_trans", SENSOR),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "back": ("back_transform", {}),
        "electronics": ("electronics_noise", electronics),
        "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
    }
    return linked_network(
        nodes,
        [
            ("scene.image", "photons.image"), ("photons.image", "init.image"),
            ("init.context", "blur.context"), ("init.magnitude", "blur.magnitude"),
            ("blur.magnitude", "back.magnitude"), ("init.phase", "back.phase"),
            ("back.image", "electronics.image"), ("init.context", "electronics.context"),
            ("electronics.image", "pixels.image"),
        ],
        seed=7,
    )  # fmt: skip


def evaluated(document, precision="double"):
    engine = Engine(standard_library())
    plan = planned(engine, document, Path())
    return evaluate(engine, plan, TimedWork(Policy(precision), engine.store), Path())


def radiance(found):
    return float(found.engine.value(found.plan, "scene.image", found.work)[0, 0])


def expected_sigmas(level):
    """Rms noise in the combined picture, each from its own law."""
    area_cm2 = (PITCH_UM * 1e-4) ** 2
    throughput = (4 * F_NUMBER**2 + 1) / math.pi
    ner = math.sqrt(area_cm2 * BANDWIDTH) / D_STAR * throughput / area_cm2 * 1e4
    lags = np.arange(-12, 13)
    weights = np.exp(-((lags / BLUR_PX) ** 2) / 2) / (BLUR_PX * math.sqrt(2 * math.pi))
    line = np.convolve(weights, [0.5, 0.5])  # the blur, then the mean of two samples
    photons = math.sqrt(level / PHOTONS["photons_per_unit"]) * float(np.sum(line**2))
    return {
        "": photons,
        "gain": 0.01 * level / 2,
        "bias": 0.005 * level / 2,
        "detector": ner / 2,
        "amplifier": level / 80 / 2,
    }


@pytest.fixture(scope="module")
def whole():
    found = evaluated(network())
    return found, noise_budget(found)


def test_noise_of_each_source_is_that_of_its_law(whole):
    found, budget_ = whole
    expected = expected_sigmas(radiance(found))
    assert {each.source.name: each.sigma for each in budget_.shares} == pytest.approx(
        expected,
        rel=0.02,  # 65536 samples tell a deviation to 0.3 %, a blurred one to 0.7 %
    )
    assert budget_.port == "pixels.image"
    for each in budget_.shares:
        assert each.mean == pytest.approx(0, abs=0.05 * expected[each.source.name])


def test_variances_add_up(whole):
    _, budget_ = whole
    variances = [each.sigma**2 for each in budget_.shares]
    assert budget_.summed == pytest.approx(math.sqrt(sum(variances)), rel=1e-12)
    assert [each.share for each in budget_.shares] == pytest.approx(
        [variance / sum(variances) for variance in variances], rel=1e-12
    )
    # All at once: sources are independent, whatever the picture they were told from.
    assert budget_.together == pytest.approx(budget_.summed, rel=0.02)


def test_every_source_alone_makes_the_same_noise():
    """Not silenced among others, but the only one there: drawn by the same stream."""
    silent = {**ELECTRONICS, "gain_percent": 0, "bias_percent": 0, "amplifier_snr": None}
    alone = evaluated(network({**PHOTONS, "mode": "published", "percent": 0}, silent))
    shares = noise_budget(alone).shares
    assert [each.source.name for each in shares] == ["detector"]
    assert shares[0].share == 1.0
    among = {each.source.name: each.sigma for each in noise_budget(evaluated(network())).shares}
    assert shares[0].sigma == pytest.approx(among["detector"], rel=1e-9)


def test_quantization_is_a_step_over_root_twelve(whole):
    level = radiance(whole[0])
    low, high = 0.8 * level, 1.2 * level
    coarse = {**ELECTRONICS, "bits": 6, "range_low": low, "range_high": high}
    found = noise_budget(evaluated(network(electronics=coarse)))
    by_name = {each.source.name: each.sigma for each in found.shares}
    step = (high - low) / 63
    assert by_name.pop("quantization") == pytest.approx(step / math.sqrt(12) / 2, rel=0.02)
    # The others are told before it: they are as without it.
    unquantized = {each.source.name: each.sigma for each in whole[1].shares}
    assert by_name == pytest.approx(unquantized, rel=1e-9)
    assert found.together == pytest.approx(found.summed, rel=0.02)


def test_what_is_switched_off_or_elsewhere_is_no_source():
    document = network()
    off = document.with_node(
        type(document.node("photons"))("photons", "poisson_noise", PHOTONS, disabled=True)
    )
    names = [each.source.name for each in noise_budget(evaluated(off)).shares]
    assert names == ["gain", "bias", "detector", "amplifier"]
    assert noise_budget(evaluated(without_electronics())) is None


def without_electronics(*stages):
    nodes = {
        "scene": ("test_scene", {**SCENE, "width": 64, "height": 64}),
        "init": ("init_trans", SENSOR),
        "back": ("back_transform", {}),
        "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
    }
    links, last = [("scene.image", "init.image"), ("init.phase", "back.phase")], "init"
    for name, key, params in stages:
        nodes[name] = (key, params)
        links += [("init.context", f"{name}.context"), (f"{last}.magnitude", f"{name}.magnitude")]
        last = name
    links += [(f"{last}.magnitude", "back.magnitude"), ("back.image", "pixels.image")]
    return linked_network(nodes, links)


def test_gaussian_blurs_share_as_their_variances():
    stages = (
        ("a", "gaussian_mtf", {"sigma_x_mrad": 3.0, "sigma_y_mrad": 1.0}),
        ("b", "jitter_mtf", {"sigma_mrad": 1.0}),
        ("idle", "gaussian_mtf", {}),
    )
    found = blur_budget(evaluated(without_electronics(*stages)))
    shares = {each.node: each.share for each in found.shares}
    assert list(shares) == ["a", "b"]
    assert shares["a"] == pytest.approx((9 / 10, 1 / 2), rel=1e-9)
    assert shares["b"] == pytest.approx((1 / 10, 1 / 2), rel=1e-9)
    interval = math.radians(FOV_DEG) * 1000 / 64
    # Half of 1/(2·interval), where the interval is that of the combined pixels.
    assert found.frequency == pytest.approx((1 / (8 * interval),) * 2, rel=1e-9)


def test_detector_and_gaussian():
    stages = (
        ("a", "gaussian_mtf", {"sigma_x_mrad": 1.0, "sigma_y_mrad": 0.0}),
        ("b", "detector_mtf", {"detector_x_um": 200, "detector_y_um": 100}),
    )
    found = blur_budget(evaluated(without_electronics(*stages)))
    f = found.frequency[0]
    losses = 2 * (math.pi * f) ** 2, -math.log(math.sin(math.pi * 4 * f) / (math.pi * 4 * f))
    shares = {each.node: each.share for each in found.shares}
    assert shares["a"] == pytest.approx((losses[0] / sum(losses), 0.0), rel=1e-9)
    assert shares["b"] == pytest.approx((losses[1] / sum(losses), 1.0), rel=1e-9)
    assert all(math.copysign(1, value) == 1 for pair in shares.values() for value in pair)


def test_what_lets_nothing_through_has_all_of_it():
    assert _shares([0.5, 0.0, 0.9]) == [0.0, 1.0, 0.0]
    assert _shares([0.0, 0.0]) == [0.5, 0.5]
    assert _shares([1.0, 1.0]) == [0.0, 0.0]
    assert sum(_shares([2.0, 0.25])) == pytest.approx(1.0)
    assert _shares([2.0, 0.25])[0] == pytest.approx(-1.0)


def test_nothing_to_tell():
    found = evaluated(without_electronics())
    facts = {"budget": budget_facts(found)}
    assert facts == {"budget": {"noise": None, "blur": None}}
    assert budget(facts) == ""


@pytest.mark.parametrize("gain_model", ["per_pixel", "literal"])
def test_the_gain_as_printed_is_the_picture_and_no_noise(gain_model):
    found = evaluated(network(electronics={**ELECTRONICS, "gain_model": gain_model}))
    names = [each.source.name for each in noise_budget(found).shares]
    assert ("gain" in names) is (gain_model == "per_pixel")


def test_single_precision_tells_the_same(whole):
    single = noise_budget(evaluated(network(), "single"))
    for one, other in zip(single.shares, whole[1].shares, strict=True):
        assert one.sigma == pytest.approx(other.sigma, rel=0.02)


def test_it_is_in_both_reports(imagechain, tmp_path):
    done = imagechain("run", "inframetrics", "--report", "r.json", "--report", "r.html")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads((tmp_path / "r.json").read_text())["budget"]
    sources = [each["name"] or each["node"] for each in found["noise"]["sources"]]
    assert sources[1:] == ["gain", "bias", "detector", "amplifier", "quantization"]
    assert sum(each["share"] for each in found["noise"]["sources"]) == pytest.approx(1)
    for axis in ("x", "y"):
        shares = [each[f"share_{axis}"] for each in found["blur"]["stages"]]
        assert sum(shares) == pytest.approx(1)
    # One detector reads every line: its error of bias shifts the picture and spreads nothing.
    (bias,) = [each for each in found["noise"]["sources"] if each["name"] == "bias"]
    assert bias["sigma"] == 0.0
    assert bias["mean"] > 0.01
    page = (tmp_path / "r.html").read_text()
    assert 'alt="shares of noise and blur"' in page
    for words in ("What contributes how much", "Quantization", "All together", "Detector MTF"):
        assert words in page


def test_a_phase_does_not_blur(imagechain, tmp_path):
    done = imagechain("run", "spatial_blur", "--report", "r.json")
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads((tmp_path / "r.json").read_text())["budget"]
    assert found["noise"] is None
    assert [each["node"] for each in found["blur"]["stages"]] == ["blur"]


def test_two_bars_of_one_name_tell_their_node():
    row = {"title": "Gaussian MTF", "share_x": 0.5, "share_y": -0.2}
    blur = {"stages": [{**row, "node": "a"}, {**row, "node": "b"}]}
    assert bars_png(None, blur).startswith(b"\x89PNG")
