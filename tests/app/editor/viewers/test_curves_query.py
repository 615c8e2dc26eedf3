"""Transfer functions as the plot viewer gets them, against the laws themselves."""

import csv
import math

import numpy as np
import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.plot.plot_export import csv_text
from app.editor.viewers.plot.plotted_lines import (
    CurvesQuery,
    PortDataQuery,
    TransferCurve,
    TransferCurves,
    transfer_drawing,
)
from app.run.output import sound_part
from app.run.responses import responses, responses_along
from app.run.transfer_chain import find_chain
from core.chain.results import CurveData, Series
from core.errors import ImagechainError

NETWORK = "inframetrics"
SIGMA = 0.02  # jitter of the Inframetrics network, mrad


def curves(bench, angle=0.0, plan=None):
    engine, whole, work = bench.truth()
    return CurvesQuery(angle).answer(Passing(engine, plan or whole, work))


def named(found):
    return {curve.name: curve for curve in found.curves}


@pytest.mark.parametrize("angle", [0.0, 90.0, 37.0, -120.0, 180.0])
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


@pytest.mark.parametrize(("angle", "axis"), [(0.0, "x"), (90.0, "y")])
def test_along_the_axes_they_are_those_of_the_reports(bench, angle, axis):
    _, plan, work = bench.truth()
    chain = find_chain(plan)
    reported, found = responses(chain, work), responses_along(chain, work, angle)
    frequency = reported.xi if axis == "x" else reported.eta
    assert found.frequency == pytest.approx(frequency, abs=1e-12)
    both = (*reported.stages, *reported.products), (*found.stages, *found.products)
    for old, new in zip(*both, strict=True):
        assert (new.name, new.title) == (old.name, old.title)
        assert new.response.mtf == pytest.approx(getattr(old, axis).mtf, abs=1e-9)
        assert new.response.ptf == pytest.approx(getattr(old, axis).ptf, abs=1e-9)


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


def test_of_a_broken_chain_what_can_be_planned_is_plotted(bench):
    engine, _, work = bench.truth()
    network = bench.session.network.with_parameter("detector", "nonsense", 1)
    plan = engine.plan(network)
    CurvesQuery().key(plan)
    found = CurvesQuery().answer(Passing(engine, plan, work))
    names = {curve.name for curve in found.curves}
    assert {"jitter", "optics", "aberration"} <= names
    assert not names & {"detector", "total"}
    assert "detector" in found.trouble
    assert "\n" not in found.trouble


def test_a_final_picture_that_failed_is_put_up_with(bench):
    engine, _, work = bench.truth()
    plan = engine.plan(bench.session.network.with_parameter("frame_grabber", "width", -3))
    assert sound_part(plan) is not plan
    found = CurvesQuery().answer(Passing(engine, plan, work))
    assert "total" in named(found)
    assert "frame_grabber" in found.trouble


@pytest.mark.parametrize("port", ["scene.image", "nothing.curve", "scene.curve"])
def test_what_is_no_curve_is_told(bench, port):
    _, plan, _ = bench.truth()
    with pytest.raises(ImagechainError, match=port.partition(".")[0]):
        PortDataQuery(port).key(plan)


def test_a_drawing_of_phases_alone_leaves_out_those_that_are_zero(bench):
    drawing = transfer_drawing(curves(bench), "ptf")
    (panel,) = drawing.panels
    assert panel.y_label == "PTF (rad)"
    assert {line.name for line in panel.lines} == {"electronics", "total_with_electronics"}


def test_curves_of_different_lengths_leave_cells_empty():
    short, long = np.array([1.0]), np.array([0.1, 0.2])
    data = CurveData("T", "x", "y", (Series("a", short, short), Series('b, "c"', long, long)))
    heads, first, second = csv.reader(csv_text(data).splitlines())
    assert heads == ["a: x", "a: y", 'b, "c": x', 'b, "c": y']
    assert first == ["1.0", "1.0", "0.1", "0.1"]
    assert second == ["", "", "0.2", "0.2"]


def many_stages(count):
    """Stages that lower the MTF the more, the later they come, and their product."""
    mtf = [np.array([1.0, 1.0 - 0.5 * n / count]) for n in range(count)]
    stages = [TransferCurve(f"n{n}", f"n{n}", "stage", y, np.zeros(2)) for n, y in enumerate(mtf)]
    total = TransferCurve("total", "Total", "total", np.array([1.0, 0.0]), np.zeros(2))
    return TransferCurves(0.0, np.array([0.0, 5.0]), (*stages, total), ())


def test_of_very_many_stages_the_strongest_are_drawn():
    all_of_them = transfer_drawing(many_stages(200), "mtf")
    assert len(all_of_them.entries) == len(all_of_them.panels[0].lines) == 201
    assert not all_of_them.note
    few = transfer_drawing(many_stages(5000), "both")
    names = [f"n{n}" for n in range(4976, 5000)] + ["total"]
    assert [entry.name for entry in few.entries] == names
    assert [line.name for line in few.panels[0].lines] == names
    assert few.note.splitlines() == [
        "Strongest 24 of 5,000 stages",
        "Save the plot as CSV to get them all",
    ]
    assert csv_text(many_stages(5000)).partition("\n")[0].count(".mtf") == 5001
