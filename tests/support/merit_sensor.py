"""A small staring sensor before Figures of Merit, of which every part can be changed."""

import math

from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import in_order, linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
FOV = 2.0  # degrees in 80 samples: 0.4363 mrad
INTERVAL = math.radians(FOV) * 1000 / 80
NYQUIST = 0.5 / INTERVAL
SCENE = {
    "kind": "uniform", "width": 80, "height": 80, "fov_x_deg": FOV, "fov_y_deg": FOV,
    "cut_on_um": 3.0, "cut_off_um": 5.0, "temperature_K": 300.0,
}  # fmt: skip
INIT = {
    "detector_x_um": 80.0, "detector_y_um": 80.0, "focal_length_mm": 200.0, "f_number": 2.0,
    "range_m": 400.0, "platform": "array",
}  # fmt: skip
NOISE = {
    "region": "MWIR", "d_star": 1e12, "material": "manual", "bandwidth_Hz": 3e5,
    "amplifier_snr": 100.0,
}  # fmt: skip


def sensor(merit=None, *, scene=None, init=None, noise=None, noisy=True, seed=1, air=()):
    """`air`: parameters of Atmospheric Paths one after the other, behind the scene."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        **{f"air{number}": ("atmospheric_path", path) for number, path in enumerate(air)},
        "init": ("init_trans", {**INIT, **(init or {})}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.1}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        **({"noise": ("electronics_noise", {**NOISE, **(noise or {})})} if noisy else {}),
        "merit": ("figures_of_merit", merit or {}),
    }
    engine = Engine(LIBRARY)
    plan = engine.plan(linked_network(nodes, in_order(nodes, LIBRARY), seed=seed))
    return engine, plan, engine.work(Policy(precision="double"))
