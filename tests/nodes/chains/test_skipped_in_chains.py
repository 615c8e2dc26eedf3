"""What a scene does not need is skipped."""

from __future__ import annotations

import math

import pytest

from core.chain.engine import Engine
from core.chain.filtered_sum import chosen_wavelengths
from core.chain.skipped import skips
from core.evaluation.work import Policy
from core.network.file import load_network
from cube_network import BANDS, write_cube_network
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
SIZE = {"width": 48, "height": 40, "fov_x_deg": 3.0, "fov_y_deg": 2.5}
NYQUIST_X = 0.5 / (1000 * math.radians(3.0) / 48)  # cycles/mrad
NYQUIST_Y = 0.5 / (1000 * math.radians(2.5) / 40)
DIAMETER_MM = 40.0  # radius 50 of 128 samples that span 51.2 mm
OPTICS = {"size_x_cm": 5.12, "size_y_cm": 5.12, "cut_on_um": 9.0, "cut_off_um": 11.0}


def account(folder, *, init=(), pupil=(), optics=(), pixels=(), ports=("pixels.image",), times=1):
    """What the last of some equal evaluations skipped, by node and kind."""
    nodes = {
        "scene": ("test_scene", {"kind": "slanted_edge", **SIZE}),
        "init": ("init_trans", {"focal_length_mm": 100.0, **dict(init)}),
        "pupil": ("exit_pupil", {"size_x": 128, "size_y": 128, "radius": 50.0, **dict(pupil)}),
        "optics": ("exit_pupil_mtf", {**OPTICS, **dict(optics)}),
        "back": ("back_transform", {}),
        "look": ("examine_image", {}),
        "pixels": ("combine_pixels", {"factor_x": 3, "factor_y": 2, **dict(pixels)}),
    }
    links = [
        ("scene.image", "init.image"), ("init.context", "optics.context"),
        ("init.magnitude", "optics.magnitude"), ("init.phase", "optics.phase"),
        ("pupil.pupil", "optics.pupil"), ("optics.magnitude", "back.magnitude"),
        ("optics.phase", "back.phase"), ("back.image", "pixels.image"),
        ("init.magnitude", "look.image"),
    ]  # fmt: skip
    bench = NodeBench(LIBRARY, folder, nodes, links)
    for _ in range(times):
        bench.work = bench.engine.work(bench.work.policy)
        for port in ports:
            bench.value(port)
    return {(each.node, each.kind): each for each in skips(bench.plan, bench.work)}


SHORTEST_OF_THREE = 10.0 - math.sqrt(3 / 5)  # µm: Gauss-Legendre places over 9 to 11 µm


@pytest.mark.parametrize(
    ("pupil", "optics", "wavelength_um", "width"),
    [
        ({"shape": "clear"}, {}, 10.0, 1.0),
        ({"shape": "half_moon"}, {}, 10.0, 0.5),
        (
            {"shape": "cassegrain", "obscuration_radius": 20.0},
            {"wavelengths": 3},
            SHORTEST_OF_THREE,
            1.0,
        ),
        ({"shape": "clear", "defocus_waves": 0.25}, {}, 10.0, 1.0),
    ],
)
def test_only_the_centre_of_the_otf_reaches_the_image(
    tmp_path, pupil, optics, wavelength_um, width
):
    found = account(tmp_path, pupil=pupil, optics=optics)["optics", "pupil_centre"]
    cutoff = DIAMETER_MM / wavelength_um  # cycles/mrad
    wanted = NYQUIST_X / (width * cutoff) * NYQUIST_Y / cutoff
    assert found.share == pytest.approx(wanted, rel=1e-12)
    assert found.share < 1


def test_an_otf_within_the_band_is_all_evaluated(tmp_path):
    # 40 mm at 100 µm end at 0.4 cycles/mrad, below Nyquist (0.458) either way.
    found = account(tmp_path, optics={"cut_on_um": 99.0, "cut_off_um": 101.0})
    assert ("optics", "pupil_centre") not in found
    across = account(tmp_path, optics={"cut_on_um": 99.0, "cut_off_um": 101.0, "size_y_cm": 51.2})
    assert across["optics", "pupil_centre"].share == pytest.approx(NYQUIST_Y / 4.0, rel=1e-12)


def test_samples_are_autocorrelated_whole(tmp_path):
    found = account(tmp_path, optics={"method": "autocorrelation"})
    assert ("optics", "pupil_centre") not in found
    assert ("pupil", "unseen") not in found


def test_a_closed_form_needs_no_samples(tmp_path):
    assert account(tmp_path)["pupil", "unseen"].ports == ("pupil",)
    assert ("pupil", "unseen") not in account(tmp_path, ports=("pixels.image", "pupil.pupil"))


def test_all_that_a_known_picture_stems_from_is_unchanged(tmp_path):
    found = account(tmp_path, optics={"method": "autocorrelation"}, times=2)
    for node in ("scene", "pupil", "back", "pixels"):
        assert found[node, "unchanged"].share == 0
    assert ("pupil", "unseen") not in found


def test_a_table_of_a_spectrum_stems_from_its_picture(tmp_path):
    once, again = (account(tmp_path, ports=("look.table",), times=times) for times in (1, 2))
    assert ("scene", "unchanged") not in once
    assert "magnitude" not in once["init", "unseen"].ports
    assert ("scene", "unchanged") in again
    assert ("scene", "unseen") not in again


def test_periodic_edges_are_not_mirrored(tmp_path):
    assert ("back", "mirrored_edges") in account(tmp_path)
    assert ("back", "mirrored_edges") not in account(tmp_path, init={"edges": "periodic"})


def test_the_share_of_the_inverse_that_folding_leaves(tmp_path):
    assert account(tmp_path)["pixels", "folded"].share == pytest.approx(1 / 6, rel=1e-15)
    assert ("pixels", "folded") not in account(tmp_path, pixels={"factor_x": 5})


@pytest.mark.parametrize("port", ["back.image", "fpa.electrons"])
def test_the_account_has_them_whoever_sums_the_bands(tmp_path, port):
    library = standard_library()
    write_cube_network(tmp_path, library, aperture_mm=100.0)
    engine = Engine(library)
    network = load_network(tmp_path / "cube.json", library=library)
    plan = engine.plan(network, folder=tmp_path)
    work = engine.work(Policy("double", 1e-3))
    engine.value(plan, port, work)
    made = [one for one in skips(plan, work) if one.kind == "wavelengths"]
    (rank,) = (
        work.value(recipe)
        for recipe in list(work.log.requested.values())
        if getattr(recipe, "function", None) is chosen_wavelengths
    )
    assert [one.node for one in made] == ["back"]
    assert 0 < made[0].bound <= 1e-3
    assert made[0].bound == rank.bound
    assert made[0].share == len(rank.chosen) / BANDS < 1
