"""A camera in electrons: which figures come first, and what they are called."""

import pytest

from app.editor.declared_text import label_of
from app.editor.docks.tradeoff_view import first_figures, in_order
from app.tradeoff.tradeoff_figures import computed, default_figures, figures_of
from core.chain.engine import Engine
from core.evaluation.policy import Policy
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


def test_netd_and_snr_come_first(camera):
    known = in_order(figures_of(camera, LIBRARY), camera)
    assert next(iter(known)).startswith("fpa.")
    assert first_figures(camera, known) >= {"fpa.netd_K", "fpa.snr"}


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("full_well_e", "Full well"), ("dark_current_e_per_s", "Dark current"),
        ("gain_e_per_dn", "Gain"), ("tdi_stages", "TDI stages"), ("prnu_percent", "PRNU"),
        ("nei_photons_per_cm2", "NEI"), ("mean_dn", "Mean"), ("netd_K", "NETD"),
        ("netd_mK", "NETD"), ("psd_path", "PSD path"),
    ],
)  # fmt: skip
def test_a_unit_at_the_end_of_a_name_stands_beside_the_value(name, label):
    assert label_of(name) == label


@pytest.mark.parametrize("name", ["optics_K", "housing_K", "source_K"])
def test_a_field_in_kelvin_is_of_a_temperature(name):
    """`Optics`, with a field in K below the transmission, named no quantity."""
    assert label_of(name).endswith("temperature")


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
    assert list(found.values) == ["fpa.signal_e"]
    assert found.reasons["fpa.netd_K"].startswith("fpa.netd_K has no value: the picture's mean is ")
    assert found.reasons["fpa.netd_K"].endswith(" % of the full well and is clipped")
