"""Curves of the chain and of ports, with a real worker behind the viewer."""

import csv
import math

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt

from app.editor.evaluation.queries import Passing
from app.editor.viewers.plot.plotted_lines import CurvesQuery
from core.editing.operations import set_parameter

NETWORK = "inframetrics"

SIGMA = 0.02  # jitter of the Inframetrics network, mrad


@pytest.fixture
def viewer(plot_viewer):
    return plot_viewer


def curves(bench, angle=0.0, plan=None):
    engine, whole, work = bench.truth()
    return CurvesQuery(angle).answer(Passing(engine, plan or whole, work))


def named(found):
    return {curve.name: curve.x for _, curve in found.curves}


def test_an_edit_draws_only_what_it_changes(bench, viewer):
    plot, drawn = viewer.canvas.plots[0], viewer.canvas.plots[0].drawn
    before = {name: id(item.xData) for name, item in drawn.items()}
    axes = [id(plot.getAxis(name).picture) for name in ("left", "bottom")]
    bench.do(set_parameter("jitter", "sigma_mrad", 2 * SIGMA))
    assert viewer.canvas.plots[0] is plot
    totals = {each.name for kind, each in curves(bench).curves if kind == "total"}
    changed = {name for name, item in drawn.items() if id(item.xData) != before[name]}
    assert changed == {"jitter", *totals}
    x, y = drawn["jitter"].getData()
    assert y == pytest.approx(np.exp(-2 * math.pi**2 * (2 * SIGMA) ** 2 * x**2), abs=1e-12)
    assert axes == [id(plot.getAxis(name).picture) for name in ("left", "bottom")]


def test_draws_every_stage_and_the_totals_along_any_line(bench, viewer, qtbot):
    (panel,) = viewer.canvas.drawing.panels
    assert panel.y_label == "MTF"
    drawn = viewer.canvas.plots[0].drawn
    found = curves(bench)
    for _, curve in found.curves:
        x, y = drawn[curve.name].getData()
        assert (x == found.frequency).all()
        assert (y == curve.x.mtf).all()
    texts = [viewer.list.item(row).text() for row in range(viewer.list.count())]
    assert texts[:2] == ["Total", "Total with electronics"]
    assert "2.64" in viewer.status.title.text()  # the cutoff, beyond Nyquist
    # The cursor reads the nearest curve.
    canvas, box = viewer.canvas, viewer.canvas.plots[0].getViewBox()
    x = 0.3
    y = np.interp(x, found.frequency, named(found)["detector"].mtf)
    canvas.scene().sigMouseMoved.emit(box.mapViewToScene(QPointF(x, float(y))))
    told = viewer.status.more.text().replace("\N{MINUS SIGN}", "-")
    assert "detector" in told
    assert "cyc/mrad" in told
    assert float(told.split()[0]) == pytest.approx(x, abs=1e-3)
    assert float(told.split()[-1]) == pytest.approx(y, abs=1e-2)
    canvas.scene().sigMouseMoved.emit(QPointF(-9, -9))
    assert viewer.status.more.text() == ""
    # Buttons and an angle choose the line.
    qtbot.mouseClick(viewer.bar._y, Qt.MouseButton.LeftButton)
    bench.settle()
    assert viewer.angle_deg == 90.0
    assert viewer.canvas.drawing.x_label == "η (cyc/mrad)"
    viewer.bar.angle.setValue(37.0)
    bench.settle()
    assert "37°" in viewer.canvas.drawing.x_label
    wanted = named(curves(bench, 37.0))["detector"].mtf
    assert (viewer.canvas.plots[0].drawn["detector"].getData()[1] == wanted).all()
    qtbot.mouseClick(viewer.bar._x, Qt.MouseButton.LeftButton)
    bench.settle()
    assert viewer.angle_deg == 0.0


def test_both_parts_share_their_abscissa_and_the_legend_switches_curves(bench, viewer):
    row = next(r for r in range(viewer.list.count()) if "jitter" in viewer.list.item(r).text())
    curve = viewer.canvas.plots[0].drawn["jitter"]
    assert curve.isVisible()
    viewer.list.item(row).setCheckState(Qt.CheckState.Unchecked)
    assert not curve.isVisible()
    bench.do(set_parameter("jitter", "sigma_mrad", 2 * SIGMA))
    assert not curve.isVisible()
    viewer.set_parts("both")
    assert [panel.y_label for panel in viewer.canvas.drawing.panels] == ["MTF", "PTF (rad)"]
    upper, lower = (plot.getViewBox() for plot in viewer.canvas.plots)
    assert upper.viewRange()[0] == pytest.approx(lower.viewRange()[0])
    lower.setXRange(0.1, 0.2, padding=0)
    assert upper.viewRange()[0] == pytest.approx([0.1, 0.2])
    names = {line.name for line in viewer.canvas.drawing.panels[1].lines}
    assert names == {"electronics", "total_with_electronics"}  # the others have no phase


def test_a_curve_and_a_table_of_a_node(bench, viewer):
    viewer.look_at("picture.curve")
    bench.settle()
    truth = bench.value("picture.curve")
    x, y = viewer.canvas.plots[0].drawn["0"].getData()
    assert (x == truth.series[0].x).all()
    assert (y == truth.series[0].y).all()
    assert viewer.canvas.drawing.x_label == truth.x_label
    assert not viewer.bar.angle.isEnabled()
    viewer.look_at("electronics.table")
    bench.settle()
    truth = bench.value("electronics.table")
    table = viewer.table
    assert table.isVisible()
    assert table.rowCount() == len(truth.rows)
    for row, figure in enumerate(truth.rows):
        cells = [table.item(row, column).text() for column in range(4)]
        assert cells[0] == figure.name
        assert float(cells[1].replace("−", "-")) == pytest.approx(figure.value, rel=1e-5)
        assert cells[2:] == [figure.unit, figure.meaning]


def test_numbers_are_written_in_full(bench, viewer, tmp_path):
    viewer.export(tmp_path / "curves.csv")
    with (tmp_path / "curves.csv").open(newline="") as file:
        heads, *rows = list(csv.reader(file))
    found = curves(bench)
    columns = dict(zip(heads, zip(*rows, strict=True), strict=True))
    assert [float(cell) for cell in columns["frequency_cyc_per_mrad"]] == found.frequency.tolist()
    for _, curve in found.curves:
        assert [float(cell) for cell in columns[f"{curve.name}.mtf"]] == curve.x.mtf.tolist()
        assert [
            float(cell) for cell in columns[f"{curve.name}.ptf_rad"]
        ] == curve.x.ptf_rad.tolist()


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
    assert np.abs(by_name["electronics"].ptf_rad) == pytest.approx(np.abs(np.angle(pole)), abs=1e-9)
    product = np.prod([c.x.mtf for _, c in found.curves if c.name in bench_stages(found)], axis=0)
    assert by_name["total"].mtf * by_name["electronics"].mtf == pytest.approx(product, abs=1e-12)
    assert by_name["total_with_electronics"].mtf == pytest.approx(product, abs=1e-12)


def bench_stages(found):
    return [curve.name for kind, curve in found.curves if kind == "stage"]


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
