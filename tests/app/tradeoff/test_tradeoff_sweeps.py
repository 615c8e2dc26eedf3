"""Trade-offs against laws written out, and what they compute and leave alone."""

import json
import math
from collections import Counter

import pytest

from app.run.overrides import variation
from app.tradeoff.tradeoff_results import computed, default_figures, figures_of, points_at
from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.network.file import load_network
from linked_network import linked_network
from nodes.library import standard_library
from tradeoff_network import DOCUMENT, NYQUIST_X, mtf

LIBRARY = standard_library()


@pytest.fixture
def network(tmp_path):
    path = tmp_path / "sensor.json"
    path.write_text(json.dumps(DOCUMENT))
    return load_network(path, library=LIBRARY)


def swept(network, node, parameter, values, *names, engine=None, **work):
    """Points and the work they took."""
    engine = engine or Engine(LIBRARY)
    known = figures_of(network, LIBRARY)
    figures = [known[name] for name in names]
    made = engine.work(Policy(), **work)
    places = [(value,) for value in values]
    plan = engine.plan(network)
    return list(points_at(engine, plan, made, [(node, parameter)], places, figures)), made


def column(points, name):
    return [point.figures.get(name) for point in points]


# --- values ------------------------------------------------------------------------------------


def test_mtf_of_gaussians_at_nyquist_and_half_of_it(network):
    values = [0.0, 0.05, 0.3, 1.0]
    names = ("total.mtf_nyquist_x", "total.mtf_half_nyquist_x")
    points, _ = swept(network, "blur", "sigma_x_mrad", values, *names)
    for value, whole, half in zip(values, *(column(points, n) for n in names), strict=True):
        assert whole == pytest.approx(mtf(value), rel=1e-12)
        assert half == pytest.approx(mtf(value, NYQUIST_X / 2), rel=1e-12)


def test_the_electronics_filter_is_in_their_total_alone(network):
    """The pre-amplifier's single pole, 1/√(1 + (2πτvξ)²), of a mirror that turns at `rate`."""
    tau, rates = 1e-6, [5.0, 50.0]
    network = network.with_parameter("electronics", "use_mtf", True)
    network = network.with_parameter("electronics", "time_constant_s", tau)
    names = ("total.mtf_nyquist_x", "total_with_electronics.mtf_nyquist_x")
    points, _ = swept(network, "electronics", "scan_mirror_rate_Hz", rates, *names)
    for rate, without, whole in zip(rates, *(column(points, n) for n in names), strict=True):
        w = 2 * math.pi * tau * (2 * math.pi * 1000.0 * rate) * NYQUIST_X
        assert without == pytest.approx(mtf(0.5), rel=1e-12)
        assert whole / without == pytest.approx(1 / math.hypot(1.0, w), rel=1e-9)


def test_a_point_is_what_the_network_gives_with_that_value(network):
    name = "electronics.snr"
    points, _ = swept(network, "blur", "sigma_x_mrad", [0.1, 2.0], name)
    for point in points:
        engine = Engine(LIBRARY)
        plan = engine.plan(network.with_parameter("blur", "sigma_x_mrad", point.values[0]))
        found = engine.readouts(plan, "electronics", engine.work(Policy()))
        assert point.figures[name] == found["snr"]


# --- economy -----------------------------------------------------------------------------------


def computed_by_node(work):
    nodes = [recipe.node for key, recipe in work.log.requested.items() if key in work.log.computed]
    return Counter(nodes)


def test_only_what_the_parameter_touches_is_computed_again(network):
    name = "electronics.netd_system_K"
    _, once = swept(network, "electronics", "d_star", [1e10], name)
    _, many = swept(network, "electronics", "d_star", [1e10, 2e10, 3e10, 4e10, 5e10], name)
    one, five = computed_by_node(once), computed_by_node(many)
    assert one.keys() == five.keys() == {"scene", "back", "electronics", None}
    assert (five["scene"], five["back"]) == (one["scene"], one["back"])
    assert five["electronics"] > one["electronics"]
    assert five[None] == 5 * one[None] == 5  # the figure taken from the table


def test_an_mtf_is_told_without_any_picture(network):
    _, work = swept(network, "blur", "sigma_x_mrad", [0.1, 0.2], "total.mtf_nyquist_x")
    assert not work.log.computed


# --- gaps --------------------------------------------------------------------------------------


def test_what_still_works_where_a_node_fails_is_told(network):
    """The blur does not hang on the electronics, which need D* of the material."""
    network = network.with_parameter("electronics", "d_star", None)
    network = network.with_parameter("electronics", "region", "MWIR")
    values = ["PtSi", "manual"]
    names = ("electronics.ner", "blur.mtf_at_nyquist_x")
    points, _ = swept(network, "electronics", "material", values, *names)
    assert points[0].reasons == {}
    assert list(points[1].figures) == ["blur.mtf_at_nyquist_x"]
    assert "give D*, because material is manual" in points[1].reasons["electronics.ner"]


def test_zero_that_stands_for_empty_is_no_zero(network):
    points, _ = swept(network, "electronics", "amplifier_snr", [0.0, None], "electronics.snr")
    assert "leaves the parameter empty" in points[0].reasons["electronics.snr"]
    assert "electronics.snr" in points[1].figures


# --- which figures, which values ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("blur.sigma_x_mrad=.5, 1e0,+2", (0.5, 1.0, 2.0)),
        ("blur.sigma_x_mrad=-1:1:3", (-1.0, 0.0, 1.0)),
        ("electronics.material=PtSi,Si:Ga", ("PtSi", "Si:Ga")),
        ("electronics.post_poles=1:8:4:log", (1, 2, 4, 8)),
        ("electronics.amplifier_snr=null,10", (None, 10.0)),
    ],
)
def test_values_as_they_are_said(network, text, values):
    assert variation(text, network, library=LIBRARY).values == values


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("blur.sigma=1", "has no parameter sigma; allowed: apply, sigma_x_mrad"),
        ("blur.sigma_x_mrad=soft", "'soft' mrad"),
        ("blur.sigma_x_mrad=0:1:1", "COUNT = 1 is not allowed: must be 2 to 1000"),
        ("blur.sigma_x_mrad=0:1:5:log", "log needs FROM and TO above 0"),
    ],
)
def test_values_that_are_none(network, text, told):
    with pytest.raises(ImagechainError) as caught:
        variation(text, network, library=LIBRARY)
    assert told in str(caught.value)
    assert caught.value.exit_code == 2


# --- A camera in electrons: which figures come first, and what they are called ---


PIXELS = {"detector_x_um": 15, "detector_y_um": 15}


@pytest.fixture
def camera():
    nodes = {
        "scene": ("test_scene", {}),
        "init": ("init_trans", {}),
        "fpa": ("focal_plane", {}),
        "beside": ("examine_image", {}),
    }
    links = [("scene.image", "init.image"), ("init.context", "fpa.context")]
    return linked_network(nodes, links)


def test_its_figures_are_what_a_trade_off_shows_by_default(camera):
    names = {figure.text for figure in default_figures(camera, LIBRARY)}
    assert {"fpa.netd_K", "fpa.snr", "fpa.well_fill_percent"} <= names
    assert not any(name.startswith("beside.") for name in names)


def test_a_figure_of_a_clipped_picture_has_its_reason():
    """10 s of exposure at 300 K fill a well of 1e5 e- many times over."""
    nodes = {
        "scene": ("test_scene", {"kind": "uniform", "width": 8, "height": 8}),
        "init": ("init_trans", {**PIXELS, "focal_length_mm": 50, "f_number": 2}),
        "fpa": ("focal_plane", {"integration_time_s": 10.0, "full_well_e": 1e5}),
    }
    network, engine = linked_network(nodes), Engine(LIBRARY)
    wanted = [figures_of(network, LIBRARY)[f"fpa.{name}"] for name in ("netd_K", "signal_e")]
    found = computed(wanted, engine, engine.plan(network), engine.work(Policy("double")), {"fpa"})
    assert list(found.figures) == ["fpa.signal_e"]
    assert found.reasons["fpa.netd_K"].startswith(
        "fpa.netd_K has no value: the picture's mean reaches "
    )
    assert found.reasons["fpa.netd_K"].endswith(" % of the full well and is clipped")
