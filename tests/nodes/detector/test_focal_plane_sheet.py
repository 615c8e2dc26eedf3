"""Focal Plane: entries of data sheets in other forms, against hand calculations and statistics."""

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


@pytest.mark.parametrize(
    ("params", "line"),
    [
        ({"dark_current_A_per_cm2": 1e-9, "dark_current_e_per_s": 5.0},
         "dark_current_A_per_cm2 = 1e-09 A/cm² is not allowed: 0 if dark_current_e_per_s = 5"),
        ({**SILICON, "dark_reference_K": None}, "dark_reference_K"),
        ({**SILICON, "dark_doubling_K": None}, "dark_doubling_K"),
        ({**SILICON, "detector_K": None}, "rule_07 and dark_doubling_K need it"),
        ({"quantum_efficiency_percent": 60, "responsivity_A_per_W": 1, "responsivity_um": 4},
         "quantum_efficiency_percent = 60.0 % is not allowed: empty if responsivity_A_per_W is"),
        ({"responsivity_A_per_W": 4.0, "responsivity_um": 4.5}, "at most 3.629 at 4.5 µm"),
        ({"responsivity_A_per_W": 1.0}, "responsivity_um"),
        ({"responsivity_um": 4.0}, "responsivity_A_per_W"),
        ({**SILICON, "dark_doubling_K": 0.1}, "at least 0.3 for temperatures 30 K apart"),
    ],
)  # fmt: skip
def test_entries_that_do_not_fit_are_refused_in_one_line(tmp_path, params, line):
    error = focal_plane_bench(tmp_path, {**CAMERA_SHEET, **params}, size=(8, 6)).error("it")
    assert isinstance(error, ParameterError)
    assert line in str(error)
    assert "\n" not in str(error)
