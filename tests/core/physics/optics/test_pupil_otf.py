"""Exact pupil OTFs against areas cut into cells, reference values and symmetry."""

import math
from dataclasses import asdict

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.optics.overlap_area import annular_otf
from core.physics.optics.pupil_otf import geometric_otf, strip_sum_area, strips_add_up
from core.physics.optics.pupil_shapes import PupilShape
from core.physics.optics.strip_overlap import Strip, StripPupil, strip_overlap_area
from reference_cases import reference_cases
from slow_reference.pupil_area import overlap

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


def expected_otf(shape, lags):
    """Exact areas of the cells between all outlines."""
    a, b = np.array([*lags, (0.0, 0.0)]).T.astype(np.longdouble)
    area = overlap(asdict(shape), a, b)
    return (area[:-1] / area[-1]).astype(float)


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.vane_width}")
def test_overlap_is_the_area_of_all_cells(shape):
    lags = LAGS if shape.vanes < 5 else LAGS[shape.vanes % 3 :: 3]
    a, b = np.array(lags).T
    np.testing.assert_allclose(
        geometric_otf(shape, lag_x=a, lag_y=b), expected_otf(shape, lags), rtol=0, atol=ROUNDING
    )


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: f"{s.shape}-{s.vanes}-{s.vane_width}")
def test_a_row_and_a_column_of_lags_make_a_plane(shape):
    x, y = np.array([[0.0, 0.23, 0.4, 1.3]]), np.array([[0.0], [0.1], [1.1]])
    plane = geometric_otf(shape, lag_x=x, lag_y=y)
    x, y = np.broadcast_arrays(x, y)
    one_by_one = [
        geometric_otf(shape, lag_x=a, lag_y=b) for a, b in zip(x.flat, y.flat, strict=True)
    ]
    np.testing.assert_allclose(plane.ravel(), one_by_one, rtol=0, atol=ROUNDING)


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


def test_annulus_refuses_what_has_no_opening():
    for ratio in (1.0, 1.2, -0.1, math.nan):
        with pytest.raises(ParameterError, match="obscuration_ratio"):
            annular_otf(frequency_ratio=0.1, obscuration_ratio=ratio)
    with pytest.raises(DataError):
        annular_otf(frequency_ratio=math.nan)
    with pytest.raises(DataError):
        geometric_otf(SHAPES[0], lag_x=math.inf, lag_y=0.0)


def test_published_figures_of_the_two_cameras():
    # Tantalo 1996, sections 5.1.2 and 5.2.2 print 0.918 and 0.967.
    line = geometric_otf(PupilShape("clear", 75.0), lag_x=10 * 0.48892 / 0.5, lag_y=0.0)
    assert abs(line - 0.9171) < 5e-5
    array = geometric_otf(PupilShape("clear", 90.0), lag_x=4 * 1.17342 / 1.0, lag_y=0.0)
    assert abs(array - 0.9668) < 5e-5


# Strips whose crossings are hidden: sums over strips against areas cut into cells.


SHAPES_PUPIL_STRIP_SUM = [
    PupilShape("hinged", 1.0, slit_width=0.23),
    PupilShape("hinged", 1.0, slit_width=1.9),
    PupilShape("cassegrain_slit", 1.0, 0.9, 0.4),
    PupilShape("cassegrain_slit", 1.0, 0.2, 1.1),
    PupilShape("spider", 1.0, 1 / 3, vanes=4, vane_width=0.07),
    PupilShape("spider", 1.0, 0.9, vanes=4, vane_width=0.02),
    PupilShape("spider", 1.0, 1 / 3, vanes=3, vane_width=0.07),
    PupilShape("spider", 1.0, 0.95, vanes=3, vane_width=0.2),
    PupilShape("spider", 1.0, 0.25, vanes=1, vane_width=0.2),
    PupilShape("spider", 1.0, 0.5, vanes=5, vane_width=0.1),
    PupilShape("spider", 1.0, 0.5, vanes=8, vane_width=0.1),
]


def named(shape):
    return f"{shape.shape}-{shape.vanes}-{shape.obscuration_radius:.2f}"


def strips_of(shape):
    """Opposite vanes as one bar."""
    if shape.slit_width:
        half = shape.slit_width / 2
        return StripPupil(1.0, shape.inner_radius, (Strip(0.0, 1.0, -half, half, False),))
    half, odd = shape.vane_width / 2, shape.vanes % 2 == 1
    angles = 2 * np.pi * np.arange(shape.vanes if odd else shape.vanes // 2) / shape.vanes
    strips = (Strip(float(np.cos(a)), float(np.sin(a)), -half, half, odd) for a in angles)
    return StripPupil(1.0, shape.inner_radius, tuple(strips))


@pytest.mark.parametrize("shape", SHAPES_PUPIL_STRIP_SUM, ids=named)
def test_sum_is_the_boundary_integral(shape):
    x, y = np.random.default_rng(4).uniform(0.0, 1.4, (2, 1, 2000))
    x[:, ::3] *= 0.1
    y[:, ::4] *= 0.1
    pupil = strips_of(shape)
    assert strips_add_up(pupil=pupil)
    found = strip_sum_area(pupil=pupil, lag_x=x, lag_y=y)
    expected = strip_overlap_area(pupil=pupil, lag_x=x, lag_y=y)
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-14)


@pytest.mark.thorough(but=23)
@pytest.mark.parametrize("shape", SHAPES_PUPIL_STRIP_SUM, ids=named)
@pytest.mark.parametrize("size", [(1, 300), (300, 1), (150, 290)])
@pytest.mark.parametrize("reach", [2.1, 0.2])
def test_bits_do_not_depend_on_what_else_is_computed(shape, size, reach):
    """Tiles leave out what holds nowhere in them; on a grid what one lag decides is hoisted."""
    y, x = (np.arange(count) * reach / count for count in size)
    grid = geometric_otf(shape, lag_x=x[np.newaxis, :], lag_y=y[:, np.newaxis])
    rng = np.random.default_rng(5)
    i, j = rng.integers(0, size[0], 400), rng.integers(0, size[1], 400)
    np.testing.assert_array_equal(geometric_otf(shape, lag_x=x[j], lag_y=y[i]), grid[i, j])


@pytest.mark.parametrize(
    "shape",
    [
        PupilShape("spider", 1.0, 0.0, vanes=4, vane_width=0.1),
        PupilShape("spider", 1.0, 0.05, vanes=3, vane_width=0.1),
        PupilShape("spider", 1.0, 0.1, vanes=1, vane_width=0.3),
    ],
    ids=named,
)
def test_strips_that_are_seen_to_meet_do_not_add_up(shape):
    assert not strips_add_up(pupil=strips_of(shape))


def test_unequal_strips_do_not_add_up():
    wide, narrow = Strip(1.0, 0.0, -0.1, 0.1, False), Strip(0.0, 1.0, -0.05, 0.05, False)
    assert not strips_add_up(pupil=StripPupil(1.0, 0.5, (wide, narrow)))
    aside = Strip(1.0, 0.0, -0.1, 0.2, False)
    assert not strips_add_up(pupil=StripPupil(1.0, 0.5, (aside,)))


def test_two_half_planes_moved_over_two_others_leave_a_square():
    """Bars of width 0.2 cross at (0.6, 0), 0.5 from the moved centre: nothing cuts the square."""
    first = (Strip(1.0, 0.0, 0.1, 2.0, False), Strip(1.0, 0.0, -2.0, -0.1, False))
    second = (Strip(0.0, 1.0, 0.1, 2.0, False), Strip(0.0, 1.0, -2.0, -0.1, False))
    area = strip_overlap_area(
        pupil=StripPupil(1.0, 0.3, first),
        other=StripPupil(1.0, 0.3, second),
        lag_x=np.array([0.6]),
        lag_y=np.array([0.5]),
    )
    np.testing.assert_allclose(area, 0.04, rtol=1e-13)


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
