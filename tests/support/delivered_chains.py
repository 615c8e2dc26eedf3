"""Chains from a picture file, and what they deliver."""

import numpy as np

from analytic_stages import INTERVAL_X, INTERVAL_Y, PUPIL, SENSOR, STAGES
from linked_network import linked_network
from node_bench import NodeBench

PRECISIONS = ["double", "single"]
MTF_ERROR = {"double": 1e-12, "single": 2e-6}
MEAN_ERROR = {"double": 1e-13, "single": 1e-7}
SHIFT_ERROR = {"double": 1e-10, "single": 1e-5}
FOLD_ERROR = {"double": 1e-13, "single": 1e-6}


def fov_deg(samples, interval):
    return float(np.degrees(samples * interval / 1000))


def chain_network(stages, rows, columns, edges="periodic", tail=()):
    """A picture file through the stages to `last.image`; `tail` are further image modules."""
    nodes = {
        "file": ("read_image", {"path": "in.npy"}),
        "init": ("init_trans", {
            **SENSOR, "edges": edges, "fov_x_deg": fov_deg(columns, INTERVAL_X),
            "fov_y_deg": fov_deg(rows, INTERVAL_Y),
        }),
        "pupil": ("exit_pupil", PUPIL),
        **{stage: STAGES[stage] for stage in stages},
        "back": ("back_transform", {}),
        **{f"tail{number}": module for number, module in enumerate(tail)},
    }  # fmt: skip
    return linked_network(nodes), list(nodes)[-1]


def delivered(tmp_path, picture, stages, precision, edges="periodic", tail=()):
    np.save(tmp_path / "in.npy", picture)
    document, last = chain_network(stages, *picture.shape, edges, tail)
    bench = NodeBench(tmp_path, document, precision=precision)
    found = bench.value(f"{last}.image")
    assert found.dtype == bench.work.policy.dtype
    return found.astype(float), bench.plan


def scene(rows, columns, seed=5):
    """A frame with a wide range that is exact in single precision too."""
    drawn = np.random.default_rng(seed).uniform(20, 60, (rows, columns))
    return drawn.astype(np.float32).astype(float)
