"""Turbulence and aerosols against the published forms in higher precision."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import ParameterError
from core.physics.atmosphere.scattering_and_turbulence import (
    aerosol_mtf,
    fried_mtf,
    fried_r0_slant_m,
    fried_r0_uniform_m,
    hufnagel_valley_cn2,
    path_optical_depth,
    turbidity_optical_depth,
)

_RHO = np.array([0.0, 1e-12, 5e-4, 1e-3, 0.2, 1.0, 9.0, 1e6, 1e200])
_POSITIVE = st.floats(1e-300, 1e300)


@given(wavelength=_POSITIVE, r0=_POSITIVE, aperture=_POSITIVE, alpha=st.floats(0.0, 1.0))
def test_turbulence_is_passive_for_every_parameter(wavelength, r0, aperture, alpha):
    mtf = fried_mtf(
        rho=_RHO, wavelength_um=wavelength, fried_r0_m=r0, aperture_mm=aperture, alpha=alpha
    )
    _assert_passive(mtf)


@given(depth=st.floats(0.0, 1e300), cutoff=_POSITIVE)
def test_aerosol_is_passive_for_every_parameter(depth, cutoff):
    _assert_passive(aerosol_mtf(rho=_RHO, optical_depth=depth, cutoff_cyc_per_mrad=cutoff))


def _assert_passive(mtf):
    assert np.all(np.isfinite(mtf))
    assert np.all((mtf >= 0.0) & (mtf <= 1.0))
    assert mtf[0] == 1.0


def test_air_without_turbulence_is_exactly_one():
    np.testing.assert_array_equal(fried_mtf(rho=_RHO, wavelength_um=4.0, fried_r0_m=math.inf), 1.0)


def test_standard_profile_has_its_name_giving_coherence_diameter():
    """HV 5/7: r0 = 5 cm at 0.5 µm from the zenith."""
    r0 = fried_r0_slant_m(
        target_height_m=2e5, sensor_height_m=0.0, path_m=2e5, wavelength_um=0.5, wave="plane"
    )
    assert r0 == pytest.approx(0.05, rel=0.02)


def _cn2_truth(height):
    mpf = mpmath.mpf
    high = mpf("0.00594") * (mpf(21) / 27) ** 2 * (height / 100000) ** 10
    return (
        high * mpmath.exp(-height / 1000)
        + mpf("2.7e-16") * mpmath.exp(-height / 1500)
        + mpf("1.7e-14") * mpmath.exp(-height / 100)
    )


@pytest.mark.parametrize("wave", ["plane", "spherical"])
@pytest.mark.parametrize(
    ("target", "sensor", "path"),
    [(0.0, 3000.0, 3000.0), (12000.0, 5.0, 20000.0), (0.0, 8e5, 8e5), (10.0, 10.0, 402.0)],
)
def test_slant_path_against_direct_quadrature(wave, target, sensor, path):
    power = mpmath.mpf(5) / 3 if wave == "spherical" else mpmath.mpf(0)
    rise = sensor - target
    heights = [50, 100, 200, 400, 800, 1600, 3000, 6000, 9000, 12000, 16000, 25000, 50000, 100000]
    inner = sorted((h - target) / rise for h in heights) if rise else []
    edges = [0.0, *(u for u in inner if 0.0 < u < 1.0), 1.0]
    with mpmath.workdps(20):
        # mpmath stops at an absolute error, and Cn2 is about 1e-16.
        scaled = mpmath.quad(lambda u: 1e20 * _cn2_truth(target + rise * u) * u**power, edges)
        mean = scaled / mpmath.mpf("1e20")
        k = 2 * mpmath.pi / mpmath.mpf("4e-6")
        truth = (mpmath.mpf("0.423") * k**2 * path * mean) ** (mpmath.mpf(-3) / 5)
    got = fried_r0_slant_m(
        target_height_m=target, sensor_height_m=sensor, path_m=path, wavelength_um=4.0, wave=wave
    )
    assert got == pytest.approx(float(truth), rel=1e-12)


def test_uniform_path_is_the_level_slant_path():
    cn2 = float(hufnagel_valley_cn2(height_m=10.0))
    for wave in ("plane", "spherical"):
        level = fried_r0_slant_m(
            target_height_m=10.0, sensor_height_m=10.0, path_m=402.0, wavelength_um=10.0, wave=wave
        )
        uniform = fried_r0_uniform_m(cn2=cn2, path_m=402.0, wavelength_um=10.0, wave=wave)
        assert level == pytest.approx(uniform, rel=1e-13)
    assert fried_r0_uniform_m(cn2=0.0, path_m=402.0, wavelength_um=10.0) == math.inf


def test_profile_is_finite_at_every_height():
    cn2 = hufnagel_valley_cn2(height_m=[0.0, 1e4, 1e6, 1e300])
    assert np.all(np.isfinite(cn2))
    assert cn2[0] == pytest.approx(1.7e-14 + 2.7e-16, rel=1e-15)


@pytest.mark.parametrize(
    "call",
    [
        lambda: fried_mtf(rho=1.0, wavelength_um=4.0, fried_r0_m=0.0),
        lambda: fried_mtf(rho=1.0, wavelength_um=0.0, fried_r0_m=0.1),
        lambda: fried_mtf(rho=1.0, wavelength_um=4.0, fried_r0_m=0.1, alpha=0.5),
        lambda: fried_mtf(rho=1.0, wavelength_um=4.0, fried_r0_m=0.1, alpha=1.5),
        lambda: aerosol_mtf(rho=1.0, optical_depth=-1.0),
        lambda: aerosol_mtf(rho=1.0, optical_depth=1.0, cutoff_cyc_per_mrad=0.0),
        lambda: turbidity_optical_depth(level="thick"),
        lambda: path_optical_depth(
            scattering_per_km=1.0, path_m=1.0, view="sideways", scale_height_km=1.0
        ),
        lambda: fried_r0_uniform_m(cn2=1e-14, path_m=1.0, wavelength_um=4.0, wave="beam"),
        lambda: fried_r0_slant_m(
            target_height_m=0.0, sensor_height_m=100.0, path_m=50.0, wavelength_um=4.0
        ),
    ],
)
def test_values_out_of_range_are_refused(call):
    with pytest.raises(ParameterError, match=r"is not allowed|is empty"):
        call()  # type: ignore[operator]
