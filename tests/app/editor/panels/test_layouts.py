"""How panels group parameters: all of them, once, and none hidden that counts."""

from collections import Counter

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.policy import Policy
from core.evaluation.recipes import Recipe
from core.modules.declaration import declaration
from core.modules.panel_sections import Section
from core.network.network import Link, Network, Node
from cube_files import centres, write_cube
from nodes.files.pictures import write_by_oiio
from nodes.library import standard_library

LIBRARY = standard_library()
DECLARED = {key: declaration(module) for key, module in LIBRARY.items()}
CONDITIONAL = [
    pytest.param(key, section, id=f"{key}-{'-'.join(section.parameters)}")
    for key, declared in DECLARED.items()
    for section in declared.panel
    if section.shown_when
]
ENOUGH = {  # to be computed whatever is chosen
    "charge_diffusion_mtf": {"absorption_per_um": 0.05},
    "exit_pupil": {"path": "pupil.npy", "size_x": 160, "size_y": 160},
    "atmosphere_mtf": {"fried_r0_m": 0.1, "aperture_mm": 50.0},
    "poisson_noise": {"photons_per_unit": 10.0},
    "electronics_noise": {
        "region": "LWIR",
        "bits": 4,
        "scan_mirror_rate_Hz": 10.0,
        "post_corner_Hz": 900.0,
    },
    "line_by_line": {"line_spacing_m": 0.5, "altitude_m": 500.0},
    "atmospheric_path": {"range_m": 2000.0},
}
ENOUGH_WITH = {  # of one choice
    ("atmospheric_path", "modtran"): {"path": "air.csv"},
    ("spectral_response", "file"): {"path": "response.csv"},
    ("vignetting", "file"): {"path": "light.csv"},
    ("vignetting", "polynomial"): {"coefficients": [-1e-5]},
    ("field_psf", "mtf"): {"path_1": "mtf.csv"},
    ("field_psf", "psf"): dict.fromkeys(("path_1", "path_2", "path_3"), "pupil.npy")
    | {"sample_pitch_um": 5.0},
    ("read_image", "all"): {"path": "cube.img"},
    ("read_image", "luminance"): {"path": "colour.tif"},
}
NEEDS_PYBSM = "modtran_tables"
INIT = {
    "detector_x_um": 30.0,
    "detector_y_um": 30.0,
    "focal_length_mm": 100.0,
    "f_number": 2.0,
    "velocity_m_per_s": 50.0,
    "scan_velocity_mrad_per_s": 5000.0,
}


@pytest.mark.parametrize("key", DECLARED)
def test_every_parameter_stands_on_the_panel_once(key):
    placed = Counter(name for section in DECLARED[key].panel for name in section.parameters)
    assert placed == Counter(parameter.name for parameter in DECLARED[key].parameters)


@pytest.mark.parametrize("key", [key for key, d in DECLARED.items() if len(d.parameters) > 5])
def test_a_panel_of_many_parameters_has_sections_with_titles(key):
    assert any(section.title for section in DECLARED[key].panel)


@pytest.mark.parametrize(("key", "section"), CONDITIONAL)
def test_what_shows_a_section_is_a_choice_that_is_always_shown(key, section):
    name, values = section.shown_when
    parameter = DECLARED[key].parameter(name)
    assert parameter.kind == "choice"
    assert set(values) < set(parameter.choices)
    home = next(other for other in DECLARED[key].panel if name in other.parameters)
    assert home.shown_when is None
    assert home.page == section.page


def test_the_published_order_of_the_initialization_panel():
    placed = [name for section in DECLARED["init_trans"].panel for name in section.parameters]
    published = ["detector_x_um", "detector_y_um", "focal_length_mm", "f_number", "range_m"]
    assert placed[:7] == [*published, "fill_x", "fill_y"]  # fig. 4.3


def test_the_published_order_of_the_electronics_panel():
    sections = DECLARED["electronics_noise"].panel
    placed = [name for section in sections for name in section.parameters]
    published = ["cut_on_um", "cut_off_um", "region", "material", "optics_transmission"]
    published += ["filter_transmission", "bits", "seed_mode", "seed"]  # fig. 4.42
    assert [name for name in placed if name in published] == published


def test_each_region_offers_its_materials():
    sections = DECLARED["electronics_noise"].panel
    (offer,) = [section.offer for section in sections if section.offer]
    assert (offer.parameter, offer.by) == ("material", "region")
    offered = {region: set(choices) for region, choices in offer.choices}
    assert offered == {
        "VIS": {"Si", "manual"},
        "MWIR": {"InSb", "PtSi", "HgCdTe", "manual"},
        "LWIR": {"HgCdTe", "Si:Ga", "Si:As", "manual"},  # figs. 4.35 and 4.42
    }


def test_a_module_that_nobody_laid_out_has_all_its_parameters_in_one_section():
    plain = DECLARED["combine_pixels"]
    assert plain.panel == (Section("", ("factor_x", "factor_y", "mode")),)


def other_values(parameter):
    """Values that differ from the default, and from one another."""
    low = parameter.param.low
    candidates = [3.0, 0.25, 7, 1.5, -2.5, *parameter.choices, "other.npy", [0.1]]
    found = []
    for value in candidates:
        try:
            coerced = parameter.coerce(value)
        except ImagechainError:
            continue
        if coerced not in (parameter.default, low):
            found.append(value)
    return found[:2]


SCENE = {"width": 24, "height": 16}
SCENES = {"measured_mtf": {"kind": "slanted_edge", "width": 32, "height": 32}}


def made(engine, key, params, folder):
    """All that a node makes of a small scene, as arrays; errors as their text."""
    nodes = {
        "scene": Node("scene", "test_scene", SCENES.get(key, SCENE)),
        "camera": Node("camera", "camera", {"focal_length_mm": 100.0}),
        "init": Node("init", "init_trans", INIT),
        "pupil": Node("pupil", "exit_pupil", {"size_x": 32, "size_y": 32, "radius": 10}),
        "node": Node("node", key, params),
    }
    sources = {"image": "scene.image", "reference": "scene.image", "transfer": "init.magnitude"}
    sources["pupil"] = "pupil.pupil"
    if key == "field_psf":
        sources["image"] = "camera.image"
    sources |= {name: f"init.{name}" for name in ("context", "magnitude", "phase")}
    links = [Link.between("scene.image", f"{node}.image") for node in ("init", "camera")]
    links += [
        Link.between(sources[port.name], f"node.{port.name}")
        for port in DECLARED[key].inputs
        if port.name in sources
    ]
    network = Network(nodes=nodes, links=tuple(links), seed=1)
    plan = engine.plan(network, folder=folder)
    planned = plan.node("node")
    if planned.error is not None:
        return {"error": str(planned.error)}
    found = {}
    for port, value in planned.outputs.items():
        work = engine.work(Policy("double", threads=1))
        held = value.samples if hasattr(value, "samples") else None
        found[port] = (
            work.value(held) if held is not None else engine.value(plan, f"node.{port}", work)
        )
    return {port: as_array(value) for port, value in found.items()}


def as_array(value):
    assert not isinstance(value, Recipe)
    if hasattr(value, "series"):
        return np.concatenate([np.concatenate([s.x, s.y]) for s in value.series])
    if hasattr(value, "as_dict"):
        return np.array([v for v in value.as_dict().values() if isinstance(v, float)])
    return np.asarray(value)


@pytest.mark.parametrize(("key", "section"), CONDITIONAL)
def test_parameters_that_are_not_shown_change_nothing(key, section, tmp_path):
    np.save(tmp_path / "pupil.npy", np.ones((8, 8)))
    (tmp_path / "air.csv").write_text("7,0.5,1\n13,0.6,2\n")
    (tmp_path / "response.csv").write_text("7,0.5\n13,0.6\n")
    (tmp_path / "light.csv").write_text("0 1\n20 0.5\n")
    (tmp_path / "mtf.csv").write_text("frequency (cyc/mrad),mtf\n0,1\n9,0.5\n")
    write_cube(tmp_path, np.ones((3, 8, 8)), *centres(3))
    write_by_oiio(tmp_path / "colour.tif", np.full((8, 8, 3), 7, np.uint8), {})
    declared = DECLARED[key]
    name, values = section.shown_when
    hidden = [c for c in declared.parameter(name).choices if c not in (*values, NEEDS_PYBSM)]
    assert hidden
    others = [
        {inside: value}
        for inside in section.parameters
        for value in other_values(declared.parameter(inside))
    ]
    assert {name for other in others for name in other} == set(section.parameters)
    engine = Engine(LIBRARY)
    for choice in hidden:
        always = ENOUGH.get(key, {}) | ENOUGH_WITH.get((key, choice), {}) | {name: choice}
        before = made(engine, key, always, tmp_path)
        assert "error" not in before
        for other in others:
            after = made(engine, key, always | other, tmp_path)
            assert before.keys() == after.keys()
            for port in before:
                np.testing.assert_array_equal(before[port], after[port], f"{other}: {port}")
