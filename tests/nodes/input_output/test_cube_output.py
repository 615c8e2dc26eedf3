"""Bands into ENVI files and back."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.evaluation.policy import Policy
from core.evaluation.work import Work
from cube_files import centres, materials_cube, write_cube
from node_bench import NodeBench
from nodes.files.envi_header import read_layout
from nodes.library import standard_library

LIBRARY = standard_library()

WAVELENGTHS, WIDTH = centres(40)
SIZE = (33, 47)


def reading(folder, sink, *, precision="double", read=()):
    """A cube from a file into Write Image."""
    nodes = {
        "in": ("read_image", {"path": "cube.img", "bands": "all", "fov_x_deg": 2.0, **dict(read)}),
        "out": ("write_image", sink),
    }
    return NodeBench(LIBRARY, folder, nodes, [("in.image", "out.image")], precision=precision)


@pytest.fixture
def cube(tmp_path):
    samples = materials_cube(SIZE, WAVELENGTHS)
    write_cube(tmp_path, samples, WAVELENGTHS, WIDTH, unit="uW/cm^2/sr/nm", order="bil")
    return samples * 10.0  # in W/m²/sr/µm


@pytest.mark.parametrize(
    ("wavelengths", "widths", "total"),
    [
        # Each reaches half-way to its neighbours.
        ([1.0, 1.1, 1.6, 1.7, 2.4], None, [0.1, 0.3, 0.3, 0.4, 0.7]),
        # What two have in common is halved: 3 to 4, 3.5 to 4.5 and 4.3 to 4.7 µm.
        ([3.5, 4.0, 4.5], [1.0, 1.0, 0.4], [0.75, 0.65, 0.3]),
    ],
    ids=["uneven", "overlapping"],
)
def test_bands_that_overlap_have_the_same_sum_when_they_are_read_again(
    tmp_path, wavelengths, widths, total
):
    samples = np.random.default_rng(1).uniform(1, 2, (len(wavelengths), 5, 6))
    write_cube(tmp_path, samples, wavelengths, 1.0)
    header = tmp_path / "cube.img.hdr"
    lines = [line for line in header.read_text().splitlines() if not line.startswith("fwhm")]
    if widths:
        lines.append(f"fwhm = {{{', '.join(map(str, widths))}}}")
    header.write_text("\n".join(lines) + "\n")
    first = reading(tmp_path, {"path": "o.img"})
    want = np.tensordot(total, samples, 1)
    np.testing.assert_allclose(first.value("in.image"), want, rtol=1e-13)
    first.write("out")
    second = reading(tmp_path, {"path": "p.img"}, read={"path": "o.img"})
    np.testing.assert_allclose(second.value("in.image"), want, rtol=1e-13)
    second.write("out")
    third = reading(tmp_path, {"path": "q.img"}, read={"path": "p.img"})
    np.testing.assert_allclose(third.value("in.image"), want, rtol=1e-13)


@pytest.mark.parametrize(("precision", "dtype"), [("single", np.float32), ("double", np.float64)])
@pytest.mark.parametrize(
    "sink", [{"path": "o.img"}, {"path": "o.bsq"}, {"path": "o", "format": "envi"}]
)
def test_bands_come_back_to_rounding(tmp_path, cube, precision, dtype, sink):
    bench = reading(tmp_path, sink, precision=precision)
    data, header = bench.write("out")
    assert header.name == f"{data.name}.hdr"
    assert data.stat().st_size == cube.size * np.dtype(dtype).itemsize
    stored = np.fromfile(data, f"<{np.dtype(dtype).str[1:]}").reshape(cube.shape)
    np.testing.assert_allclose(stored, cube, rtol=2 * np.finfo(dtype).eps)
    again = reading(tmp_path, sink, precision=precision, read={"path": data.name})
    first, second = bench.port("in.image"), again.port("in.image")
    assert second.bands.centres_um == first.bands.centres_um
    np.testing.assert_allclose(second.bands.widths_um, first.bands.widths_um, rtol=1e-12)
    assert second.header.fov_x_deg == pytest.approx(2.0)
    for index in (0, 17, 39):
        assert np.array_equal(again.work.value(second.bands.band(index)), stored[index])


def test_the_header_has_wavelengths_widths_and_unit(tmp_path, cube):
    data, _ = reading(tmp_path, {"path": "o.img"}, precision="single").write("out")
    layout = read_layout(data)
    assert (layout.rows, layout.columns, layout.bands, layout.interleave) == (33, 47, 40, "bsq")
    assert layout.fields["data units"] == "W/m^2/sr/um"
    assert layout.fields["wavelength units"] == "Micrometers"
    assert [float(text) for text in layout.fields["wavelength"]] == WAVELENGTHS.tolist()
    np.testing.assert_allclose([float(text) for text in layout.fields["fwhm"]], WIDTH, rtol=1e-12)


def test_few_bands_are_in_memory_at_a_time(tmp_path, cube, monkeypatch):
    # 40 bands of 33 × 47; what is kept when one is made shows how many there were.
    monkeypatch.setattr("nodes.input_output.write_image._BYTES_AT_ONCE", 33 * 47 * 8 * 3)
    bench = reading(tmp_path, {"path": "o.img"})
    sizes = []
    compute = Work._compute
    monkeypatch.setattr(
        Work, "_compute", lambda *a: [sizes.append(bench.work.store.used_bytes), compute(*a)][1]
    )
    bench.write("out")
    assert len(sizes) >= 40 / 3
    assert max(sizes) <= 4 * 3 * 33 * 47 * 8


def test_other_formats_take_the_sum(tmp_path, cube):
    bench = reading(tmp_path, {"path": "sum.npy"})
    bench.write("out")
    np.testing.assert_allclose(np.load(tmp_path / "sum.npy"), cube.sum(0) * WIDTH, rtol=1e-12)


def test_a_picture_without_bands_is_refused(tmp_path, cube):
    bench = reading(tmp_path, {"path": "o.img"}, read={"bands": "one"})
    error = bench.error("out")
    assert isinstance(error, ParameterError)
    assert "no spectral bands" in str(error)
    assert "\n" not in str(error)


@pytest.mark.parametrize("dtype", ["uint16", "half"])
def test_types_that_no_cube_has_are_refused(tmp_path, cube, dtype):
    error = reading(tmp_path, {"path": "o.img", "dtype": dtype}).error("out")
    assert isinstance(error, ParameterError)
    assert "float, double" in str(error)


def test_a_format_against_the_name_is_refused(tmp_path, cube):
    error = reading(tmp_path, {"path": "o.tif", "format": "envi"}).error("out")
    assert isinstance(error, ParameterError)


def test_a_cube_that_is_broken_leaves_what_was_there(tmp_path, cube):
    holed = cube.copy()
    holed[30, 3, 4] = np.nan
    write_cube(tmp_path, holed, WAVELENGTHS, WIDTH)
    (tmp_path / "o.img").write_bytes(b"before")
    with pytest.raises(DataError, match="row 3, column 4"):
        reading(tmp_path, {"path": "o.img"}).write("out")
    assert (tmp_path / "o.img").read_bytes() == b"before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cube.img", "cube.img.hdr", "o.img"]


def test_a_scene_is_written_and_read_alike(tmp_path):
    values = {"kind": "airfield", "width": 60, "height": 50, "bands": 9, "sun_elevation_deg": 45.0}
    ends = {"cut_on_um": 0.4, "cut_off_um": 2.5}
    nodes = {"in": ("test_scene", {**values, **ends}), "out": ("write_image", {"path": "s.img"})}
    bench = NodeBench(LIBRARY, tmp_path, nodes, [("in.image", "out.image")], precision="single")
    data, _ = bench.write("out")
    read = {"in": ("read_image", {"path": data.name, "bands": "all"})}
    again = NodeBench(LIBRARY, tmp_path, read, precision="single")
    made = again.engine.work(Policy()).value(again.port("in.image").recipe)
    want = bench.value("in.image")
    np.testing.assert_allclose(made, want, rtol=1e-6)
