"""The shipped cameras of today, against formulas written out here and by the command line."""

import math
from functools import lru_cache

import mpmath
import numpy as np
import pytest
from scipy import constants

from command_line import run_here
from core.physics.atmosphere.air_path import luminous_efficiency, standard_sun_irradiance
from node_bench import shipped_bench

MWIR = {"pitch": 15e-6, "fill": 0.95**2, "f_number": 4, "transmission": 0.765, "efficiency": 0.7}
BAND_UM = 3.7, 4.8
BANDS_UM = {
    "mwir_camera": [3.7, 4.8],
    "microbolometer": [8.0, 14.0],
    "satellite_tdi": [0.5, 0.8],
    "dirsig_cube": [3.0, 5.0],
    "visible_camera": [0.4, 0.7],
    "swir_camera": [0.9, 1.7],
}


@lru_cache
def photon_radiance(kelvin):
    """Photons of a black body in the band, per m² s sr."""
    h, c, k = constants.h, constants.c, constants.k

    def spectral(um):
        metres = um * mpmath.mpf("1e-6")
        return 2 * c / metres**4 / mpmath.expm1(h * c / (metres * k * kelvin)) * 1e-6

    return float(mpmath.quad(spectral, BAND_UM))


def netd(integration_s, kelvin, read_e=400.0, well_e=7e6, bits=14):
    """Shot, read and rounding noise over the electrons of a kelvin."""
    per_photon = (
        integration_s * MWIR["pitch"] ** 2 * MWIR["fill"] * MWIR["efficiency"]
        * MWIR["transmission"] * math.pi / (4 * MWIR["f_number"] ** 2 + 1)
    )  # fmt: skip
    electrons = per_photon * photon_radiance(kelvin)
    rounding = well_e / (2**bits - 1) / math.sqrt(12)
    step = 0.01
    warmer, cooler = photon_radiance(kelvin + step), photon_radiance(kelvin - step)
    slope = per_photon * (warmer - cooler) / (2 * step)
    return math.sqrt(electrons + read_e**2 + rounding**2) / slope


def test_the_netd_of_the_cooled_camera_is_that_of_its_electrons():
    bench = shipped_bench("mwir_camera")
    found = bench.readouts("focal_plane")
    table = bench.value("focal_plane.table").as_dict()
    assert found["netd_K"] == pytest.approx(netd(0.004, table["scene_K"]), rel=1e-6)
    assert 0.046 < found["netd_K"] < 0.051  # as the data sheet says
    merit = bench.readouts("merit")
    assert merit["netd_K"] == pytest.approx(found["netd_K"], rel=1e-3)


def test_solve_gives_the_integration_time_of_a_netd(tmp_path):
    words = ["--for", "focal_plane.integration_time_s", "--until", "focal_plane.netd_K=0.025"]
    done = run_here("solve", "mwir_camera", *words, "--precision", "double", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    value = next(line for line in done.stdout.splitlines() if "integration_time_s" in line)
    found = float(next(word for word in value.replace("=", " ").split() if _is_number(word)))
    kelvin = shipped_bench("mwir_camera").value("focal_plane.table").as_dict()["scene_K"]
    low, high = 0.004, 0.1
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if netd(middle, kelvin) > 0.025 else (low, middle)
    assert found == pytest.approx(low, rel=1e-6)


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True


def test_a_pixel_of_the_satellite_is_averaged_once(shipped_report):
    """At the pixels' Nyquist frequency the detector's contrast is sin(π/2)/(π/2), once."""
    facts = shipped_report("satellite_tdi").facts
    sheet = facts["data_sheet"]
    mtf = {row["label"]: row["x"] for row in sheet["mtf"]["rows"]}
    assert sheet["mtf"]["nyquist_x"] == pytest.approx(625.0)
    assert mtf["Detector MTF"] == pytest.approx(2 / math.pi, rel=1e-9)
    jitter = math.exp(-2 * math.pi**2 * 0.15e-3**2 * 625.0**2)
    assert mtf["Jitter MTF"] == pytest.approx(jitter, rel=1e-9)
    product = mtf["Diffraction MTF"] * mtf["Jitter MTF"] * mtf["TDI MTF"] * mtf["Detector MTF"]
    assert mtf["All together"] == pytest.approx(product, rel=1e-9)
    groups = {group["title"]: group for group in sheet["groups"]}
    rows = {row["label"]: row["values"] for row in groups["Camera"]["rows"]}
    assert rows["Ground sample distance"] == pytest.approx([0.48, 0.48])
    noises = {row["label"]: row for row in sheet["noises"][0]["rows"]}
    assert noises["Shot noise"]["K"] is None  # reflected light has no kelvins
    rows = {row["label"]: row["values"][0] for row in groups["Focal plane"]["rows"]}
    assert (rows["Read noise"], rows["PRNU"], rows["DSNU"]) == (20.0, 0.3, 10.0)
    band = next(r for r in groups["Focal plane"]["rows"] if r["label"] == "Spectral band")
    assert (band["values"], band["unit"]) == (BANDS_UM["satellite_tdi"], "µm")
    assert not facts["nodes"]["camera"]["neutral"]  # the sampling comes from it
    assert "identity" not in [fact["kind"] for fact in facts["skipped"].get("camera", [])]
    assert not any("averaged twice" in row["message"] for row in facts["warnings"])


def test_the_satellite_is_compared_by_the_figures_of_emva_1288(shipped_report):
    """A well of 30 ke-, 20 e- of reading, 12 bits, 10 ke-/s of dark current in 32 · 69.4 µs."""
    facts = shipped_report("satellite_tdi").facts
    groups = {group["title"]: group for group in facts["data_sheet"]["groups"]}
    rows = {(r["label"], r["unit"]): r["values"][0] for r in groups["Focal plane"]["rows"]}
    assert rows["Maximum SNR (at saturation, shot noise only)", ""] == pytest.approx(
        math.sqrt(30000)
    )
    assert rows["Maximum SNR (at saturation, shot noise only)", "dB"] == pytest.approx(
        10 * math.log10(30000)
    )
    dark, step = 1e4 * 6.94e-5 * 32, 30000 / 4095
    in_the_dark = math.sqrt(20**2 + step**2 / 12 + dark)
    threshold = rows["Absolute sensitivity threshold", "photons"]
    assert threshold == pytest.approx((in_the_dark + 0.5) / 0.6, rel=1e-9)
    for percent in (1, 10, 90):
        signal = percent / 100 * (30000 - dark)
        expected = signal / math.sqrt(signal + in_the_dark**2)
        assert rows[f"SNR at {percent} % of saturation", ""] == pytest.approx(expected, rel=1e-9)
    signal = rows["Signal electrons from the scene", "e-"]
    (scene,) = (p["mean"] for p in facts["pictures"] if p["port"] == "scene.image")
    radiance = rows["Radiance at saturation", "W/m²/sr"]
    assert radiance == pytest.approx(scene * (30000 - dark) / signal, rel=1e-3)
    rows = {row["label"]: row["values"][0] for row in groups["Camera"]["rows"]}
    speed = 6378137 / 6978137 * math.sqrt(398600.4418e9 / 6978137)
    assert rows["Ground speed"] == pytest.approx(speed, rel=1e-12)
    assert rows["Line rate for one pixel per line"] == pytest.approx(speed / 0.48, rel=1e-12)
    mtf = facts["data_sheet"]["mtf"]
    both = math.sqrt(mtf["edge_x"] * mtf["edge_y"])
    assert both == pytest.approx(facts["nodes"]["quality"]["readouts"]["rer"]["value"], rel=1e-6)


@pytest.mark.parametrize("name", ["visible_camera", "swir_camera"])
def test_a_camera_in_lux_counts_the_photons_that_its_surfaces_reflect(name):
    """Each band's mean reflectance, lit by the Sun scaled to lux: summed up on a fine grid."""
    bench = shipped_bench(name)
    assert bench.warnings() == []
    params = {
        node: bench.plan.network.nodes[node].params for node in ("light", "camera", "focal_plane")
    }
    plane, camera = params["focal_plane"], params["camera"]
    eye = np.linspace(0.38, 0.78, 8001)
    seen = 683 * np.trapezoid(luminous_efficiency(eye) * standard_sun_irradiance(eye), eye)
    bands = bench.port("scene.image").bands
    per_photon = (
        plane["integration_time_s"] * plane["optics_transmission"]
        * (camera["pitch_um"] * 1e-6) ** 2 * math.pi / (4 * camera["f_number"] ** 2 + 1)
    )  # fmt: skip
    electrons = 0.0
    for share, centre, width in zip(
        bench.work.value(bands.means()), bands.centres_um, bands.widths_um, strict=True
    ):
        um = np.linspace(centre - width / 2, centre + width / 2, 4001)
        light = params["light"]["illuminance_lux"] / seen * standard_sun_irradiance(um).mean()
        efficiency = plane.get("quantum_efficiency", 1.0)
        if "response" in plane:
            efficiency = np.interp(um, [0.9, 1.5, 1.6, 1.7], [0.85, 0.85, 0.65, 0.0]).mean()
        photon_J = constants.h * constants.c / (centre * 1e-6)
        electrons += share * light / math.pi * width * efficiency / photon_J
    found = bench.readouts("focal_plane")
    assert found["signal_e"] == pytest.approx(per_photon * electrons, rel=1e-3)
    dark = plane.get("dark_current_e_per_s", 0.0) * plane["integration_time_s"]
    rounding = plane["full_well_e"] / (2 ** plane["bits"] - 1) / math.sqrt(12)
    noise = math.sqrt(found["signal_e"] + dark + plane["read_noise_e"] ** 2 + rounding**2)
    assert found["snr"] == pytest.approx(found["signal_e"] / noise, rel=1e-6)


def test_the_ranges_of_a_picture_through_air_name_no_extinction_of_their_own(shipped_report):
    """That of the network is not used then: the air's own figures stand in its place."""
    groups = {g["title"]: g for g in shipped_report("dirsig_cube").facts["data_sheet"]["groups"]}
    rows = {row["label"]: row["values"][0] for row in groups["Air"]["rows"]}
    assert rows["Optical depth"] == pytest.approx(-math.log(rows["Transmission"]))
    assert "Atmospheric extinction" not in [row["label"] for row in groups["Range"]["rows"]]
