"""A plot viewer of data that need no network."""

import pytest

from app.editor.evaluation.queries import Answer
from app.editor.theme import DARK
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.editor.viewers.plot.plotted_lines import PortDataQuery
from panel_hands import NoEvaluator

PORT = "a.curve"


@pytest.fixture
def shown(session, qtbot):
    """A viewer of data that need no network; gives it."""

    def show(data, theme=DARK, size=(640, 360)):
        viewer = PlotViewer(session, NoEvaluator(session))
        viewer.setPalette(theme.palette())
        viewer.look_at(PORT)
        qtbot.addWidget(viewer)
        viewer.resize(*size)
        viewer.show()
        viewer.take(Answer(1, viewer.owner, PortDataQuery(PORT), data))
        qtbot.wait(20)
        return viewer

    return show
