"""A uniform scene before a Focal Plane, as a data sheet of a cooled camera has it."""

from node_bench import NodeBench

SENSOR = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.95, "platform": "array",
}  # fmt: skip
MWIR = {"cut_on_um": 3.7, "cut_off_um": 4.8}
CAMERA_SHEET = {
    "integration_time_s": 0.004, "optics_transmission": 0.765, "quantum_efficiency": 0.7,
    "read_noise_e": 400, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip


def focal_plane_bench(
    folder, params, *, size=(64, 48), init=None, scene=None, precision="double", behind=()
):
    """Scene, Init & Trans and Focal Plane `it`; `behind` are modules that take its picture."""
    seen = {
        "kind": "uniform", "width": size[0], "height": size[1], "fov_x_deg": 1.0,
        "fov_y_deg": 1.0, "temperature_K": 300.0, **MWIR, **(scene or {}),
    }  # fmt: skip
    nodes = {
        "scene": ("test_scene", seen),
        "init": ("init_trans", {**SENSOR, **(init or {})}),
        "it": ("focal_plane", params),
        **{key: (key, {}) for key in behind},
    }
    return NodeBench(folder, nodes, precision=precision)


def cautions(bench, check):
    """What is warned of by that check."""
    return [c for c in bench.warnings() if c.check == check]
