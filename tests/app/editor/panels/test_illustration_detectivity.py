"""D*(λ) and NETDs on the panel of Electronics & Noise, against formulas and printed figures."""

import math

import numpy as np
import pytest
from scipy import constants, integrate

from app.editor.panels.illustrations.electronics_illustration import DetectivityQuery
from app.run.shipped import shipped_networks
from core.network.file import load_network
from core.network.network import Network, Node
from illustration_hands import INFRAMETRICS, LIBRARY, answer, sensor


def background_limit(wavelength_um, *, efficiency, cut_off_um, factor, kelvin, half_angle_deg):
    """(λ/hc)·√(η/(m·Q)), cm √Hz/W, Q the photons of a black body in a cone, m⁻² s⁻¹."""
    h, c, k = constants.h, constants.c, constants.k

    def photons(wavelength_m):
        return 2 * c / wavelength_m**4 / math.expm1(h * c / (wavelength_m * k * kelvin))

    radiance, _ = integrate.quad(photons, 0.5e-6, cut_off_um * 1e-6, epsrel=1e-10, limit=200)
    flux = math.pi * math.sin(math.radians(half_angle_deg)) ** 2 * radiance
    return 100 * wavelength_um * 1e-6 / (h * c) * math.sqrt(efficiency / (factor * flux))


def loose(**params):
    """Electronics & Noise without inputs: the makers' conditions, 300 K in a cone of 60°."""
    return answer(
        DetectivityQuery("node"), Network(nodes={"node": Node("node", "electronics_noise", params)})
    )


@pytest.mark.parametrize(
    ("material", "efficiency", "cut_off"), [("HgCdTe", 0.7, 12.5), ("Si:Ga", 0.3, 17.1)]
)
def test_the_curve_of_a_background_limited_detector(material, efficiency, cut_off):
    found = loose(region="LWIR", material=material)
    inside = found.wavelength_um <= cut_off
    expected = background_limit(
        found.wavelength_um[inside],
        efficiency=efficiency,
        cut_off_um=cut_off,
        factor=4,
        kelvin=300.0,
        half_angle_deg=30.0,
    )
    np.testing.assert_allclose(found.values[inside], expected, rtol=1e-6)
    assert found.values[-1] == 0
    assert found.wavelength_um[-1] == pytest.approx(cut_off)
    assert found.peak.wavelength_um == pytest.approx(cut_off)
    assert found.conditions == "300 K in a cone of 60°"
    assert found.noises is None
    assert "not connected" in found.problem


@pytest.mark.parametrize(
    ("region", "material", "band", "peak_um", "stated"),
    [  # EG&G Judson 1995 for the infrared, a maker's 1 GΩ of 1 mm² for silicon
        ("LWIR", "HgCdTe", {}, 12.5, 4e10),
        ("MWIR", "InSb", {"cut_on_um": 3.0, "cut_off_um": 5.0}, 5.0, 1e11),
        ("VIS", "Si", {}, 1.107, 1e13),
    ],
)
def test_peaks_are_about_what_makers_state(region, material, band, peak_um, stated):
    found = loose(region=region, material=material, **band)
    assert found.peak.wavelength_um == pytest.approx(peak_um)
    assert stated / 2 < found.peak.d_star < stated * 2


def test_the_curve_of_a_sensor_sees_the_scene_through_its_optics():
    params = {"region": "LWIR", "material": "HgCdTe", "scan_mirror_rate_Hz": 16.0}
    scene = {"kind": "uniform", "temperature_K": 290.0}
    network = sensor("electronics_noise", params, scene=scene, init=INFRAMETRICS)
    found = answer(DetectivityQuery("node"), network)
    half_angle = math.degrees(math.atan(1 / 3.5))
    expected = background_limit(
        12.0, efficiency=0.7, cut_off_um=12.5, factor=4, kelvin=290.0, half_angle_deg=half_angle
    )
    assert found.peak.wavelength_um == pytest.approx(12.0)  # the band ends before the material
    assert found.peak.d_star == pytest.approx(expected, rel=1e-4)
    assert found.band_um == (8.0, 12.0)
    least = background_limit(
        8.0, efficiency=0.7, cut_off_um=12.5, factor=4, kelvin=290.0, half_angle_deg=half_angle
    )
    assert least < found.band_d_star < expected
    assert not found.typed
    noises = found.noises
    assert noises.system_K == pytest.approx(math.hypot(noises.detector_K, noises.amplifier_K))


def test_the_published_netd_of_a_typed_detectivity():
    network = load_network(shipped_networks()["kodak_kir310_1996"], library=LIBRARY)
    network = network.with_parameter("electronics", "background_K", 305.0)
    found = answer(DetectivityQuery("electronics"), network)
    assert found.typed
    assert found.band_d_star == 3e13
    assert found.noises.detector_K == pytest.approx(0.0065, abs=5e-5)  # table 5.4, at 305 K


def test_a_manual_detector_has_no_curve():
    found = loose(region="LWIR", material="manual", d_star=2e10)
    assert found.peak is None
    assert not found.values.size
    assert found.band_d_star == 2e10
