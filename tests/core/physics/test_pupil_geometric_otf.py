"""Exact pupil OTFs against scan-line quadrature, reference values and symmetry."""

import math
from itertools import combinations

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.annular_otf import annular_otf
from core.physics.geometric_otf import geometric_otf
from core.physics.pupil_shapes import PupilShape
from reference_cases import reference_cases

ROUNDING = 3e-14

SHAPES = [
    PupilShape("half_moon", 1.0),
    PupilShape("hinged", 1.0, slit_width=0.23),
    PupilShape("hinged", 1.0, slit_width=1.7),
    PupilShape("cassegrain", 1.0, 0.3),
    PupilShape("cassegrain_slit", 1.0, 0.3, 0.23),
    PupilShape("cassegrain_slit", 1.0, 0.2, 0.9),
    PupilShape("spider", 1.0, 0.3, vanes=4, vane_width=0.06),
    PupilShape("spider", 1.0, 0.0, vanes=4, vane_width=0.3),
    PupilShape("spider", 1.0, 0.3, vanes=3, vane_width=0.1),
    PupilShape("spider", 1.0, 0.0, vanes=3, vane_width=0.4),
    PupilShape("spider", 1.0, 0.1, vanes=3, vane_width=0.9),
    PupilShape("spider", 1.0, 0.25, vanes=1, vane_width=0.2),
    PupilShape("spider", 1.0, 0.0, vanes=1, vane_width=0.3),
    PupilShape("spider", 1.0, 0.05, vanes=1, vane_width=0.3),
    PupilShape("spider", 1.0, 0.0, vanes=1, vane_width=2.5),
    PupilShape("spider", 1.0, 0.25, vanes=2, vane_width=0.2),
    PupilShape("spider", 1.0, 0.25, vanes=5, vane_width=0.1),
    PupilShape("spider", 1.0, 0.5, vanes=6, vane_width=0.05),
    PupilShape("spider", 1.0, 0.1, vanes=7, vane_width=0.2),
]
LAGS = [
    (0.1, 0.0), (0.0, 0.1), (0.23, 0.0), (0.06, 0.0), (0.0, 0.06), (0.0, 0.3), (0.3, 0.0),
    (1e-9, 0.0), (0.0, 1e-9), (3e-5, 2e-5), (0.7, 0.0), (1.3, 0.0), (0.0, 1.3), (0.0, 1.999),
    (0.4, 0.3), (0.05 * math.sqrt(3), 0.05), (0.25, 0.25 * math.sqrt(3)), (0.9, 1.1),
    (0.123, 0.456), (0.711, 0.222), (1.5, 0.2), (0.02, 1.4), (1.0, 0.0), (0.999999, 0.1),
]  # fmt: skip


def inside(shape, x, y):
    """The definition of each shape, by itself."""
    square = x * x + y * y
    clear = square <= shape.radius**2
    if shape.shape in ("cassegrain", "cassegrain_slit", "spider"):
        clear &= square >= shape.obscuration_radius**2
    if shape.shape == "half_moon":
        clear &= x >= 0
    if shape.shape in ("hinged", "cassegrain_slit"):
        clear &= np.abs(x) > shape.slit_width / 2
    if shape.shape == "spider":
        for k in range(shape.vanes):
            angle = 2 * math.pi * k / shape.vanes
            along = x * math.cos(angle) + y * math.sin(angle)
            across = y * math.cos(angle) - x * math.sin(angle)
            clear &= ~((along >= 0) & (np.abs(across) <= shape.vane_width / 2))
    return clear


def outlines(shape, a, b):
    """Circles (x, y, radius) and lines (x, y, dx, dy) that bound the shape moved by (a, b)."""
    circles = [(a, b, shape.radius)]
    if shape.obscuration_radius > 0:
        circles.append((a, b, shape.obscuration_radius))
    lines = []
    if shape.shape == "half_moon":
        lines.append((a, b, 0.0, 1.0))
    if shape.slit_width > 0:
        lines += [(a + side * shape.slit_width / 2, b, 0.0, 1.0) for side in (-1, 1)]
    for k in range(shape.vanes):
        u, v = (f(2 * math.pi * k / shape.vanes) for f in (math.cos, math.sin))
        half = shape.vane_width / 2
        lines += [(a - side * half * v, b + side * half * u, u, v) for side in (-1, 1)]
        lines.append((a, b, -v, u))
    return circles, lines


def crossing_heights(circles, lines):
    heights = [y + side * r for _, y, r in circles for side in (-1, 1)]
    heights += [y for _, y, _, dy in lines if abs(dy) < 1e-12]
    for (x, y, dx, dy), (p, q, dp, dq) in combinations(lines, 2):
        cross = dx * dq - dy * dp
        if abs(cross) > 1e-12:
            heights.append(y + dy * ((p - x) * dq - (q - y) * dp) / cross)
    for cx, cy, r in circles:
        for x, y, dx, dy in lines:
            middle = (cx - x) * dx + (cy - y) * dy
            gap = (cx - x) * dy - (cy - y) * dx
            if abs(gap) < r:
                half = math.sqrt((r - gap) * (r + gap))
                heights += [y + dy * (middle + side * half) for side in (-1, 1)]
    for (x, y, r), (p, q, t) in combinations(circles, 2):
        d = math.hypot(p - x, q - y)
        if d > 0 and abs(r - t) <= d <= r + t:
            along = (d * d + r * r - t * t) / (2 * d)
            half = math.sqrt(max(r * r - along * along, 0))
            heights += [y + (along * (q - y) + side * half * (p - x)) / d for side in (-1, 1)]
    return heights


def scan_line_overlap(shape, a, b):
    """Overlap area: lengths along x by sorting crossings, Gauss quadrature between kinks in y."""
    sets = [outlines(shape, 0.0, 0.0), outlines(shape, a, b)]
    circles, lines = sets[0][0] + sets[1][0], sets[0][1] + sets[1][1]
    low, high = b - shape.radius, shape.radius
    if low >= high:
        return 0.0
    kinks = np.array([low, high, *crossing_heights(circles, lines)])
    kinks = np.unique(kinks[(kinks >= low) & (kinks <= high)])
    # Narrow end pieces: a singularity close beyond the end of a piece slows the rule there only.
    parts = np.array([0.0, 0.0003, 0.003, 0.03, 0.2, 0.8, 0.97, 0.997, 0.9997])
    kinks = np.append((kinks[:-1, None] + np.diff(kinks)[:, None] * parts).ravel(), high)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    turn = 0.5 * math.pi * (nodes + 1)  # y = middle - half cos(turn): no root left at the ends
    half, middle = np.diff(kinks) / 2, (kinks[1:] + kinks[:-1]) / 2
    y = (middle[:, None] - half[:, None] * np.cos(turn)).ravel()
    weight = (0.5 * math.pi * half[:, None] * np.sin(turn) * weights).ravel()
    x = []
    for cx, cy, r in circles:
        reach = np.sqrt(np.maximum((r - (y - cy)) * (r + (y - cy)), 0))
        x += [cx - reach, cx + reach]
    x += [px + (y - py) * dx / dy for px, py, dx, dy in lines if abs(dy) >= 1e-12]
    x = np.sort(np.array(x), axis=0)
    centre = 0.5 * (x[1:] + x[:-1])
    open_ = inside(shape, centre, y) & inside(shape, centre - a, y - b)
    return float(np.sum(np.diff(x, axis=0) * open_ * weight))


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.vane_width}")
def test_overlap_is_that_of_scan_line_quadrature(shape):
    lags = LAGS if shape.vanes < 3 else LAGS[shape.vanes % 3 :: 3]
    area = scan_line_overlap(shape, 0.0, 0.0)
    expected = [scan_line_overlap(shape, a, b) / area for a, b in lags]
    a, b = np.array(lags).T
    np.testing.assert_allclose(
        geometric_otf(shape, lag_x=a, lag_y=b), expected, rtol=0, atol=ROUNDING
    )


def test_random_lags_of_a_spider_and_a_slit():
    lags = np.random.default_rng(5).uniform(0, 1.45, (10, 2))
    for shape in (SHAPES[4], SHAPES[6], SHAPES[8]):
        area = scan_line_overlap(shape, 0.0, 0.0)
        expected = [scan_line_overlap(shape, a, b) / area for a, b in lags]
        got = geometric_otf(shape, lag_x=lags[:, 0], lag_y=lags[:, 1])
        np.testing.assert_allclose(got, expected, rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.vane_width}")
def test_even_in_both_lags_one_at_zero_none_past_the_diameter(shape):
    x, y = np.meshgrid(np.arange(-11, 12) * 0.2, np.arange(-11, 12) * 0.2)
    otf = geometric_otf(shape, lag_x=x, lag_y=y)
    np.testing.assert_array_equal(otf, otf[::-1])
    np.testing.assert_array_equal(otf, otf[:, ::-1])
    assert otf[11, 11] == 1.0
    assert np.all((otf >= 0) & (otf <= 1))
    assert np.all(otf[np.hypot(x, y) >= 2.0] == 0.0)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.vane_width}")
def test_continuous_where_edges_coincide_or_touch(shape):
    steps = np.array([-1e-13, -1e-16, 0.0, 1e-16, 1e-13])
    touching = [0.06, 0.1, 0.2, 0.23, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 1.3, 1.7, 1.75, 2.0]
    for value in touching:
        for otf in (
            geometric_otf(shape, lag_x=value + steps, lag_y=0.0),
            geometric_otf(shape, lag_x=0.0, lag_y=value + steps),
        ):
            assert np.ptp(otf) < 1e-8


def test_lags_scale_with_the_radius():
    small = geometric_otf(SHAPES[6], lag_x=0.3, lag_y=0.2)
    large = PupilShape("spider", 75.0, 22.5, vanes=4, vane_width=4.5)
    np.testing.assert_allclose(
        geometric_otf(large, lag_x=22.5, lag_y=15.0), small, rtol=0, atol=1e-14
    )


@pytest.mark.parametrize("unit", [1e-150, 1e-290, 1e150, 1e290])
def test_no_unit_of_length_overflows(unit):
    for small in (SHAPES[0], SHAPES[4], SHAPES[8]):
        lengths = (small.obscuration_radius, small.slit_width, small.vane_width)
        hole, slit, vane = (unit * length for length in lengths)
        scaled = PupilShape(small.shape, unit, hole, slit, small.vanes, vane)
        got = geometric_otf(scaled, lag_x=[0.3 * unit, 1e300], lag_y=[0.2 * unit, 0.0])
        expected = geometric_otf(small, lag_x=[0.3, 9.0], lag_y=[0.2, 0.0])
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-14)


def test_shapes_without_their_parts_are_the_clear_disc_or_the_annulus():
    lag = np.linspace(0, 2, 21)
    clear = geometric_otf(PupilShape("clear", 1.0, 0.5), lag_x=lag, lag_y=0.1)
    for shape in (PupilShape("hinged", 1.0), PupilShape("spider", 1.0, vanes=4)):
        np.testing.assert_array_equal(geometric_otf(shape, lag_x=lag, lag_y=0.1), clear)
    ring = geometric_otf(PupilShape("cassegrain", 1.0, 0.4), lag_x=lag, lag_y=0.1)
    thin = PupilShape("spider", 1.0, 0.4, vanes=3, vane_width=1e-12)
    np.testing.assert_allclose(geometric_otf(thin, lag_x=lag, lag_y=0.1), ring, rtol=0, atol=1e-11)
    slit = PupilShape("cassegrain_slit", 1.0, 0.4, 1e-12)
    np.testing.assert_allclose(geometric_otf(slit, lag_x=lag, lag_y=0.1), ring, rtol=0, atol=1e-11)


def mp_annulus(v, ratio):
    """Overlap of two annuli from four disc overlaps, with 60 digits."""
    with mpmath.workdps(60):
        s, r = 2 * mpmath.mpf(v), mpmath.mpf(ratio)

        def lens(p, q):
            if s >= p + q:
                return mpmath.mpf(0)
            if s <= abs(p - q):
                return mpmath.pi * min(p, q) ** 2
            one = mpmath.acos((s * s + p * p - q * q) / (2 * s * p))
            two = mpmath.acos((s * s + q * q - p * p) / (2 * s * q))
            heron = (p + q - s) * (s + p - q) * (s - p + q) * (s + p + q)
            return p * p * one + q * q * two - mpmath.sqrt(heron) / 2

        full = lens(1, 1) + (lens(r, r) - 2 * lens(mpmath.mpf(1), r) if r > 0 else 0)
        return float(full / (mpmath.pi * (1 - r * r)))


@pytest.mark.parametrize("ratio", [0.0, 1e-9, 0.05, 1 / 3, 0.5, 0.9, 0.999, 1 - 1e-6, 1 - 1e-9])
def test_annulus_of_any_thickness(ratio):
    v = np.array([1e-12, 1e-9, 1e-6, 1e-3, 0.1, 0.25, 1 / 3, 0.5, 0.66, 0.75, 0.95, 0.999, 0.9999])
    v = np.concatenate([v, [(1 - ratio) / 2, (1 + ratio) / 2, ratio]])
    v = v[v > 0]
    expected = [mp_annulus(one, ratio) for one in v]
    got = annular_otf(frequency_ratio=v, obscuration_ratio=ratio)
    np.testing.assert_allclose(got, expected, rtol=1e-11, atol=1e-15)


@pytest.mark.parametrize("below", [1e-3, 1e-6, 1e-9, 1e-12, 2.0**-53])
def test_disc_keeps_relative_precision_up_to_the_cutoff(below):
    v = 1.0 - below
    got = annular_otf(frequency_ratio=v)
    np.testing.assert_allclose(got, mp_annulus(v, 0), rtol=1e-13)


def test_annulus_refuses_what_has_no_opening():
    for ratio in (1.0, 1.2, -0.1, math.nan):
        with pytest.raises(ParameterError, match="obscuration_ratio"):
            annular_otf(frequency_ratio=0.1, obscuration_ratio=ratio)
    with pytest.raises(DataError):
        annular_otf(frequency_ratio=math.nan)
    with pytest.raises(DataError):
        geometric_otf(SHAPES[0], lag_x=math.inf, lag_y=0.0)


@pytest.mark.parametrize("case", reference_cases("diffraction_mtf"))
def test_reference_diffraction_mtf(case):
    given, expected = case["inputs"], float(case["expected"]["mtf"])
    got = annular_otf(
        frequency_ratio=float(given["xi_over_cutoff"]),
        obscuration_ratio=float(given["obscuration_ratio"]),
    )
    relative = 1e-10 if case["id"] == "disc-0.999999" else 1e-12
    assert abs(got - expected) <= relative * abs(expected) + 1e-15


@pytest.mark.parametrize("case", reference_cases("pupil_mtf_half_moon"))
def test_reference_half_moon(case):
    given, expected = case["inputs"], float(case["expected"]["mtf"])
    lag_x, lag_y = (2 * float(given[f"xi_over_cutoff_{axis}"]) for axis in "xy")
    got = geometric_otf(PupilShape("half_moon", 1.0), lag_x=lag_x, lag_y=lag_y)
    assert abs(got - expected) <= 1e-12 * abs(expected) + 1e-15


def test_published_figures_of_the_two_cameras():
    # Tantalo 1996, sections 5.1.2 and 5.2.2 print 0.918 and 0.967.
    line = geometric_otf(PupilShape("clear", 75.0), lag_x=10 * 0.48892 / 0.5, lag_y=0.0)
    assert abs(line - 0.9171) < 5e-5
    array = geometric_otf(PupilShape("clear", 90.0), lag_x=4 * 1.17342 / 1.0, lag_y=0.0)
    assert abs(array - 0.9668) < 5e-5
