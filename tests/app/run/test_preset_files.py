"""Presets that come with the program are sound and say what they are of; one's own are kept."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

import imagechain as ic
from app.run.preset_files import (
    given,
    own_presets,
    placed,
    preset_of,
    remove_set,
    save_preset,
    save_set,
    sets_of,
    shipped_presets,
)
from app.run.shipped import find_network
from core.editing.document import Document
from core.editing.macros import group
from core.editing.operations import rename_node
from core.errors import ImagechainError
from core.modules.declaration import declaration
from core.network.file import load_network, read_network
from core.network.macro import expanded
from core.network.network import Link, Network, Node
from core.network.validation import problems
from node_bench import NodeBench
from nodes.files.curve_tables import read_wavelengths
from nodes.library import standard_library

LIBRARY = standard_library()
SHIPPED = {preset.path.stem: preset for preset in shipped_presets(LIBRARY)}
LWIR = {"cut_on_um": 7.5, "cut_off_um": 13.5, "temperature_K": 300.0}
ONE = {"module": "init_trans"}
SCENE = {"width": 64, "height": 64, "fov_x_deg": 2.5, "fov_y_deg": 2.5, **LWIR}


def bench_of(network):
    bench = NodeBench(None, expanded(network, LIBRARY))
    assert not bench.plan.errors()
    return bench


def before_a_scene(stem):
    """A scene into a preset that takes a picture."""
    scene = Node("scene", "test_scene", SCENE)
    network = Network(nodes={"scene": scene})
    name, operation = placed(SHIPPED[stem], network, LIBRARY, (300, 0))
    network = operation.apply(network)
    link = Link("scene", "image", name, "image")
    return Network(nodes=network.nodes, links=(link,)), name


def test_there_are_parts_of_all_kinds():
    kinds = [preset.kind for preset in SHIPPED.values()]
    least = {"camera": 14, "detector": 11, "lens": 9, "light": 5, "satellite": 6}
    assert {kind: kinds.count(kind) for kind in kinds} == least


@pytest.mark.parametrize("stem", SHIPPED)
def test_a_shipped_preset_is_sound_and_states_its_source(stem):
    preset = SHIPPED[stem]
    assert preset.problem == ""
    assert any(word in preset.text for word in ("Source: ", "FLIR", "Tantalo 1996, table 5."))
    network = read_network(preset.path, library=LIBRARY)
    assert not problems(network, library=LIBRARY, unfinished=True)
    (node,) = network.nodes.values()
    if node.macro is not None:
        assert node.macro.extra["parameters"]
        assert not any(inner.noise for inner in node.macro.nodes.values())


def in_a_chain(stem, lux=2000.0, bands=2):
    """A camera of today in front of a scene in its own band, of 64 of its pixels."""
    preset, nodes, links = SHIPPED[stem], {}, []
    sensor = preset.body.nodes.get("focal_plane") or preset.body.nodes["bolometer"]
    other = (8.0, 12.0) if "bolometer" in preset.body.nodes or "lw" in stem else (0.95, 1.6)
    band = [sensor.params.get(name, value) for name, value in zip(CUTS, other, strict=True)]
    scene = {"width": 128, "height": 128, "fov_x_deg": None, "fov_y_deg": None}
    scene |= dict(zip(CUTS, band, strict=True))
    if band[0] < 2.5:
        scene |= {"bands": bands, "quantity": "reflectance"}
        nodes["light"] = Node("light", "reflected_light", {"illuminance_lux": lux})
        links.append(Link("scene", "image", "light", "image"))
    nodes["scene"] = Node("scene", "test_scene", scene)
    network = Network(nodes=nodes, links=tuple(links))
    name, operation = placed(preset, network, LIBRARY, (300, 0))
    network = operation.apply(network)
    camera = network.nodes[name]
    inner = camera.macro.nodes["camera"]
    few = replace(inner, params={**inner.params, "pixels_x": 64, "pixels_y": 64})
    body = replace(camera.macro, nodes={**camera.macro.nodes, "camera": few})
    light = Link("light" if "light" in nodes else "scene", "image", name, "image")
    nodes = {**network.nodes, name: replace(camera, macro=body)}
    return Network(nodes=nodes, links=(*links, light)), f"{name}/{sensor.id}"


CUTS = "cut_on_um", "cut_off_um"
TODAY = [
    stem
    for stem, preset in SHIPPED.items()
    if preset.kind in ("camera", "satellite") and "electronics_noise" not in preset.modules
]


@pytest.mark.parametrize("stem", TODAY)
def test_a_camera_of_today_runs_without_a_warning(stem):
    network, sensor = in_a_chain(stem)
    bench = bench_of(network)
    assert bench.readouts(sensor)["snr"] > 3.0
    assert [str(one) for one in bench.warnings()] == []


@pytest.mark.parametrize(
    ("stem", "ground_m", "within"),
    [
        ("worldview3_pan", 0.31, 0.005), ("landsat8_oli_pan", 14.3, 0.003),
        ("landsat8_tirs_b10", 100, 0.02),
    ],
)  # fmt: skip
def test_a_satellite_sees_its_published_pixel_on_the_ground_for_as_long_as_it_crosses_it(
    stem, ground_m, within
):
    network, sensor = in_a_chain(f"satellite_{stem}")
    camera = bench_of(network).readouts(sensor.replace("focal_plane", "camera"))
    assert camera["gsd_x_m"] == pytest.approx(ground_m, rel=within)
    nodes = SHIPPED[f"satellite_{stem}"].body.nodes
    radius_m = 6.378e6 + 1e3 * nodes["camera"].params["altitude_km"]
    speed = 6.378e6 / radius_m * (3.986e14 / radius_m) ** 0.5
    time_s = nodes["focal_plane"].params["integration_time_s"]
    if "tirs" not in stem:
        assert time_s * speed == pytest.approx(ground_m, rel=within)


def test_a_material_counts_by_its_file_from_any_folder(tmp_path):
    """Green 2008: 2810 /cm at 0.65 µm, so 0.9·(1 − e^(−15·0.281)) of its photons."""
    name, operation = placed(SHIPPED["detector_silicon_back"], Network(), LIBRARY, None, tmp_path)
    network = operation.apply(Network())
    path = tmp_path / network.nodes[name].params["response"]
    points = read_wavelengths(path.resolve(), what="QE", low=0.0, high=1.0)
    assert dict(points)[0.65] == pytest.approx(0.9 * (1 - math.exp(-15 * 0.281)), rel=2e-3)
    assert points[-1][1] == 0.0
    part = ic.preset("detector_silicon_back", bits=12, full_well_e=1e5)
    assert Path(part.params["response"]) == SHIPPED["detector_silicon_back"].path.with_suffix(
        ".csv"
    )


def test_the_uncooled_camera_has_the_figures_of_its_specification():
    """640 × 512 of 17 µm behind 25 mm: 24.6° × 19.8°, a Nyquist of 735 per rad; 50 mK at F/1."""
    network, name = before_a_scene("camera_flir_tau2_640_25mm")
    init = bench_of(network).readouts(f"{name}/init")
    assert init["ifov_x_mrad"] == pytest.approx(17e-3 / 25 * 1e3)
    optics = bench_of(network).readouts(f"{name}/optics")
    assert optics["cutoff_x"] == pytest.approx(25 / 1.1 / 10.5, rel=1e-3)  # aperture/λ
    at_f1 = network.with_parameter(name, "f_number", 1.0)
    netd = bench_of(at_f1).readouts(f"{name}/electronics")["netd_detector_K"]
    assert netd == pytest.approx(0.050, rel=1e-3)


@pytest.mark.parametrize(("focal_mm", "f_number"), [(19, 1.25), (25, 1.1), (50, 1.2)])
def test_a_lens_has_the_aperture_of_its_focal_length_and_f_number(focal_mm, f_number):
    (node,) = read_network(
        SHIPPED[f"lens_flir_tau2_{focal_mm}mm"].path, library=LIBRARY
    ).nodes.values()
    pupil, optics = node.macro.nodes["pupil"].params, node.macro.nodes["optics"].params
    aperture_cm = 2 * pupil["radius"] / pupil["size_x"] * optics["size_x_cm"]
    assert aperture_cm == pytest.approx(focal_mm / f_number / 10, rel=1e-4)


@pytest.mark.parametrize("which", ["kodak_kir310", "inframetrics"])
def test_a_camera_of_the_thesis_is_that_of_its_network(which):
    network = load_network(find_network(which).path, library=LIBRARY)
    (node,) = read_network(SHIPPED[f"camera_{which}"].path, library=LIBRARY).nodes.values()
    for name, inner in node.macro.nodes.items():
        assert inner.params == network.nodes[name].params
        assert inner.module == network.nodes[name].module


@pytest.fixture
def lens():
    network = load_network(find_network("first_steps").path, library=LIBRARY)
    return group(network, LIBRARY, ["init", "blur", "back"], "lens")[1].apply(network)


def test_an_own_preset_is_saved_listed_and_put_in(lens, tmp_path):
    folder = tmp_path / "config" / "presets"
    assert own_presets(folder, LIBRARY) == ()
    path = save_preset(lens, "lens", folder, LIBRARY)
    (preset,) = own_presets(folder, LIBRARY)
    assert (preset.path, preset.title, preset.own) == (path, "lens", True)
    assert preset_of(preset.key, [*SHIPPED.values(), preset]) is preset
    name, operation = placed(preset, lens, LIBRARY, None)
    copy = operation.apply(lens).nodes[name].macro
    assert copy.nodes == lens.nodes["lens"].macro.nodes
    with pytest.raises(ImagechainError, match="a preset lens already exists"):
        save_preset(lens, "lens", folder, LIBRARY)
    save_preset(rename_node("lens", "other").apply(lens), "other", folder, LIBRARY)
    assert len(own_presets(folder, LIBRARY)) == 2


def test_what_is_no_preset_is_listed_with_its_problem(lens, tmp_path):
    (tmp_path / "broken.json").write_text("{")
    plain = {"format": "imagechain-network", "version": 1, "nodes": dict.fromkeys("ab", ONE)}
    (tmp_path / "plain.json").write_text(json.dumps(plain))
    broken, two = own_presets(tmp_path, LIBRARY)
    assert "broken.json" in broken.problem
    assert "not a preset; a preset is a network of one node" in two.problem
    with pytest.raises(ImagechainError, match=r"broken\.json: not JSON"):
        placed(broken, lens, LIBRARY, None)


# --- sets of parameters ---

MODULE = "gaussian_mtf"
SHARP = {"sigma_x_mrad": 0.25, "sigma_y_mrad": 0.5}


def node(params):
    return Node("blur", MODULE, params)


def document(params):
    return Document(Network(nodes={"blur": node(params)}), library=LIBRARY)


def take(made, values, name="sharp"):
    old = made.network.nodes["blur"]
    return made.do(given(name, values, old, declaration(LIBRARY[MODULE]), "blur"))


def test_a_set_is_kept_and_taken_again(tmp_path):
    folder = tmp_path / "sets"
    assert sets_of(MODULE, folder) == {}
    save_set("sharp", node(SHARP), folder)
    save_set("plain", node({}), folder)
    assert json.loads((folder / f"{MODULE}.json").read_text())["sets"] == {
        "sharp": SHARP,
        "plain": {},
    }
    made = document({"sigma_x_mrad": 2.0, "apply": "filter_only"})
    before = made.text()
    assert take(made, sets_of(MODULE, folder)["sharp"])
    assert dict(made.network.nodes["blur"].params) == SHARP  # what it leaves out has its default
    made.undo()
    assert made.text() == before
    assert made.redo_text == "Set blur to sharp"
    take(made, sets_of(MODULE, folder)["plain"])
    assert dict(made.network.nodes["blur"].params) == {}
    remove_set("sharp", MODULE, folder)
    assert list(sets_of(MODULE, folder)) == ["plain"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"sigma": 1}, "the saved parameters sharp include sigma, but Gaussian MTF has no"),
        ({"sigma_x_mrad": -1}, "sigma_x_mrad = -1 mrad is not allowed"),
    ],
)
def test_a_set_that_does_not_fit_changes_nothing(values, message):
    made = document(SHARP)
    with pytest.raises(ImagechainError, match=message):
        take(made, values)
    assert not made.undo_text
