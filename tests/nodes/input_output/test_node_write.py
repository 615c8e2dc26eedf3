"""Write Image and Write Matrix: files read back."""

import numpy as np
import pytest

from core.chain.wires import CurveData, Image, Series
from core.errors import DataError, ParameterError
from core.evaluation.recipes import Step
from core.modules.declaration import Module
from node_bench import NodeBench
from nodes.files.arrays import read_matrix
from nodes.files.formats import read_info, read_pixels
from nodes.input_output.write_image import curve_columns
from nodes.library import standard_library
from nodes.shared.module_ports import ImageOutput


def with_a_hole(_work, samples):
    made = samples.copy()
    made[2, 3] = np.inf
    return made


class Hole(Module, key="hole", title="Hole", group="Tests"):
    """Make one sample infinite."""

    def run(self, image: Image) -> ImageOutput:
        """Plan it."""
        return ImageOutput(image.with_recipe(Step.of(with_a_hole, image.recipe)))


def passing(folder, array, sink, params, precision="double"):
    """A picture from a .npy file into a sink."""
    np.save(folder / "in.npy", array)
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": 2.0, "fov_y_deg": 1.5}),
        "out": (sink, params),
    }
    return NodeBench(folder, nodes, precision=precision)


def picture(rows=6, columns=9, seed=1):
    return np.random.default_rng(seed).uniform(-5, 60, (rows, columns))


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("name", ["o.tif", "o.npy", "o.exr"])
def test_float_pictures_come_back(tmp_path, name, precision):
    array = picture()
    bench = passing(tmp_path, array, "write_image", {"path": name}, precision)
    assert not (tmp_path / name).exists()  # planning writes nothing
    assert bench.write("out") == [tmp_path / name]
    exact = precision == "double" and not name.endswith("exr")
    expected = array if exact else array.astype(np.float32)
    np.testing.assert_array_equal(read_pixels(tmp_path / name), expected)


def test_written_picture_tells_what_read_image_needs(tmp_path):
    bench = passing(tmp_path, picture(), "write_image", {"path": "o.tif"})
    bench.write("out")
    info = read_info(tmp_path / "o.tif")
    assert (info.unit, info.fov_x_deg) == ("W/m²/sr", pytest.approx(2.0, rel=1e-14))
    again = NodeBench(tmp_path, {"in": ("read_image", {"path": "o.tif"})}).port("in.image")
    assert again.interval_y_mrad == pytest.approx(bench.port("in.image").interval_y_mrad)


def test_integers_span_the_range(tmp_path):
    array = picture()
    passing(tmp_path, array, "write_image", {"path": "o.png"}).write("out")
    low, high = array.min(), array.max()
    expected = np.rint((array - low) / (high - low) * 65535)
    np.testing.assert_array_equal(read_pixels(tmp_path / "o.png"), expected)
    params = {"path": "p", "format": "png", "dtype": "uint8", "range_low": 0, "range_high": 50}
    written = passing(tmp_path, array, "write_image", params).write("out")
    assert written == [tmp_path / "p.png"]
    expected = np.rint(np.clip(array, 0, 50) / 50 * 255)
    np.testing.assert_array_equal(read_pixels(tmp_path / "p.png"), expected)
    passing(tmp_path, np.full((3, 3), 7.0), "write_image", {"path": "c.png"}).write("out")
    assert (read_pixels(tmp_path / "c.png") == 0).all()


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({}, "path"),
        ({"path": "o.xyz"}, "path"),
        ({"path": "o.png", "format": "exr"}, "format"),
        ({"path": "o.png", "dtype": "float"}, "dtype"),
        ({"path": "o.npy", "dtype": "half"}, "dtype"),
        ({"path": "o.png", "range_low": 2, "range_high": 1}, "range_high"),
    ],
)
def test_faults_of_writing_are_told_at_planning(tmp_path, params, words):
    error = passing(tmp_path, picture(), "write_image", params).error("out")
    assert isinstance(error, ParameterError)
    assert error.parameter == words


@pytest.mark.parametrize("name", ["o.tif", "o.npy", "o.exr", "o.png"])
def test_samples_that_are_not_finite_are_refused_in_every_format(tmp_path, name):
    np.save(tmp_path / "in.npy", picture())
    nodes = {"in": ("read_image", {"path": "in.npy"}), "hole": ("hole", {})}
    nodes["out"] = ("write_image", {"path": name})
    links = [("in.image", "hole.image"), ("hole.image", "out.image")]
    bench = NodeBench(tmp_path, nodes, links, library={**standard_library(), Hole.key: Hole})
    with pytest.raises(DataError, match=f"{name}: 1 sample is not finite .* row 2, column 3"):
        bench.write("out")
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize("name", ["m.txt", "m.csv", "m.prn"])
def test_matrix_of_an_image(tmp_path, name):
    array = picture()
    assert passing(tmp_path, array, "write_matrix", {"path": name}).write("out")
    np.testing.assert_array_equal(read_matrix(tmp_path / name), array)


def test_matrix_of_a_curve(tmp_path):
    np.save(tmp_path / "in.npy", picture())
    nodes = {
        "in": ("read_image", {"path": "in.npy"}),
        "look": ("examine_image", {"bins": 8}),
        "csv": ("write_matrix", {"path": "h.csv"}),
        "txt": ("write_matrix", {"path": "h.txt"}),
    }
    links = [("in.image", "look.image"), ("look.curve", "csv.image"), ("look.curve", "txt.image")]
    bench = NodeBench(tmp_path, nodes, links)
    bench.write("csv")
    bench.write("txt")
    columns = list(np.loadtxt(tmp_path / "h.csv", delimiter=",", skiprows=1).T)
    counts, edges = np.histogram(picture(), bins=8)
    np.testing.assert_allclose(columns[0], (edges[1:] + edges[:-1]) / 2, rtol=1e-13)
    np.testing.assert_array_equal(columns[1], counts)
    np.testing.assert_array_equal(read_matrix(tmp_path / "h.txt"), np.stack(columns, axis=1))


def test_matrix_needs_a_path_of_text(tmp_path):
    assert passing(tmp_path, picture(), "write_matrix", {}).error("out").parameter == "path"
    error = passing(tmp_path, picture(), "write_matrix", {"path": "x.exr"}).error("out")
    assert error.parameter == "path"


def test_columns_of_curves_that_share_no_axis():
    def curves(*series):
        return curve_columns(CurveData("t", "x (m)", "y", series))

    a = Series("one, a", np.arange(3.0), np.ones(3))
    b = Series("two", np.arange(3.0) / 2, np.zeros(3))
    short = Series("two", np.arange(2.0), np.zeros(2))
    assert list(curves(a, a)) == ["x (m)", "one; a", "one; a (2)"]
    assert list(curves(a, b)) == ["one; a: x (m)", "one; a", "two: x (m)", "two"]
    long = curves(a, short)
    assert list(long) == ["curve", "x (m)", "y"]
    np.testing.assert_array_equal(long["curve"], [1, 1, 1, 2, 2])
    np.testing.assert_array_equal(long["x (m)"], [0, 1, 2, 0, 1])


def test_digital_numbers_are_written_as_they_are(tmp_path):
    """A camera of 12 bits gives 0 … 4095, and so does its file: nothing is stretched."""
    numbers = np.array([[0.0, 7.0, 4095.0], [1.0, 2048.0, 3.0]])
    np.save(tmp_path / "in.npy", numbers)
    for name in ("o.tif", "o.png"):
        nodes = {
            "in": ("read_image", {"path": "in.npy", "unit": "DN"}),
            "out": ("write_image", {"path": name}),
        }
        NodeBench(tmp_path, nodes).write("out")
        stored = read_pixels(tmp_path / name)
        assert read_info(tmp_path / name).dtype == "uint16"
        np.testing.assert_array_equal(stored, numbers)
        again = {"in": ("read_image", {"path": name})}
        image = NodeBench(tmp_path, again).port("in.image")
        assert image.unit == "DN"


@pytest.mark.parametrize(
    ("params", "numbers", "kind", "stored"),
    [
        ({"path": "o.tif"}, [[0.5, 2.0], [1.0, 3.0]], np.float64, [[0.5, 2.0], [1.0, 3.0]]),
        (
            {"path": "o.tif"}, [[0.0, 2.0**24 - 1], [1.0, 2.0]], np.float64,
            [[0.0, 2.0**24 - 1], [1.0, 2.0]],
        ),
        ({"path": "o.tif", "range_low": 0, "range_high": 10, "dtype": "uint8"}, [[0.0, 5.0]],
         np.uint8, [[0, 128]]),
        ({"path": "o.tif", "dtype": "float"}, [[0.0, 5.0]], np.float32, [[0.0, 5.0]]),
        ({"path": "o.png", "dtype": "uint8"}, [[0.0, 5.0]], np.uint8, [[0, 5]]),
    ],
)  # fmt: skip
def test_numbers_that_are_no_integers_or_given_a_range(tmp_path, params, numbers, kind, stored):
    np.save(tmp_path / "in.npy", np.array(numbers))
    nodes = {
        "in": ("read_image", {"path": "in.npy", "unit": "DN"}), "out": ("write_image", params),
    }  # fmt: skip
    NodeBench(tmp_path, nodes).write("out")
    found = read_pixels(tmp_path / params["path"])
    assert read_info(tmp_path / params["path"]).dtype == np.dtype(kind).name
    np.testing.assert_array_equal(found, stored)


def test_numbers_too_large_for_the_type_are_refused(tmp_path):
    np.save(tmp_path / "in.npy", np.array([[3.0, 300.0]]))
    nodes = {
        "in": ("read_image", {"path": "in.npy", "unit": "DN"}),
        "out": ("write_image", {"path": "o.png", "dtype": "uint8"}),
    }
    bench = NodeBench(tmp_path, nodes)
    with pytest.raises(DataError, match="sample 300 at row 0, column 1 does not fit uint8"):
        bench.write("out")
