"""A camera in electrons: which figures come first, and what they are called."""

import pytest

from app.editor.declared_text import label_of
from app.editor.tradeoff.wording import first_figures, in_order
from app.tradeoff.tradeoff_figures import default_figures, figures_of
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()


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


def test_a_bolometer_s_figures_are_shown_by_default():
    nodes = {"scene": ("test_scene", {}), "init": ("init_trans", {}), "b": ("microbolometer", {})}
    links = [("scene.image", "init.image"), ("init.context", "b.context")]
    names = {figure.text for figure in default_figures(linked_network(nodes, links), LIBRARY)}
    assert {"b.netd_K", "b.snr"} <= names


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
