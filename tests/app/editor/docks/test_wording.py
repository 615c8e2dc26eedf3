"""What the trade-off dock calls figures, and which it shows at first."""

import pytest
from PySide6.QtCore import QPoint, Qt

from app.editor.docks.tradeoff_view import first_figures, listed_title
from app.run.shipped import shipped_networks
from app.tradeoff.tradeoff_figures import figures_of
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


def test_the_list_has_each_figure_in_full(known):
    _, figures = known
    titles = {name: listed_title(figure) for name, figure in figures.items()}
    assert titles["electronics.netd_system_K"] == "NETD system of electronics (K)"
    assert titles["electronics.snr"] == "SNR of electronics"
    assert titles["merit.snr"] == "SNR of merit"
    assert titles["total.mtf_nyquist_x"] == "MTF ξ, samples' Nyquist"
    assert titles["total.mtf_pixel_nyquist_x"] == "MTF ξ, pixels' Nyquist"
    assert len(set(titles.values())) == len(titles)


def test_what_is_ticked_is_in_sight(dock):
    dock.bar.figures.menu().popup(QPoint(0, 0))
    first = next(
        dock.list.item(row)
        for row in range(dock.list.count())
        if dock.list.item(row).checkState() == Qt.CheckState.Checked
    )
    assert dock.list.viewport().rect().intersects(dock.list.visualItemRect(first))
    dock.bar.figures.menu().close()
