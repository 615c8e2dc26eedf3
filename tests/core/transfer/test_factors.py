"""What one factor is, shown on a plane and at pairs of frequencies."""

import numpy as np
import pytest

from core.transfer.factors import Law, Planar

XI, ETA = np.array([0.0, 0.3, -0.4, 0.5]), np.array([0.1, -0.2, 0.7])
ALONG, ACROSS = np.meshgrid(ETA, XI, indexing="ij")


def turned(xi, eta):
    """A modulus that is never the real part, and a phase odd in each axis."""
    return np.exp(-(xi**2) - 2 * eta**2) * np.exp(1j * (xi + 3 * eta))


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
