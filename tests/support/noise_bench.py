"""A network of noises, and the statistics that are asked of it.

Bounds are five standard errors; each is written out where it is used.
"""

import numpy as np

from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
BOUND = 5.0  # standard errors

SENSOR = {
    "fov_x_deg": 3, "fov_y_deg": 2, "f_number": 2, "detector_x_um": 30, "detector_y_um": 20,
    "focal_length_mm": 50, "fill_x": 0.9, "fill_y": 0.8, "scan_velocity_mrad_per_s": 8000,
}  # fmt: skip
BAND = {"cut_on_um": 8, "cut_off_um": 12, "background_K": 300, "bandwidth_Hz": 30000}
QUIET = {**BAND, "d_star": 1e30}  # a detector without noise worth the name
NOISY = {**BAND, "d_star": 1e9}
FULL = {
    **NOISY, "amplifier_snr": 20, "gain_percent": 3, "bias_percent": 2, "use_mtf": True,
    "noise_variability_percent": 10, "post_filter": "lowpass", "post_corner_Hz": 20000, "bits": 8,
}  # fmt: skip


def network(electronics, *, names=("noise", "photons"), seed=1996, sensor=None, photons=None):
    """File → photon noise → electronics, and a third of the same kind beside them."""
    reader, poisson = names
    nodes = {
        "file": ("read_image", {"path": "in.npy", "fov_x_deg": 3, "fov_y_deg": 2}),
        "init": ("init_trans", {**SENSOR, **(sensor or {})}),
        reader: ("electronics_noise", electronics),
        poisson: ("poisson_noise", photons or {"percent": 0}),
        "beside": ("electronics_noise", electronics),
    }
    links = [
        ("file.image", "init.image"), ("file.image", f"{poisson}.image"),
        (f"{poisson}.image", f"{reader}.image"), ("init.context", f"{reader}.context"),
        ("file.image", "beside.image"), ("init.context", "beside.context"),
    ]  # fmt: skip
    return linked_network(nodes, links, seed=seed)


class Bench:
    """A folder with a picture, and what networks make of it."""

    def __init__(self, folder):
        self.folder = folder
        self.engine = Engine(LIBRARY)

    def picture(self, samples):
        np.save(self.folder / "in.npy", np.asarray(samples, float))

    def get(self, document, *ports, engine=None, **policy):
        engine = engine or self.engine
        plan = engine.plan(document, folder=self.folder)
        assert plan.errors() == []
        work = engine.work(Policy(**{"precision": "double", **policy}))
        found = [engine.value(plan, port, work) for port in ports]
        return found[0] if len(found) == 1 else found

    def readouts(self, document, node="noise"):
        plan = self.engine.plan(document, folder=self.folder)
        return self.engine.readouts(plan, node, self.engine.work(Policy(precision="double")))


def rms(samples):
    return float(np.sqrt(np.mean(np.square(samples, dtype=float))))


def assert_rms(samples, expected, *, what=""):
    """Rms of n normal deviates: standard error σ/√(2n)."""
    error = expected / np.sqrt(2 * samples.size)
    assert abs(rms(samples) - expected) <= BOUND * error, what
