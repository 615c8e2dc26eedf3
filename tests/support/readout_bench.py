"""Read-outs of one module behind a small scene whose two axes are unlike in everything."""

import math

import numpy as np

from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
COLUMNS, ROWS = 24, 16
FOV_X_DEG, FOV_Y_DEG = 2.0, 3.0
DX = math.radians(FOV_X_DEG) * 1000 / COLUMNS  # mrad
DY = math.radians(FOV_Y_DEG) * 1000 / ROWS
NYQUIST_X, NYQUIST_Y = 0.5 / DX, 0.5 / DY  # cycles/mrad: 0.344 and 0.153
SCENE = {
    "kind": "two_panel", "width": COLUMNS, "height": ROWS,
    "fov_x_deg": FOV_X_DEG, "fov_y_deg": FOV_Y_DEG, "cut_on_um": 8.0, "cut_off_um": 12.0,
}  # fmt: skip
FOCAL_LENGTH_MM = 20.0
PITCH_X_UM, PITCH_Y_UM = 30.0, 50.0
FILL_X, FILL_Y = 0.9, 0.7
RANGE_M = 400.0
F_NUMBER = 1.5
VELOCITY_M_PER_S = 60.0
SCAN_MRAD_PER_S = 8000.0
INIT = {
    "detector_x_um": PITCH_X_UM, "detector_y_um": PITCH_Y_UM, "focal_length_mm": FOCAL_LENGTH_MM,
    "fill_x": FILL_X, "fill_y": FILL_Y, "range_m": RANGE_M, "f_number": F_NUMBER,
    "velocity_m_per_s": VELOCITY_M_PER_S, "scan_velocity_mrad_per_s": SCAN_MRAD_PER_S,
}  # fmt: skip


def bench_of(folder, key, params, *, init=None, scene=None, more=()):
    """The module as node `it` behind the scene, Init & Trans and what `more` there is."""
    nodes = {
        "scene": ("test_scene", {**SCENE, **(scene or {})}),
        "init": ("init_trans", {**INIT, **(init or {})}),
        **dict(more),
        "it": (key, params),
    }
    return NodeBench(LIBRARY, folder, nodes)


def gaussian(sigma_mrad, frequency):
    """Transfer function of a Gaussian blur."""
    return math.exp(-2 * (math.pi * sigma_mrad * frequency) ** 2)


def sinc(x):
    """The field's sinc, sin(πx)/(πx)."""
    return float(np.sinc(x))
