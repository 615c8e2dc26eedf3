"""Noise Budget on chains whose noise and blur are worked out by hand."""

import math

import numpy as np
import pytest

from core.errors import DataError
from node_bench import NodeBench, square_detectors

ROWS, COLUMNS = 80, 100
FOV_X, FOV_Y = 3.0, 2.0
X, Y = math.radians(FOV_X) * 1000 / COLUMNS, math.radians(FOV_Y) * 1000 / ROWS
SCENE = {
    "kind": "uniform", "width": COLUMNS, "height": ROWS, "fov_x_deg": FOV_X, "fov_y_deg": FOV_Y,
    "cut_on_um": 3.0, "cut_off_um": 5.0, "temperature_K": 300.0,
}  # fmt: skip
INIT = square_detectors(80.0, 200.0, 2.0, range_m=400.0, platform="array")
D_STAR, BANDWIDTH, SNR = 2e11, 3e5, 100.0
NOISE = {
    "region": "MWIR", "d_star": D_STAR, "material": "manual", "bandwidth_Hz": BANDWIDTH,
    "amplifier_snr": SNR,
}  # fmt: skip
BLURS = (
    ("a", "gaussian_mtf", {"sigma_x_mrad": 0.4, "sigma_y_mrad": 0.1}),
    ("b", "gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.3}),
)


def sensor(budget=None, *, noise=None, blurs=BLURS):
    """Blurs, then electronics, and the budget of the picture behind."""
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", INIT),
        **{name: (key, params) for name, key, params in blurs},
        "back": ("back_transform", {}),
        "noise": ("electronics_noise", {**NOISE, **(noise or {})}),
        "budget": ("noise_budget", budget or {}),
    }
    return NodeBench(None, nodes).value


def bars(data):
    """Heights by series and bar."""
    return {
        series.label: dict(zip(data.bars, series.y.tolist(), strict=True)) for series in data.series
    }


def detector_sigma():
    """NER = √(A·Δf)/D*·(4F² + 1)/π/A, from cm⁻² to m⁻²."""
    area_cm2 = (80e-4) ** 2
    throughput = (4 * 2.0**2 + 1) / math.pi
    return math.sqrt(area_cm2 * BANDWIDTH) / D_STAR * throughput / area_cm2 * 1e4


def test_two_white_noises_share_as_their_variances():
    value = sensor()
    level = float(value("scene.image")[0, 0])
    one, two = detector_sigma() ** 2, (level / SNR) ** 2
    assert 0.05 < one / two < 20  # neither hides the other
    # The amplifier's noise is a share of the mean, which the detector's noise moves a little.
    near = {"rel": 1e-3}
    share = bars(value("budget.noise"))["temporal"]
    assert share["Detector"] == pytest.approx(100 * one / (one + two), **near)
    assert share["Amplifier"] == pytest.approx(100 * two / (one + two), **near)
    figures = value("budget.table").as_dict()
    assert figures["noise.detector.temporal_share"] == pytest.approx(share["Detector"], rel=1e-12)
    assert figures["noise.detector.temporal"] == pytest.approx(math.sqrt(one), rel=1e-9)
    assert figures["noise.amplifier.temporal"] == pytest.approx(math.sqrt(two), **near)
    assert figures["sigma"] == pytest.approx(math.sqrt(one + two), **near)
    assert (figures["sigma_fixed"], figures["mean"]) == (0, pytest.approx(level, rel=1e-3))


@pytest.mark.parametrize("kind", ["all", "temporal", "fixed"])
def test_kinds_of_noise(kind):
    value = sensor({"noise": kind}, noise={"gain_percent": 2.0, "bias_percent": 1.0})
    level = float(value("scene.image")[0, 0])
    variances = {
        "temporal": {"Detector": detector_sigma() ** 2, "Amplifier": (level / SNR) ** 2},
        "fixed": {"Gain": (0.02 * level) ** 2, "Bias": (0.01 * level) ** 2},
    }
    counted = variances if kind == "all" else {kind: variances[kind]}
    whole = sum(sum(each.values()) for each in counted.values())
    shares = bars(value("budget.noise"))
    assert set(shares) == set(counted)
    for one, found in shares.items():
        expected = {name: 100 * v / whole for name, v in variances[one].items()}
        assert {name: share for name, share in found.items() if share} == pytest.approx(
            expected, rel=2e-3
        )
    assert sum(sum(found.values()) for found in shares.values()) == pytest.approx(100)
    figures = value("budget.table").as_dict()
    for one, each in variances.items():
        sigma = math.sqrt(sum(each.values()))
        assert figures[f"sigma_{one}"] == pytest.approx(sigma, rel=1e-3)  # whatever is shown
        assert (f"noise.{next(iter(each)).lower()}.{one}" in figures) is (one in counted)


def test_rounding_has_a_temporal_and_a_fixed_part():
    level = float(sensor()("scene.image")[0, 0])
    step = 5.0 * math.hypot(detector_sigma(), level / SNR)
    value = sensor(noise={"bits": 4, "range_low": level - 8 * step, "range_high": level + 7 * step})
    shares = bars(value("budget.noise"))
    both = [shares[kind]["Quantization"] for kind in ("temporal", "fixed")]
    whole = detector_sigma() ** 2 + (level / SNR) ** 2 + step**2 / 12
    assert min(both) > 0.1
    assert sum(both) == pytest.approx(100 * step**2 / 12 / whole, rel=1e-2)
    assert sum(sum(found.values()) for found in shares.values()) == pytest.approx(100)


def test_amounts_are_deviations_and_losses():
    value = sensor({"show": "amount"}, noise={"gain_percent": 2.0})
    level = float(value("scene.image")[0, 0])
    found = bars(value("budget.noise"))
    assert found["fixed"]["Gain"] == pytest.approx(0.02 * level, rel=1e-3)
    assert found["temporal"]["All together"] == pytest.approx(
        math.hypot(detector_sigma(), level / SNR), rel=1e-3
    )
    losses = bars(value("budget.blur"))
    f = 0.5 * 0.5 / X
    assert losses["horizontal"] == pytest.approx(
        {
            "Gaussian MTF (a)": 2 * (math.pi * 0.4 * f) ** 2,
            "Gaussian MTF (b)": 2 * (math.pi * 0.2 * f) ** 2,
            "All together": 2 * math.pi**2 * (0.4**2 + 0.2**2) * f**2,
        },
        rel=1e-9,
    )


def test_what_amplifies_makes_up_for_blur():
    """A boost 1 + (g − 1)·(1 − cos πu)/2, u = f·v/corner, after a Gaussian blur."""
    boost = {"scan_mirror_rate_Hz": 1.0, "post_filter": "boost", "post_gain": 3.0,
             "post_corner_Hz": 5000.0, "use_mtf": False}  # fmt: skip
    value = sensor(noise=boost, blurs=BLURS[:1])
    f = 0.5 * 0.5 / X
    u = f * 2 * math.pi * 1000 * 1.0 / 5000.0
    gain = 1 + 2 * (1 - math.cos(math.pi * u)) / 2
    assert u < 1
    figures = value("budget.table").as_dict()
    assert figures["noise.mtf_x"] == pytest.approx(gain, rel=1e-9)
    lost = 2 * (math.pi * 0.4 * f) ** 2
    assert bars(value("budget.blur"))["horizontal"] == pytest.approx(
        {"Gaussian MTF": 100.0, "Electronics": -100 * math.log(gain) / lost}, rel=1e-9
    )


def test_nothing_to_share_out_is_said():
    nodes = {"scene": ("test_scene", SCENE), "budget": ("noise_budget", {})}
    value = NodeBench(None, nodes).value
    for port in ("noise", "blur"):
        data = value(f"budget.{port}")
        assert (data.series, data.bars) == ((), ())
        assert "none" in data.title
    figures = value("budget.table").as_dict()
    assert (figures["noise"], figures["blur"], figures["sigma"]) == ("none", "none", 0)
    assert (figures["mtf_x"], figures["mtf_y"]) == (1, 1)


def test_temporal_noise_may_be_all_there_is():
    value = sensor({"noise": "fixed"})
    assert value("budget.noise").title == "Fixed noise: none in this picture"
    assert value("budget.table").as_dict()["noise"] == "none"


def test_a_picture_without_sampling_interval_is_refused(tmp_path):
    np.save(tmp_path / "bare.npy", np.ones((8, 8)))
    nodes = {
        "read": ("read_image", {"path": str(tmp_path / "bare.npy")}),
        "budget": ("noise_budget", {}),
    }
    (error,) = NodeBench(None, nodes).plan.errors()
    assert error.node == "budget"
    assert "the image has no sampling interval: set fov_x_deg and fov_y_deg" in str(error)


def crossed():
    """Magnitude of a noisy picture and phase of another, blurred further on."""
    nodes = {
        "one": ("test_scene", SCENE),
        "photons": ("poisson_noise", {"percent": 5.0}),
        "other": ("test_scene", {**SCENE, "kind": "sine"}),
        "init_one": ("init_trans", INIT),
        "init_other": ("init_trans", INIT),
        "crossed": ("back_transform", {}),
        "init": ("init_trans", INIT),
        "blur": ("gaussian_mtf", BLURS[0][2]),
        "back": ("back_transform", {}),
        "budget": ("noise_budget", {}),
    }
    links = [
        ("one.image", "photons.image"),
        ("photons.image", "init_one.image"),
        ("other.image", "init_other.image"),
        ("init_one.magnitude", "crossed.magnitude"),
        ("init_other.phase", "crossed.phase"),
        ("crossed.image", "init.image"),
        ("init.context", "blur.context"),
        ("init.magnitude", "blur.magnitude"),
        ("blur.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"),
        ("back.image", "budget.image"),
    ]
    return NodeBench(None, nodes, links).value


def test_noise_through_what_is_not_known_is_refused():
    with pytest.raises(DataError, match="the noise after crossed cannot be computed"):
        crossed()("budget.noise")


def test_blur_before_what_is_not_known_does_not_count():
    data = crossed()("budget.blur")
    assert data.title == "Blur after crossed"
    assert bars(data)["horizontal"] == {"Gaussian MTF": 100.0}
