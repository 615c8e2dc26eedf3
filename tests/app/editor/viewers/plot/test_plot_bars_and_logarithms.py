"""Bars with names, and logarithmic ordinates with gaps, as the plot viewer draws them."""

import csv

import numpy as np
import pytest
from PySide6.QtCore import QPointF

from app.editor.viewers.plot.plot_canvas import PlotCanvas
from app.editor.viewers.plot.plotted_lines import curve_drawing
from core.chain.wires import CurveData, Series

NAMES = ("Optics", "Detector", "Jitter")


def bars(*heights, log=False):
    series = tuple(
        Series(f"set {number}", np.arange(3.0), np.array(each))
        for number, each in enumerate(heights)
    )
    return CurveData("Shares", "stage", "share (%)", series, NAMES, log)


FREQUENCY = np.linspace(0.0, 2.0, 201)
MRTD = CurveData(
    "MRTD",
    "frequency (cyc/mrad)",
    "MRTD (K)",
    (Series("MRTD", FREQUENCY, np.where(FREQUENCY <= 1.5, 0.01 * 10**FREQUENCY, np.inf)),),
    log_y=True,
)


def test_bars_are_as_long_as_their_values(shown):
    viewer = shown(bars([10.0, 40.0, np.inf], [5.0, -1.0, 2.0]))
    plot = viewer.canvas.bars
    assert [bar.opts["x1"].tolist() for bar in plot.bars] == [[10.0, 40.0, 0.0], [5.0, 0.0, 2.0]]
    assert [bar.opts["x0"].tolist() for bar in plot.bars] == [[0.0] * 3, [0.0, -1.0, 0.0]]
    seen = plot.getViewBox().viewRange()
    assert seen[0] == pytest.approx([-1.0, 40.0])
    assert seen[1] == pytest.approx([2.5, -0.5] if seen[1][0] > seen[1][1] else [-0.5, 2.5])
    upper, lower = (bar.boundingRect() for bar in plot.bars)
    assert upper.top() < lower.top()
    assert viewer.canvas.accessibleDescription().endswith("; Jitter: ∞, 2")


def test_curves_in_place_of_which_bars_are_drawn_are_gone_from_the_scene(qtbot):
    canvas = PlotCanvas()
    qtbot.addWidget(canvas)
    canvas.show()
    scene = canvas.scene()

    def draw(data, width):
        drawing = curve_drawing(data, log=False)
        canvas.resize(width, 300)
        canvas.show_drawing(drawing, {entry.name for entry in drawing.entries})
        qtbot.wait(20)

    for _ in range(3):
        draw(MRTD, 360)
        draw(MRTD, 200)
        plots = canvas.plots  # held: what the scene still had of them would be freed memory
        draw(bars([10.0, 40.0, 30.0]), 200)
        found = scene.items(scene.sceneRect())
        assert canvas.bars in found
        assert not set(plots) & set(found)


def test_bars_of_one_line_each_have_a_row_and_are_exported_with_their_names(shown, tmp_path):
    plot = shown(bars([10.0, 0.0, 20.0], [0.0, 5.0, 0.0])).canvas.bars
    assert {tuple(bar.opts["y"]) for bar in plot.bars} == {(0.0, 1.0, 2.0)}  # a row each
    assert "Detector: 0, 5" in plot.description
    viewer = shown(bars([10.0, 40.0, np.inf]))
    viewer.export(tmp_path / "b.csv")
    with (tmp_path / "b.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [
            ["stage", "set 0"], ["Optics", "10.0"], ["Detector", "40.0"], ["Jitter", "inf"],
        ]  # fmt: skip
    viewer.export(tmp_path / "b.png")
    assert (tmp_path / "b.png").stat().st_size > 1000


def test_a_logarithmic_curve_is_drawn_with_gaps_and_read_as_it_is(shown):
    viewer = shown(MRTD)
    assert viewer.bar.log.isChecked()
    _, y = viewer.canvas.plots[0].drawn["0"].getData()
    seen = FREQUENCY <= 1.5
    np.testing.assert_allclose(y[seen], FREQUENCY[seen] - 2.0, atol=1e-12)
    assert np.isnan(y[~seen]).all()
    low, high = viewer.canvas.plots[0].getViewBox().viewRange()[1]
    assert low < -2.0 < -0.5 < high < 0.0
    read = []
    viewer.canvas.read.connect(read.append)
    box = viewer.canvas.plots[0].getViewBox()
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.0, -1.0)))
    value = float(read[-1].split("MRTD: ")[1].split()[0])
    assert value == pytest.approx(0.1, rel=0.05)
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.8, -1.0)))  # in the gap
    assert read[-1] == ""
