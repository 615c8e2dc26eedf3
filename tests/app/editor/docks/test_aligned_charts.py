"""The charts of the trade-off dock stand in line with one another."""

import numpy as np
import pytest
from PySide6.QtGui import QColor

from app.editor.docks.tradeoff_plots import Span, TradeOffPlots
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
