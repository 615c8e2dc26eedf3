"""What one factor is, shown on a plane and at pairs of frequencies."""

import numpy as np
import pytest

from core.transfer.factors import Law, Planar, Separable, factor_at

XI, ETA = np.array([0.0, 0.3, -0.4, 0.5]), np.array([0.1, -0.2, 0.7])
ALONG, ACROSS = np.meshgrid(ETA, XI, indexing="ij")


def turned(xi, eta):
    """A modulus that is never the real part, and a phase odd in each axis."""
    return np.exp(-(xi**2) - 2 * eta**2) * np.exp(1j * (xi + 3 * eta))


def halved(frequency):
    return 1.0 - 0.5 * np.abs(frequency)


def late(frequency, by):
    return -2 * np.pi * frequency * by


@pytest.mark.parametrize(
    ("take", "expected"),
    [
        ("real", np.exp(-(ACROSS**2) - 2 * ALONG**2) * np.cos(ACROSS + 3 * ALONG)),
        ("modulus", np.exp(-(ACROSS**2) - 2 * ALONG**2)),
        ("phase", ACROSS + 3 * ALONG),  # within ±π on these
    ],
)
def test_a_complex_law_is_shown_as_what_its_wire_carries(take, expected):
    factor = Planar(Law.of(turned), symmetric=False, take=take)
    assert factor.plane(None, XI, ETA) == pytest.approx(expected, rel=1e-14, abs=1e-15)


@pytest.mark.parametrize(
    ("factor", "expected"),
    [
        (Separable(Law.of(halved), None), 1 - 0.5 * np.abs(XI)),
        (Separable(None, Law.of(halved)), 1 - 0.5 * np.abs(XI[::-1])),
        (Separable(None, None), np.ones(4)),
        (Separable(None, None, part="ptf"), np.zeros(4)),
        (
            Separable(Law.of(late, by=0.2), Law.of(late, by=-0.5), part="ptf"),
            -2 * np.pi * (0.2 * XI - 0.5 * XI[::-1]),
        ),
    ],
    ids=["across", "along", "no MTF", "no PTF", "both PTF"],
)
def test_a_missing_law_is_one_or_zero_at_every_pair(factor, expected):
    values = factor_at(None, factor, XI, XI[::-1])
    assert values.shape == expected.shape
    assert values == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_a_factor_with_its_axes_multiplied_ends_where_its_law_does():
    def disc(rho):
        return np.where(rho < 0.6, 1.0, 0.0)

    rescaled = Planar(Law.of(disc), radial=True, cutoff=(0.6, 0.6)).rescaled(2.0, 1.5)
    across, along = rescaled.cutoff
    xi, eta = np.array([0.0, 0.99 * across, 1.01 * across]), np.array([0.0, 0.99 * along])
    assert rescaled.plane(None, xi, np.zeros(1)).ravel().tolist() == [1.0, 1.0, 0.0]
    assert rescaled.plane(None, np.zeros(1), np.append(eta, 1.01 * along)).ravel().tolist() == [
        1.0, 1.0, 0.0,
    ]  # fmt: skip
