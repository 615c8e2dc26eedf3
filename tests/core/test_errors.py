"""Names that are near to one that is not there."""

import pytest

from core.errors import alike

KNOWN = ("gaussian_mtf", "jitter_mtf", "diffraction_mtf", "poisson_noise")


@pytest.mark.parametrize(
    ("name", "found"),
    [("jitter", "jitter_mtf"), ("gausian_mtf", "gaussian_mtf"), ("noise", "poisson_noise")],
)
def test_a_part_or_a_slip_finds_the_name(name, found):
    suggestion = alike(name, KNOWN)
    assert found in suggestion
    assert not [other for other in KNOWN if other != found and other in suggestion]
