"""MODTRAN's tables: air whose law is known between them, paths from above them, refusals."""

import math
import sys
import types

import numpy as np
import pytest

from core.errors import ParameterError
from node_bench import NodeBench
from nodes.atmosphere.atmospheric_path import table_path

R = 6378.137
WAVELENGTH = np.linspace(0.3, 14.0, 1371)
BETA = 0.02 + 0.1 / WAVELENGTH  # 1/km
LIGHT = 3.0 + WAVELENGTH  # W/m²/sr/µm, of the air itself


def chord_km(height, ground):
    """Between two points given by their coordinates."""
    turn = ground / R
    return math.hypot(R * math.sin(turn), R + height - R * math.cos(turn))


@pytest.fixture
def tables(monkeypatch):
    """pyBSM's function for air with the same extinction everywhere, over the ground to 300 km."""
    asked = []

    def load(*, altitude, ground_range, ihaze):
        height, ground = altitude / 1e3, ground_range / 1e3
        asked.append((height, ground, ihaze))
        if ground > R * math.acos(R / (R + height)):
            raise IndexError
        passed = np.exp(-BETA * ihaze * chord_km(height, ground))
        light = LIGHT * (1.0 - passed) * 1e6
        return np.stack([1e-6 * WAVELENGTH, passed, 0.3 * light, 7 * light, 0.7 * light, light], 1)

    module = types.ModuleType("pybsm.utils")
    module.load_database_atmosphere_no_interp = load
    monkeypatch.setitem(sys.modules, "pybsm", types.ModuleType("pybsm"))
    monkeypatch.setitem(sys.modules, "pybsm.utils", module)
    table_path.cache_clear()
    yield asked
    table_path.cache_clear()


@pytest.mark.parametrize(
    ("height", "ground", "ihaze"), [(5, 10, 1), (0.05, 0.3, 2), (7.7, 33, 1), (22, 152.5, 2)]
)
def test_uniform_air_is_exact_between_the_tables(tables, height, ground, ihaze):
    length = chord_km(height, ground)
    transmission, radiance = table_path(height_km=height, range_km=length, ihaze=ihaze)
    expected = np.exp(-BETA * ihaze * length)
    np.testing.assert_allclose(np.array(transmission), np.stack([WAVELENGTH, expected], 1),
                               rtol=1e-9, atol=1e-29)  # fmt: skip
    np.testing.assert_allclose(np.array(radiance)[:, 1], LIGHT * (1 - expected), rtol=1e-8)
    assert max(abs(h - height) for h, _, _ in tables) < 0.4 * height + 1.01
    assert len(tables) == (1 if height == 5 else 4)


def test_a_satellite_sees_the_air_below_the_highest_table(tables):
    """600 km up, 30° off nadir: the length to 24.5 km height, by the elevation of 56.84°."""
    sine = math.sin(math.acos(math.sin(math.radians(30)) * (R + 600) / R))
    slant, length = (
        math.sqrt((R * sine) ** 2 + 2 * R * h + h * h) - R * sine for h in (600.0, 24.5)
    )
    transmission, _ = table_path(height_km=600.0, range_km=slant, ihaze=1)
    np.testing.assert_allclose(np.array(transmission)[:, 1], np.exp(-BETA * length), rtol=1e-9)


@pytest.mark.parametrize(
    ("height", "length", "words"),
    [
        (0.001, 1.0, "altitude_m = 1.0 m.*2 or more"),
        (5.0, 4.0, "range_m = 4000.0 m.*at least the altitude, 5000 m"),
        (0.002, 5.5, "not beyond the horizon"),
        (20.0, 310.0, "at most 300 km along the ground"),
        (600.0, 2750.0, "not beyond the horizon"),
        (5.0, 2e4, "not beyond the horizon"),
    ],
)
def test_paths_outside_the_tables(tables, height, length, words):
    with pytest.raises(ParameterError, match=words):
        table_path(height_km=height, range_km=length, ihaze=1)


def planned(folder, params, camera=None):
    np.save(folder / "in.npy", np.full((2, 3), 20.0))
    read = {"path": "in.npy", "fov_x_deg": 1, "fov_y_deg": 1, "cut_on_um": 4, "cut_off_um": 5}
    nodes = {"read": ("read_image", read), "camera": ("camera", camera or {}),
             "air": ("atmospheric_path", {"model": "modtran_tables", **params})}  # fmt: skip
    return NodeBench(folder, nodes)


def test_the_module_takes_the_orbit_of_the_camera(tables, tmp_path):
    bench = planned(tmp_path, {"haze": "rural_5_km"}, {"altitude_km": 500})
    assert bench.plan.errors() == []
    assert [caution for caution in bench.plan.warnings() if caution.node == "air"] == []
    found = bench.readouts("air")
    least, most = np.exp(-2 * 24.5 * (0.02 + 0.1 / np.array([4, 5])))
    assert least < found["transmission"] < most
    given = {"altitude_m": 9000, "air_K": 280, "range_m": 2e4}
    plan = planned(tmp_path, given, {"altitude_km": 500}).plan
    words = " ".join(str(caution) for caution in plan.warnings())
    assert "air_K = 280 K is not used: the MODTRAN tables contain the path radiance" in words
    assert "altitude_m = 9000 m here but 5e+05 m on Camera" in words


def test_without_pybsm_the_extra_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "pybsm.utils", None)
    table_path.cache_clear()
    plan = planned(tmp_path, {"altitude_m": 3000, "range_m": 4000}).plan
    (text,) = map(str, plan.errors())
    assert text.startswith("air: model = modtran_tables needs the package pybsm: run pip install")
    assert "[atmosphere]" in text
