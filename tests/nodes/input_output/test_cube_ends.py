"""Where the bands of a cube lie and what they hold: cut ones, and overlapping ones in W/m²/sr."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import FileError
from cube_files import PHOTON_J_UM, write_cube
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()

SIZE = (6, 7)
PITCH_UM, F_NUMBER, TIME_S = 15.0, 2.0, 0.002
PER_PHOTON = TIME_S * (PITCH_UM * 1e-6) ** 2 * np.pi / (4 * F_NUMBER**2 + 1)


def bench(folder, *, read, plane=()):
    nodes = {
        "read": (
            "read_image",
            {"path": "cube.img", "bands": "all", "fov_x_deg": 1.0, "fov_y_deg": 1.0, **read},
        ),
        "init": (
            "init_trans",
            {
                "detector_x_um": PITCH_UM,
                "detector_y_um": PITCH_UM,
                "focal_length_mm": 100.0,
                "f_number": F_NUMBER,
                "platform": "array",
            },
        ),
        "plane": (
            "focal_plane",
            {"integration_time_s": TIME_S, "quantum_efficiency": 1.0, **dict(plane)},
        ),
    }
    return NodeBench(LIBRARY, folder, nodes)


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
