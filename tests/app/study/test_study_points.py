"""The points of a study: their values, their number, and the order that repeats least."""

import json
import math
from pathlib import Path

import pytest

from app.run.option_values import save_target
from app.study.study_request import file_names, files_axis, natural, sampled
from app.study.study_rows import order_of
from core.errors import ImagechainError
from core.network.file import load_network
from nodes.library import standard_library
from tradeoff_network import DOCUMENT

LIBRARY = standard_library()
SIGMA, D_STAR = "blur.sigma_x_mrad", "electronics.d_star"


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    path = tmp_path_factory.mktemp("network") / "sensor.json"
    path.write_text(json.dumps(DOCUMENT))
    return load_network(path, library=LIBRARY)


def points_of(network, vary, sample="grid", points=None):
    return sampled(network, vary, sample, points, library=LIBRARY)


def test_a_grid_has_every_value_with_every_other(network):
    axes, points = points_of(network, {SIGMA: "0:1:3", D_STAR: "1e10,1e11"})
    assert [axis.text for axis in axes] == [SIGMA, D_STAR]
    assert [axis.unit for axis in axes] == ["mrad", "cm √Hz/W"]
    expected = [(s, d) for s in (0.0, 0.5, 1.0) for d in (1e10, 1e11)]
    assert list(points) == expected


@pytest.mark.parametrize("swapped", [False, True])
def test_the_deepest_parameter_moves_first(network, swapped):
    """Behind the blur hang jitter, back and electronics; behind the electronics nothing."""
    names = [SIGMA, D_STAR]
    vary = {name: [1e-1, 2e-1, 3e-1] if name == SIGMA else [1e10, 1e11] for name in names}
    axes, points = points_of(network, dict(reversed(vary.items())) if swapped else vary)
    at = [axis.text for axis in axes].index(SIGMA)
    order = order_of(axes, points, network)
    assert sorted(order) == list(range(6))
    assert [points[place][at] for place in order] == [0.1, 0.1, 0.2, 0.2, 0.3, 0.3]


def test_a_latin_hypercube_takes_each_part_of_each_range_once(network):
    count = 40
    vary = {SIGMA: "0:2", D_STAR: "1e9:1e13:log", "scene.width": "32:71"}
    vary["scene.kind"] = "dormitory,slanted_edge"
    axes, points = points_of(network, vary, "latin", count)
    sigma, d_star, width, kind = zip(*points, strict=True)
    assert sorted(int(value / 2.0 * count) for value in sigma) == list(range(count))
    decades = [(math.log10(value) - 9) / 4 for value in d_star]
    assert sorted(int(share * count) for share in decades) == list(range(count))
    assert sorted(width) == list(range(32, 72))
    assert sorted(kind) == ["dormitory"] * 20 + ["slanted_edge"] * 20
    assert points == points_of(network, vary, "latin", count)[1]
    other = points_of(network.with_seed(4), vary, "latin", count)[1]
    assert points != other
    for axis, column in zip(axes, zip(*points, strict=True), strict=True):
        assert set(column) == set(axis.values)


def test_a_list_has_columns_by_name_in_the_parameters_units(network, tmp_path):
    path = tmp_path / "list.csv"
    path.write_text(f"{SIGMA} (mrad),scene.kind\n0.25,dormitory\n.5,slanted_edge\n")
    axes, points = points_of(network, {}, str(path))
    assert points == [(0.25, "dormitory"), (0.5, "slanted_edge")]
    assert [axis.values for axis in axes] == [(0.25, 0.5), ("dormitory", "slanted_edge")]


LISTS = {
    "other unit": (f"{SIGMA} (µrad)\n1\n", "the parameter's unit is mrad"),
    "out of range": (f"{SIGMA}\n1\n-1\n", "line 3: sigma_x_mrad = -1 mrad is not allowed"),
    "short row": (f"{SIGMA},{D_STAR}\n1,1e10\n1\n", "line 3 has 1 cell,"),
}


@pytest.mark.parametrize(("text", "why"), LISTS.values(), ids=LISTS.keys())
def test_a_list_that_cannot_be_used(network, tmp_path, text, why):
    path = tmp_path / "list.csv"
    path.write_text(text)
    with pytest.raises(ImagechainError) as error:
        points_of(network, {}, str(path))
    assert why in str(error.value)


def test_files_of_a_pattern_come_as_people_count(network, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in ("s10.img", "s2.img", "s1.img", "t3.img", "s1.hdr"):
        Path(name).touch()
    reading = network.with_node(_reading(network))
    axis = files_axis("scene.path=s*.img", reading, library=LIBRARY)
    assert [axis.shown(value) for value in axis.values] == ["s1.img", "s2.img", "s10.img"]
    assert axis.values[0] == (tmp_path / "s1.img").as_posix()
    assert sorted(["b", "a10", "a9", "a9b1", "10", "9"], key=natural) == [
        "9", "10", "a9", "a9b1", "a10", "b",
    ]  # fmt: skip
    for text, why in (
        ("scene.path=u*.img", "no file matches"),
        ("scene.fov_x_deg=*.img", "not a file name"),
    ):
        with pytest.raises(ImagechainError, match=why):
            files_axis(text, reading, library=LIBRARY)


def _reading(network):
    from core.network.network import Node

    return Node("scene", "read_image", {"path": "x.img"})


def test_files_are_named_by_fields(network, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    axes, points = points_of(network, {SIGMA: "0.5,1"})

    def names(pattern):
        rows = file_names([save_target(f"back.image={pattern}")], axes, points)
        return [Path(name).relative_to(tmp_path).as_posix() for (name,) in rows]

    assert names("o/{point}.tif") == ["o/1.tif", "o/2.tif"]
    assert names("{point:03d}_{blur.sigma_x_mrad}.tif") == ["001_0.5.tif", "002_1.0.tif"]
    assert names("{blur.sigma_x_mrad:.2f}.tif") == ["0.50.tif", "1.00.tif"]
    for pattern, why in (
        ("all.tif", "two files of points 1 and 2 would both be named"),
        ("{point:0999999999}.tif", "width and digits of a number format must be at most 999"),
        ("{blur.sigma_x_mrad:.0e}{poin}.tif", "no field poin; did you mean point"),
        ("{point.tif", "back.image="),
        ("{point!r}.tif", "only a number format"),
        ("{blur.sigma_x_mrad:q}.tif", "{blur.sigma_x_mrad:q}"),
    ):
        with pytest.raises(ImagechainError) as error:
            names(pattern)
        assert why in str(error.value)
