"""Chains of random modules with random parameters."""

from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from battery_settings import SENSOR
from core.modules.declaration import declaration
from core.modules.parameters import Parameter, plain
from core.network.network import Network
from linked_network import in_order, linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
SPECTRUM = (
    "atmosphere_mtf", "exit_pupil_mtf", "gaussian_mtf", "crosstrack_mtf", "alongtrack_mtf",
    "relative_motion_mtf", "jitter_mtf", "vibration_mtf", "detector_mtf", "charge_eff_mtf",
    "charge_eff_phase",
)  # fmt: skip
PICTURE = (
    "combine_pixels", "anti_alias", "interpolate", "poisson_noise", "electronics_noise",
    "periodic_noise",
)  # fmt: skip
SIZES = [
    (1, 1),
    (1, 2),
    (1, 7),
    (9, 1),
    (2, 2),
    (2, 3),
    (5, 4),
    (7, 13),
    (33, 7),
    (16, 16),
    (12, 31),
]
# Where the declared range is that of a large machine, not of a test.
AFFORDABLE = {
    "width": (1, 40), "height": (1, 40), "wavelengths": (1, 6), "size_x": (2, 48),
    "size_y": (2, 48), "factor": (1, 60), "factor_x": (1, 6), "factor_y": (1, 6), "vanes": (0, 9),
}  # fmt: skip
PUPIL = {"size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4, "slit_width": 3}
BAND = {"cut_on_um": 8, "cut_off_um": 12}
# Of these some parameters must be given for the module to run at all.
GIVEN: dict[str, dict[str, Any]] = {
    "exit_pupil_mtf": BAND,
    "electronics_noise": {**BAND, "d_star": 1e10, "background_K": 300, "bandwidth_Hz": 1e4},
    "poisson_noise": {"photons_per_unit": 10},
    "atmosphere_mtf": {"wavelength_um": 9, "fried_r0_m": 0.02, "aperture_mm": 20},
}


def ordinary(parameter: Parameter) -> st.SearchStrategy[Any]:
    """Values a person may give, over the declared range."""
    return drawn(parameter, 3)


def drawn(parameter: Parameter, decades: int) -> st.SearchStrategy[Any]:
    low, high = AFFORDABLE.get(parameter.name, (parameter.param.low, parameter.param.high))
    if parameter.kind == "choice":
        return st.sampled_from(parameter.choices)
    if parameter.kind == "switch":
        return st.booleans()
    if parameter.kind == "integer":
        whole = st.integers(int(low or 0), int(min(high or 10**4, 10**9)))
        return whole | st.none() if parameter.empty else whole
    if parameter.kind == "number":
        size = st.floats(-decades, decades).map(lambda power: float(10.0**power))
        ends = [e for e in (low, high, 1.0, 0.0) if e is not None]
        value = st.one_of(size, size.map(lambda v: -v), st.sampled_from(ends))
        fits = value.filter(parameter._in_range)
        return fits | st.none() if parameter.empty else fits
    return st.just(plain(parameter.default))


@st.composite
def module_values(draw, key, strategy, few=3):
    """A few parameters of a module; the others keep their default, or what lets it run."""
    parameters = declaration(LIBRARY[key]).parameters
    some = draw(st.lists(st.sampled_from(parameters), max_size=few, unique_by=lambda p: p.name))
    return {**GIVEN.get(key, {}), **{p.name: draw(strategy(p)) for p in some}}


@dataclass
class Chain:
    """A network, its last picture, and whether the mean should come out as it went in."""

    network: Network
    last: str
    keeps_mean: bool


@st.composite
def chains(draw, strategy, sizes=SIZES):
    size = draw(st.sampled_from(sizes))
    edges = draw(st.sampled_from(["reflect", "periodic"]))
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1}),
        "init": ("init_trans", {**SENSOR, "edges": edges}),
        "pupil": ("exit_pupil", PUPIL),
    }
    keeps = True
    for number, key in enumerate(draw(st.lists(st.sampled_from(SPECTRUM), max_size=4))):
        values = draw(module_values(key, strategy))
        nodes[f"s{number}"] = (key, values)
        keeps &= values.get("apply") != "filter_only"
        if key == "exit_pupil_mtf" and draw(st.booleans()):
            nodes["pupil"] = (
                "exit_pupil",
                {**PUPIL, **draw(module_values("exit_pupil", strategy))},
            )
        # On mirrored frames an H that is not even along each axis moves the mean.
        turns = key in ("charge_eff_phase", "exit_pupil_mtf")
        keeps &= not ((turns or values.get("model") == "line") and edges == "reflect")
    nodes["back"] = ("back_transform", {})
    shape = size
    for number, key in enumerate(draw(st.lists(st.sampled_from(PICTURE), max_size=3))):
        values = draw(module_values(key, strategy))
        nodes[f"p{number}"] = (key, values)
        if key == "combine_pixels":
            fy, fx = values.get("factor_y", 2), values.get("factor_x", 2)
            keeps &= shape[0] % fy == 0 and shape[1] % fx == 0 and values.get("mode") != "sum"
            shape = shape[0] // fy, shape[1] // fx
        elif key != "anti_alias":
            keeps = False
    document = linked_network(nodes, in_order(nodes, LIBRARY), seed=draw(st.integers(0, 5)))
    return size, Chain(document, list(nodes)[-1], keeps)
