"""Presets that come with the program are sound and say what they are of; one's own are kept."""

from __future__ import annotations

import json
import tomllib
from fnmatch import fnmatch

import pytest

from app.run.preset_files import own_presets, placed, preset_of, save_preset, shipped_presets
from app.run.shipped import find_network
from child_process import ROOT
from core.chain.engine import Engine
from core.editing.grouping import group, ungroup
from core.editing.operations import Rename
from core.errors import ImagechainError
from core.evaluation.policy import Policy
from core.network.file import load_network, read_network
from core.network.macro import expanded
from core.network.network import Link, Network, Node
from core.network.validation import problems
from nodes.library import standard_library

LIBRARY = standard_library()
SHIPPED = {preset.path.stem: preset for preset in shipped_presets(LIBRARY)}
LWIR = {"cut_on_um": 7.5, "cut_off_um": 13.5, "temperature_K": 300.0}
SCENE = {"width": 64, "height": 64, "fov_x_deg": 2.5, "fov_y_deg": 2.5, **LWIR}


def readouts(network, node):
    engine = Engine(LIBRARY)
    plan = engine.plan(expanded(network, LIBRARY))
    assert not plan.errors()
    return engine.readouts(plan, node, engine.work(Policy("double")))


def before_a_scene(stem):
    """A scene into a preset that takes a picture."""
    scene = Node("scene", "test_scene", SCENE)
    network = Network(nodes={"scene": scene})
    name, operation = placed(SHIPPED[stem], network, LIBRARY, (300, 0))
    network = operation.apply(network)
    link = Link("scene", "image", name, "image")
    return Network(nodes=network.nodes, links=(link,)), name


def test_there_are_lenses_detectors_and_cameras():
    kinds = [stem.partition("_")[0] for stem in SHIPPED]
    assert {kind: kinds.count(kind) for kind in kinds} == {"camera": 3, "detector": 2, "lens": 3}


@pytest.mark.parametrize("stem", SHIPPED)
def test_a_shipped_preset_is_sound_and_states_its_source(stem):
    preset = SHIPPED[stem]
    assert preset.problem == ""
    assert "FLIR" in preset.text or "Tantalo 1996, table 5." in preset.text
    network = read_network(preset.path, library=LIBRARY)
    assert not problems(network, library=LIBRARY, unfinished=True)
    (node,) = network.nodes.values()
    assert node.macro.extra["parameters"]
    assert not any(inner.noise for inner in node.macro.nodes.values())


def test_shipped_presets_are_packaged():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["networks"]
    for preset in SHIPPED.values():
        name = preset.path.relative_to(ROOT / "networks").as_posix()
        assert any(fnmatch(name, pattern) for pattern in patterns)


def test_the_uncooled_camera_has_the_figures_of_its_specification():
    """640 × 512 of 17 µm behind 25 mm: 24.6° × 19.8°, a Nyquist of 735 per rad; 50 mK at F/1."""
    network, name = before_a_scene("camera_flir_tau2_640_25mm")
    init = readouts(network, f"{name}/init")
    assert init["ifov_x_mrad"] == pytest.approx(17e-3 / 25 * 1e3)
    optics = readouts(network, f"{name}/optics")
    assert optics["cutoff_x"] == pytest.approx(25 / 1.1 / 10.5, rel=1e-3)  # aperture/λ
    at_f1 = network.with_parameter(name, "f_number", 1.0)
    netd = readouts(at_f1, f"{name}/electronics")["netd_detector_K"]
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


def test_a_preset_is_put_in_under_a_name_that_is_free():
    network, name = before_a_scene("camera_kodak_kir310")
    again, operation = placed(SHIPPED["camera_kodak_kir310"], network, LIBRARY, None)
    assert (name, again) == ("camera", "camera_2")
    assert ungroup(operation.apply(network), LIBRARY, again)


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
    with pytest.raises(ImagechainError, match="a preset lens exists already"):
        save_preset(lens, "lens", folder, LIBRARY)
    save_preset(Rename("lens", "other").apply(lens), "other", folder, LIBRARY)
    assert len(own_presets(folder, LIBRARY)) == 2


def test_what_is_no_preset_is_listed_with_its_problem(lens, tmp_path):
    (tmp_path / "broken.json").write_text("{")
    plain = {"format": "imagechain-network", "version": 1, "nodes": {"a": {"module": "init_trans"}}}
    (tmp_path / "plain.json").write_text(json.dumps(plain))
    broken, no_macro = own_presets(tmp_path, LIBRARY)
    assert "broken.json" in broken.problem
    assert "not a preset; a preset is a network of one macro" in no_macro.problem
    with pytest.raises(ImagechainError, match=r"broken\.json: not JSON"):
        placed(broken, lens, LIBRARY, None)


@pytest.mark.parametrize(
    ("node", "message"),
    [("scene", "scene is not a macro: group nodes"), ("a/b", "a/b cannot be a file name")],
)
def test_what_can_be_no_preset_is_refused(node, message, lens, tmp_path):
    network = Rename("lens", "a/b").apply(lens)
    with pytest.raises(ImagechainError, match=message):
        save_preset(network, node, tmp_path, LIBRARY)
    assert not list(tmp_path.iterdir())
