"""MTF File: against the modules whose curves its tables hold, in every unit, and what it refuses.

Pictures differ by less than the largest error of the interpolated curve times the picture's
contrast (Parseval).
"""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from node_bench import NodeBench

SCENE = {"kind": "siemens_star", "width": 96, "height": 80, "fov_x_deg": 1.5, "fov_y_deg": 1.4}
FOCAL_LENGTH_MM, PITCH_X_UM, PITCH_Y_UM = 120.0, 36.0, 30.0
SENSOR = {
    "focal_length_mm": FOCAL_LENGTH_MM,
    "detector_x_um": PITCH_X_UM,
    "detector_y_um": PITCH_Y_UM,
    "f_number": 2.0,
}
UNITS = {
    "cyc/mrad": 1.0,
    "cyc/mm": 1000.0 / FOCAL_LENGTH_MM,
    "cyc/pixel": PITCH_X_UM / FOCAL_LENGTH_MM,
}


def plan_of(folder, key, params, *, init=SENSOR):
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", init),
        "it": (key, params),
        "back": ("back_transform", {}),
    }
    return NodeBench(folder, nodes, tolerance=0.0)


def picture(folder, key, params, port="back.image", **how):
    return plan_of(folder, key, params, **how).value(port)


def refusal(folder, text, **params):
    path = folder / "lens.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    bench = plan_of(folder, "mtf_file", {"path": "lens.csv", **params})
    return bench.refusal("back.image", "it")


def table(folder, frequencies, unit="cyc/mrad", **columns):
    lines = [f"frequency ({unit})," + ",".join(columns)]
    rows = np.column_stack([frequencies, *columns.values()]).tolist()
    lines += [",".join(map(repr, row)) for row in rows]
    (folder / "lens.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return {"path": "lens.csv"}


def gaussian(f, sigma):
    return np.exp(-2 * (np.pi * sigma * f) ** 2)


def curve(points=40, last=4.0, sigma=0.34):
    """Frequencies up to where a Gaussian is 0, and the interpolation's largest error, by scipy."""
    f = np.linspace(0.0, last, points)
    dense = np.linspace(0.0, last, 20001)
    pchip = PchipInterpolator(f, gaussian(f, sigma))
    return f, float(np.abs(pchip(dense) - gaussian(dense, sigma)).max())


@pytest.mark.parametrize(("points", "expected"), [(20, 1e-2), (80, 5e-4), (320, 3e-5)])
def test_a_table_of_a_curve_is_that_curve_to_the_interpolation_error(tmp_path, points, expected):
    """The error falls with the square of the points' distance: where the curve starts level."""
    f, error_x = curve(points)
    error_y = curve(points, sigma=0.2)[1]
    assert error_y < error_x < expected
    params = table(tmp_path, f, mtf_x=gaussian(f, 0.34), mtf_y=gaussian(f, 0.2))
    wanted = picture(tmp_path, "gaussian_mtf", {"sigma_x_mrad": 0.34, "sigma_y_mrad": 0.2})
    got = picture(tmp_path, "mtf_file", params)
    contrast = picture(tmp_path, "mtf_file", {}, port="scene.image").std()
    assert np.sqrt(np.mean((got - wanted) ** 2)) < (error_x + error_y) * contrast


@pytest.mark.parametrize("column", ["mtf", "radial"])
def test_a_radial_table_is_round(tmp_path, column):
    f, error = curve(160)
    params = table(tmp_path, f, **{column: gaussian(f, 0.34)})
    sigma = {"sigma_x_mrad": 0.34, "sigma_y_mrad": 0.34}
    wanted, got = (
        picture(tmp_path, *what, port="it.mtf")
        for what in (("gaussian_mtf", sigma), ("mtf_file", params))
    )
    np.testing.assert_allclose(got, wanted, atol=error)


@pytest.mark.parametrize("column", ["mtf_x", "radial"])
@pytest.mark.parametrize("unit", ["cyc/mm", "cyc/pixel"])
def test_one_curve_in_every_unit_is_one_picture(tmp_path, column, unit):
    """Pixels here are squares, so that what is round by the pixel is round in angle too."""
    init = {**SENSOR, "detector_y_um": PITCH_X_UM}
    f, _ = curve()
    params = table(tmp_path, f, **{column: gaussian(f, 0.34)})
    wanted = picture(tmp_path, "mtf_file", params, init=init)
    params = table(tmp_path, f * UNITS[unit], unit, **{column: gaussian(f, 0.34)})
    got = picture(tmp_path, "mtf_file", params, init=init)
    np.testing.assert_allclose(got, wanted, rtol=1e-12)
    own = {"focal_length_mm": FOCAL_LENGTH_MM, "detector_x_um": PITCH_X_UM,
           "detector_y_um": PITCH_X_UM}  # fmt: skip
    np.testing.assert_array_equal(picture(tmp_path, "mtf_file", {**params, **own}, init={}), got)


@pytest.mark.parametrize("direction", ["x", "y"])
def test_direction_of_one_curve(tmp_path, direction):
    f, _ = curve(160)
    named = picture(
        tmp_path, "mtf_file", table(tmp_path, f, **{f"mtf_{direction}": gaussian(f, 0.3)})
    )
    params = table(tmp_path, f, mtf=gaussian(f, 0.3))
    set_here = picture(tmp_path, "mtf_file", {**params, "direction": direction})
    np.testing.assert_array_equal(named, set_here)
    both = table(tmp_path, f, mtf_x=gaussian(f, 0.3), mtf_y=gaussian(f, 0.3))
    chosen = picture(tmp_path, "mtf_file", {**both, "direction": direction})
    np.testing.assert_array_equal(named, chosen)


@pytest.mark.parametrize("unit", ["rad", "deg"])
def test_a_phase_shifts_the_picture(tmp_path, unit):
    """−2π·f·s delays to +x: by 3 samples here; edges periodic, so that it is a roll of the rows."""
    interval = np.radians(SCENE["fov_x_deg"]) * 1000 / SCENE["width"]
    f = np.linspace(0.0, 2.5, 60)
    phase = -2 * np.pi * f * 3 * interval
    name = f"phase_x ({unit})" if unit == "deg" else "phase_x"
    wrapped = np.angle(np.exp(1j * phase))
    columns = {"mtf_x": np.ones(60), name: np.degrees(wrapped) if unit == "deg" else wrapped}
    params = table(tmp_path, f, **columns)
    init = {**SENSOR, "edges": "periodic"}
    scene, got = (
        picture(tmp_path, "mtf_file", params, port=port, init=init)
        for port in ("scene.image", "back.image")
    )
    # At Nyquist only the real part of a phase acts: the row's alternating part is left out.
    wanted, signs = np.roll(scene, 3, axis=1), (-1.0) ** np.arange(SCENE["width"])
    got, wanted = (one - np.outer((one * signs).mean(axis=1), signs) for one in (got, wanted))
    np.testing.assert_allclose(got, wanted, rtol=1e-9)


def test_zemax_listing(tmp_path):
    """Headings as its readers expect them, in UTF-16; tangential is along y."""
    text = (
        "Polychromatic Diffraction MTF\r\n\r\nFile : C:\\lens.ZMX\r\nTitle: a\r\n"
        "Date : 1/1/2026\r\n\r\n\r\nData for 3.7000 to 4.8000 µm.\r\n"
        "Spatial Frequency units are cycles per mm.\r\n\r\n"
        "Field: Diffraction limit\r\nSpatial frequency    Tangential    Sagittal\r\n"
        "  0.000000   1.000000   1.000000\r\n 10.000000   0.900000   0.900000\r\n\r\n"
        "Field: 0.00 (deg)\r\nSpatial frequency    Tangential    Sagittal\r\n"
        "  0.000000   1.000000   1.000000\r\n 10.000000   0.800000   0.800000\r\n\r\n"
        "Field: 2.00 (deg)\r\nSpatial frequency    Tangential    Sagittal\r\n"
        "  0.000000   1.000000   1.000000\r\n 10.000000   0.500000   0.700000\r\n"
        " 20.000000   0.000000   0.300000\r\n"
    )
    (tmp_path / "mtf.txt").write_bytes(text.encode("utf-16"))
    bench = plan_of(tmp_path, "mtf_file", {"path": "mtf.txt", "field": 1})
    x, y = (dict(law.parameters) for law in bench.port("it.mtf").factors[0].laws)
    assert x["frequencies"] == y["frequencies"] == (0.0, 10.0, 20.0)
    assert (x["values"], y["values"]) == ((1.0, 0.7, 0.3), (1.0, 0.5, 0.0))
    assert bench.readouts("it")["end_x"] == pytest.approx(20.0 * FOCAL_LENGTH_MM / 1000)
    law = plan_of(tmp_path, "mtf_file", {"path": "mtf.txt"}).port("it.mtf").factors[0].x
    assert dict(law.parameters)["values"] == (1.0, 0.8)  # not the limit's 0.9
    error = plan_of(tmp_path, "mtf_file", {"path": "mtf.txt", "field": 2}).plan.errors()[0]
    assert "no field 2 in this listing; allowed: 0 to 1" in str(error)


GOOD = "frequency (cyc/mm),mtf\n0,1\n10,0.5\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the file is empty"),
        ("# nothing\n", "contains no table"),
        ("frequency (cyc/mm)\n0\n1\n", "line 1: must contain column names"),
        ("0,1\n10,0.5\n", "line 1: must contain column names: frequency with its unit"),
        ("frequency (cyc/mm),mtf\n0,1\n", "1 point; a curve needs at least 2"),
        ("frequency (cyc/mm),mtf\n0,1\n10,nan\n", "line 3: must contain an MTF from 0 to 2"),
        ("frequency (cyc/mm),mtf\nnan,1\n10,1\n", "line 2: must contain a frequency from 0"),
        ("frequency (cyc/mm),mtf\n0,1\n10,.5\n5,.7\n", "line 4: must contain a frequency above"),
        ("frequency (cyc/mm),mtf\n0,1\n10,-.5\n", "to 2; write a negative lobe"),
        ("frequency (cyc/mm),mtf\n0,100\n10,50\n", "divide percentages by 100"),
        ("frequency (cyc/mm),mtf\n0,1\n10,half\n", "line 3: must contain 2 numbers"),
        ("frequency (cyc/mm),mtf\n0,1\n10\n", "line 3: must contain 2 numbers: frequency, mtf"),
        ("frequency,mtf\n0,1\n10,0.5\n", "frequency_unit = 'file'"),
        ("frequency (cyc/inch),mtf\n0,1\n10,0.5\n", "cyc/mm, cyc/mrad or cyc/pixel"),
        ("frequency (cyc/mm),mtfx\n0,1\n10,0.5\n", "must contain column names"),
        ("frequency (cyc/mm),phase_x\n0,0\n10,0.5\n", "at least one of them for an MTF"),
        ("frequency (cyc/mm),mtf,mtf_x\n0,1,1\n1,1,1\n", "either mtf or mtf_x, not both"),
        ("frequency (cyc/mm),mtf,phase\n0,1,0\n1,1,1\n", "a phase needs a direction"),
        ("frequency (cyc/mm),mtf,phase_x\n0,1,1\n1,1,1\n", "column phase_x: the table has 1 at"),
        ("frequency (cyc/mm),mtf\n0,0.9\n10,0.5\n", "0.9 at frequency 0; allowed: 1 ± 0.001"),
        ("frequency (cyc/mm),mtf_x,radial\n0,1,1\n10,0.5,.5\n", "direction = 'file'"),
        (bytes(range(256)) * 40, "not a text file with frequency and MTF columns"),
        (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "not a text file with frequency"),
        ("frequency (cyc/mm),mtf\n" + "0,1\n" * 3_000_000, "12000023 bytes; a table of"),
    ],
)  # fmt: skip
def test_bad_files_are_one_clear_line(tmp_path, text, words):
    message = refusal(tmp_path, text)
    assert words in message
    assert "lens.csv" in message
    assert len(message) < 400


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"direction": "y"}, ""),
        ({"frequency_unit": "cyc/mrad"}, "the table lens.csv is in cyc/mm; choose cyc/mm or file"),
    ],
)
def test_what_does_not_fit_the_file(tmp_path, params, words):
    text = GOOD.replace("mtf", "mtf_x") if "direction" in params else GOOD
    message = refusal(tmp_path, text, **params)
    assert words in message
    assert next(iter(params)) in message


def test_normalised_by_its_value_at_zero(tmp_path):
    (tmp_path / "lens.csv").write_text("frequency (cyc/mrad);mtf_x\n0;0.8\n10;0.4\n20;0\n")
    bench = plan_of(tmp_path, "mtf_file", {"path": "lens.csv", "normalise": "at_zero"})
    law = bench.port("it.mtf").factors[0].x
    assert dict(law.parameters)["values"] == (1.0, 0.5, 0.0)


def cautions(folder, params, **how):
    plan = plan_of(folder, "mtf_file", params, **how).plan
    assert plan.errors() == []
    return {caution.check: caution.text for caution in plan.nodes["it"].warnings}


@pytest.mark.parametrize(
    ("last", "end", "warned"), [(1.0, 0.3, True), (1.0, 0.01, False), (3.0, 0.3, False)]
)
def test_warns_of_a_table_that_ends_before_the_picture_does(tmp_path, last, end, warned):
    """The picture's Nyquist frequency across is 96/(2·26.18 mrad) = 1.833 cyc/mrad."""
    found = cautions(tmp_path, table(tmp_path, [0.0, last], mtf_x=[1.0, end]))
    assert set(found) == ({"end"} if warned else set())
    if warned:
        assert "MTF is 0.3 where the table ends (1 cyc/mrad)" in found["end"]
        assert "1.833 cyc/mrad" in found["end"]


def test_warns_of_what_amplifies_of_no_file_and_of_another_geometry(tmp_path):
    params = table(tmp_path, [0.0, 1.0, 4.0], mtf=[1.0, 1.25, 0.0])
    found = cautions(tmp_path, params)
    assert set(found) == {"above_one"}
    assert "rises to 1.25" in found["above_one"]
    assert "path is empty" in cautions(tmp_path, {})["no_file"]
    params = table(tmp_path, [0.0, 40.0], "cyc/mm", mtf=[1.0, 0.0])
    found = cautions(tmp_path, {**params, "focal_length_mm": 150.0})
    assert "focal_length_mm = 150 mm here but 120 mm on Init & Trans" in found["geometry"]
    assert "geometry" not in cautions(tmp_path, {**params, "focal_length_mm": 120.0})
