"""The budget of noise and blur in reports, and what they say where it cannot be told."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.report.budget import budget_facts
from app.run.evaluation import TimedWork, evaluate, planned
from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import document_of, linked_network
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
    return linked_network(nodes, seed=7)


def evaluated(document, precision="double"):
    engine = Engine(standard_library())
    plan = planned(engine, document, Path())
    return evaluate(engine, plan, TimedWork(Policy(precision), engine.store))


def radiance(found):
    return float(found.engine.value(found.plan, "scene.image", found.work)[0, 0])


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
    electronics = {**ELECTRONICS, "amplifier_snr": 30.0, "cut_on_um": 8.0, "cut_off_um": 12.0}
    nodes = {
        "scene": ("read_image", {"path": "dark.npy", "fov_x_deg": 3.0, "fov_y_deg": 3.0}),
        "glow": ("noise_file", {"path": "glow.npy"}),
        "init": ("init_trans", SENSOR),
        "back": ("back_transform", {}),
        "electronics": ("electronics_noise", electronics),
    }
    works("run", write(document_of(nodes)), "--report", "r.json", "--report", "r.html")
    found = json.loads((tmp_path / "r.json").read_text())["budget"]
    by_name = {each["name"]: each for each in found["noise"]["sources"]}
    # ±1 about 30, as the estimate of 32 columns about their mean that is right on average.
    assert by_name["file"]["fixed"] == pytest.approx(math.sqrt(32 / 31), rel=1e-6)
    assert by_name["amplifier"]["temporal"] == pytest.approx(1.0, rel=0.01)  # 30 over 30
    assert "Noise file" in (tmp_path / "r.html").read_text()


# --- laws ---


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
        "photons": photons,
        "gain": 0.01 * level / 2,
        "bias": 0.005 * level / 2,
        "detector": ner / 2,
        "amplifier": level / 80 / 2,
    }


def told(evaluation, what):
    """The noise, or the blur; or why there is none."""
    facts = budget_facts(evaluation)
    return facts[what] or facts[f"{what}_reason"]


@pytest.fixture(scope="module")
def whole():
    found = evaluated(network())
    return found, told(found, "noise")


def sigmas(noise):
    return {each["name"]: each["sigma"] for each in noise["sources"]}


# Parameters of the electronics without which a source makes no noise.
SILENT = {
    "gain": {"gain_percent": 0.0},
    "bias": {"bias_percent": 0.0},
    "detector": {"d_star": 1e25},  # noise far below the rounding of any radiance
    "amplifier": {"amplifier_snr": None},
    "quantization": {"bits": 0},
}


def silenced(document, source):
    if source == "photons":
        return document.with_node(replace(document.node("photons"), disabled=True))
    for name, value in SILENT[source].items():
        document = document.with_parameter("electronics", name, value)
    return document


def silenced_sigmas(found, sources):
    """Rms of what the picture loses when a source alone is silenced, the others as before.

    All but quantization are compared without it, since it rounds them away or up together.
    """

    def picture(document):
        plan = found.engine.plan(document, folder=found.plan.folder)
        return found.engine.value(plan, found.chain.final, found.work).astype(float)

    smooth = silenced(found.network, "quantization")
    spreads = {}
    for source in sources:
        base = found.network if source == "quantization" else smooth
        spreads[source] = np.std(picture(base) - picture(silenced(base, source)))
    return spreads


def test_noise_of_each_source_is_that_of_its_law(whole):
    found, budget_ = whole
    assert sigmas(budget_) == pytest.approx(
        expected_sigmas(radiance(found)),
        rel=1e-3,  # means that have noise themselves
    )
    assert budget_["port"] == "pixels.image"
    fixed = {each["name"] for each in budget_["sources"] if each["temporal"] is None}
    assert fixed == {"gain", "bias"}
    assert all((each["fixed"] is None) != (each["name"] in fixed) for each in budget_["sources"])


COARSE = {**ELECTRONICS, "bits": 6}


@pytest.mark.parametrize("case", ["as it is", "quantized", "literal"])
def test_noise_of_each_source_is_what_its_silence_takes_away(case, whole):
    level = radiance(whole[0])
    electronics = {
        "as it is": ELECTRONICS,
        "quantized": {**COARSE, "range_low": 0.8 * level, "range_high": 1.2 * level},
        "literal": {**ELECTRONICS, "gain_model": "literal"},
    }[case]
    found = evaluated(network(electronics=electronics))
    # As eq. 4.59 is printed the gain error is the picture: without it nothing would be left.
    other = {"as it is": ["gain"], "quantized": ["gain", "quantization"], "literal": []}[case]
    simulated = silenced_sigmas(found, ["photons", "bias", "detector", "amplifier", *other])
    noise = told(found, "noise")
    predicted = sigmas(noise)
    if case == "literal":  # a bias that is the same for all samples
        assert simulated.pop("bias") == pytest.approx(0, abs=1e-9 * level)
    # 65536 samples tell a deviation to 0.3 %, a blurred one to 0.7 %.
    assert predicted == pytest.approx(simulated, rel=0.02)
    variances = {name: sigma**2 for name, sigma in simulated.items()}
    for each in noise["sources"]:
        share = variances[each["name"]] / sum(variances.values())
        assert each["share"] == pytest.approx(share, rel=0.05)


def test_what_is_switched_off_or_elsewhere_is_no_source():
    document = network()
    off = document.with_node(
        type(document.node("photons"))("photons", "poisson_noise", PHOTONS, disabled=True)
    )
    assert list(sigmas(told(evaluated(off), "noise"))) == ["gain", "bias", "detector", "amplifier"]
    reason = told(evaluated(without_electronics()), "noise")
    assert reason == "no noise is added on the way to pixels.image"


def without_electronics(**stages):
    nodes = {
        "scene": ("test_scene", {**SCENE, "width": 64, "height": 64}),
        "init": ("init_trans", SENSOR),
        **stages,
        "back": ("back_transform", {}),
        "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
    }
    return linked_network(nodes)


PAIRS = -math.log(math.cos(math.pi / 8))  # mean of two samples, at half the pixels' Nyquist


def shares_of(found):
    return {each["title"]: (each["share_x"], each["share_y"]) for each in found["stages"]}


def test_gaussian_blurs_share_as_their_variances():
    document = without_electronics(
        a=("gaussian_mtf", {"sigma_x_mrad": 3.0, "sigma_y_mrad": 1.0}),
        b=("jitter_mtf", {"sigma_mrad": 1.0}),
        idle=("gaussian_mtf", {}),
    )
    found = told(evaluated(document), "blur")
    interval = math.radians(FOV_DEG) * 1000 / 64
    # Half of 1/(2·interval), where the interval is that of the combined pixels.
    for name in ("xi_cyc_per_mrad", "eta_cyc_per_mrad"):
        assert found[name] == pytest.approx(1 / (8 * interval), rel=1e-9)
    one = 2 * (math.pi / (8 * interval)) ** 2  # −ln of exp(−2π²σ²f²) where σ is 1 mrad
    assert shares_of(found) == {
        "Gaussian MTF": pytest.approx((9 * one / (10 * one + PAIRS), one / (2 * one + PAIRS))),
        "Jitter MTF": pytest.approx((one / (10 * one + PAIRS), one / (2 * one + PAIRS))),
        "Combined pixels": pytest.approx((PAIRS / (10 * one + PAIRS), PAIRS / (2 * one + PAIRS))),
    }
    x, y = (math.exp(-n * one) * math.cos(math.pi / 8) for n in (10, 2))
    assert (found["mtf_x"], found["mtf_y"]) == pytest.approx((x, y), rel=1e-9)
