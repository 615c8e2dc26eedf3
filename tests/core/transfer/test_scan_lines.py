"""Filtering along lines against sums written out."""

import numpy as np
import pytest

from core.chain.band_stack import band_mean_otf
from core.evaluation.store import Store
from core.evaluation.work import Policy, Work
from core.physics.optics.diffraction_otf import Aperture, diffraction_otf
from core.physics.sampling.platform_motion import line_intervals_mrad, view_angles_rad
from core.transfer.factors import Grid, Law, Planar, Product, Separable
from core.transfer.scan_lines import ScanChain, filter_lines, filter_mixed
from slow_reference.filtering import filtered_lines

TOLERANCE = {"double": 1e-12, "single": 2e-6}


def modulus(frequency, tau):
    return 1 / np.hypot(1, 2 * np.pi * frequency * tau)


def angle(frequency, tau):
    return -np.arctan(2 * np.pi * frequency * tau)


POLE = (
    Separable(Law.of(modulus, tau=0.7), None),
    Separable(Law.of(angle, tau=0.7), None, part="ptf"),
)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("shape", [(1, 1), (3, 2), (4, 9), (2, 16)])
def test_equals_the_sum_written_out(shape, edges, precision):
    work = Work(Policy(precision=precision), Store())
    image = np.random.default_rng(5).uniform(30, 50, shape).astype(work.policy.dtype)
    grid = Grid(*shape, 0.9, 0.9)
    got = filter_lines(work, image, factors=POLE, grid=grid, edges=edges)
    expected = filtered_lines(
        image.astype(float), lambda xi: 1 / (1 + 2j * np.pi * 0.7 * xi), np.float64(0.9), edges
    )
    assert got.dtype == work.policy.dtype
    assert np.abs(got - expected).max() <= TOLERANCE[precision] * 50


def test_a_scan_towards_plus_x_delays_towards_plus_x():
    work = Work(Policy(precision="double"), Store())
    line = np.zeros((1, 65))
    line[0, 20] = 1.0
    got = filter_lines(work, line, factors=POLE, grid=Grid(1, 65, 0.9, 0.9), edges="reflect")[0]
    assert got[21:30].sum() > 3 * got[11:20].sum()


# Frames whose columns are sampled unlike in flight: how many intervals a blend takes.

SHAPE = (9, 14)
ANGLES = view_angles_rad(columns=14, interval_mrad=13.6, look_angle_rad=0.5)
INTERVALS = line_intervals_mrad(line_spacing_m=2.9e-3, altitude_m=1.0, view_angle_rad=ANGLES)
IMAGE = np.random.default_rng(1).random(SHAPE)


def filtered(law, symmetric=True, **how):
    factor = Planar(law, radial=True, symmetric=symmetric)
    chain = ScanChain(Product([factor]), Grid(*SHAPE, 13.6, 2.9), "reflect")
    work = Work(Policy(precision="double"), Store(1 << 20))
    how = {"method": "nodes", **how}
    return filter_mixed(work, IMAGE, chain=chain, intervals_mrad=INTERVALS, **how)


def diffraction(wavelength_um, defocus_waves=0.0):
    return Law.of(
        diffraction_otf,
        aperture=Aperture(2.0, 0.3, defocus_waves),
        cut_on_um=wavelength_um,
        cut_off_um=wavelength_um,
        weighting="uniform",
        temperature_K=300.0,
        wavelengths=1,
    )


def bands(count, defocus_waves):
    laws = tuple(diffraction(w, defocus_waves) for w in np.linspace(4.0, 12.0, count).tolist())
    return Law.of(band_mean_otf, laws=laws, shares=np.full(count, 1.0 / count))


@pytest.mark.parametrize(
    ("law", "symmetric", "tolerance"),
    [(diffraction(5.0), False, 1e-3), (bands(3, 0.3), True, 1e-2), (bands(3, 0.3), True, 1e-3)],
)
def test_a_blend_takes_the_fewest_intervals(law, symmetric, tolerance):
    found = filtered(law, symmetric, tolerance=tolerance)
    same = filtered(law, symmetric, nodes=found.nodes)
    assert found.nodes > 1
    assert (found.nodes, found.response_error) == (same.nodes, same.response_error)
    np.testing.assert_array_equal(found.picture, same.picture)
    assert found.response_error <= tolerance
    for fewer in range(1, found.nodes):
        assert filtered(law, symmetric, nodes=fewer).response_error > tolerance
