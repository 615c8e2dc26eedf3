"""The charts of the trade-off dock stand in line with one another."""

import numpy as np
import pytest
from PySide6.QtGui import QColor

from app.editor.docks.tradeoff_plots import Span, TradeOffPlots, _ordinate
from app.editor.viewers.plot.plotted_lines import Line
from window_hands import place_in

X = np.linspace(0.0, 1.0, 11)
GRAPHS = [  # numbers of one digit, of many, and powers
    ("a", Line("a", X, 5.0 * X)),
    ("b (Hz)", Line("b", X, 120000.0 + 20000.0 * X)),
    ("c", Line("c", X, 10.0 ** (9 * X - 9))),
    ("d", Line("d", X, -0.0375 * X)),
]


@pytest.fixture(params=[(300, 800), (900, 500)], ids=["in one column", "in two"])
def plots(request, qtbot):
    made = TradeOffPlots()
    qtbot.addWidget(made)
    made.resize(*request.param)
    made.show_graphs(GRAPHS, Span(0.0, 1.0, count=11), "sigma")
    made.show()
    qtbot.waitExposed(made)
    return made


def test_their_scales_are_in_line(plots):
    across = plots.across
    assert across == (1 if plots.width() < 400 else 4)
    for value in (0.0, 0.5, 1.0):
        places = [
            place_in(plots, index, value).x() % (plots.width() / across)
            for index in range(len(GRAPHS))
        ]
        assert max(places) - min(places) < 0.01, places


def test_a_geometric_mean_is_halfway_up_powers(plots):
    middle = place_in(plots, 2, 0.5).toPoint()  # of 1e-9 to 1
    ink = plots.grab().toImage().pixelColor(middle)
    assert ink == QColor(plots.charts[2].theme.curves[2])


@pytest.mark.parametrize(
    ("values", "low", "high", "log"),
    [
        ([1.0, 100.0], 1.0 - 0.08 * 99, 100.0 + 0.08 * 99, False),
        ([1.0, 100.1], 1.0 / 1.2, 100.1 * 1.2, True),
        ([1e-12, 1.0], 1e-9 / 1.2, 1.2, True),
        ([0.0, 1000.0], -80.0, 1080.0, False),
        ([-5.0, 1000.0], -5.0 - 80.4, 1080.4, False),
        ([np.nan, 2.0, 3.0, np.inf], 1.92, 3.08, False),
        ([3.0, 3.0], 2.7, 3.3, False),
        ([-2.0, -2.0], -2.2, -1.8, False),
        ([0.0, 0.0], -1.0, 1.0, False),
        ([np.nan], -0.08, 1.08, False),
        ([1.0, 1.0 + 1e-7], 0.9, 1.1, False),
        ([1.0, 1.0 + 1e-5], 1.0 - 8e-7, 1.0 + 1.08e-5, False),
    ],
)
def test_an_ordinate_is_in_decades_where_values_span_a_hundred(values, low, high, log):
    axis = _ordinate(("", Line("a", np.arange(len(values)), np.array(values))))
    assert (axis.low, axis.high) == pytest.approx((low, high), rel=1e-6)
    assert axis.log == log


@pytest.mark.parametrize("count", [1, 4, 5, 7])
@pytest.mark.parametrize("width", [100, 500, 900, 1400])
def test_charts_are_wide_enough_in_as_few_rows_as_can_be(qtbot, count, width):
    made = TradeOffPlots()
    qtbot.addWidget(made)
    made.resize(width, 400)
    made.show_graphs([GRAPHS[0]] * count, Span(0.0, 1.0), "sigma")
    least, rows = 11 * made.fontMetrics().height(), -(-count // made.across)
    assert made.across == 1 or made.across * least <= width
    assert rows == 1 or width // least < -(-count // (rows - 1))  # one row less would not do
    assert rows * (made.across - 1) < count  # nor a column less
