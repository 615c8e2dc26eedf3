"""Figures of Merit of staring, parallel and serial scans, and of noise that is not white."""

import math

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import DataError
from core.evaluation.work import Policy
from linked_network import in_order, linked_network
from nodes.library import standard_library
from planck_truth import band_radiance

LIBRARY = standard_library()
SIDE = 96
INTERVAL = 0.5  # mrad
NYQUIST = 1.0
SCENE = {
    "kind": "uniform", "width": SIDE, "height": SIDE, "cut_on_um": 8.0, "cut_off_um": 12.0,
    "fov_x_deg": math.degrees(SIDE * INTERVAL / 1000), "temperature_K": 300.0,
    "fov_y_deg": math.degrees(SIDE * INTERVAL / 1000),
}  # fmt: skip
INIT = {
    "detector_x_um": 50.0, "detector_y_um": 50.0, "focal_length_mm": 100.0, "f_number": 2.0,
    "scan_velocity_mrad_per_s": 1000.0,
}  # fmt: skip
NOISE = {"region": "LWIR", "d_star": 1e10, "material": "manual"}  # bandwidth 1/(2·0.5 ms)


def sensor(platform="line", merit=None, *, noise=None, seed=1, **scene):
    """Scene, aperture, electronics, the figures."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **scene}),
        "init": ("init_trans", {**INIT, "platform": platform}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "noise": ("electronics_noise", {**NOISE, **(noise or {})}),
        "merit": ("figures_of_merit", merit or {}),
    }
    engine = Engine(LIBRARY)
    plan = engine.plan(linked_network(nodes, in_order(nodes, LIBRARY), seed=seed))
    assert not plan.errors(), plan.errors()
    return engine, plan, engine.work(Policy(precision="double"))


def table_of(*args, **kwargs):
    engine, plan, work = sensor(*args, **kwargs)
    return engine.value(plan, "merit.table", work).as_dict()


def curves_of(port, *args, **kwargs):
    engine, plan, work = sensor(*args, **kwargs)
    return {s.label: s for s in engine.value(plan, f"merit.{port}", work).series}


class TestPatternOfDetectors:
    """A spread of gain of 2 %: on a uniform field 2 % of its radiance, over dL/dT."""

    @pytest.mark.parametrize("kind", ["uniform", "two_panel"])
    @pytest.mark.parametrize(
        ("platform", "component"), [("array", "vh"), ("push", "h"), ("line", "")]
    )
    def test_is_of_samples_columns_or_nothing(self, platform, component, kind):
        """Whatever the scene shows, one detector has no pattern, and those of a push columns."""
        found = table_of(platform, noise={"gain_percent": 2.0}, kind=kind, delta_K=20.0)
        background = found["background_K"]
        level, warmer, colder = (
            float(band_radiance(8.0, 12.0, background + d)) for d in (0.0, 0.01, -0.01)
        )
        for name in ("vh", "v", "h"):
            expected = 0.02 * level / ((warmer - colder) / 0.02) if name == component else 0.0
            # What the seed does to the mean itself is a hundredth of the pattern and less.
            assert found[f"sigma_{name}_K"] == pytest.approx(expected, rel=0.03, abs=1e-9), name

    def test_columns_hide_upright_bars_and_leave_lying_ones(self):
        clean, spoilt = (
            table_of("push", noise={"gain_percent": percent}) for percent in (0.0, 2.0)
        )
        name = "mrtd_{}_50_percent_nyquist"
        assert spoilt[name.format("x")] > 5 * clean[name.format("x")]
        assert spoilt[name.format("y")] == pytest.approx(clean[name.format("y")], rel=0.05)


class TestNoiseBehindAFilter:
    """A pre-amplifier of the dwell time leaves 40 % of the variance, at low frequencies mostly."""

    FILTERED = {"use_mtf": True}  # noqa: RUF012

    def test_threshold_is_that_of_bars_cut_out_of_frames(self):
        """Bars of 8 × 56 samples (7:1), averaged in 60 frames of noise; (π²/8)·2.5·σ/H."""
        means = []
        for seed in range(60):
            engine, plan, work = sensor("line", noise=self.FILTERED, seed=seed)
            drawn = engine.value(plan, "noise.noise", work)[:56, :]
            means.append(drawn.mean(axis=0).reshape(12, 8).mean(axis=1))
        up, down = (float(band_radiance(8.0, 12.0, 300.0 + d)) for d in (0.01, -0.01))
        sigma_K = np.std(means) / ((up - down) / 0.02)
        # Bars of 4 mrad: 0.125 cycles/mrad. Detector of 0.5 mrad, pole 1/√(1 + (2π·0.5·0.125)²).
        transfer = np.sinc(0.5 * 0.125) / math.sqrt(1 + (math.pi * 0.125) ** 2)
        truth = math.pi**2 / 8 * 2.5 * sigma_K / transfer
        curve = curves_of("mrtd", "line", {"frame_rate_Hz": None}, noise=self.FILTERED)
        found = np.interp(0.125, curve["horizontal"].x, curve["horizontal"].y)
        assert found == pytest.approx(truth, rel=0.08)  # 720 bars: σ to 2.6 %


def test_gain_error_as_printed_is_refused():
    engine, plan, work = sensor(noise={"gain_model": "literal", "gain_percent": 1.0})
    with pytest.raises(DataError, match="gain_model = literal"):
        engine.value(plan, "merit.table", work)
