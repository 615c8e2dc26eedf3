"""Strips whose crossings are hidden: sums over strips against areas cut into cells."""

from dataclasses import asdict

import numpy as np
import pytest

from core.physics.optics.pupil_otf import geometric_otf, strip_sum_area, strips_add_up
from core.physics.optics.pupil_shapes import PupilShape
from core.physics.optics.strip_overlap import Strip, StripPupil, strip_overlap_area
from slow_reference.pupil_area import overlap

ROUNDING = 4e-15  # of areas; the unit disc's is 3.1

SHAPES = [
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


def lags_of(shape):
    """Drawn ones, small ones, and those at which circles and edges touch."""
    rng = np.random.default_rng(3)
    lags = rng.uniform(0.0, 1.4, (2, 24))
    lags[:, ::3] *= 0.1
    hole, half = shape.inner_radius, (shape.slit_width or shape.vane_width) / 2
    touching = [2 * hole, 1 - hole, 1 + hole, 2 * half, half, 1 - half, 1 + half, hole + half]
    touching = np.array([lag for lag in touching if 0.0 < lag < 2.0])
    none = np.zeros_like(touching)
    x = np.concatenate([lags[0], touching, none, touching])
    y = np.concatenate([lags[1], none, touching, none + 0.3])
    inside = np.hypot(x, y) < 2.0
    return x[inside], y[inside]


@pytest.mark.parametrize("shape", SHAPES, ids=named)
def test_sum_is_the_area_of_all_cells(shape):
    assert strips_add_up(pupil=strips_of(shape))
    x, y = lags_of(shape)
    if shape.vanes > 4:
        x, y = x[::4], y[::4]
    cells = overlap(asdict(shape), *(np.append(lag, 0.0).astype(np.longdouble) for lag in (x, y)))
    expected = (cells[:-1] / cells[-1]).astype(float)
    otf = geometric_otf(shape, lag_x=x, lag_y=y)
    np.testing.assert_allclose(otf, expected, rtol=0, atol=ROUNDING / float(cells[-1]))


@pytest.mark.parametrize("shape", SHAPES, ids=named)
def test_sum_is_the_boundary_integral(shape):
    x, y = np.random.default_rng(4).uniform(0.0, 1.4, (2, 1, 2000))
    x[:, ::3] *= 0.1
    y[:, ::4] *= 0.1
    pupil = strips_of(shape)
    found = strip_sum_area(pupil=pupil, lag_x=x, lag_y=y)
    expected = strip_overlap_area(pupil=pupil, lag_x=x, lag_y=y)
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-14)


@pytest.mark.thorough(but=23)
@pytest.mark.parametrize("shape", SHAPES, ids=named)
@pytest.mark.parametrize("size", [(1, 300), (300, 1), (150, 290)])
@pytest.mark.parametrize("reach", [2.1, 0.2])
def test_bits_do_not_depend_on_what_else_is_computed(shape, size, reach):
    """Tiles leave out what holds nowhere in them; on a grid what one lag decides is hoisted."""
    y, x = (np.arange(count) * reach / count for count in size)
    grid = geometric_otf(shape, lag_x=x[np.newaxis, :], lag_y=y[:, np.newaxis])
    rng = np.random.default_rng(5)
    i, j = rng.integers(0, size[0], 400), rng.integers(0, size[1], 400)
    np.testing.assert_array_equal(geometric_otf(shape, lag_x=x[j], lag_y=y[i]), grid[i, j])


@pytest.mark.parametrize("shape", SHAPES, ids=named)
def test_lags_one_by_one_have_the_bits_of_all_at_once(shape):
    """Lenses that one disc fills, or that are empty, at all lags of a tile are not computed."""
    x, y = lags_of(shape)
    together = geometric_otf(shape, lag_x=x, lag_y=y)
    for index in range(0, x.size, 1 if shape.vanes < 5 else 4):
        alone = geometric_otf(shape, lag_x=x[index], lag_y=y[index])
        assert alone == together[index]


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
