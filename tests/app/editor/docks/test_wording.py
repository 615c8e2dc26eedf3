"""What the trade-off dock calls figures, and which it shows at first."""

import math

import pytest

from app.editor.docks.snapshots import changed_figures
from app.editor.docks.tradeoff_view import first_figures, title_of
from app.run.shipped import shipped_networks
from app.tradeoff.tradeoff_results import figures_of
from core.network.file import load_network


def test_first_figures_and_titles(library):
    network = load_network(shipped_networks()["figures_of_merit"], library=library)
    figures = figures_of(network, library)
    wanted = {"electronics.netd_system_K", "electronics.snr", "total.mtf_pixel_nyquist_x"}
    assert first_figures(network, figures) == wanted
    titles = {name: title_of(figure) for name, figure in figures.items()}
    assert titles["electronics.netd_system_K"] == "NETD system of electronics (K)"
    assert titles["electronics.snr"] == "SNR of electronics"
    assert titles["merit.snr"] == "SNR of merit"
    assert titles["total.mtf_nyquist_x"] == "MTF ξ, samples' Nyquist"
    assert titles["total.mtf_pixel_nyquist_x"] == "MTF ξ, pixels' Nyquist"
    assert len(set(titles.values())) == len(titles)


@pytest.mark.parametrize(
    ("a", "b", "line"),
    [
        (0.1, 0.125, "100 mK → 125 mK"),
        (1.0, 1.0 + 1e-9, None),  # nothing that six digits show
        (1.0, 1.00002, "1 K → 1.00002 K"),
        (math.nan, math.nan, None),
        (None, 1.0, "— → 1 K"),
    ],
)
def test_figures_that_differ_between_a_snapshot_and_now(a, b, line):
    one, other = ({("camera", "netd_K"): (value, "K")} for value in (a, b))
    lines, count = changed_figures(one, other)
    assert (lines, count) == ([] if line is None else [f"camera NETD: {line}"], 1)
