"""Spectral Response: the same weights by fine sums, of bands and of one band by a black body."""

import numpy as np
import pytest

from core.errors import ParameterError
from cube_files import C1_UM, C2_UM, centres, materials_cube, write_cube
from node_bench import NodeBench

SIZE = (24, 20)
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.2}


def planck(um, kelvin):
    return C1_UM / um**5 / np.expm1(C2_UM / um / kelvin)


def fine(low, high, count=400_000):
    return low + (high - low) * (np.arange(count) + 0.5) / count


def gaussian(um, centre, width):
    return np.exp(-4 * np.log(2) * ((um - centre) / width) ** 2)


def bench(folder, params, *, read):
    nodes = {"read": ("read_image", {**FOV, **read}), "filter": ("spectral_response", params)}
    return NodeBench(folder, nodes)


@pytest.fixture
def cube(tmp_path):
    wavelengths, width = centres(20)
    samples = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, samples, wavelengths, width)
    return samples, wavelengths, width


@pytest.mark.parametrize("shape", ["rectangle", "gaussian", "file"])
def test_every_band_counts_by_its_mean_response(tmp_path, cube, shape):
    samples, wavelengths, width = cube
    (tmp_path / "r.csv").write_text("3.1,0.1\n3.7,1\n4.45,0.6\n")
    params = {"shape": shape, "centre_um": 3.93, "width_um": 0.71, "peak": 0.9}
    if shape == "file":
        params = {"shape": shape, "path": "r.csv"}
    law = {
        "rectangle": lambda um: 0.9 * (np.abs(um - 3.93) <= 0.355),
        "gaussian": lambda um: 0.9 * gaussian(um, 3.93, 0.71),
        "file": lambda um: np.interp(um, [3.1, 3.7, 4.45], [0.1, 1, 0.6], left=0, right=0),
    }[shape]
    weights = [
        width * law(fine(one - width / 2, one + width / 2, 40_000)).mean() for one in wavelengths
    ]
    want = np.tensordot(weights, samples, 1)
    there = bench(tmp_path, params, read={"path": "cube.img", "bands": "all"})
    made = there.value("filter.image")
    assert np.abs(made - want).max() <= 3e-5 * want.max()  # of the fine sums at the edges
    assert there.port("filter.image").bands.count == 20
    light = samples.mean(axis=(1, 2))
    mean = there.readouts("filter")["mean_of_band"]
    assert mean == pytest.approx(np.dot(weights, light) / (width * light.sum()), rel=3e-5)


@pytest.mark.parametrize("shape", ["rectangle", "gaussian"])
def test_one_band_counts_by_the_black_body_of_its_mean(tmp_path, shape):
    um = fine(8.0, 12.0)
    radiance = planck(um, 305.0).mean() * 4.0
    np.save(tmp_path / "flat.npy", np.full(SIZE, radiance))
    params = {"shape": shape, "centre_um": 9.4, "width_um": 1.3}
    law = np.abs(um - 9.4) <= 0.65 if shape == "rectangle" else gaussian(um, 9.4, 1.3)
    read = {"path": "flat.npy", "cut_on_um": 8.0, "cut_off_um": 12.0}
    there = bench(tmp_path, params, read=read)
    body = planck(um, 305.0)
    want = (law * body).sum() / body.sum()
    assert there.readouts("filter")["mean_of_band"] == pytest.approx(want, rel=2e-6)
    assert there.value("filter.image").mean() == pytest.approx(want * radiance, rel=2e-6)


def test_middle_and_width_left_empty_are_those_of_the_band(tmp_path, cube):
    _, wavelengths, width = cube
    low, high = wavelengths[0] - width / 2, wavelengths[-1] + width / 2
    named = {"shape": "gaussian", "centre_um": (low + high) / 2, "width_um": high - low}
    pictures = [
        bench(tmp_path, params, read={"path": "cube.img", "bands": "all"}).value("filter.image")
        for params in ({"shape": "gaussian"}, named)
    ]
    assert pictures[0] == pytest.approx(pictures[1], rel=1e-6)


def test_left_empty_it_passes_the_picture_on(tmp_path, cube):
    there = bench(tmp_path, {}, read={"path": "cube.img", "bands": "all"})
    assert there.port("filter.image") is there.port("read.image")


def test_a_response_beside_the_band_is_refused(tmp_path, cube):
    params = {"centre_um": 9.0, "width_um": 1.0}
    error = bench(tmp_path, params, read={"path": "cube.img", "bands": "all"}).error("filter")
    assert isinstance(error, ParameterError)
    assert "3 to 5 µm" in str(error)


def test_what_knows_no_bands_says_that_it_took_their_sum(tmp_path, cube):
    nodes = {
        "read": ("read_image", {**FOV, "path": "cube.img", "bands": "all"}),
        "sharpen": ("anti_alias", {"factor": 2.0}),
        "kelvin": ("to_temperature", {}),
    }
    links = [("read.image", "sharpen.image"), ("read.image", "kelvin.image")]
    plan = NodeBench(tmp_path, nodes, links).plan
    for name in ("sharpen", "kelvin"):
        texts = [caution.message for caution in plan.nodes[name].warnings]
        assert any("this node sums the picture's 20 bands, 3 to 5 µm" in text for text in texts), (
            texts
        )
    assert not plan.nodes["read"].warnings


@pytest.mark.parametrize(
    ("points", "law"),
    [
        ("2,0.2\n6,0.6\n", lambda um: 0.2 + 0.1 * (um - 2)),
        ("2,0\n4,1\n6,0\n", lambda um: 1 - np.abs(um - 4) / 2),
    ],
    ids=["no point in the band", "1 at its only point in the band"],
)
def test_a_file_counts_between_points_that_lie_beyond_the_band(tmp_path, points, law):
    np.save(tmp_path / "one.npy", np.full(SIZE, 2.0))
    (tmp_path / "r.csv").write_text(points)
    read = {"path": "one.npy", "cut_on_um": 3.0, "cut_off_um": 5.0}
    there = bench(tmp_path, {"shape": "file", "path": "r.csv", "source_K": 300.0}, read=read)
    places = fine(3.0, 5.0)
    want = 2.0 * np.average(law(places), weights=planck(places, 300.0))
    np.testing.assert_allclose(there.value("filter.image"), want, rtol=1e-9)
