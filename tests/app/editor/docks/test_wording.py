"""What the trade-off dock calls figures, and which it shows at first."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt

from app.editor.docks import tradeoff_view as wording
from app.editor.docks.tradeoff_view import first_figures, listed_titles
from app.run.shipped import shipped_networks
from app.tradeoff.tradeoff_figures import Figure, figures_of
from core.network.file import load_network


@pytest.fixture
def known(library):
    network = load_network(shipped_networks()["figures_of_merit"], library=library)
    return network, figures_of(network, library)


def test_a_parameter_of_the_chain_moves_the_electronics_figures(known):
    wanted = {"electronics.netd_system_K", "electronics.snr", "total.mtf_pixel_nyquist_x"}
    assert first_figures(*known) == wanted


def test_a_parameter_of_an_analysis_moves_that_ones_figures(known):
    wanted = {"merit.mrtd_x_K", "merit.detection_range_km", "merit.ttp_range_km"}
    assert first_figures(*known, "merit") == wanted
    network, figures = known
    others = {name: each for name, each in figures.items() if "range" not in name}
    del others["merit.mrtd_x_K"]
    assert first_figures(network, others, "merit") == {"merit.snr", "merit.netd_K"}


def test_a_node_is_named_only_where_figures_are_called_alike(known):
    _, figures = known
    every = tuple(figures.values())
    titles = dict(zip(figures, listed_titles(every), strict=True))
    assert titles["electronics.netd_system_K"] == "NETD system"
    assert titles["electronics.snr"] == "SNR, electronics"
    assert titles["merit.snr"] == "SNR, merit"
    assert titles["total.mtf_nyquist_x"] == "MTF ξ, samples' Nyquist"
    assert titles["total.mtf_pixel_nyquist_x"] == "MTF ξ, pixels' Nyquist"
    assert len(set(titles.values())) == len(titles)


def test_what_is_ticked_is_in_sight(dock):
    first = next(
        dock.list.item(row)
        for row in range(dock.list.count())
        if dock.list.item(row).checkState() == Qt.CheckState.Checked
    )
    assert dock.list.viewport().rect().intersects(dock.list.visualItemRect(first))


def test_titles_of_many_figures_look_at_each_a_few_times(monkeypatch):
    """Not at every other figure: 5,000 nodes have 20,000."""
    looked = []
    each = [Figure(f"blur_{n}", "half_contrast", "cyc/mrad", "") for n in range(300)]
    each += [Figure("alone", "snr", "", "")]
    title = wording.title_of
    monkeypatch.setattr(
        wording, "title_of", lambda one, shown: looked.append(len(shown)) or title(one, shown)
    )
    titles = wording.listed_titles(each)
    assert sum(looked) <= 2 * len(each)
    monkeypatch.undo()
    assert titles == [wording.title_of(replace(one, unit=""), each) for one in each]
    assert titles[7].endswith(", blur_7")
    assert "alone" not in titles[-1]
