"""The shipped network that measures an MTF, its picture in a viewer, and a hand on it."""

import pytest

from app.editor.viewers.picture.image_viewer import ImageViewer
from region_hands import PictureHand
from viewer_bench import ViewerBench


@pytest.fixture
def bench(qtbot, opened):
    made = ViewerBench(qtbot, opened("measured_mtf"))
    yield made
    made.close()


@pytest.fixture
def viewer(bench):
    made = ImageViewer(bench.session, bench.evaluator, 1)
    made.look_at("electronics.image")
    return bench.show(made, 900, 700)


@pytest.fixture
def hand(viewer, bench):
    bench.session.select(["measured"])
    return PictureHand(viewer)
