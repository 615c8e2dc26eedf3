"""Wavelengths that stand for those of all bands, where a detector counts its own sum of these."""

import pytest

from core.chain.engine import Engine
from core.chain.filtered_sum import chosen_wavelengths
from core.chain.skipped import skips
from core.evaluation.work import Policy
from core.network.file import load_network
from cube_network import BANDS, write_cube_network
from nodes.library import standard_library


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
