"""Tables of MTF against scipy's PCHIP, and where they begin and end."""

import cmath

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.special import j0, j1

from core.errors import DataError
from core.physics.optics.blur import (
    PointSpread,
    coarseness,
    edge_share,
    from_zero,
    radial_tabulated_mtf,
    sampled_psf_otf,
    tabulated_mtf,
    tabulated_ptf,
)

RNG = np.random.default_rng(7)
TABLES = {
    "two": ((0.0, 3.0), (1.0, 0.2)),
    "three": ((0.0, 1.0, 3.0), (1.0, 0.2, 0.3)),
    "flat": ((0.0, 1.0, 1.5, 3.0, 9.0), (1.0, 0.5, 0.5, 0.5, 0.0)),
    "ripple": (tuple(range(9)), tuple(1.0 - 0.1 * np.abs(np.sin(1.3 * np.arange(9.0))))),
    "random": (
        (0.0, *np.cumsum(RNG.uniform(0.01, 4, 60)).tolist()), (1.0, *RNG.uniform(0, 1, 60)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_interpolates_as_pchip_does(name):
    frequencies, values = TABLES[name]
    f = np.linspace(0.0, frequencies[-1], 4001)
    got = tabulated_mtf(frequency=f, frequencies=frequencies, values=values)
    np.testing.assert_allclose(got, PchipInterpolator(frequencies, values)(f), atol=3e-15)
    assert got.min() >= min(values) - 1e-15
    assert got.max() <= max(values) + 1e-15
    np.testing.assert_array_equal(
        got, radial_tabulated_mtf(rho=-f, frequencies=frequencies, values=values)
    )
    at_knots = tabulated_mtf(
        frequency=np.array(frequencies), frequencies=frequencies, values=values
    )
    np.testing.assert_allclose(at_knots, values, atol=1e-15)


def test_nothing_is_beyond_the_last_point_and_rounding_does_not_count():
    last = 3.0
    f = np.array([last, last * (1 + 2e-16), last * (1 + 1e-9), 100.0, -100.0])
    got = tabulated_mtf(frequency=f, frequencies=(0.0, last), values=(1.0, 0.25))
    np.testing.assert_array_equal(got, [0.25, 0.25, 0, 0, 0])


def test_a_phase_is_odd():
    table = {"frequencies": (0.0, 1.0, 2.0), "values": (0.0, -0.5, -1.5)}
    f = np.linspace(0, 2, 51)
    f = np.concatenate([-f[:0:-1], f])
    got = tabulated_ptf(frequency=f, **table)
    np.testing.assert_array_equal(got, -got[::-1])
    np.testing.assert_allclose(got[50:], PchipInterpolator(*table.values())(f[50:]), atol=1e-15)
    assert got[50] == 0.0


@pytest.mark.parametrize(
    ("frequencies", "values", "options", "expected"),
    [
        ((0.0, 1.0), (0.9995, 0.4), {}, ((0.0, 1.0), (1.0, 0.4))),
        ((2.0, 3.0), (0.9, 0.4), {}, ((0.0, 2.0, 3.0), (1.0, 0.9, 0.4))),
        ((0.0, 1.0), (0.8, 0.4), {"normalised": True}, ((0.0, 1.0), (1.0, 0.5))),
    ],
)
def test_every_table_begins_with_1(frequencies, values, options, expected):
    assert from_zero(frequencies, values, at_zero=1.0, **options) == expected


@pytest.mark.parametrize(
    ("frequencies", "values", "options", "words"),
    [
        ((1.0, 2.0), (0.8, 0.4), {"at_zero": 1.0, "normalised": True}, "begins at frequency 1"),
        (
            (0.0, 2.0),
            (0.0, 0.4),
            {"at_zero": 1.0, "normalised": True},
            "so it cannot be normalised",
        ),
    ],
)
def test_what_is_not_1_there_is_refused(frequencies, values, options, words):
    with pytest.raises(DataError, match=words):
        from_zero(frequencies, values, **options)


@pytest.mark.parametrize(
    ("frequencies", "values"),
    [((0.0,), (1.0,)), ((0.5, 1.0), (1.0, 0.5)), ((0.0, 1.0), (1.0,)), ((0.0, 0.0), (1.0, 1.0))],
)
def test_no_table(frequencies, values):
    with pytest.raises(DataError, match="two or more frequencies that rise from 0"):
        tabulated_mtf(frequency=0.0, frequencies=frequencies, values=values)


# The OTF of a sampled point spread function: against direct sums and against an Airy disc.

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
