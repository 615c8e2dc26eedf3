"""The MTF measured in the final picture against closed forms written out here."""

import math
from pathlib import Path

import numpy as np
import pytest

from app.report.edge_measurement import judged_facts
from app.run.evaluation import TimedWork, evaluate, planned
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import load_network
from linked_network import linked_network
from nodes.library import standard_library

NETWORKS = Path(__file__).parents[3] / "networks"


def evaluated(network, folder=NETWORKS, precision="double"):
    engine = Engine(standard_library())
    plan = planned(engine, network, folder)
    return evaluate(engine, plan, TimedWork(Policy(precision), engine.store))


def attempts(found):
    told = judged_facts(found)
    assert told["reason"] is None
    return {(each["direction"], each["method"]): each for each in told["measurements"]}


def cyc_per_mrad(measured):
    return measured["frequency_cyc_per_sample"] * 2 * measured["nyquist_cyc_per_mrad"]


def disc_mtf(share):
    """Diffraction by a round aperture, at shares of its cutoff."""
    share = np.minimum(np.abs(share), 1.0)
    return 2 / np.pi * (np.arccos(share) - share * np.sqrt(1 - share**2))


def linear_where_it_runs(f, old, new, crossed):
    """|Mean response| of linear interpolation at the middle `crossed` new samples."""
    place = (np.arange(new // 2 - crossed // 2, new // 2 + crossed // 2) + 0.5) * old / new - 0.5
    t = place % 1.0
    f = np.asarray(f)[:, None]
    mean = (1 - t) * np.exp(-2j * np.pi * f * t) + t * np.exp(2j * np.pi * f * (1 - t))
    return np.abs(mean.mean(axis=1))


@pytest.fixture(scope="module")
def kodak():
    network = load_network(NETWORKS / "kodak_kir310.json", library=standard_library())
    return attempts(evaluated(network))


def kodak_stages(f, *, charge):
    """Tantalo 1996, table 5.3: 90 mm at 4 µm, 0.1 mrad, 25 µm/200 mm·0.95, 640 transfers."""
    mtf = disc_mtf(f * 4e-3 / 90 * 1e3) * np.exp(-2 * (np.pi * 0.1 * f) ** 2)
    mtf = mtf * np.sinc(25 / 200 * 0.95 * f)
    if charge:
        turn = np.exp(-2j * np.pi * f * math.radians(25) * 1e3 / 1024)
        mtf = mtf * np.abs(0.99999 / (1 - 1e-5 * turn)) ** 640
    return mtf


def test_kodak_across(kodak):
    """Two samples of 0.426 mrad a pixel, whose number across the frame grabber leaves alone."""
    measured = kodak["horizontal", "slanted_edge"]
    f = cyc_per_mrad(measured)
    pixel = 2 * math.radians(25) * 1e3 / 1024
    true = kodak_stages(f, charge=True) * np.sinc(pixel * f)
    np.testing.assert_allclose(measured["mtf"], true, atol=0.005)
    np.testing.assert_allclose(measured["expected"], true, atol=0.005)
    assert np.max(np.abs(measured["mtf"] - measured["expected"])) < 1e-3
    assert measured["at_nyquist"] == pytest.approx(0.564, abs=0.005)


def test_kodak_along(kodak):
    """512 rows become 486: the edge runs through 32 of them, some between two rows."""
    measured = kodak["vertical", "slanted_edge"]
    f = cyc_per_mrad(measured)
    pixel = 2 * math.radians(25) * 1e3 / 1024
    grabbed = linear_where_it_runs(pixel * f, 512, 486, 32)
    true = kodak_stages(f, charge=False) * np.sinc(pixel * f) * grabbed
    np.testing.assert_allclose(measured["mtf"], true, atol=0.01)
    assert np.max(np.abs(measured["mtf"] - measured["expected"])) < 0.01


@pytest.mark.parametrize("direction", ["horizontal", "vertical"])
def test_inframetrics(direction):
    """Three samples a pixel and a frame grabber of three samples a pixel; table 5.1.

    Pixels of 3.07 mrad alias what passes beyond their Nyquist frequency, 0.163 cycles/mrad. An edge
    meets them in eleven places only, which leaves some thousandths. The pre-amplifier filters
    pixels: its phase jumps there, over which the measurement's window smooths.
    """
    network = load_network(NETWORKS / "inframetrics.json", library=standard_library())
    both = attempts(evaluated(network))
    assert abs(both[direction, "row_average"]["largest_difference"]) < 1e-9  # its phase counts too
    measured = both[direction, "slanted_edge"]
    f = cyc_per_mrad(measured)
    sample = math.radians(30) * 1e3 / 512
    true = disc_mtf(f * 10e-3 / 26.4 * 1e3) * np.exp(-2 * (np.pi * 0.5 * f) ** 2)
    true = true * np.exp(-2 * (np.pi * 0.02 * f) ** 2) * np.sinc(600 / 130 * 0.95 * f)
    new, crossed = (512, 34) if direction == "horizontal" else (480, 32)
    grabbed = linear_where_it_runs(3 * sample * f, 170, new, crossed)
    true = true * np.sinc(3 * sample * f) * grabbed
    if direction == "horizontal":  # the pre-amplifier: τ·v is one sample of the scene
        alias = f - np.rint(f * 3 * sample) / (3 * sample)
        true = true / np.hypot(1, 2 * np.pi * sample * alias)
    jump = np.abs(f - 0.5 / (3 * sample)) < 0.01
    np.testing.assert_allclose(measured["mtf"][~jump], np.abs(true)[~jump], atol=0.01)
    np.testing.assert_allclose(measured["mtf"][jump], np.abs(true)[jump], atol=0.02)
    # The horizontal MTF falls earlier, as the thesis says of fig. 5.27.
    assert measured["mtf50_cyc_per_mrad"] == pytest.approx(
        {"horizontal": 0.0803, "vertical": 0.0869}[direction], abs=0.001
    )


INTERVAL = math.radians(10) * 1e3 / 256
SCENE = {"kind": "dormitory", "width": 256, "height": 192, "fov_x_deg": 10, "fov_y_deg": 7.5}


def blurred(sigma_px=1.2, scene=SCENE, edges="reflect", **more):
    """A Gaussian blur, pixels combined two by two, and 128 columns resampled to 150."""
    sigma = sigma_px * INTERVAL
    nodes = {
        "scene": ("test_scene", scene),
        "init": ("init_trans", {"edges": edges}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": 0.75 * sigma}),
        "back": ("back_transform", {}),
        "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
        "grabber": ("interpolate", {"width": 150}),
        **more,
    }
    return linked_network(nodes)


@pytest.mark.parametrize(
    ("across", "sigma_px", "edges"), [(True, 1.2, "reflect"), (False, 0.9, "periodic")]
)
def test_row_average(across, sigma_px, edges):
    """One row in space: the step summed with Gaussian weights, averaged by two, interpolated."""
    size = 256 if across else 192
    step = (np.arange(size) >= size / 2).astype(float)
    lags = np.arange(-20, 21)
    # The chain's own Gaussian is cut off at the samples' Nyquist frequency.
    f = (np.arange(4096) + 0.5) / 8192
    passed = np.exp(-2 * (np.pi * sigma_px * f) ** 2)
    weights = np.array([np.mean(np.cos(2 * np.pi * f * lag) * passed) for lag in lags])
    row = np.convolve(np.pad(step, 20, mode="edge"), weights, "valid").reshape(-1, 2).mean(axis=1)
    if across:
        places = np.clip((np.arange(150) + 0.5) * 128 / 150 - 0.5, 0, 127)
        row = np.interp(places, np.arange(128), row)
    measured = attempts(evaluated(blurred(edges=edges)))[
        "horizontal" if across else "vertical", "row_average"
    ]
    half = max(len(row) // 2, 64)
    first = (len(row) - half) // 2
    spread = np.diff(row[first : first + half])
    n = np.arange(len(spread))
    true = np.array(
        [
            abs(np.sum(spread * np.exp(-2j * np.pi * f * n)))
            for f in measured["frequency_cyc_per_sample"]
        ]
    )
    # The ends that are cut off hold little of the blur.
    np.testing.assert_allclose(measured["mtf"], true / true[0], atol=2e-4)
    np.testing.assert_allclose(measured["expected"], measured["mtf"], atol=1e-9)
