"""Bands into ENVI files and back."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.evaluation.work import Work
from cube_files import centres, materials_cube, write_cube
from node_bench import NodeBench
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


def test_a_picture_without_bands_is_refused(tmp_path, cube):
    bench = reading(tmp_path, {"path": "o.img"}, read={"bands": "one"})
    error = bench.error("out")
    assert isinstance(error, ParameterError)
    assert "no spectral bands" in str(error)
    assert "\n" not in str(error)


def test_a_cube_that_is_broken_leaves_what_was_there(tmp_path, cube):
    holed = cube.copy()
    holed[30, 3, 4] = np.nan
    write_cube(tmp_path, holed, WAVELENGTHS, WIDTH)
    (tmp_path / "o.img").write_bytes(b"before")
    with pytest.raises(DataError, match="row 3, column 4"):
        reading(tmp_path, {"path": "o.img"}).write("out")
    assert (tmp_path / "o.img").read_bytes() == b"before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cube.img", "cube.img.hdr", "o.img"]
