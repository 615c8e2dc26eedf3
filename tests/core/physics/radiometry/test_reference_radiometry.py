"""Radiometry against the reference values of 20 digits, and the rules between the noise figures."""

import pytest

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
