"""Filtering along lines against sums written out."""

import numpy as np
import pytest

from core.chain.band_stack import band_mean_otf
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.physics.optics.diffraction_otf import Aperture, diffraction_otf
from core.physics.sampling.platform_motion import line_intervals_mrad, view_angles_rad
from core.transfer.factors import Grid, Law, Planar, Product
from core.transfer.scan_lines import ScanChain, filter_mixed

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
    found, nodes, error, _ = filtered(law, symmetric, tolerance=tolerance)
    same = filtered(law, symmetric, nodes=nodes)
    assert nodes > 1
    assert (nodes, error) == same[1:3]
    np.testing.assert_array_equal(found, same[0])
    assert error <= tolerance
    for fewer in range(1, nodes):
        assert filtered(law, symmetric, nodes=fewer)[2] > tolerance
