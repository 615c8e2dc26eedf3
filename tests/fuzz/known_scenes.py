"""Random cameras before scenes that are known, and whether the fit recovers them.

Scene and picture are made by `tests/support/oversampled_camera.py`, which shares no code with the
fit; the network gets the scene's fine cells as its source, out of place by whole
cells where they are shifted.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy import fft

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from measured_cameras import INTERVAL_MRAD, freed, network_of

from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import FittedPictures, fit_known_scene
from camera_scenes import DEVELOPMENT, drawn_camera
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.network.parsing import parse_network
from nodes.library import standard_library
from oversampled_camera import take
from oversampled_scene import render

ROWS, COLUMNS, FINE, MARGIN = 96, 112, 8, 24
KINDS = ("rectangles", "letters", "leaves", "discs", "star")  # nothing at the frame but ground


def drawn(seed, *, shifted):
    """A camera, its picture, and the fine cells of its scene, out of place if they are to be."""
    rng = np.random.default_rng([seed, 5])
    camera, full = drawn_camera(rng)
    while camera.motion or camera.electronics:
        camera, full = drawn_camera(rng)
    scene = DEVELOPMENT[KINDS[seed % len(KINDS)]](rng, ROWS, COLUMNS, full)
    picture = take(scene, camera, rows=ROWS, columns=COLUMNS, seed=seed).picture
    cells = _points(render(scene, ROWS, COLUMNS, fine=FINE, margin=MARGIN).level)
    by = rng.integers(-2 * FINE, 2 * FINE + 1, 2) if shifted else np.zeros(2, int)
    top, left = MARGIN * FINE + by
    return camera, picture, cells[top : top + ROWS * FINE, left : left + COLUMNS * FINE]


def _points(cells):
    """The scene at the cells' middles, from its means over them, as the picture is made of it."""
    fy, fx = fft.fftfreq(cells.shape[0])[:, None], fft.rfftfreq(cells.shape[1])
    return fft.irfft2(fft.rfft2(cells) / (np.sinc(fy) * np.sinc(fx)), cells.shape)


def fitted(seed, *, shifted):
    """The true values of a camera's parameters, and the fit's result."""
    camera, picture, cells = drawn(seed, shifted=shifted)
    network, truth = network_of(camera)
    free = freed(network, truth, np.random.default_rng([seed, 9]))
    fov = [math.degrees(2 * math.atan(n * INTERVAL_MRAD / 2000)) for n in (COLUMNS, ROWS)]
    with tempfile.TemporaryDirectory() as folder:
        np.save(Path(folder) / "scene.npy", cells)
        network["nodes"]["scene"] = {
            "module": "read_image",
            "params": {"path": "scene.npy", "fov_x_deg": fov[0], "fov_y_deg": fov[1]},
        }
        network["nodes"]["pixels"] = {
            "module": "sample_pixels", "params": {"factor_x": FINE, "factor_y": FINE},
        }  # fmt: skip
        network["links"].append(["back.image", "pixels.image"])
        library = standard_library()
        made = parse_network(json.dumps(network), library=library, name_of_source="drawn")
        engine = Engine(library)
        result = fit_known_scene(
            engine, engine.plan(made, folder=Path(folder)), engine.work(Policy("single", None, 1)),
            free=free_parameters(free, made, library),
            pictures=FittedPictures(("taken",), (picture,)),
        )  # fmt: skip
    return truth, result
