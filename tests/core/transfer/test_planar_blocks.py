"""Planes of factors by low rank, tables and within the support, against the factors themselves."""

from dataclasses import replace

import numpy as np
import pytest

from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.physics.optics.diffraction_otf import band_wavelengths
from core.physics.optics.overlap_area import annular_otf
from core.physics.optics.pupil_otf import circular_pupil_otf, geometric_pupil_otf
from core.physics.optics.pupil_shapes import PupilShape
from core.transfer.factors import Grid, Law, Planar, Product
from core.transfer.planar_blocks import (
    SINGLE_TOLERANCE,
    Planes,
    RadialTable,
    _probes,
    cross_approximation,
)

SHAPES = {
    "clear": PupilShape("clear", 75),
    "cassegrain": PupilShape("cassegrain", 75, obscuration_radius=25),
    "half_moon": PupilShape("half_moon", 75),
    "hinged": PupilShape("hinged", 75, slit_width=20),
    "cassegrain_slit": PupilShape("cassegrain_slit", 75, obscuration_radius=25, slit_width=20),
    "spider": PupilShape("spider", 75, obscuration_radius=25, vanes=3, vane_width=5),
}
BAND = {"wavelengths_um": (8.0, 12.0), "weights": (0.5, 0.5)}


def pupil(shape, size_cm):
    """In closed form at every frequency, its cutoff not told."""
    pitch = size_cm * 10 / 512
    law = Law.of(geometric_pupil_otf, shape=shape, pitch_x_mm=pitch, pitch_y_mm=pitch, **BAND)
    return Planar(law)


def round_pupil(hole, size_cm, ratio=1.0):
    """A function of the radius, of unequal scales unless the ratio is 1."""
    diameter = 150 * size_cm * 10 / 512
    law = Law.of(circular_pupil_otf, diameter_mm=diameter, obscuration_ratio=hole, **BAND)
    cutoff = diameter / 8.0, diameter / 8.0 / ratio
    return Planar(law, radial=True, ratios=(1.0, ratio), cutoff=cutoff)


def planes_of(factor, grid, axes, precision, capacity=1 << 29):
    work = Work(Policy(precision=precision), Store(capacity))
    return Planes(work, Product([factor]), grid, axes)


def evaluated(factor, grid, axes, rows=slice(None)):
    xi, eta = grid.axes(axes)
    return factor.transfer(None, xi[np.newaxis, :], eta[rows, np.newaxis])


SINGLE_ERROR = SINGLE_TOLERANCE + 2.5e-7  # thin matrices are rounded to single before their product


@pytest.mark.thorough(but=13)
@pytest.mark.parametrize("axes", ["reflect", "periodic"])
@pytest.mark.parametrize("size_cm", [25.6, 5.0, 0.6])
@pytest.mark.parametrize("name", SHAPES)
def test_single_precision_planes_are_within_their_tolerance(name, size_cm, axes):
    factor, grid = pupil(SHAPES[name], size_cm), Grid(200, 257, 1.0, 1.3)
    got = planes_of(factor, grid, axes, "single").block(slice(None))
    assert np.abs(got - evaluated(factor, grid, axes)).max() <= SINGLE_ERROR


@pytest.mark.thorough(but=21)
@pytest.mark.parametrize("axes", ["reflect", "periodic"])
@pytest.mark.parametrize("shape", [(200, 257), (720, 810)])
@pytest.mark.parametrize("size_cm", [25.6, 5.0, 1.2, 0.6, 0.05])
@pytest.mark.parametrize(("hole", "ratio"), [(0.0, 1.0), (0.0, 0.8), (1 / 3, 1.0), (0.9, 1.25)])
def test_tables_and_thin_matrices_are_within_the_tolerance(hole, ratio, size_cm, shape, axes):
    factor, grid = round_pupil(hole, size_cm, ratio), Grid(*shape, 1.0, 1.3)
    got = planes_of(factor, grid, axes, "single").block(slice(None))
    assert np.abs(got - evaluated(factor, grid, axes)).max() <= SINGLE_ERROR


@pytest.mark.thorough(but=17)
@pytest.mark.parametrize("axes", ["reflect", "periodic"])
@pytest.mark.parametrize("size_cm", [5.0, 1.2, 0.6, 0.001])
@pytest.mark.parametrize("name", SHAPES)
def test_only_the_support_is_evaluated_and_the_rest_is_0(name, size_cm, axes):
    """Down to a cutoff below the first frequency."""
    factor, grid = pupil(SHAPES[name], size_cm), Grid(200, 257, 1.0, 1.3)
    across = 75 * (1 if name == "half_moon" else 2) * size_cm * 10 / 512 / 8.0
    along = 150 * size_cm * 10 / 512 / 8.0
    within = replace(factor, cutoff=(across, along))
    planes = planes_of(within, grid, axes, "double")
    expected = evaluated(factor, grid, axes)
    for rows in (slice(None), slice(3, 90), slice(90, 110), slice(150, None), slice(120, 20, -1)):
        np.testing.assert_array_equal(planes.block(rows), expected[rows])


@pytest.mark.parametrize("name", ["clear", "spider"])
def test_double_precision_is_never_approximated(name):
    factor, grid = pupil(SHAPES[name], 25.6), Grid(200, 257, 1.0, 1.3)
    got = planes_of(factor, grid, "reflect", "double").block(slice(10, 20))
    assert np.array_equal(got, evaluated(factor, grid, "reflect", slice(10, 20)))
    factor = round_pupil(1 / 3, 0.6)
    got = planes_of(factor, grid, "periodic", "double").block(slice(10, 20))
    assert np.array_equal(got, evaluated(factor, grid, "periodic", slice(10, 20)))


@pytest.mark.parametrize("axes", ["reflect", "periodic"])
@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize(
    "factor",
    [pupil(SHAPES["clear"], 0.6), pupil(SHAPES["spider"], 0.6), round_pupil(1 / 3, 0.6)],
    ids=["clear", "spider", "radial"],
)
def test_a_plane_kept_or_not_gives_the_same_bits(factor, precision, axes):
    """A store too small for the plane."""
    grid = Grid(200, 257, 1.0, 1.3)
    kept, anew = (
        planes_of(factor, grid, axes, precision, capacity).block(slice(3, 150))
        for capacity in (1 << 29, 1 << 10)
    )
    assert kept.dtype == np.dtype(Policy(precision=precision).dtype)
    assert np.array_equal(kept, anew)


def test_what_the_first_probes_miss_is_found_between_them():
    size = 400
    first = _probes(size, 0)
    missed = np.setdiff1d(np.arange(size), first)
    plane = np.ones((size, size))
    plane[np.ix_(missed, missed)] = 2.0
    found = cross_approximation(lambda i, j: plane[np.ix_(i, j)], size, size, 1e-9)
    assert found is not None
    assert np.abs(found[0] @ found[1] - plane).max() < 1e-9


# Tables of the radius against the function that they stand for.


def band_otf(hole, count):
    wavelengths, weights = band_wavelengths(cut_on_um=3.0, cut_off_um=5.0, count=count)

    def function(radii):
        return sum(
            weight * annular_otf(frequency_ratio=wavelength * radii / 4.0, obscuration_ratio=hole)
            for wavelength, weight in zip(wavelengths, weights, strict=True)
        )

    kinks = [4.0 / w * v for w in wavelengths for v in (1.0, hole, (1 - hole) / 2, (1 + hole) / 2)]
    return function, kinks


@pytest.mark.parametrize("hole", [0.0, 1 / 3, 0.9])
@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("reach", [0.1, 0.9, 1.25])
def test_errors_are_within_what_was_asked_for(hole, count, reach):
    function, kinks = band_otf(hole, count)
    table = RadialTable.of(function, reach=reach, error=5e-8)
    rng = np.random.default_rng(1)
    near = [kink * (1.0 + 1e-3 * rng.normal(size=3000)) for kink in kinks]
    radii = np.concatenate([rng.uniform(0.0, reach, 20000), *near])
    radii = radii[(radii >= 0.0) & (radii <= reach)]
    # Halfway between its entries a table shows most of its error, not all.
    assert np.abs(table.at(radii**2, function) - function(radii)).max() < 1e-7


def test_places_too_rough_to_interpolate_are_evaluated():
    def step(radii):
        return np.where(radii < 0.31, 1.0, 0.25)

    table = RadialTable.of(step, reach=1.0, error=1e-8)
    assert table.rough
    radii = 0.31 + np.linspace(-1e-3, 1e-3, 1001)
    np.testing.assert_array_equal(table.at(radii**2, step), step(np.sqrt(radii**2)))


def test_what_is_rough_everywhere_has_no_table():
    assert RadialTable.of(lambda radii: np.sin(1e6 * radii), reach=1.0, error=1e-8) is None
