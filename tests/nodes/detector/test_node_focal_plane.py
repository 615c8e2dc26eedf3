"""Focal Plane and its data sheet."""

import math

import numpy as np
import pytest
from scipy import stats

from core.chain.random_fields import at_frame
from core.errors import ParameterError
from core.evaluation.recipes import Region
from core.physics.radiometry.planck import band_radiance
from focal_plane_bench import CAMERA_SHEET, MWIR, cautions, focal_plane_bench
from reference_cases import CAMERA, reference_cases

CONVERTED = {  # of the reference: what Init & Trans is given
    "pitch_um": ("detector_x_um", "detector_y_um"),
    "f_number": ("f_number",),
    "fill": ("fill_x",),
}


@pytest.mark.parametrize("case", reference_cases("focal_plane", file=CAMERA))
def test_the_readouts_of_a_focal_plane_of_the_reference(case, tmp_path):
    given = {name: float(value) for name, value in case["inputs"].items()}
    init = {}
    for name, places in CONVERTED.items():
        value = given.pop(name)
        init |= dict.fromkeys(places, value)
    scene = {"temperature_K": given.pop("scene_K")}
    scene |= {name: given[name] for name in ("cut_on_um", "cut_off_um")}
    for name in ("bits", "tdi_stages"):
        if name in given:
            given[name] = int(given[name])
    bench = focal_plane_bench(
        tmp_path, given, init={**init, "fill_y": 1.0}, scene=scene, size=(4, 3)
    )
    found = bench.readouts("it")
    for name, value in case["expected"].items():
        assert found[name] == pytest.approx(float(value), rel=1e-9, abs=0.0), name
    assert found["snr"] == pytest.approx(found["signal_e"] / found["temporal_noise_e"])


def test_electrons_are_poisson_distributed_pixel_by_pixel(tmp_path):
    dim = {"integration_time_s": 6e-8, "units": "electrons"}
    bench = focal_plane_bench(
        tmp_path, dim, size=(300, 300), scene={"kind": "two_panel", "delta_K": 40}
    )
    electrons = bench.value("it.electrons")
    expected = bench.readouts("it")["signal_e"]
    assert 5 < expected < 60
    for half in (electrons[:, :150], electrons[:, 150:]):
        assert half.var() == pytest.approx(half.mean(), rel=0.03)
        assert stats.skew(half.ravel()) == pytest.approx(1 / math.sqrt(half.mean()), rel=0.15)
    np.testing.assert_array_equal(bench.value("it.image"), electrons)


def test_the_order_is_pattern_then_read_noise_then_well_then_numbers(tmp_path):
    """Fixed patterns multiply and add what was collected; the well cuts what was read."""
    params = {**CAMERA_SHEET, "prnu_percent": 2.0, "dsnu_e": 5000.0, "offset_dn": 100.0}
    one = focal_plane_bench(tmp_path, params, size=(200, 200))
    electrons = one.value("it.electrons")
    found = one.readouts("it")
    total = found["signal_e"]
    assert found["fixed_pattern_e"] == pytest.approx(math.hypot(0.02 * total, 5000.0))
    spread = math.hypot(found["fixed_pattern_e"], found["shot_noise_e"], 400.0)
    assert electrons.std() == pytest.approx(spread, rel=0.02)
    image = one.value("it.image")
    gain = found["gain_e_per_dn"]
    np.testing.assert_array_equal(image, np.clip(np.rint(electrons / gain + 100.0), 0, 16383))
    full = focal_plane_bench(tmp_path, {**params, "full_well_e": total})
    assert full.value("it.electrons").max() == total
    assert full.value("it.image").max() == np.rint(16383 + 100.0) - 100  # the last number
    marked = full.value("it.saturated")
    np.testing.assert_array_equal(
        marked == 1.0,
        np.rint(full.value("it.electrons") / full.readouts("it")["gain_e_per_dn"] + 100) > 16383,
    )
    assert full.readouts("it")["saturated_pixels"] == np.count_nonzero(marked)
    assert 0.4 < marked.mean() < 0.7


def test_noise_and_responsivity_are_those_behind_the_nonlinearity(tmp_path):
    """At 70 % of the well, bent by 10 %: measured in a picture, and between two scenes."""
    params = {**CAMERA_SHEET, "nonlinearity_percent": 10.0, "prnu_percent": 0.1, "bits": 0}
    params["integration_time_s"] = 0.7 * 7e6 / (584765.21021844287024 / 0.004)
    bench = focal_plane_bench(tmp_path, params, size=(256, 256))
    found, electrons = bench.readouts("it"), bench.value("it.electrons")
    slope = 1 - 2 * 0.1 * found["well_fill_percent"] / 100
    assert found["shot_noise_e"] == pytest.approx(slope * math.sqrt(found["signal_e"]), rel=1e-12)
    spread = math.hypot(found["temporal_noise_e"], found["fixed_pattern_e"])
    assert electrons.std() == pytest.approx(spread, rel=0.01)
    warmer = focal_plane_bench(tmp_path, params, size=(256, 256), scene={"temperature_K": 300.2})
    rise = (warmer.value("it.electrons").mean() - electrons.mean()) / 0.2
    assert found["responsivity_e_per_K"] == pytest.approx(rise, rel=0.01)
    assert found["netd_K"] == pytest.approx(
        found["temporal_noise_e"] / found["responsivity_e_per_K"], rel=1e-12
    )


def test_frames_averaged_lower_shot_and_read_noise_by_their_root(tmp_path):
    one, many = (
        focal_plane_bench(
            tmp_path, {**CAMERA_SHEET, "bits": 0, "frames_averaged": n}, size=(200, 200)
        )
        for n in (1, 16)
    )
    assert many.value("it.electrons").std() == pytest.approx(
        one.value("it.electrons").std() / 4, rel=0.02
    )
    ratio = one.readouts("it")["netd_K"] / many.readouts("it")["netd_K"]
    assert ratio == pytest.approx(4.0, rel=1e-12)
    assert many.value("it.electrons").mean() == pytest.approx(
        one.value("it.electrons").mean(), rel=1e-4
    )


def test_patterns_and_bad_pixels_stay_from_frame_to_frame_and_noise_does_not(tmp_path):
    params = {**CAMERA_SHEET, "bits": 0, "bad_pixel_percent": 1.0, "prnu_percent": 3.0}
    bench = focal_plane_bench(tmp_path, params, size=(80, 60))
    first = bench.value("it.electrons")
    second = bench.work.value(at_frame(bench.port("it.electrons").recipe, 1))
    bad = (first == 0.0) | (first == 7e6)
    assert np.count_nonzero(bad) == 48
    np.testing.assert_array_equal(bad, (second == 0.0) | (second == 7e6))
    assert (first[bad] == second[bad]).all()
    assert (first[~bad] != second[~bad]).mean() > 0.99
    both = np.corrcoef(first[~bad], second[~bad])[0, 1]
    total = bench.readouts("it")["signal_e"]
    pattern, temporal = (0.03 * total) ** 2, total + 400.0**2
    assert both == pytest.approx(pattern / (pattern + temporal), abs=0.02)


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("port", ["image", "electrons", "noise", "saturated"])
def test_a_region_has_the_bits_of_the_whole(tmp_path, precision, port):
    params = {
        **CAMERA_SHEET, "integration_time_s": 2e-5, "prnu_percent": 1, "dsnu_e": 10,
        "bad_pixel_percent": 5, "nonlinearity_percent": 2, "full_well_e": 1e4,
    }  # fmt: skip
    scene = {"kind": "dormitory"}
    benches = [
        focal_plane_bench(tmp_path, params, scene=scene, size=(97, 61), precision=precision)
        for _ in range(2)
    ]
    whole = benches[0].value(f"it.{port}")
    region = Region(13, 29, 21, 40)
    part = benches[1].work.part(benches[1].port(f"it.{port}").recipe, region)
    np.testing.assert_array_equal(part, whole[region.slices])


def test_a_response_file_takes_the_place_of_the_number(tmp_path):
    (tmp_path / "qe.csv").write_text("um,QE\n3.0,0.7\n5.2,0.7\n")
    sheet = {**CAMERA_SHEET, "reference_radiance": 2.0}
    number = focal_plane_bench(tmp_path, sheet).readouts("it")
    params = {**sheet, "response": "qe.csv", "quantum_efficiency": 0.1}
    for name, value in focal_plane_bench(tmp_path, params).readouts("it").items():
        if name == "photon_weighting":
            continue
        assert value == pytest.approx(number[name], rel=1e-11), name
    (tmp_path / "qe.csv").write_text("# none beyond 4 µm\n3.0;0.7\n4.0;0.7\n")
    short = focal_plane_bench(tmp_path, params).readouts("it")
    narrow = focal_plane_bench(tmp_path, {**CAMERA_SHEET, "cut_off_um": 4.0}).readouts("it")
    assert short["signal_e"] == pytest.approx(narrow["signal_e"], rel=1e-11)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("3.9,0.5\n4.5,0.7\n",
         "begins at 3.9 µm with a value of 0.5 and ends at 4.5 µm with a value of 0.7"),
        ("3.7,0.5\n4.8,0.7\n", ""), ("3.9,0\n4.2,0.7\n4.5,0\n", ""),
    ],
)  # fmt: skip
def test_a_response_that_ends_within_the_band_is_told(tmp_path, text, said):
    (tmp_path / "qe.csv").write_text(text)
    told = cautions(focal_plane_bench(tmp_path, {"response": "qe.csv"}), "response_ends")
    assert [said in caution.message for caution in told] == [True] * bool(said)


def test_reflected_light_has_no_netd(tmp_path):
    scene = {"cut_on_um": 0.5, "cut_off_um": 0.9, "temperature_K": 1500.0}
    for weighting in ("source", "scene"):
        params = {**CAMERA_SHEET, "photon_weighting": weighting, "full_well_e": 1e9}
        found = focal_plane_bench(tmp_path, params, scene=scene).readouts("it")
        assert found["netd_K"] is None
        assert found["responsivity_e_per_K"] is None
    table = focal_plane_bench(tmp_path, {**CAMERA_SHEET, "photon_weighting": "source"}, scene=scene)
    rows = table.value("it.table").as_dict()
    assert rows["photon_weighting"] == "source"
    assert rows["signal_by_scene_e"] is None
    assert rows["signal_by_source_e"] == rows["signal_e"]
    assert rows["signal_by_middle_e"] == pytest.approx(rows["signal_e"], rel=0.05)


def test_what_the_weighting_is_worth(tmp_path):
    rows = focal_plane_bench(tmp_path, CAMERA_SHEET).value("it.table").as_dict()
    radiance = band_radiance(temperature_K=300.0, **MWIR)
    h_c = 6.62607015e-34 * 299792458.0
    k = math.pi / 65 * 0.765 * 0.7 * 0.004 * (15e-6 * 0.95) ** 2
    assert rows["signal_by_middle_e"] == pytest.approx(k * radiance * 4.25e-6 / h_c, rel=1e-12)
    assert rows["signal_by_scene_e"] == pytest.approx(rows["signal_e"], rel=1e-13)
    assert rows["signal_by_source_e"] < rows["signal_by_middle_e"] < rows["signal_e"]
    worth = (rows["signal_e"] - rows["signal_by_source_e"]) / rows["signal_e"]
    assert rows["weighting_worth_percent"] == pytest.approx(100 * worth, rel=1e-12)
    assert focal_plane_bench(tmp_path, CAMERA_SHEET).readouts("it")["photon_weighting"] == "scene"


@pytest.mark.parametrize(
    ("params", "line"),
    [
        ({"bits": 12}, "gain_e_per_dn"),
        ({"nonlinearity_percent": 1}, "full_well_e"),
        ({"cold_shield_efficiency": 0.9}, "housing_K"),
        ({"rule_07": True, "detector_K": 77}, "material_cutoff_um"),
        ({"cut_on_um": 5.0, "cut_off_um": 4.0}, "cut_off_um"),
        ({"bits": 25, "full_well_e": 1e6}, "bits = 25 bit is not allowed: must be a whole number"),
    ],
)  # fmt: skip
def test_what_lacks_a_value_is_refused_in_one_line(tmp_path, params, line):
    error = focal_plane_bench(tmp_path, params).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("3.0,0.7\n", "1 point; a curve needs at least 2"),
        ("3.0,0.7\n2.0,0.7\n", "line 2: must contain a larger wavelength than the previous one, 3"),
        ("3.0,0.7\n4.0,1.7\n", "quantum efficiency from 0 to 1"),
        ("3.0,0.7\nfour,0.5\n", "line 2: must contain two numbers"),
        ("3.0,O.7\n4.0,0.7\n5.0,0.7\n", "line 1: must contain two numbers"),
        ("3;0,7\n4;0\n5;1\n", "line 1: must contain two numbers"),
        ('3,0.5\n4,"' + "9" * 200_000 + '"\n', "line 2: "),
        ("6,0.5\n7,0.5\n", "must overlap the band, 3.7 to 4.8 µm"),
    ],
)
def test_a_response_that_is_none_is_refused(tmp_path, text, line):
    (tmp_path / "qe.csv").write_text(text)
    error = focal_plane_bench(tmp_path, {"response": "qe.csv"}).error("it")
    assert line in str(error)
    assert "\n" not in str(error)


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
         "1e-09 A/cm² is not allowed: must be 0 if dark_current_e_per_s = 5"),
        ({**SILICON, "dark_reference_K": None}, "dark_reference_K"),
        ({**SILICON, "dark_doubling_K": None}, "dark_doubling_K"),
        ({**SILICON, "detector_K": None}, "dark_doubling_K need the detector's temperature"),
        ({"quantum_efficiency_percent": 60, "responsivity_A_per_W": 1, "responsivity_um": 4},
         "= 60.0 % is not allowed: must be empty if responsivity_A_per_W is"),
        ({"responsivity_A_per_W": 4.0, "responsivity_um": 4.5}, "at most 3.629 at 4.5 µm"),
        ({"responsivity_A_per_W": 1.0}, "responsivity_um"),
        ({"responsivity_um": 4.0}, "responsivity_A_per_W"),
        ({"charge_gain": "avalanche", "charge_gain_factor": 0.5, "ionization_ratio": 0.1},
         "at least 1 for charge_gain = avalanche"),
        ({"charge_gain": "em_register", "charge_gain_factor": 0.5},
         "at least 1 for charge_gain = em_register"),
        ({**SILICON, "dark_doubling_K": 0.1},
         "at least 0.3 if detector_K is 30 K from dark_reference_K"),
    ],
)  # fmt: skip
def test_entries_that_do_not_fit_are_refused_in_one_line(tmp_path, params, line):
    error = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 6)).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)
    assert "\n" not in str(error)
