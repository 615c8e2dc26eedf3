"""Low-rank planes against the factors evaluated everywhere."""

import numpy as np
import pytest

from core.cross import cross_approximation
from core.factors import Law, Planar
from core.grid import Grid
from core.physics.pupil_otf import geometric_pupil_otf
from core.physics.pupil_shapes import PupilShape
from core.planes import SINGLE_TOLERANCE, Planes, axes_of
from core.policy import Policy
from core.product import Product
from core.store import Store
from core.work import Work

SHAPES = {
    "clear": PupilShape("clear", 75),
    "cassegrain": PupilShape("cassegrain", 75, obscuration_radius=25),
    "half_moon": PupilShape("half_moon", 75),
    "hinged": PupilShape("hinged", 75, slit_width=20),
    "cassegrain_slit": PupilShape("cassegrain_slit", 75, obscuration_radius=25, slit_width=20),
}


def pupil(shape, size_cm):
    law = Law.of(
        geometric_pupil_otf,
        shape=shape,
        pitch_x_mm=size_cm * 10 / 512,
        pitch_y_mm=size_cm * 10 / 512,
        wavelengths_um=(10.0,),
        weights=(1.0,),
    )
    return Planar(law, smooth=True)


@pytest.mark.parametrize("axes", ["mirrored", "periodic"])
@pytest.mark.parametrize("size_cm", [25.6, 5.0, 0.6])
@pytest.mark.parametrize("name", SHAPES)
def test_single_precision_planes_are_within_their_tolerance(name, size_cm, axes):
    factor, grid = pupil(SHAPES[name], size_cm), Grid(200, 257, 1.0, 1.3)
    work = Work(Policy(precision="single"), Store())
    planes = Planes(work, Product([factor]), grid, axes)
    got = planes.block(slice(None))
    xi, eta = axes_of(grid, axes)
    expected = factor.transfer(None, xi[np.newaxis, :], eta[:, np.newaxis])
    # The thin matrices are rounded to single: a few roundings of 6e-8 come on top.
    assert np.abs(got - expected).max() <= 2 * SINGLE_TOLERANCE + 1e-6 * 0.2


def test_double_precision_is_never_approximated():
    factor, grid = pupil(SHAPES["clear"], 25.6), Grid(200, 257, 1.0, 1.3)
    work = Work(Policy(precision="double"), Store())
    xi, eta = axes_of(grid, "mirrored")
    got = Planes(work, Product([factor]), grid, "mirrored").block(slice(10, 20))
    expected = factor.transfer(None, xi[np.newaxis, :], eta[10:20, np.newaxis])
    assert np.array_equal(got, expected)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("name", ["clear", "cassegrain_slit"])
def test_a_plane_kept_or_not_gives_the_same_bits(name, precision):
    """A store too small for the plane, and a cutoff inside the band, which has no low rank."""
    factor, grid = pupil(SHAPES[name], 0.6), Grid(200, 257, 1.0, 1.3)
    kept, anew = (
        Planes(
            Work(Policy(precision=precision), Store(capacity)), Product([factor]), grid, "mirrored"
        ).block(slice(3, 90))
        for capacity in (1 << 29, 1 << 10)
    )
    assert kept.dtype == np.dtype(Policy(precision=precision).dtype)
    assert np.array_equal(kept, anew)


def test_a_plane_of_high_rank_is_given_up():
    noise = np.random.default_rng(1).normal(size=(300, 200))
    found = cross_approximation(lambda i, j: noise[np.ix_(i, j)], 300, 200, 1e-7)
    assert found is None


def test_a_plane_of_rank_three_is_found():
    rng = np.random.default_rng(2)
    plane = rng.normal(size=(300, 3)) @ rng.normal(size=(3, 200))
    found = cross_approximation(lambda i, j: plane[np.ix_(i, j)], 300, 200, 1e-9)
    assert found is not None
    assert found[0].shape == (300, 3)
    assert np.abs(found[0] @ found[1] - plane).max() < 1e-9


def test_a_plane_with_the_edge_of_its_support_is_given_up():
    plane = np.maximum(0.0, 1 - np.hypot(*np.mgrid[0:2:300j, 0:2:200j]))
    assert cross_approximation(lambda i, j: plane[np.ix_(i, j)], 300, 200, 1e-7) is None
