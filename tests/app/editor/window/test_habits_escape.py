"""Esc while the mouse holds something puts back what it had before, until the button is up."""

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QStyle, QStyleOptionSlider

from app.editor.viewers.picture.picture_bar import SPREAD_MS
from panel_hands import handle_of
from window_hands import KEY, WindowHands, place_in

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def opened(window, idle):
    """The small shipped network, with the panel of its blur."""
    window.files.open_now("first_steps")
    idle(window)
    WindowHands(window).select("blur")
    idle(window)
    return window


def held(widget, places, value):
    """Values at a press, while places are gone through, at Esc, at another move and at the end."""
    start, *ways = places
    QTest.mouseMove(widget, start)
    QTest.mousePress(widget, LEFT, pos=start)
    for place in ways:
        QTest.mouseMove(widget, place)
        QTest.qWait(60)
    dragged = value()
    QTest.keyClick(widget.window().focusWidget(), KEY.Key_Escape)
    after = [value()]
    QTest.mouseMove(widget, start + QPoint(3, -30))
    QTest.qWait(60)
    after.append(value())
    QTest.mouseRelease(widget, LEFT, pos=start + QPoint(3, -30))
    return dragged, [*after, value()]


def beside_handle(slider):
    """In the groove, where a press goes on by pages."""
    option, control = QStyleOptionSlider(), QStyle.ComplexControl.CC_Slider
    slider.initStyleOption(option)
    handle = slider.style().subControlRect(
        control, option, QStyle.SubControl.SC_SliderHandle, slider
    )
    assert handle.right() < slider.width() - 8
    return QPoint(slider.width() - 5, slider.height() // 2)


def test_escape_gives_up_whatever_is_dragged(opened, idle):
    window, steps = opened, opened.session.document.position

    def sigma():
        return window.session.network.nodes["blur"].params["sigma_x_mrad"]

    field = window.panels.panels["blur"].body.sections.field("sigma_x_mrad")
    window.panels.ensureWidgetVisible(field)
    field.slider.setFocus()
    before = sigma()
    handle = handle_of(field.slider)
    by_handle = [handle + QPoint(by, 0) for by in (0, 20, 40, 60)]
    for places in (by_handle, [beside_handle(field.slider)] * 2):
        dragged, after = held(field.slider, places, sigma)
        assert dragged != before
        assert after == [before] * 3
    QTest.qWait(400)  # a press that is held goes on by itself
    assert sigma() == before
    # Its mark in the trade-off.
    window.viewers.trade_off("blur", "sigma_x_mrad")
    idle(window)
    plots, span = window.viewers.tradeoff.plots, window.viewers.tradeoff.span
    shares = (span.low + part * (span.high - span.low) for part in (0.3, 0.5, 0.6))
    dragged, after = held(plots, [place_in(plots, 0, x).toPoint() for x in shares], sigma)
    assert dragged != before
    assert after == [before] * 3
    assert window.session.document.position == steps
    # A bound of the histogram.
    viewer = window.viewers.images[1]
    window.viewers.docks[1].raise_()
    idle(window)
    canvas, levels = viewer.canvas, viewer.canvas.levels
    canvas.setFocus()

    def chosen():
        return viewer.choices.levels

    before, bounds = chosen(), tuple(levels.getLevels())
    spot = levels.vb.mapViewToScene(QPointF(-0.5, bounds[0]))
    start = canvas.mapFromScene(spot)
    places = [start - QPoint(0, by) for by in (0, 5, 20, 40)]
    dragged, after = held(canvas.viewport(), places, chosen)
    assert dragged != before
    assert after == [before] * 3
    idle(window)  # a picture of the levels before Esc may still come
    QTest.qWait(2 * SPREAD_MS)
    assert tuple(levels.getLevels()) == bounds
