"""Single formulas for other programs: what they are called with, and that none lacks a source."""

import inspect

import numpy as np
import pytest

import imagechain as ic
from reference_cases import CAMERA, reference_cases

QUANTITIES = ("giqe_oblique", "field_of_view", "diffusion_mtf", "rule_07")


@pytest.mark.parametrize("case", reference_cases(*QUANTITIES, file=CAMERA))
def test_the_reference(case):
    given = {name: float(value) for name, value in case["inputs"].items()}
    if "pixels" in given:
        given["pixels"] = int(given["pixels"])
    found = getattr(ic.physics, case["quantity"])(**given)
    expected = [float(value) for value in case["expected"].values()]
    assert np.atleast_1d(found) == pytest.approx(expected, rel=1e-9)
    if hasattr(found, "_fields"):
        assert list(case["expected"]) == list(found._fields)


@pytest.mark.parametrize("name", [n for n in ic.physics.__all__ if n != "ObliqueQuality"])
def test_each_is_documented_with_its_source(name):
    function = getattr(ic.physics, name)
    assert "Source:" in inspect.getdoc(function)
    assert inspect.signature(function).parameters


def test_a_lens_by_its_cutoff():
    """F/4 at 0.5 µm: 500 cycles/mm; a quarter of it by the disc's closed form."""
    at = np.array([0.0, 125.0, 500.0, 900.0])
    found = ic.physics.diffraction_otf(cycles_per_mm=at, wavelength_um=0.5, f_number=4)
    v = 0.25
    disc = 2 / np.pi * (np.arccos(v) - v * np.sqrt(1 - v * v))
    assert found == pytest.approx([1.0, disc, 0.0, 0.0], abs=1e-14)
    white = ic.physics.planck_radiance(wavelength_um=10.0, temperature_K=300.0)
    assert float(white) == pytest.approx(9.9240, abs=1e-3)
    with pytest.raises(ic.ParameterError, match="f_number"):
        ic.physics.solid_angle(f_number=-1)
