"""The shipped network that measures an MTF, its picture in a viewer, and a hand on it."""

import pytest

from region_hands import PictureHand


@pytest.fixture
def viewer(image_viewer):
    return image_viewer("electronics.image", 900, 700)


@pytest.fixture
def hand(viewer, bench):
    bench.session.select(["measured"])
    return PictureHand(viewer)
