"""The shipped networks: sound, quick to open, and with the figures of the thesis."""

import json
from pathlib import Path

import numpy as np
import pytest

from core.chain.engine import Engine
from core.network.file import format_network, load_network
from core.network.validation import problems
from node_bench import shipped_bench
from nodes.library import standard_library
from region_checks import image_ports

FOLDER = Path(__file__).parents[2] / "networks"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))


def opened(name):
    return shipped_bench(name, precision="single")


def figures(name, node):
    return opened(name).readouts(node)


@pytest.mark.parametrize("name", NAMES)
class TestEach:
    def test_is_sound_and_written_as_we_write(self, name):
        library = standard_library()
        path = FOLDER / f"{name}.json"
        network = load_network(path, library=library)
        assert problems(network, library=library) == []
        assert format_network(network, library=library) == path.read_text(encoding="utf-8")
        assert set(network.layout) == set(network.nodes)

    def test_opens_without_computing_anything(self, name):
        bench = opened(name)
        assert bench.plan.errors() == []
        assert len(bench.engine.store) == 0
        assert not bench.work.log.computed

    @pytest.mark.thorough(but=8)  # at a quarter of the samples all of them run in picture hashes
    def test_every_picture_is_finite(self, name):
        bench = opened(name)
        ports = image_ports(bench.plan)
        assert ports
        for port in ports:
            assert np.isfinite(bench.value(port)).all(), port


@pytest.mark.parametrize("name", ["inframetrics", "inframetrics_1996"])
def test_inframetrics_figures(name):
    """Tantalo 1996, table 5.2 and section 5.1."""
    init, electronics = figures(name, "init"), figures(name, "electronics")
    assert init["interval_x_mrad"] == pytest.approx(1.02265, abs=5e-6)
    assert init["nyquist_x"] == pytest.approx(0.488924, abs=5e-7)
    assert init["ifov_x_mrad"] == pytest.approx(4.3846, abs=5e-5)
    assert electronics["bandwidth_Hz"] == pytest.approx(49152, abs=1e-6)
    assert electronics["g_number"] == pytest.approx(5.20692, abs=5e-6)


@pytest.mark.parametrize("name", ["kodak_kir310", "kodak_kir310_1996"])
def test_kodak_figures(name):
    """Tantalo 1996, table 5.4 and section 5.2."""
    init, electronics = figures(name, "init"), figures(name, "electronics")
    assert init["nyquist_x"] == pytest.approx(1.17342, abs=5e-6)
    assert init["ifov_x_mrad"] == pytest.approx(0.11875, abs=1e-12)
    assert electronics["bandwidth_Hz"] == pytest.approx(294912, abs=1e-6)
    assert electronics["g_number"] == pytest.approx(6.68, abs=5e-3)


def test_minimum_otf_of_the_panels_of_1996():
    """0.918 and 0.967 in print; 0.91704 and 0.96676 follow from the geometry."""
    scanner = figures("inframetrics_1996", "optics")["mtf_at_nyquist_x"]
    array = figures("kodak_kir310_1996", "optics")["mtf_at_nyquist_x"]
    assert scanner == pytest.approx(0.918, abs=1.5e-3)
    assert array == pytest.approx(0.967, abs=5e-4)


def test_netd_of_1996():
    """Kodak: 0.0065 K and 0.177 K in print, for a background of 303 to 305 K."""
    kodak = figures("kodak_kir310_1996", "electronics")
    assert 0.0063 < kodak["netd_detector_K"] < 0.0069
    assert kodak["netd_system_K"] == pytest.approx(0.177219, abs=2e-3)
    scanner = figures("inframetrics_1996", "electronics")
    assert 0.0030 < scanner["netd_detector_K"] < 0.0032


def test_noise_of_the_budget_is_what_frames_show():
    """16 frames of 65536 samples, and one fixed pattern of as many: 0.1 and 0.3 percent."""
    budget, components = (figures("noise_budget", node) for node in ("budget", "components"))
    assert components["temporal_measured"] == pytest.approx(budget["sigma_temporal"], rel=0.01)
    assert components["fixed_measured"] == pytest.approx(budget["sigma_fixed"], rel=0.015)


def test_every_published_figure_names_its_place():
    for name in ("inframetrics", "inframetrics_1996", "kodak_kir310", "kodak_kir310_1996"):
        document = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
        assert len(document["published"]) >= 10
        assert len(document["conflicts"]) >= 5
        for row in document["published"]:
            assert row["figure"]
            assert row["where"]
            assert row["within"] > 0


EVER_SHIPPED = sorted((Path(__file__).parent / "ever_shipped").glob("*.json"))


@pytest.mark.parametrize("path", EVER_SHIPPED, ids=lambda path: path.stem)
def test_every_file_ever_shipped_still_opens(path):
    """What people saved from an earlier version is their work: it opens, and plans."""
    library = standard_library()
    network = load_network(path, library=library)
    assert problems(network, library=library) == []
    assert Engine(library).plan(network, folder=path.parent).errors() == []
