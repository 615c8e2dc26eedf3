"""The OTF of a sampled point spread function: against direct sums and against an Airy disc."""

from __future__ import annotations

import cmath

import numpy as np
import pytest
from scipy.special import j0, j1

from core.physics.optics.measured_otf import (
    PointSpread,
    coarseness,
    edge_share,
    sampled_psf_otf,
)

SAMPLES = np.array([[0.0, 2.0, 1.0, -0.1], [3.0, 8.0, 4.0, 2.0], [1.0, 3.0, 2.0, 1.0]])
X, Y = 0.2, 0.3


def direct(samples, xi, eta, column, row):
    """The sum, term by term."""
    total = samples.sum()
    return sum(
        samples[r, c] / total * cmath.exp(-2j * cmath.pi * (xi * X * (c - column)
                                                            + eta * Y * (r - row)))
        for r in range(samples.shape[0]) for c in range(samples.shape[1])
    )  # fmt: skip


@pytest.mark.parametrize("keep", [True, False])
def test_is_the_sum_over_the_samples(keep):
    psf = PointSpread.of(SAMPLES, keep_centroid=keep)
    weights = SAMPLES / SAMPLES.sum()
    column, row = (1.5, 1.0) if keep else (
        (weights * np.arange(4)).sum(), (weights * np.arange(3)[:, None]).sum()
    )  # fmt: skip
    xi, eta = np.array([-2.5, -1.0, 0.0, 0.3, 2.0]), np.array([-1.6, 0.0, 0.7])
    wanted = [[direct(SAMPLES, f, g, column, row) for f in xi] for g in eta]
    how = {"psf": psf, "pitch_x_mrad": X, "pitch_y_mrad": Y}
    plane = sampled_psf_otf(xi=xi[None, :], eta=eta[:, None], **how)
    np.testing.assert_allclose(plane, wanted, atol=1e-14)
    pairs = sampled_psf_otf(xi=np.tile(xi, 3), eta=np.repeat(eta, 5), **how)
    np.testing.assert_allclose(pairs, plane.ravel(), atol=1e-14)
    assert plane[1, 2] == 1.0


def airy(size, pitch_over_fringe):
    """Airy disc of cutoff 1 at samples so many to 1/cutoff, and the energy beyond its circle."""
    place = (np.arange(size) - (size - 1) / 2) * pitch_over_fringe
    v = np.pi * np.hypot(place[None, :], place[:, None])
    v[v == 0] = 1e-9
    rim = np.pi * place[-1]
    return (2 * j1(v) / v) ** 2, float(j0(rim) ** 2 + j1(rim) ** 2)


@pytest.mark.parametrize(("size", "pitch"), [(65, 0.4), (256, 0.5), (400, 0.35)])
def test_an_airy_disc_has_the_mtf_of_its_aperture(size, pitch):
    """Samples at 1/(2 cutoff) or finer are exact; what errs is the energy E cut off at the border.

    H' = (H − T)/(1 − E) with |T| ≤ E, so |H' − H| ≤ 2E/(1 − E); E = J0² + J1² (Rayleigh 1881).
    """
    samples, cut = airy(size, pitch)
    psf = PointSpread.of(samples)
    f = np.linspace(-1.2, 1.2, 49)
    s = np.minimum(np.hypot(f[None, :], f[:, None]), 1.0)
    wanted = 2 / np.pi * (np.arccos(s) - s * np.sqrt(1 - s * s))
    known = 0.5 / pitch
    wanted[(np.abs(f)[None, :] > known) | (np.abs(f)[:, None] > known)] = 0.0
    otf = sampled_psf_otf(
        xi=f[None, :], eta=f[:, None], psf=psf, pitch_x_mrad=pitch, pitch_y_mrad=pitch
    )
    error = np.abs(otf - wanted).max()
    assert error < 2 * cut / (1 - cut)
    assert error > 1e-5  # it is that error, and not another function
    assert coarseness(psf) < 2 * cut
    # The pedestal is about the energy that is missing.
    assert 0.2 * cut < edge_share(psf) < 5 * cut


def test_centroid_and_total():
    psf = PointSpread.of(np.pad([[1.0, 3.0]], ((0, 2), (4, 0))) + 0.5, background=0.5)
    assert (psf.total, psf.centroid_column, psf.centroid_row) == pytest.approx((4.0, 4.75, 0.0))
    assert (psf.column, psf.row) == (2.5, 1.0)


def test_coarse_samples_show_at_their_nyquist_frequency():
    """Of a single sample the OTF is 1 everywhere."""
    single = np.zeros((5, 5))
    single[2, 2] = 7.0
    assert coarseness(PointSpread.of(single)) == 1.0
    assert edge_share(PointSpread.of(single)) == 0.0
    assert edge_share(PointSpread.of(np.ones((5, 5)))) == pytest.approx(1.0)
