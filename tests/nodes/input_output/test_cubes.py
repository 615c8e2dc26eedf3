"""Cubes that are read and written."""

import os

import numpy as np
import pytest

from core.errors import DataError, FileError, ParameterError
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from cube_files import PHOTON_J_UM, centres, materials_cube, write_cube
from node_bench import NodeBench, square_detectors


class WrittenMeanwhile(Work):
    """An evaluation during whose first pass over a file another program writes to it."""

    def __init__(self, file):
        super().__init__(Policy(), Store(1 << 20))
        self._file = file

    def for_each(self, function, items):
        super().for_each(function, items)
        with self._file.open("r+b") as file:
            file.write(np.full(1, 9.0, "<f8").tobytes())
        os.utime(self._file, ns=(0, 0))  # another time, however coarse the clock


@pytest.mark.parametrize("wanted", ["picture", "means"])
@pytest.mark.parametrize("missing", ["refuse", "zero", "mean"])
def test_what_is_read_of_a_cube_that_changes_meanwhile_is_refused(tmp_path, missing, wanted):
    path = write_cube(tmp_path, np.ones((3, 8, 9)), np.array([3.5, 4.0, 4.5]), 0.5)
    read = {"path": path.name, "bands": "all", "missing": missing}
    there = NodeBench(tmp_path, {"read": ("read_image", read)})
    image = there.port("read.image")
    with pytest.raises(FileError, match="changed since the network was planned"):
        WrittenMeanwhile(path).value(image.recipe if wanted == "picture" else image.bands.means())


SIZE = (6, 7)
PITCH_UM, F_NUMBER, TIME_S = 15.0, 2.0, 0.002
PER_PHOTON = TIME_S * (PITCH_UM * 1e-6) ** 2 * np.pi / (4 * F_NUMBER**2 + 1)


def bench(folder, *, read, plane=()):
    seen = {"path": "cube.img", "bands": "all", "fov_x_deg": 1.0, "fov_y_deg": 1.0, **read}
    counting = {"integration_time_s": TIME_S, "quantum_efficiency": 1.0}
    nodes = {
        "read": ("read_image", seen),
        "init": ("init_trans", square_detectors(PITCH_UM, 100.0, F_NUMBER, platform="array")),
        "plane": ("focal_plane", {**counting, **dict(plane)}),
    }
    return NodeBench(folder, nodes)


def flat(*levels):
    return np.array(levels)[:, np.newaxis, np.newaxis] * np.ones(SIZE)


@pytest.mark.parametrize("unit", ["W/m^2/sr/um", "photons/s/m^2/sr/um"])
def test_a_band_cut_on_reading_is_counted_whole_behind_a_filter_of_the_same_ends(tmp_path, unit):
    # Bands of 3 to 4 and 4 to 5 µm, of which 3.6 to 4.3 µm are read and let through.
    write_cube(tmp_path, flat(2.0, 5.0), np.array([3.5, 4.5]), 1.0, unit=unit)
    cut = {"cut_on_um": 3.6, "cut_off_um": 4.3}
    there = bench(tmp_path, read=cut, plane=cut)
    assert there.port("read.image").band_um == pytest.approx((3.6, 4.3), rel=1e-14)
    # 0.4 µm about 3.8 µm, 0.3 µm about 4.15 µm.
    photons = 2.0 * 0.4 + 5.0 * 0.3
    if unit.startswith("W"):
        photons = (2.0 * 0.4 * 3.8 + 5.0 * 0.3 * 4.15) / PHOTON_J_UM
    made = there.readouts("plane")["signal_e"]
    assert made == pytest.approx(PER_PHOTON * photons, rel=1e-12)


def test_a_cut_band_counts_by_the_response_within_the_cut(tmp_path):
    write_cube(tmp_path, flat(2.0), np.array([3.5]), 1.0)
    (tmp_path / "qe.csv").write_text("3,0\n4,1\n")
    there = bench(
        tmp_path, read={"cut_on_um": 3.6, "cut_off_um": 4.0}, plane={"response": "qe.csv"}
    )
    want = PER_PHOTON * 2.0 * 0.4 * 0.8 * 3.8 / PHOTON_J_UM  # mean of 0.6 and 1 over 0.4 µm
    assert there.readouts("plane")["signal_e"] == pytest.approx(want, rel=1e-12)


@pytest.mark.parametrize("cut", [{}, {"cut_on_um": 3.0, "cut_off_um": 4.25}])
def test_overlapping_bands_without_a_share_of_wavelength_hold_their_own_width(tmp_path, cut):
    # A spectrum of 2 W/m²/sr/µm all over, measured in bands of 1 µm that overlap by half.
    write_cube(tmp_path, flat(2.0, 2.0), np.array([3.5, 4.0]), 1.0, unit="W/m^2/sr")
    there = bench(tmp_path, read=cut)
    want = 2.0 * ((4.25 if cut else 4.5) - 3.0)
    np.testing.assert_allclose(there.value("read.image"), want, rtol=1e-13)


@pytest.mark.parametrize(
    ("centres", "width", "reach"),
    [
        ([3.5, 4.0], 100.0, "band 0 at 3.5 µm extends from -46.5 to 53.5 µm"),  # nm for µm
        ([3.5, 4.0], 1e-300, "band 0 at 3.5 µm extends from 3.5 to 3.5 µm"),
        ([3.5, 2e6], 1.0, "band 1 at 2e\\+06 µm extends from 2e\\+06 to 2e\\+06 µm"),
    ],
)
def test_a_band_that_reaches_where_no_light_is_is_refused(tmp_path, centres, width, reach):
    write_cube(tmp_path, flat(2.0, 5.0), np.array(centres), width)
    there = bench(tmp_path, read={})
    with pytest.raises(FileError, match=reach):
        raise there.error("read")


WAVELENGTHS, WIDTH = centres(40)
SIZE_CUBE_OUTPUT = (33, 47)


def reading(folder, sink, *, precision="double", read=()):
    """A cube from a file into Write Image."""
    nodes = {
        "in": ("read_image", {"path": "cube.img", "bands": "all", "fov_x_deg": 2.0, **dict(read)}),
        "out": ("write_image", sink),
    }
    return NodeBench(folder, nodes, precision=precision)


@pytest.fixture
def cube(tmp_path):
    samples = materials_cube(SIZE_CUBE_OUTPUT, WAVELENGTHS)
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
