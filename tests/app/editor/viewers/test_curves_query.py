"""Transfer functions as the plot viewer gets them, against the laws themselves."""

import math

import numpy as np
import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.plot.plotted_lines import CurvesQuery

NETWORK = "inframetrics"

SIGMA = 0.02  # jitter of the Inframetrics network, mrad


def curves(bench, angle=0.0, plan=None):
    engine, whole, work = bench.truth()
    return CurvesQuery(angle).answer(Passing(engine, plan or whole, work))


def named(found):
    return {curve.name: curve for curve in found.curves}


@pytest.mark.parametrize("angle", [0.0, 37.0])
def test_curves_are_those_of_the_laws(bench, angle):
    found = curves(bench, angle)
    f = found.frequency
    cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    by_name = named(found)
    # Gaussian of the same width in all directions; sinc·sinc of a square detector.
    jitter = np.exp(-2 * math.pi**2 * SIGMA**2 * f**2)
    assert by_name["jitter"].mtf == pytest.approx(jitter, abs=1e-12)
    ifov = 600.0 / 130.0 * 0.95
    detector = np.sinc(ifov * f * cos) * np.sinc(ifov * f * sin)
    assert by_name["detector"].mtf == pytest.approx(detector, abs=1e-9)
    # One pole of the amplifier along the scan: its corner is at 1/(2πτv).
    tau_v = 30.0 * math.pi / 180 * 1000 / 512  # the dwell time is one sample of the scan
    pole = 1 / (1 + 2j * math.pi * tau_v * f * cos)
    assert by_name["electronics"].mtf == pytest.approx(np.abs(pole), rel=1e-9)
    assert np.abs(by_name["electronics"].ptf) == pytest.approx(np.abs(np.angle(pole)), abs=1e-9)
    product = np.prod([c.mtf for c in found.curves if c.name in bench_stages(found)], axis=0)
    assert by_name["total"].mtf * by_name["electronics"].mtf == pytest.approx(product, abs=1e-12)
    assert by_name["total_with_electronics"].mtf == pytest.approx(product, abs=1e-12)


def bench_stages(found):
    return [curve.name for curve in found.curves if curve.kind == "stage"]


def test_marks(bench):
    marks = {mark.text: mark.x for mark in curves(bench).marks}
    interval = 30.0 * math.pi / 180 * 1000 / 512
    assert marks["samples' Nyquist"] == pytest.approx(1 / (2 * interval), rel=1e-9)
    assert marks["pixels' Nyquist"] == pytest.approx(1 / (6 * interval), rel=1e-9)
    # Aperture over the shortest wavelength: 26.4 mm and 10 µm.
    cutoff = 4.5056e1 * 300 / 512 / 10.0
    assert marks["optics cutoff"] == pytest.approx(cutoff, rel=1e-6)
    slanted = {mark.text: mark.x for mark in curves(bench, 30.0).marks}
    assert slanted["samples' Nyquist"] == pytest.approx(
        marks["samples' Nyquist"] / math.cos(math.pi / 6)
    )
    assert slanted["optics cutoff"] == pytest.approx(cutoff, rel=1e-6)


def test_the_key_tells_whether_curves_would_change(bench):
    engine, plan, _ = bench.truth()
    key = CurvesQuery().key(plan)
    network = bench.session.network

    def changed(node, name, value):
        return CurvesQuery().key(engine.plan(network.with_parameter(node, name, value)))

    assert changed("electronics", "amplifier_snr", 8.0) == key
    assert changed("scene", "temperature_K", 250.0) == key
    assert changed("jitter", "sigma_mrad", 0.5) != key
    assert changed("pixels", "factor_x", 2) != key
    assert CurvesQuery(45.0).key(plan) != key
