"""The Nyquist frequency is marked where a measured MTF is plotted."""

import numpy as np
import pytest

from core.chain.wires import CurveData, CurveMark, Series
from core.editing.operations import set_parameter

FREQUENCY = np.linspace(0.0, 2.0, 201)


def test_a_mark_in_a_low_plot_has_its_number_alone(shown):
    series = (Series("a", FREQUENCY, np.cos(FREQUENCY)),)
    viewer = shown(CurveData("", "x", "MTF", series, marks=(CurveMark("pixels' Nyquist", 0.5),)))
    (mark,) = viewer.canvas.plots[0].marks
    assert mark.label.format == "pixels' Nyquist 0.5"
    viewer.canvas.plots[0].getViewBox().resize(300, 60)
    assert mark.label.format == "0.5"


def test_a_measured_mtf_marks_half_a_cycle_per_pixel(window, idle):
    window.files.open_now("measured_mtf")
    idle(window)
    plot = window.viewers.plot
    assert plot.port == "measured.curve"
    image = window.evaluator.plan.output("electronics.image")
    assert image.interval_x_mrad == pytest.approx(image.interval_y_mrad)
    (mark,) = plot.canvas.drawing.marks
    assert mark.text == "Nyquist"
    assert mark.x == pytest.approx(0.5 / image.interval_x_mrad)
    window.session.do(set_parameter("measured", "axis", "cyc_per_pixel"))
    idle(window)
    (mark,) = plot.canvas.drawing.marks
    assert mark.x == 0.5
