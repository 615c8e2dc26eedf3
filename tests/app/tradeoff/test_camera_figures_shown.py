"""A camera in electrons: which figures come first, and what they are called."""

import pytest

from app.tradeoff.tradeoff_results import computed, default_figures, figures_of
from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
PIXELS = {"detector_x_um": 15, "detector_y_um": 15}


@pytest.fixture
def camera():
    nodes = {
        "scene": ("test_scene", {}),
        "init": ("init_trans", {}),
        "fpa": ("focal_plane", {}),
        "beside": ("examine_image", {}),
    }
    links = [("scene.image", "init.image"), ("init.context", "fpa.context")]
    return linked_network(nodes, links)


def test_its_figures_are_what_a_trade_off_shows_by_default(camera):
    names = {figure.text for figure in default_figures(camera, LIBRARY)}
    assert {"fpa.netd_K", "fpa.snr", "fpa.well_fill_percent"} <= names
    assert not any(name.startswith("beside.") for name in names)


def test_a_figure_of_a_clipped_picture_has_its_reason():
    """10 s of exposure at 300 K fill a well of 1e5 e- many times over."""
    nodes = {
        "scene": ("test_scene", {"kind": "uniform", "width": 8, "height": 8}),
        "init": ("init_trans", {**PIXELS, "focal_length_mm": 50, "f_number": 2}),
        "fpa": ("focal_plane", {"integration_time_s": 10.0, "full_well_e": 1e5}),
    }
    links = [
        ("scene.image", "init.image"), ("init.context", "fpa.context"),
        ("scene.image", "fpa.image"),
    ]  # fmt: skip
    network, engine = linked_network(nodes, links), Engine(LIBRARY)
    wanted = [figures_of(network, LIBRARY)[f"fpa.{name}"] for name in ("netd_K", "signal_e")]
    found = computed(wanted, engine, engine.plan(network), engine.work(Policy("double")), {"fpa"})
    assert list(found.figures) == ["fpa.signal_e"]
    assert found.reasons["fpa.netd_K"].startswith(
        "fpa.netd_K has no value: the picture's mean reaches "
    )
    assert found.reasons["fpa.netd_K"].endswith(" % of the full well and is clipped")
