"""Bars with names, and logarithmic ordinates with gaps, as the plot viewer draws them."""

import csv

import numpy as np
import pytest
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor

from app.editor.theme import DARK, LIGHT
from core.chain.results import CurveData, Series

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


def painted(viewer, colour):
    """Rows and columns of the dots of a colour in the chart."""
    image = viewer.bars.widget().grab().toImage()
    wanted = QColor(colour).rgb()
    return [
        (y, x) for y in range(image.height()) for x in range(image.width())
        if image.pixel(x, y) == wanted
    ]  # fmt: skip


def lengths(viewer, colour, count):
    """Dots that each bar of a colour is long, from the top down."""
    dots = painted(viewer, colour)
    height = viewer.bars.widget().height() - 2 * viewer.fontMetrics().height()
    found = []
    for place in range(count):
        top, bottom = place * height / count, (place + 1) * height / count
        columns = [x for y, x in dots if top <= y < bottom]
        found.append((max(columns) - min(columns) + 1) if columns else 0)
    return found


@pytest.mark.parametrize("theme", [DARK, LIGHT])
def test_bars_are_as_long_as_their_values(shown, theme):
    viewer = shown(bars([10.0, 40.0, 20.0]), theme)
    assert viewer.bars.isVisible()
    assert not viewer.canvas.isVisible()
    first, second, third = lengths(viewer, theme.curves[0], 3)
    assert second > 100
    assert first == pytest.approx(second / 4, abs=2)
    assert third == pytest.approx(second / 2, abs=2)


def test_bars_are_exported_with_their_names(shown, tmp_path):
    viewer = shown(bars([10.0, 40.0, np.inf]))
    viewer.export(tmp_path / "b.csv")
    with (tmp_path / "b.csv").open(newline="") as file:
        assert list(csv.reader(file)) == [
            ["stage", "set 0"], ["Optics", "10.0"], ["Detector", "40.0"], ["Jitter", "inf"],
        ]  # fmt: skip
    viewer.export(tmp_path / "b.png")
    assert (tmp_path / "b.png").stat().st_size > 1000


def test_a_logarithmic_curve_is_drawn_by_its_logarithm_with_gaps(shown):
    viewer = shown(MRTD)
    assert viewer.bar.log.isChecked()
    _, y = viewer.canvas._curves[0]["0"].getData()
    seen = FREQUENCY <= 1.5
    np.testing.assert_allclose(y[seen], FREQUENCY[seen] - 2.0, atol=1e-12)
    assert np.isnan(y[~seen]).all()
    low, high = viewer.canvas._plots[0].getViewBox().viewRange()[1]
    assert low < -2.0 < -0.5 < high < 0.0


def test_what_the_cursor_reads_is_no_logarithm(shown, qtbot):
    viewer = shown(MRTD)
    read = []
    viewer.canvas.read.connect(read.append)
    box = viewer.canvas._plots[0].getViewBox()
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.0, -1.0)))
    value = float(read[-1].split("MRTD: ")[1].split()[0])
    assert value == pytest.approx(0.1, rel=0.05)
    viewer.canvas._mouse_moved(box.mapViewToScene(QPointF(1.8, -1.0)))  # in the gap
    assert read[-1] == ""
