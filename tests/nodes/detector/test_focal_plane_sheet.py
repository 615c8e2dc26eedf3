"""Focal Plane: entries of data sheets in other forms, against hand calculations and statistics."""

import math

import pytest

from core.errors import ParameterError
from focal_plane_bench import CAMERA_SHEET, cautions, focal_plane_bench

CHARGE_C = 1.602176634e-19
HC_J_M = 6.62607015e-34 * 299792458.0
SILICON = {"dark_current_A_per_cm2": 1e-9, "detector_K": 263.15, "dark_reference_K": 293.15,
           "dark_doubling_K": 6.0}  # fmt: skip


def figures_of(folder, params, **how):
    return focal_plane_bench(folder, {**CAMERA_SHEET, **params}, size=(8, 6), **how).readouts("it")


def test_dark_current_by_density_and_doubling(tmp_path):
    """1 nA/cm² on 15 × 15 µm at 20 °C, five times halved at -10 °C, in 4 ms."""
    wanted = 1e-9 * 15e-4 * 15e-4 / CHARGE_C / 32 * 0.004
    dense = figures_of(tmp_path, SILICON)
    assert dense["dark_e"] == pytest.approx(wanted, rel=1e-12)
    # The same current as electrons at the detector's own temperature.
    given = {"dark_current_e_per_s": wanted / 0.004}
    assert figures_of(tmp_path, given)["dark_e"] == pytest.approx(wanted, rel=1e-12)
    warm = {**given, "detector_K": 303.15, "dark_reference_K": 293.15, "dark_doubling_K": 8.0}
    assert figures_of(tmp_path, warm)["dark_e"] == pytest.approx(wanted * 2**1.25, rel=1e-12)


@pytest.mark.parametrize(
    "name", ["dark_current_e_per_s", "dark_current_A_per_cm2", "dark_doubling_K"]
)
def test_rule_07_sets_other_dark_currents_aside(tmp_path, name):
    rule = {"rule_07": True, "detector_K": 120.0, "material_cutoff_um": 5.0}
    params = {**rule, "dark_reference_K": 77.0, "dark_doubling_K": 8.0, name: 10.0}
    if name != "dark_doubling_K":
        del params["dark_reference_K"], params["dark_doubling_K"]
    bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 6))
    (found,) = cautions(bench, "dark_current")
    assert f"{name} = 10" in found.text
    plain = figures_of(tmp_path, rule)["dark_e"]
    assert bench.readouts("it")["dark_e"] == plain


@pytest.mark.parametrize(
    "params",
    [
        {"quantum_efficiency_percent": 62.0},
        # 0.62·q·λ/(hc): 2.25028 A/W at 4.5 µm
        {"responsivity_A_per_W": 0.62 * CHARGE_C * 4.5e-6 / HC_J_M, "responsivity_um": 4.5},
    ],
    ids=["per cent", "A/W"],
)
def test_quantum_efficiency_in_other_forms(tmp_path, params):
    wanted = figures_of(tmp_path, {"quantum_efficiency": 0.62})
    bench = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 6))
    assert bench.readouts("it")["signal_e"] == pytest.approx(wanted["signal_e"], rel=1e-12)
    table = bench.value("it.table").as_dict()
    assert table["quantum_efficiency"] == pytest.approx(0.62, rel=1e-12)


def exposure_of(electrons):
    """For a signal of so many electrons of the reference camera at 300 K."""
    return {"integration_time_s": 0.004 * electrons / 584765.21021844287024}


EMCCD = {
    "charge_gain": "em_register", "charge_gain_factor": 300.0, "read_noise_e": 60.0, "bits": 16,
    "full_well_e": 80_000, "register_well_e": 600_000, "gain_e_per_dn": 12.0, "offset_dn": 100.0,
}  # fmt: skip
QWIP = {
    "charge_gain": "photoconductive", "charge_gain_factor": 0.3, "read_noise_e": 400.0,
    "full_well_e": 7e6, "bits": 14, "quantum_efficiency": 0.1,
}  # fmt: skip


def test_an_emccd_by_hand_and_in_a_picture(tmp_path):
    """30 electrons: F = (2·299·300^(-1/536) + 1)/300, 0.2 e- of read noise, K of 0.04 e-/DN."""
    size = (300, 200)
    params = {**CAMERA_SHEET, **EMCCD, **exposure_of(30.0)}
    bench = focal_plane_bench(tmp_path, params, size=size)
    found, factor = bench.readouts("it"), (2 * 299 * 300 ** (-1 / 536) + 1) / 300
    assert found["signal_e"] == pytest.approx(30.0, rel=1e-9)
    assert found["shot_noise_e"] == pytest.approx(math.sqrt(30.0), rel=1e-9)
    assert found["excess_noise_e"] == pytest.approx(math.sqrt((factor - 1) * 30), rel=1e-9)
    assert found["read_noise_e"] == pytest.approx(0.2, rel=1e-12)
    assert found["gain_e_per_dn"] == pytest.approx(0.04, rel=1e-12)
    temporal = math.sqrt(factor * 30 + 0.2**2 + 0.04**2 / 12)
    assert found["temporal_noise_e"] == pytest.approx(temporal, rel=1e-9)
    assert found["snr"] == pytest.approx(30 / temporal, rel=1e-9)
    assert found["mean_dn"] == pytest.approx(30 * 300 / 12 + 100, rel=1e-9)
    # 600 000 e- in the register are 2000 before it, less than the pixel's 80 000.
    assert found["well_fill_percent"] == pytest.approx(100 * 30 / 2000, rel=1e-9)
    table = bench.value("it.table").as_dict()
    assert table["snr_max"] == pytest.approx(math.sqrt(2000 / factor), rel=1e-9)
    threshold = (math.hypot(0.2, 0.04 / math.sqrt(12)) + factor / 2) / 0.7
    assert table["sensitivity_threshold_photons"] == pytest.approx(threshold, rel=1e-9)
    electrons, count = bench.value("it.electrons"), size[0] * size[1]
    assert electrons.mean() == pytest.approx(30.0, abs=4 * temporal / math.sqrt(count))
    # Poisson sum of exponentials: third moment 6·N, fourth 24·N + 3·variance².
    assert electrons.var() == pytest.approx(temporal**2, rel=4 * math.sqrt((2 + 0.7) / count))
    skew = ((electrons - electrons.mean()) ** 3).mean()
    assert skew == pytest.approx(6 * 30, rel=0.15)


def test_a_photoconductor_by_hand(tmp_path):
    """Recombination doubles the variance; well, read noise and numbers are behind the gain."""
    plain, found = (
        figures_of(tmp_path, {"quantum_efficiency": 0.1, "bits": 14}), figures_of(tmp_path, QWIP)
    )  # fmt: skip
    signal = plain["signal_e"]
    assert found["signal_e"] == signal
    assert found["excess_noise_e"] == pytest.approx(math.sqrt(signal), rel=1e-12)
    step = 7e6 / 16383 / 0.3
    noise = math.sqrt(2 * signal + (400 / 0.3) ** 2 + step**2 / 12)
    assert found["netd_K"] == pytest.approx(
        plain["netd_K"] * noise / plain["temporal_noise_e"], rel=1e-12
    )
    assert found["well_fill_percent"] == pytest.approx(100 * 0.3 * signal / 7e6, rel=1e-12)
    # The data sheet's amperes include the gain: 0.3·0.1·q·λ/(hc) at 4.5 µm, and J·A/q behind it.
    sheet = {
        **QWIP, "responsivity_A_per_W": 0.03 * CHARGE_C * 4.5e-6 / HC_J_M, "responsivity_um": 4.5,
        "dark_current_A_per_cm2": 1e-6,
    }  # fmt: skip
    other = figures_of(tmp_path, sheet)
    assert other["signal_e"] == pytest.approx(signal, rel=1e-12)
    assert other["dark_e"] * 0.3 == pytest.approx(1e-6 * 225e-8 / CHARGE_C * 0.004, rel=1e-12)


def test_excess_noise_in_noise_budget_and_figures_of_merit(tmp_path):
    bench = focal_plane_bench(
        tmp_path, {**CAMERA_SHEET, **QWIP}, behind=("figures_of_merit", "noise_budget")
    )
    own, found = bench.readouts("it"), bench.readouts("noise_budget")
    assert bench.readouts("figures_of_merit")["netd_K"] == pytest.approx(own["netd_K"], rel=1e-6)
    temporal = own["temporal_noise_e"] / own["gain_e_per_dn"]
    assert found["sigma_temporal"] == pytest.approx(temporal, rel=1e-6)
    assert "Excess" in bench.value("noise_budget.noise").bars


def test_a_gain_setting_in_decibels_moves_the_converter_and_not_the_noise(tmp_path):
    """26.0206 dB is a factor of 20: 4 e-/DN of 80, and 12 bits clip at 16 380 electrons."""
    params = {"gain_e_per_dn": 80.0, "bits": 12, **exposure_of(15_000.0)}
    found = figures_of(tmp_path, {**params, "gain_dB": 20 * math.log10(20)})
    assert found["gain_e_per_dn"] == pytest.approx(4.0, rel=1e-12)
    assert found["mean_dn"] == pytest.approx(15_000 / 4, rel=1e-9)
    assert found["quantization_noise_e"] == pytest.approx(4 / math.sqrt(12), rel=1e-12)
    assert found["shot_noise_e"] == figures_of(tmp_path, params)["shot_noise_e"]
    dark = math.sqrt(400**2 + 4**2 / 12)
    assert found["dynamic_range_dB"] == pytest.approx(20 * math.log10(4 * 4095 / dark), rel=1e-12)
    more = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params, "gain_dB": 30.0})
    assert more.readouts("it")["snr"] is None
    assert (more.value("it.image") == 4095).mean() > 0.99


def test_a_gain_of_no_kind_is_warned_of(tmp_path):
    params = {**CAMERA_SHEET, "charge_gain_factor": 100.0}
    (found,) = cautions(focal_plane_bench(tmp_path, params, size=(8, 6)), "unused_gain")
    assert "charge_gain_factor = 100" in found.text


@pytest.mark.parametrize(
    ("params", "line"),
    [
        ({"dark_current_A_per_cm2": 1e-9, "dark_current_e_per_s": 5.0},
         "dark_current_A_per_cm2 = 1e-09 A/cm² is not allowed: 0 if dark_current_e_per_s = 5"),
        ({**SILICON, "dark_reference_K": None}, "dark_reference_K"),
        ({**SILICON, "dark_doubling_K": None}, "dark_doubling_K"),
        ({**SILICON, "detector_K": None}, "dark_doubling_K need the detector's temperature"),
        ({"quantum_efficiency_percent": 60, "responsivity_A_per_W": 1, "responsivity_um": 4},
         "quantum_efficiency_percent = 60.0 % is not allowed: empty if responsivity_A_per_W is"),
        ({"responsivity_A_per_W": 4.0, "responsivity_um": 4.5}, "at most 3.629 at 4.5 µm"),
        ({"responsivity_A_per_W": 1.0}, "responsivity_um"),
        ({"responsivity_um": 4.0}, "responsivity_A_per_W"),
        ({"charge_gain": "avalanche", "charge_gain_factor": 0.5, "ionization_ratio": 0.1},
         "at least 1 for avalanche"),
        ({"charge_gain": "em_register", "charge_gain_factor": 0.5}, "at least 1 for em_register"),
        ({**SILICON, "dark_doubling_K": 0.1}, "at least 0.3 for temperatures 30 K apart"),
    ],
)  # fmt: skip
def test_entries_that_do_not_fit_are_refused_in_one_line(tmp_path, params, line):
    error = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 6)).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)
    assert "\n" not in str(error)
