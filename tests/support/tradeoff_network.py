"""A small sensor whose figures of merit follow laws that are written out in a line."""

import math

from linked_network import document_of

WIDTH, HEIGHT, FOV_X_DEG, FOV_Y_DEG = 48, 40, 3.0, 2.5
JITTER_MRAD = 0.2
NYQUIST_X = 0.5 / (math.radians(FOV_X_DEG) * 1000.0 / WIDTH)  # cycles/mrad

BAND = {"cut_on_um": 3.0, "cut_off_um": 5.0}
SCENE = {
    "kind": "slanted_edge", "width": WIDTH, "height": HEIGHT, "fov_x_deg": FOV_X_DEG,
    "fov_y_deg": FOV_Y_DEG, **BAND,
}  # fmt: skip
LENS = {"focal_length_mm": 100.0, "detector_x_um": 30.0, "detector_y_um": 30.0, "f_number": 2.0}
ELECTRONICS = {**BAND, "d_star": 1e11, "bandwidth_Hz": 1e4, "background_K": 300.0}
NODES = {
    "scene": ("test_scene", SCENE),
    "init": ("init_trans", LENS),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.5, "sigma_y_mrad": 0.3}),
    "jitter": ("jitter_mtf", {"sigma_mrad": JITTER_MRAD}),
    "back": ("back_transform", {}),
    "electronics": ("electronics_noise", ELECTRONICS),
}
DOCUMENT = document_of(NODES, name="Sensor", seed=3)


def mtf(sigma_mrad, frequency=NYQUIST_X):
    """The chain's MTF along x: two Gaussians."""
    variance = sigma_mrad**2 + JITTER_MRAD**2
    return math.exp(-2.0 * math.pi**2 * variance * frequency**2)
