"""MTF at the Nyquist frequency of the computed samples, and at that of the pixels."""

import math

import pytest

from app.run.transfer_chain import find_chain
from app.tradeoff.tradeoff_results import computed, default_figures, figures_of
from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
PITCH_X, PITCH_Y = 0.15, 0.3  # mrad: 15 and 30 µm at 100 mm
SIGMA = 0.04
SCENE = {  # samples of 0.05 mrad: 3 and 6 to a pixel
    "kind": "point", "width": 60, "height": 60,
    "fov_x_deg": math.degrees(0.003), "fov_y_deg": math.degrees(0.003),
}  # fmt: skip


def network(*, pixels="sample_pixels", detector_x_um=15, detector_y_um=30, **blur):
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {"detector_x_um": detector_x_um, "detector_y_um": detector_y_um,
                                "focal_length_mm": 100}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": SIGMA, "sigma_y_mrad": SIGMA, **blur}),
        "aperture": ("detector_mtf", {}),
        "slices": ("mtf_slices", {"direction": "both"}),
        "back": ("back_transform", {}),
    }  # fmt: skip
    if pixels:
        nodes["pixels"] = (pixels, {})
    return linked_network(nodes)


def planned(**how):
    engine = Engine(LIBRARY)
    plan = engine.plan(network(**how))
    return engine, plan, engine.work(Policy("double"))


def gaussian(frequency):
    return math.exp(-2 * (math.pi * SIGMA * frequency) ** 2)


def test_a_pixel_passes_two_over_pi_at_its_own_nyquist_frequency():
    engine, plan, work = planned()
    found = engine.readouts(plan, "aperture", work)
    assert found["mtf_at_pixel_nyquist_x"] == pytest.approx(2 / math.pi, rel=1e-12)
    assert found["mtf_at_pixel_nyquist_y"] == pytest.approx(2 / math.pi, rel=1e-12)
    # Of the samples, 3 and 6 to a pixel: sin(3π/2)/(3π/2) and sin(3π)/(3π).
    assert found["mtf_at_nyquist_x"] == pytest.approx(-2 / (3 * math.pi), rel=1e-9)
    assert found["mtf_at_nyquist_y"] == pytest.approx(0.0, abs=1e-12)


def test_without_a_pitch_there_is_the_nyquist_of_the_samples_alone():
    engine, plan, work = planned(pixels="", detector_x_um=None, detector_y_um=None)
    blur = engine.readouts(plan, "blur", work)
    assert blur["mtf_at_pixel_nyquist_x"] is None
    assert blur["mtf_at_nyquist_x"] == pytest.approx(gaussian(10.0), rel=1e-12)
    assert default_figures(plan.network, LIBRARY)[0].text == "total.mtf_nyquist_x"
    assert "total.mtf_pixel_nyquist_x" not in figures_of(plan.network, LIBRARY)


@pytest.mark.parametrize(
    ("pixels", "pixel_x", "pixel_y"),
    [("sample_pixels", PITCH_X, PITCH_Y), ("combine_pixels", 0.05 * 2, 0.05 * 2)],
)
def test_the_chain_at_the_nyquist_frequency_of_its_pixels(pixels, pixel_x, pixel_y):
    """Where samples are combined the picture's pixels are these, whatever the pitch."""
    engine, plan, work = planned(pixels=pixels)
    if pixels == "combine_pixels":
        changed = plan.network
        for axis in "xy":
            changed = changed.with_parameter("pixels", f"factor_{axis}", 2)
        plan = engine.plan(changed)
    assert find_chain(plan).pixel_nyquist == pytest.approx((0.5 / pixel_x, 0.5 / pixel_y))
    figures = [f for f in default_figures(plan.network, LIBRARY) if f.node == "total"]
    names = {"mtf_pixel_nyquist_x", "mtf_pixel_nyquist_y", "mtf_half_pixel_nyquist_x",
             "mtf_half_pixel_nyquist_y"}  # fmt: skip
    assert {figure.name for figure in figures} == names
    found = computed(figures, engine, plan, work, {"blur"}).figures

    def chain(frequency, pitch):
        angle = math.pi * pitch * frequency
        return gaussian(frequency) * math.sin(angle) / angle

    for axis, pixel, pitch in (("x", pixel_x, PITCH_X), ("y", pixel_y, PITCH_Y)):
        whole, half = chain(0.5 / pixel, pitch), chain(0.25 / pixel, pitch)
        # Behind the transform, what pixels are combined by is no part of the total.
        assert found[f"total.mtf_pixel_nyquist_{axis}"] == pytest.approx(whole, rel=1e-9)
        assert found[f"total.mtf_half_pixel_nyquist_{axis}"] == pytest.approx(half, rel=1e-9)
