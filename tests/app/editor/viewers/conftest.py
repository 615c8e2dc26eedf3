"""Viewers with a worker behind them: of the network that a module of tests names."""

import pytest

from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.viewers.plot.plot_viewer import PlotViewer
from viewer_bench import ViewerBench


@pytest.fixture
def bench(qtbot, opened, request):
    made = ViewerBench(qtbot, opened(request.module.NETWORK))
    yield made
    made.close()


@pytest.fixture
def image_viewer(bench):
    """Make a viewer of one wire."""

    def show(port, *size, number=1):
        made = ImageViewer(bench.session, bench.evaluator, number)
        made.look_at(port)
        return bench.show(made, *size)

    return show


@pytest.fixture
def plot_viewer(bench):
    return bench.show(PlotViewer(bench.session, bench.evaluator))
