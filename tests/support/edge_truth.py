"""Pictures of an edge by direct sums: each pixel a mean over many points of a blurred step."""

import math

import numpy as np
from scipy.special import erf

from linked_network import document_of
from node_bench import square_detectors


def gaussian_edge(
    *, angle_deg, sigma, shape, levels=(1000.0, 4000.0), points=12, middle=None, noise=0.0, seed=0
):
    """A step blurred by a Gaussian (σ across and down), averaged over square pixels."""
    rows, columns = shape
    x0, y0 = middle or ((columns - 1) / 2 + 0.31, (rows - 1) / 2 - 0.17)
    angle = math.radians(angle_deg)
    nx, ny = math.cos(angle), math.sin(angle)
    along_normal = math.hypot(sigma[0] * nx, sigma[1] * ny)
    places = (np.arange(points) + 0.5) / points - 0.5
    y, x = np.mgrid[0:rows, 0:columns].astype(float)
    total = np.zeros(shape)
    for v in places:
        for u in places:
            d = (x + u - x0) * nx + (y + v - y0) * ny
            total += 0.5 + 0.5 * erf(d / (math.sqrt(2) * along_normal))
    picture = levels[0] + (levels[1] - levels[0]) * total / points**2
    return picture + noise * np.random.default_rng(seed).standard_normal(shape)


HEADER = """ENVI
samples = 64
lines = 64
bands = 1
header offset = 0
data type = 5
interleave = bsq
byte order = 0
wavelength units = micrometers
wavelength = {{ {centre} }}
fwhm = {{ {width} }}
fov_x = {fov}
"""


def blur_network(*, interval_mrad=0.1, size=64, **stages):
    """A chain with an ideal detector of square pixels and the given modules in series."""
    fov_deg = 2 * math.degrees(math.atan(size * interval_mrad / 2000))
    scene = {"width": size, "height": size, "fov_x_deg": fov_deg, "fov_y_deg": fov_deg}
    nodes = {
        "scene": ("test_scene", scene),
        "init": ("init_trans", square_detectors(10.0, 10.0 / interval_mrad, 4.0, platform="array")),
        **stages,
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
    }
    return document_of(nodes, name="blurs", seed=1)
