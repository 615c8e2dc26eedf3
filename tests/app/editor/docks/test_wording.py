"""What the trade-off dock calls figures, and which it shows at first."""

import pytest

from app.editor.docks.tradeoff_view import first_figures, title_of
from app.run.shipped import shipped_networks
from app.tradeoff.tradeoff_results import figures_of
from core.network.file import load_network


@pytest.fixture
def known(library):
    network = load_network(shipped_networks()["figures_of_merit"], library=library)
    return network, figures_of(network, library)


def test_a_parameter_of_the_chain_moves_the_electronics_figures(known):
    wanted = {"electronics.netd_system_K", "electronics.snr", "total.mtf_pixel_nyquist_x"}
    assert first_figures(*known) == wanted


def test_the_list_has_each_figure_in_full(known):
    _, figures = known
    titles = {name: title_of(figure) for name, figure in figures.items()}
    assert titles["electronics.netd_system_K"] == "NETD system of electronics (K)"
    assert titles["electronics.snr"] == "SNR of electronics"
    assert titles["merit.snr"] == "SNR of merit"
    assert titles["total.mtf_nyquist_x"] == "MTF ξ, samples' Nyquist"
    assert titles["total.mtf_pixel_nyquist_x"] == "MTF ξ, pixels' Nyquist"
    assert len(set(titles.values())) == len(titles)
