"""Line by Line."""

import cmath
import math
import re

import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.network.network import Link, Network, Node
from delivered_chains import scene
from linked_network import linked_network
from node_bench import NodeBench

ACROSS, ALONG = 90.0, 70.0  # mrad from sample to sample: a few of them are a wide field
SIGMA_X, SIGMA_Y = 55.0, 80.0
PITCH_X, PITCH_Y, FOCAL = 100.0, 120.0, 1.0
TRANSFERS, EFFICIENCY = 3, 0.8
VELOCITY_X, VELOCITY_Y, RANGE_M, TIME = 30.0, 50.0, 100.0, 0.2
CUTOFF = 0.009  # cycles/mrad of the round aperture, beyond Nyquist at nadir
INIT = {
    "detector_x_um": PITCH_X, "detector_y_um": PITCH_Y, "focal_length_mm": FOCAL,
    "range_m": RANGE_M,
}  # fmt: skip
APERTURE_CM = CUTOFF * 10 / 10  # cutoff × 10 µm in mm, in cm
OPTICS = {
    "cut_on_um": 10, "cut_off_um": 10, "size_x_cm": 2 * APERTURE_CM, "size_y_cm": 2 * APERTURE_CM,
}  # fmt: skip
# At the detector's own frequencies: an angle that is the same in every column.
CHARGE = {"detectors_per_line": TRANSFERS, "efficiency": EFFICIENCY, "nyquist": "detector"}
STAGES = {
    "blur": ("gaussian_mtf", {"sigma_x_mrad": SIGMA_X, "sigma_y_mrad": SIGMA_Y}),
    "pixel": ("detector_mtf", {}),
    "left": ("charge_eff_mtf", CHARGE),
    "late": ("charge_eff_phase", CHARGE),
    "smear": ("relative_motion_mtf", {
        "image_velocity_x": VELOCITY_X, "platform_velocity_y": VELOCITY_Y, "model": "line",
        "integration_time_s": TIME,
    }),
    "optics": ("exit_pupil_mtf", OPTICS),
    "coma": ("exit_pupil_mtf", OPTICS),
}  # fmt: skip
_PUPIL = {"size_x": 64, "size_y": 64, "radius": 16}
PUPILS = {"optics": _PUPIL, "coma": {**_PUPIL, "zernike_waves": [0, 0, 0, 0.1, 0, 0, 0.2, 0.15]}}


def _sinc(x):
    return 1.0 if x == 0 else math.sin(math.pi * x) / (math.pi * x)


def _round(v):
    v = min(v, 1.0)
    return 2 / math.pi * (math.acos(v) - v * math.sqrt(1 - v * v))


def _charge(xi):
    w = 2 * math.pi * xi * PITCH_X / FOCAL
    return (EFFICIENCY / (1 - (1 - EFFICIENCY) * cmath.exp(-1j * w))) ** TRANSFERS


SMEAR_X = -VELOCITY_X * TIME / RANGE_M * 1000  # platform less image
SMEAR_Y = VELOCITY_Y * TIME / RANGE_M * 1000
ANALYTIC = {
    "blur": lambda xi, eta: math.exp(
        -2 * math.pi**2 * ((SIGMA_X * xi) ** 2 + (SIGMA_Y * eta) ** 2)
    ),
    "pixel": lambda xi, eta: _sinc(PITCH_X / FOCAL * xi) * _sinc(PITCH_Y / FOCAL * eta),
    "left": lambda xi, _: abs(_charge(xi)),
    "late": lambda xi, _: _charge(xi) / abs(_charge(xi)),
    "smear": lambda xi, eta: _sinc(SMEAR_X * xi + SMEAR_Y * eta),
    "optics": lambda xi, eta: _round(math.hypot(xi, eta) / CUTOFF),
}


def column_by_column(picture, laws, edges, scan="x"):
    """Every column (row, for a scan along y) of the frame at its own interval in flight."""
    rows, columns = picture.shape
    found = np.zeros(picture.shape)
    for place in range(columns if scan == "x" else rows):
        middle = ((columns if scan == "x" else rows) - 1) / 2
        angle = (place - middle) * (ACROSS if scan == "x" else ALONG) / 1000
        nearer = 1 / math.hypot(1.0, math.tan(angle))  # altitude over range
        if scan == "x":
            steps = ACROSS, ALONG * nearer
            found[:, place] = _whole(picture, laws, edges, steps, columns=[place])[:, 0]
        else:
            steps = ACROSS * nearer, ALONG
            found[place] = _whole(picture, laws, edges, steps, rows=[place])[0]
    return found


def _whole(picture, laws, edges, steps, rows=None, columns=None):
    """Samples of the frame filtered at one pair of intervals, frequency by frequency."""
    frame = picture
    if edges == "reflect":
        frame = np.vstack([frame, frame[::-1]])
        frame = np.hstack([frame, frame[:, ::-1]])
    high, wide = frame.shape
    rows = range(picture.shape[0]) if rows is None else rows
    columns = range(picture.shape[1]) if columns is None else columns
    y, x = np.arange(high), np.arange(wide)
    total = np.zeros((len(rows), len(columns)), complex)
    for j in range(high):
        for k in range(wide):
            wave_y, wave_x = np.exp(-2j * np.pi * j * y / high), np.exp(-2j * np.pi * k * x / wide)
            amplitude = wave_y @ frame @ wave_x / frame.size
            response = _at(laws, j, k, high, wide, steps)
            back = np.outer(wave_y.conj()[list(rows)], wave_x.conj()[list(columns)])
            total += amplitude * response * back
    return total.real


def _at(laws, j, k, high, wide, steps):
    """H at index (j, k); where that is Nyquist, the mean over both of its signs."""
    etas, xis = (
        [index] if 2 * index < size else [index - size] if 2 * index > size else [index, -index]
        for index, size in ((j, high), (k, wide))
    )
    both = [
        math.prod([law(xi / (wide * steps[0]), eta / (high * steps[1])) for law in laws])
        for eta in etas for xi in xis
    ]  # fmt: skip
    return sum(both) / len(both)


EXACT, SINGLE = {"precision": "double", "tolerance": 0.0}, {"precision": "single"}
CHAINS = {
    "separable": ("blur", "pixel"),
    "phase": ("blur", "left", "late"),
    "optics": ("optics", "pixel"),
    "optics and phase": ("optics", "pixel", "left", "late"),
    "line smear": ("smear", "blur"),
    "line smear and phase": ("smear", "pixel", "left", "late"),
}
DEFAULT_CHAINS = {**CHAINS, "coma and phase": ("coma", "left", "late"), "nothing": ()}


def network(stages, shape, edges="reflect", init=None, **params):
    """A picture file through the stages, to Back Transform and to Line by Line."""
    fields = {"fov_x_deg": math.degrees(ACROSS * shape[1]) / 1000,
              "fov_y_deg": math.degrees(ALONG * shape[0]) / 1000}  # fmt: skip
    nodes = {
        "file": ("read_image", {"path": "in.npy"}),
        "init": ("init_trans", {**INIT, **fields, "edges": edges, **(init or {})}),
    }
    for stage in stages:
        if stage in PUPILS:
            nodes[f"{stage} pupil"] = ("exit_pupil", PUPILS[stage])
        nodes[stage] = STAGES[stage]
    nodes |= {"back": ("back_transform", {}), "lines": ("line_by_line", params)}
    return linked_network(nodes)


def values(folder, picture, stages, ports=("image",), policy=EXACT, **settings):
    np.save(folder / "in.npy", picture)
    bench = NodeBench(folder, network(stages, picture.shape, **settings), **policy)
    return tuple(bench.value(port if "." in port else f"lines.{port}") for port in ports)


SIZES = [(12, 9), (11, 10), (8, 13), (1, 6), (7, 1)]
EDGES = ["reflect", "periodic"]
METHODS = ["nodes", "direct"]
SCANS = ["x", "y"]


@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("scan", SCANS)
class TestSumsWrittenOut:
    """The frame extended, each column at its own interval, every sum a loop in the test."""

    @pytest.mark.thorough(but=29)
    def test_direct(self, tmp_path, size, chain, edges, scan):
        picture = scene(*size)
        expected = column_by_column(picture, [ANALYTIC[s] for s in CHAINS[chain]], edges, scan)
        (found,) = values(tmp_path, picture, CHAINS[chain], edges=edges, scan=scan, method="direct")
        assert np.abs(found - expected).max() <= 1e-12 * expected.max()

    @pytest.mark.thorough(but=29)
    def test_nodes(self, tmp_path, size, chain, edges, scan):
        """As far off as the module says, which for factors that separate is not at all."""
        picture = scene(*size)
        expected = column_by_column(picture, [ANALYTIC[s] for s in CHAINS[chain]], edges, scan)
        found, table = values(
            tmp_path, picture, CHAINS[chain], ("image", "table"), edges=edges, scan=scan
        )
        table = table.as_dict()
        planar = "optics" in chain or "smear" in chain
        assert (table["scale_nodes"] > 0) == planar
        allowed = 1e-12 * expected.max()
        if planar:
            span = np.ptp(values(tmp_path, picture, CHAINS[chain], ("whole",), edges=edges)[0])
            allowed += 2 * max(table["error_percent"] / 100, 1e-5) * span
        assert np.abs(found - expected).max() <= allowed


@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("chain", DEFAULT_CHAINS)
@pytest.mark.parametrize("size", [(12, 9), (9, 14), (1, 1)], ids=str)
@pytest.mark.parametrize("scan", SCANS)
@pytest.mark.parametrize("method", METHODS)
class TestEvenSampling:
    @pytest.mark.thorough(but=47)
    def test_is_the_whole_image_way(self, tmp_path, size, chain, edges, scan, method):
        """An array samples evenly: both ways agree to 1e-12."""
        found, whole, gap, table = values(
            tmp_path, scene(*size), DEFAULT_CHAINS[chain], ("image", "back.image", "difference",
            "table"), edges=edges, scan=scan, method=method, init={"platform": "array"},
        )  # fmt: skip
        np.testing.assert_allclose(found, whole, rtol=0, atol=1e-12 * whole.max())
        assert np.abs(gap).max() <= 1e-12 * whole.max()
        told = table.as_dict()
        assert told["interval_nadir_mrad"] == told["interval_edge_mrad"]
        assert told["max_percent"] <= 1e-10


@pytest.mark.thorough(but=11)
@pytest.mark.parametrize("edges", EDGES)
@pytest.mark.parametrize("scan", SCANS)
@pytest.mark.parametrize("chain", DEFAULT_CHAINS)
def test_each_column_is_back_transforms_at_its_interval(tmp_path, chain, edges, scan):
    """Whole frames with the field of view that the column's own interval makes."""
    picture = scene(12, 9)
    (found,) = values(
        tmp_path, picture, DEFAULT_CHAINS[chain], edges=edges, scan=scan, method="direct"
    )
    count, across, along, name = {
        "x": (9, ACROSS, ALONG * 12, "fov_y_deg"), "y": (12, ALONG, ACROSS * 9, "fov_x_deg")
    }[scan]  # fmt: skip
    for place in range(count):
        cosine = 1 / math.hypot(1, math.tan((place - (count - 1) / 2) * across / 1000))
        field = {name: math.degrees(along * cosine) / 1000}
        (whole,) = values(
            tmp_path, picture, DEFAULT_CHAINS[chain], ("back.image",), edges=edges, init=field
        )
        line = (slice(None), place) if scan == "x" else (place, slice(None))
        np.testing.assert_allclose(found[line], whole[line], rtol=0, atol=1e-12 * whole.max())


class TestEstimate:
    """The error that the module tells of its blend, against direct sums."""

    @pytest.mark.parametrize("edges", EDGES)
    @pytest.mark.parametrize("chain", ["optics and phase", "line smear", "coma and phase"])
    def test_closes_in_and_is_honest(self, tmp_path, chain, edges):
        picture = scene(24, 32)
        stages = DEFAULT_CHAINS[chain]
        # Half as far apart, for a field of 82°; the columns have 32 intervals in flight.
        init = {"fov_x_deg": 82.0}
        exact, whole = values(
            tmp_path, picture, stages, ("image", "whole"), edges=edges, method="direct", init=init
        )
        errors = []
        for count in (1, 2, 4, 8):
            found, table = values(
                tmp_path, picture, stages, ("image", "table"), edges=edges, nodes=count, init=init
            )
            table = table.as_dict()
            assert table["scale_nodes"] == count
            errors.append(np.abs(found - exact).max() / np.ptp(whole))
            told = table["error_percent"] / 100
            assert 0.2 * errors[-1] <= told <= 50 * errors[-1]
            # By Parseval's theorem; the transfer function errs by no more than is told.
            rms = np.sqrt(np.mean((found - exact) ** 2))
            assert rms <= 1.5 * table["response_error"] * picture.std()
        assert errors[0] > errors[1] > errors[2] > errors[3] > 0.0
        if chain == "line smear":  # a smooth law; the others end at their cutoff with a kink
            assert errors[0] > 10 * errors[1] > 100 * errors[2] > 1e6 * errors[3]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("chain", ["separable", "optics and phase", "line smear and phase"])
def test_single_precision_is_near_double(tmp_path, chain, method):
    picture = scene(40, 33)
    exact, single = (
        values(tmp_path, picture, CHAINS[chain], policy=policy, method=method, nodes=6)[0]
        for policy in (EXACT, SINGLE)
    )
    assert np.abs(single - exact).max() <= 2e-6 * exact.max()


@pytest.mark.parametrize("method", METHODS)
def test_the_bits_do_not_depend_on_threads(tmp_path, method):
    picture, wide = scene(150, 140), {"fov_x_deg": 90.0, "fov_y_deg": 90.0}
    stages = CHAINS["optics and phase"]
    one, three = (
        values(tmp_path, picture, stages, policy={**SINGLE, "threads": n}, method=method, init=wide)
        for n in (1, 3)
    )
    np.testing.assert_array_equal(one, three)


class TestGeometry:
    """Intervals and places by hand: 12 × 9 samples, 90 mrad apart along the scan."""

    def told(self, folder, **settings):
        (table,) = values(folder, scene(12, 9), ("blur",), ("table",), **settings)
        return table.as_dict()

    def test_lines_at_nadir_as_far_apart_as_the_frames(self, tmp_path):
        told = self.told(tmp_path)
        assert told["interval_nadir_mrad"] == pytest.approx(ALONG, rel=1e-12)
        assert told["interval_edge_mrad"] == pytest.approx(ALONG * math.cos(0.36), rel=1e-12)
        assert told["view_first_deg"] == pytest.approx(-math.degrees(0.36), rel=1e-12)
        assert told["view_last_deg"] == pytest.approx(math.degrees(0.36), rel=1e-12)

    def test_scan_down_the_frame(self, tmp_path):
        told = self.told(tmp_path, scan="y")
        assert told["interval_nadir_mrad"] == pytest.approx(ACROSS * math.cos(0.035), rel=1e-12)
        assert told["interval_edge_mrad"] == pytest.approx(ACROSS * math.cos(0.385), rel=1e-12)

    def test_spacing_of_the_flight(self, tmp_path):
        """60 m/s and 10 turns a second: 6 m, at 100 m 60 mrad."""
        flight = {"velocity_m_per_s": -60.0, "scan_velocity_mrad_per_s": 20000 * math.pi}
        told = self.told(tmp_path, spacing="flight", init=flight)
        assert told["interval_nadir_mrad"] == pytest.approx(60.0, rel=1e-12)

    @pytest.mark.parametrize("scan", SCANS)
    def test_where_and_how_large(self, tmp_path, scan):
        found, whole, gap, table, curve = values(
            tmp_path, scene(12, 9), ("blur",), ("image", "whole", "difference", "table", "curve"),
            scan=scan, look_angle_deg=20.0,
        )  # fmt: skip
        expected = found - whole
        np.testing.assert_array_equal(gap, expected)
        share = 100 / np.ptp(whole)
        told = table.as_dict()
        assert told["max_percent"] == pytest.approx(np.abs(expected).max() * share, rel=1e-12)
        assert told["rms_percent"] == pytest.approx(expected.std() * share, rel=1e-3)
        place = np.unravel_index(np.argmax(np.abs(expected)), expected.shape)[scan == "x"]
        count, interval = (9, ACROSS) if scan == "x" else (12, ALONG)
        angle = 20.0 + math.degrees((place - (count - 1) / 2) * interval / 1000)
        assert told["max_view_deg"] == pytest.approx(angle, rel=1e-12)
        largest, rms = curve.series
        axis = 0 if scan == "x" else 1
        np.testing.assert_allclose(largest.y, np.abs(expected).max(axis=axis) * share, rtol=1e-12)
        power = np.sqrt(np.mean(expected**2, axis=axis)) * share
        np.testing.assert_allclose(rms.y, power, rtol=1e-12)
        assert largest.x[place] == pytest.approx(angle, rel=1e-12)


@pytest.mark.parametrize(
    ("params", "init", "told"),
    [
        ({"look_angle_deg": 70.0}, {}, "look_angle_deg.*horizon"),
        ({"nadir_column": 40.0}, {}, "nadir_column.*horizon"),
        ({"nadir_column": 4.0, "look_angle_deg": 1.0}, {}, "nadir_column"),
        ({"spacing": "typed"}, {}, "line_spacing_m"),
        ({"spacing": "typed", "line_spacing_m": 7.0}, {"range_m": None}, "range_m"),
        ({"spacing": "flight"}, {}, "velocity_m_per_s"),
        ({"spacing": "flight"}, {"velocity_m_per_s": 3.0}, "scan_velocity_mrad_per_s"),
    ],
)
def test_what_makes_no_scan_is_refused(tmp_path, params, init, told):
    np.save(tmp_path / "in.npy", scene(12, 9))
    document = network(("blur",), (12, 9), init=init, **params)
    error = NodeBench(tmp_path, document).error("lines")
    assert isinstance(error, ParameterError)
    assert re.search(told, str(error))


def test_two_images_and_no_image_are_refused(tmp_path):
    for name, seed in (("in", 5), ("other", 6)):
        np.save(tmp_path / f"{name}.npy", scene(12, 9, seed=seed))
    document = network(("blur",), (12, 9))
    fields = document.nodes["init"].params
    nodes = {
        **document.nodes,
        "file2": Node("file2", "read_image", {"path": "other.npy"}),
        "init2": Node("init2", "init_trans", fields),
    }
    links = tuple(k for k in document.links if (k.target, k.input) != ("lines", "phase"))
    links += (Link("file2", "image", "init2", "image"), Link("init2", "phase", "lines", "phase"))
    error = NodeBench(tmp_path, Network(nodes=nodes, links=links)).error("lines")
    assert isinstance(error, DataError)
    assert "Back Transform" in str(error)
    alone = document.with_parameter("blur", "apply", "filter_only")
    error = NodeBench(tmp_path, alone).error("lines")
    assert isinstance(error, DataError)
    assert "multiply" in str(error)
    links = tuple(k for k in document.links if (k.target, k.input) != ("lines", "context"))
    links += (
        Link("file2", "image", "init2", "image"),
        Link("init2", "context", "lines", "context"),
    )
    other = Network(nodes=nodes, links=links).with_parameter("init2", "fov_x_deg", 7.0)
    error = NodeBench(tmp_path, other).error("lines")
    assert isinstance(error, DataError)
    assert "context" in str(error)
