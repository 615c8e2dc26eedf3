"""A cooled camera of today on a scene in memory, with every noise of its focal plane."""

from __future__ import annotations

import time
from typing import Any

from app.bench.measuring.loaded_network import Chain, network_of, stages_in_turn
from core.evaluation.policy import Policy

OPTICS, CAMERA = "back.image", "camera.image"
_FOCAL_PLANE: dict[str, Any] = {
    "integration_time_s": 0.004, "optics_transmission": 0.8, "optics_K": 293.0,
    "dark_current_e_per_s": 1e5, "full_well_e": 7e6, "nonlinearity_percent": 1.0,
    "read_noise_e": 400.0, "prnu_percent": 0.3, "dsnu_e": 200.0, "bad_pixel_percent": 0.3,
    "bits": 14,
}  # fmt: skip
_STAGES: dict[str, tuple[str, dict[str, Any]]] = {
    "detector": ("detector_mtf", {}),
    "jitter": ("jitter_mtf", {"sigma_mrad": 0.05}),
}


class Camera(Chain):
    """Scene, two MTFs, focal plane.

    Parameters
    ----------
    size : int
        Samples across, and along.
    threads : int
        Of the evaluation; 0 for all.
    rows : int, optional
        Samples along, where not as many as across.
    """

    def __init__(self, size: int, threads: int = 0, rows: int | None = None) -> None:
        rows = size if rows is None else rows
        scene = {
            "kind": "dormitory", "width": size, "height": rows, "fov_x_deg": 8.8,
            "fov_y_deg": 8.8 * rows / size, "cut_on_um": 3.7, "cut_off_um": 4.8,
        }  # fmt: skip
        sensor = {
            "detector_x_um": 15.0, "detector_y_um": 15.0, "focal_length_mm": 100.0,
            "f_number": 4.0, "platform": "array",
        }  # fmt: skip
        nodes: dict[str, tuple[str, dict[str, Any]]] = {
            "scene": ("test_scene", scene),
            "init": ("init_trans", sensor),
            **_STAGES,
            "back": ("back_transform", {}),
            "camera": ("focal_plane", _FOCAL_PLANE),
        }
        links = [
            ("scene.image", "init.image"),
            *stages_in_turn(_STAGES),
            ("back.image", "camera.image"),
            ("init.context", "camera.context"),
        ]
        super().__init__(network_of(nodes, links), Policy("single", threads=threads))
        self._edits = 0

    def kept(self, port: str) -> set[str]:
        """Keys of what a port's value leaves in an empty store."""
        self.store.clear()
        self.value(self.network, port)
        return self.store.keys()

    def behind(self, known: set[str], parameter: str = "", values: tuple[Any, ...] = ()) -> float:
        """Seconds to the camera's picture with that known, perhaps after an edit.

        Parameters
        ----------
        known : set of str
            From `kept`: all else is forgotten.
        parameter, values : str, tuple
            What of the focal plane is edited, and the values it takes in turn.
        """
        self.store.forget_all_but(known)
        network = self.network
        if values:
            self._edits += 1
            value = values[self._edits % len(values)]
            network = network.with_parameter("camera", parameter, value)
        before = self.engine.plan(self.network)
        start = time.perf_counter()
        plan = self.engine.plan(network, previous=before)
        self.engine.value(plan, CAMERA, self.work)
        return time.perf_counter() - start
