"""Radiometry against the reference values of 20 digits, and the rules between the noise figures."""

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.noise import noise_equivalent as ne
from core.physics.radiometry.planck import band_radiance, band_radiance_derivative
from reference_cases import reference_cases


def inputs(case):
    return {name: float(value) for name, value in case["inputs"].items()}


def assert_equal(got, expected):
    expected = float(expected)
    assert abs(got - expected) <= 1e-12 * abs(expected) + 1e-15


@pytest.mark.parametrize("case", reference_cases("band_radiance"))
def test_band_radiance(case):
    expected = case["expected"]
    assert_equal(band_radiance(**inputs(case)), expected["radiance_W_m2_sr"])
    assert_equal(band_radiance_derivative(**inputs(case)), expected["dL_dT_W_m2_sr_K"])


@pytest.mark.parametrize("case", reference_cases("optical_throughput_number"))
def test_throughput_number(case):
    assert_equal(ne.g_number(**inputs(case)), case["expected"]["g_number_per_sr"])


@pytest.mark.parametrize("case", reference_cases("noise_equivalent_radiance"))
def test_noise_equivalents(case):
    given, expected = inputs(case), case["expected"]
    area = ne.detector_area_cm2(
        pitch_x_um=given["pitch_um"],
        pitch_y_um=given["pitch_um"],
        fill_x=given["fill_factor_x"],
        fill_y=given["fill_factor_y"],
    )
    throughput = ne.g_number(
        f_number=given["f_number"],
        filter_transmission=given["filter_transmission"],
        optics_transmission=given["optics_transmission"],
    )
    nep = ne.nep_W(
        area_cm2=area, bandwidth_Hz=given["bandwidth_Hz"], d_star=given["d_star_cm_sqrtHz_per_W"]
    )
    ner = ne.ner_W_m2_sr(nep_W=nep, area_cm2=area, g_number=throughput)
    netd = ne.netd_K(
        noise_radiance=ner,
        cut_on_um=given["cut_on_um"],
        cut_off_um=given["cut_off_um"],
        background_K=given["background_K"],
    )
    # the power is 1e-14: only its relative error says something
    assert nep == pytest.approx(float(expected["nep_W"]), rel=1e-12, abs=0.0)
    assert_equal(ner, expected["ner_W_m2_sr"])
    assert_equal(netd, expected["netd_K"])


def test_system_and_amplifier():
    assert ne.system_netd_K(amplifier_netd_K=3.0, detector_netd_K=4.0) == pytest.approx(5.0)
    assert ne.amplifier_noise_radiance(reference_radiance=40.0, snr=4.0) == pytest.approx(10.0)
    assert ne.amplifier_noise_radiance(reference_radiance=0.0, snr=4.0) == 0.0


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_values_out_of_range_are_refused(bad):
    with pytest.raises(ParameterError, match="f_number"):
        ne.g_number(f_number=bad, filter_transmission=0.9, optics_transmission=0.9)
    with pytest.raises(ParameterError, match="optics_transmission"):
        ne.g_number(f_number=2.0, filter_transmission=0.9, optics_transmission=bad)
    with pytest.raises(ParameterError, match="d_star"):
        ne.nep_W(area_cm2=1.0, bandwidth_Hz=1.0, d_star=bad)
    with pytest.raises(ParameterError, match="fill_y"):
        ne.detector_area_cm2(pitch_x_um=25.0, pitch_y_um=25.0, fill_x=1.0, fill_y=bad)
    with pytest.raises(ParameterError, match="snr"):
        ne.amplifier_noise_radiance(reference_radiance=1.0, snr=bad)


def test_a_background_without_emission_is_refused():
    with pytest.raises(ParameterError, match="background_K"):
        ne.netd_K(noise_radiance=1.0, cut_on_um=3, cut_off_um=5, background_K=1.0)
