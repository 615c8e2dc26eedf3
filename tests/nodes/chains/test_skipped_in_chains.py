"""What a scene does not need is skipped."""

import pytest

from core.chain.band_stack import chosen_wavelengths
from core.chain.engine import Engine
from core.chain.skipped import skips
from core.evaluation.work import Policy
from core.network.file import load_network
from cube_network import BANDS, write_cube_network
from node_bench import NodeBench
from nodes.library import standard_library

SIZE = {"width": 48, "height": 40, "fov_x_deg": 3.0, "fov_y_deg": 2.5}
OPTICS = {"size_x_cm": 5.12, "size_y_cm": 5.12, "cut_on_um": 9.0, "cut_off_um": 11.0}


def account(folder, *, optics=(), ports=("pixels.image",), times=1):
    """What the last of some equal evaluations skipped, by node and kind."""
    nodes = {
        "scene": ("test_scene", {"kind": "slanted_edge", **SIZE}),
        "init": ("init_trans", {"focal_length_mm": 100.0}),
        "pupil": ("exit_pupil", {"size_x": 128, "size_y": 128, "radius": 50.0}),
        "optics": ("exit_pupil_mtf", {**OPTICS, **dict(optics)}),
        "back": ("back_transform", {}),
        "look": ("examine_image", {}),
        "pixels": ("combine_pixels", {"factor_x": 3, "factor_y": 2}),
    }
    links = [
        ("scene.image", "init.image"), ("init.context", "optics.context"),
        ("init.magnitude", "optics.magnitude"), ("init.phase", "optics.phase"),
        ("pupil.pupil", "optics.pupil"), ("optics.magnitude", "back.magnitude"),
        ("optics.phase", "back.phase"), ("back.image", "pixels.image"),
        ("init.magnitude", "look.image"),
    ]  # fmt: skip
    bench = NodeBench(folder, nodes, links)
    for _ in range(times):
        bench.work = bench.engine.work(bench.work.policy)
        for port in ports:
            bench.value(port)
    return {(each.node, each.kind): each for each in skips(bench.plan, bench.work)}


def test_samples_are_autocorrelated_whole(tmp_path):
    found = account(tmp_path, optics={"method": "autocorrelation"})
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
