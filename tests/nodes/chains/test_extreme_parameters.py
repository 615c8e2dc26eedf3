"""Each parameter of each module at the ends of its range."""

import math
from itertools import count
from typing import Any

import numpy as np
import pytest

from battery_settings import AFFORDABLE, SENSOR
from chain_runs import arrays_of
from core.chain.engine import Engine
from core.modules.declaration import declaration
from core.modules.parameters import Parameter
from core.network.network import Network
from drawn_networks import ON_SPECTRUM
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
MEAN_ERROR = {"double": 1e-12, "single": 1e-6}

PICTURE = (
    "combine_pixels", "anti_alias", "interpolate", "poisson_noise", "electronics_noise",
    "periodic_noise",
)  # fmt: skip
PUPIL = {"size_x": 32, "size_y": 32, "radius": 12, "obscuration_radius": 4, "slit_width": 3}
BAND = {"cut_on_um": 8, "cut_off_um": 12}
# Of these some parameters must be given for the module to run at all.
GIVEN: dict[str, dict[str, Any]] = {
    "exit_pupil_mtf": BAND,
    "electronics_noise": {**BAND, "d_star": 1e10, "background_K": 300, "bandwidth_Hz": 1e4},
    "poisson_noise": {"photons_per_unit": 10},
    "atmosphere_mtf": {"wavelength_um": 9, "fried_r0_m": 0.02, "aperture_mm": 20},
}
# What is switched on beside the parameter under test, so that it acts.
ACTIVE: dict[str, list[dict[str, Any]]] = {
    "atmosphere_mtf": [
        {"turbulence": "short_exposure", **GIVEN["atmosphere_mtf"]},
        {"turbulence": "long_exposure", "cn2": 1e-14, "wavelength_um": 9},
        {"turbulence": "long_exposure", "cn2": 1e-14, "wavelength_um": 9, "view": "vertical"},
        {"fwhm_mrad": 1, "turbidity": "custom", "scatter_depth": 1},
        {"turbidity": "custom", "scattering_per_km": 1, "view": "vertical"},
    ],
    "exit_pupil_mtf": [BAND, {**BAND, "method": "autocorrelation"}, {**BAND, "wavelengths": 3}],
    "gaussian_mtf": [{"sigma_x_mrad": 1, "sigma_y_mrad": 1}],
    "crosstrack_mtf": [{"dwell_time_s": 1e-4}],
    "alongtrack_mtf": [{"integration_time_s": 0.01}],
    "relative_motion_mtf": [
        {"image_velocity_x": 3, "platform_velocity_y": 4, "integration_time_s": 0.1, "model": m}
        for m in ("published", "line")
    ],
    "vibration_mtf": [
        {"amplitude_x_mrad": 1, "amplitude_y_mrad": 2, "frequency_Hz": 9, "integration_time_s": t}
        for t in (0.1, 1.0)
    ],
    "charge_eff_mtf": [{"efficiency": 0.9, "model": m} for m in ("exact", "published")],
    "charge_eff_phase": [{"efficiency": 0.9, "model": m} for m in ("exact", "published")],
    "poisson_noise": [{"percent": 10}, {"mode": "photon", "photons_per_unit": 10}],
    "electronics_noise": [
        GIVEN["electronics_noise"],
        {**BAND, "region": "LWIR", "scan_mirror_rate_Hz": 1},
        {
            **GIVEN["electronics_noise"], "amplifier_snr": 9, "gain_percent": 2,
            "bias_percent": 2, "noise_variability_percent": 5, "use_mtf": True,
            "post_filter": "boost", "post_corner_Hz": 1000, "bits": 8,
        },
        {
            **GIVEN["electronics_noise"], "gain_percent": 2, "bias_percent": 2, "bits": 64,
            "gain_model": "literal", "post_filter": "lowpass", "post_corner_Hz": 1000,
        },
    ],
    "periodic_noise": [{"amplitude": 1, "modulation": 0.5}],
    "anti_alias": [{"factor": 3, "kernel": k} for k in ("box", "gaussian", "lanczos")],
    "init_trans": [SENSOR],
    "exit_pupil": [
        PUPIL,
        *({**PUPIL, "shape": s} for s in ("half_moon", "cassegrain", "cassegrain_slit", "spider")),
        {**PUPIL, "defocus_waves": 0.5},
        {**PUPIL, "shape": "cassegrain", "zernike_waves": [0, 0, 0, 0.1]},
    ],
}  # fmt: skip
LARGEST, SMALLEST = 1.7976931348623157e308, 5e-324


def extremes(parameter: Parameter) -> list[Any]:
    """The ends of a parameter's range, and what lies far out within it."""
    low, high = AFFORDABLE.get(parameter.name, (parameter.param.low, parameter.param.high))
    if parameter.kind == "choice":
        return list(parameter.choices)
    if parameter.kind == "switch":
        return [False, True]
    if parameter.kind not in ("number", "integer"):
        return []
    sizes = [SMALLEST, 1e-30, 1e9, 1e300, LARGEST]
    values = [*sizes, *(-v for v in sizes), 0.0]
    values += [end for end in (low, high) if end is not None]
    for end, step in ((low, math.inf), (high, -math.inf)):
        if end is not None and parameter.kind == "number":
            values.append(math.nextafter(end, step))
    if parameter.kind == "integer":
        values = [int(v) for v in values if abs(v) < 2**62 and v == int(v)]
        values = [v for v in values if (low is None or v >= low) and (high is None or v <= high)]
    return [v for v in dict.fromkeys(values) if parameter._in_range(v)]


def fixed_chain(key: str, values: dict[str, Any]) -> tuple[Network, str, bool]:
    """Init, the module (of spectra), a pupil, back, the module (of pictures), in this order.

    With the last port, and whether the mean should come out there as it went in.
    """
    on_picture, own = key in PICTURE, {"it": (key, values)}
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 1.5, "fov_y_deg": 1.1}),
        "init": ("init_trans", SENSOR),
        **({} if on_picture else own),
        "pupil": ("exit_pupil", PUPIL),
        "optics": ("exit_pupil_mtf", BAND),
        "back": ("back_transform", {}),
        **(own if on_picture else {}),
    }
    named = {"init_trans": "init", "exit_pupil": "pupil", "exit_pupil_mtf": "optics"}
    if key in named:
        nodes[named[key]] = nodes.pop("it")
    document = linked_network(nodes)
    even = key not in ("charge_eff_phase", "exit_pupil") and values.get("model") != "line"
    keeps = (not on_picture or key == "anti_alias") and even and not values.get("apply")
    return document, "it.image" if on_picture else "back.image", keeps


def each_extreme(key: str, *, thorough: bool):
    """Settings, and the precisions to try them in: samples overflow sooner in single.

    Each value goes with one of what is switched on beside it, in turn; if `thorough`, with all.
    """
    bases, turn = ACTIVE.get(key, [{}]), count()
    for parameter in declaration(LIBRARY[key]).parameters:
        for value in extremes(parameter):
            for base in bases if thorough else [bases[next(turn) % len(bases)]]:
                far = isinstance(value, float) and not 1e-200 < abs(value) < 1e200
                precisions = ("double",) if key not in PICTURE else ("single", "double")[: 1 + far]
                for precision in precisions:
                    yield {**base, parameter.name: value}, precision


@pytest.mark.parametrize("key", [*ON_SPECTRUM, *PICTURE, "init_trans", "exit_pupil"])
def test_each_parameter_at_its_extremes(folder, key, request):
    """One engine for all settings, as in the window: what they do not change is made once."""
    picture = np.random.default_rng(7).uniform(20, 60, (3, 4))
    np.save(folder / "in.npy", picture)
    engine, faults = Engine(LIBRARY), []
    for values, precision in each_extreme(key, thorough=request.config.option.thorough):
        network, last, keeps_mean = fixed_chain(key, values)
        try:
            found = arrays_of(network, folder, precision, engine)
            if keeps_mean and last in found:
                mean = found[last].mean(dtype=np.longdouble)
                assert mean == pytest.approx(picture.mean(), rel=MEAN_ERROR[precision])
        except (ArithmeticError, AssertionError, ValueError, Warning) as fault:
            reason = str(fault).splitlines()[0] if str(fault) else ""
            faults.append(f"{precision} {values}: {type(fault).__name__} {reason}")
    assert not faults, "\n".join([f"{len(faults)} settings fail", *faults[:8]])
