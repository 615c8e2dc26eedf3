"""A small sensor whose figures of merit follow laws that are written out in a line."""

import math

WIDTH, HEIGHT, FOV_X_DEG, FOV_Y_DEG = 48, 40, 3.0, 2.5
JITTER_MRAD = 0.2
NYQUIST_X = 0.5 / (math.radians(FOV_X_DEG) * 1000.0 / WIDTH)  # cycles/mrad

DOCUMENT = {
    "format": "imagechain-network",
    "version": 1,
    "name": "Sensor",
    "seed": 3,
    "nodes": {
        "scene": {
            "module": "test_scene",
            "params": {
                "kind": "slanted_edge",
                "width": WIDTH,
                "height": HEIGHT,
                "fov_x_deg": FOV_X_DEG,
                "fov_y_deg": FOV_Y_DEG,
                "cut_on_um": 3.0,
                "cut_off_um": 5.0,
            },
        },
        "init": {
            "module": "init_trans",
            "params": {
                "focal_length_mm": 100.0,
                "detector_x_um": 30.0,
                "detector_y_um": 30.0,
                "f_number": 2.0,
            },
        },
        "blur": {"module": "gaussian_mtf", "params": {"sigma_x_mrad": 0.5, "sigma_y_mrad": 0.3}},
        "jitter": {"module": "jitter_mtf", "params": {"sigma_mrad": JITTER_MRAD}},
        "back": {"module": "back_transform"},
        "electronics": {
            "module": "electronics_noise",
            "params": {
                "cut_on_um": 3.0,
                "cut_off_um": 5.0,
                "d_star": 1e11,
                "bandwidth_Hz": 1e4,
                "background_K": 300.0,
            },
        },
    },
    "links": [
        ["scene.image", "init.image"],
        ["init.context", "blur.context"],
        ["init.magnitude", "blur.magnitude"],
        ["init.context", "jitter.context"],
        ["blur.magnitude", "jitter.magnitude"],
        ["jitter.magnitude", "back.magnitude"],
        ["init.phase", "back.phase"],
        ["back.image", "electronics.image"],
        ["init.context", "electronics.context"],
    ],
}


def mtf(sigma_mrad, frequency=NYQUIST_X):
    """The chain's MTF along x: two Gaussians."""
    variance = sigma_mrad**2 + JITTER_MRAD**2
    return math.exp(-2.0 * math.pi**2 * variance * frequency**2)
