"""A small sensor whose noise and blur are shared out, as a document and evaluated."""

import math
from pathlib import Path

from app.run.evaluation import TimedWork, evaluate, planned
from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

SIZE, FOV_DEG = 512, 10.0
INTERVAL = math.radians(FOV_DEG) * 1000 / SIZE
PITCH_UM, F_NUMBER, BANDWIDTH, D_STAR = 30.0, 2.0, 1e5, 1e10
BLUR_PX = 1.5
SCENE = {
    "kind": "uniform", "width": SIZE, "height": SIZE, "fov_x_deg": FOV_DEG, "fov_y_deg": FOV_DEG,
}  # fmt: skip
SENSOR = {
    "detector_x_um": PITCH_UM, "detector_y_um": PITCH_UM, "focal_length_mm": 50,
    "f_number": F_NUMBER, "platform": "array", "edges": "periodic",
}  # fmt: skip
ELECTRONICS = {
    "region": "LWIR", "material": "manual", "d_star": D_STAR, "bandwidth_Hz": BANDWIDTH,
    "amplifier_snr": 80.0, "gain_percent": 1.0, "bias_percent": 0.5,
}  # fmt: skip
PHOTONS = {"mode": "photon", "photons_per_unit": 40.0}


def network(photons=PHOTONS, electronics=ELECTRONICS, scene=SCENE, sigma_px=BLUR_PX):
    """Photon noise, a blur, the electronics, and pixels combined two by two."""
    sigma = sigma_px * INTERVAL
    nodes = {
        "scene": ("test_scene", scene),
        "photons": ("poisson_noise", photons),
        "init": ("init_trans", SENSOR),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "back": ("back_transform", {}),
        "electronics": ("electronics_noise", electronics),
        "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
    }
    return linked_network(
        nodes,
        [
            ("scene.image", "photons.image"), ("photons.image", "init.image"),
            ("init.context", "blur.context"), ("init.magnitude", "blur.magnitude"),
            ("blur.magnitude", "back.magnitude"), ("init.phase", "back.phase"),
            ("back.image", "electronics.image"), ("init.context", "electronics.context"),
            ("electronics.image", "pixels.image"),
        ],
        seed=7,
    )  # fmt: skip


def evaluated(document, precision="double"):
    engine = Engine(standard_library())
    plan = planned(engine, document, Path())
    return evaluate(engine, plan, TimedWork(Policy(precision), engine.store), Path())


def radiance(found):
    return float(found.engine.value(found.plan, "scene.image", found.work)[0, 0])
