"""Random cameras, measured and fitted, judged by what is true of them.

    python tests/fuzz/measured_cameras.py --count 100

Pictures and truth come from `tests/support/oversampled_camera.py`, which shares no code with what
is judged. Development goes by numbers below 1000; those from there on are for the last word alone.
Each case is a line of JSON; then comes how much lies within three errors.
"""

import argparse
import json
import sys
import time
import traceback
from dataclasses import asdict
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[1] / "support"), str(HERE.parents[2])]

from app.measure.measuring import edges_of, pooled  # noqa: E402
from camera_scenes import SCENES, drawn_camera  # noqa: E402
from core.errors import ImagechainError  # noqa: E402
from core.physics.measurement.picture_noise import noise_of_picture  # noqa: E402
from edge_truth import blur_network  # noqa: E402
from oversampled_camera import take, true_mtf, true_sigma  # noqa: E402


def within(values, limit=3):
    """A share in words, with how many it is of."""
    size = np.abs(np.asarray(values, float))
    return f"{100 * np.mean(size <= limit):.2f} % of {size.size}" if size.size else "none"


def table(rows):
    """One line for each thing that is judged."""
    good = [row for row in rows if "fault" not in row]
    noises = [row["noise"] for row in good]
    given = [
        one
        for row in good
        for one in ((row.get("fit") or {}).get("parameters") or {}).values()
        if one is not None
    ]
    missed = [row["case"] for row in good if row["usable"] and not row["used"]]
    lines = [
        ("cameras", f"{len(rows)}, faults {len(rows) - len(good)}"),
        ("cameras whose edges were missed", missed or "none"),
        ("MTF of one edge", within([p for row in good for e in row["edges"] for p in e["pulls"]])),
        ("pooled MTF", within([p for row in good for e in row["pooled"] for p in e["pulls"]])),
        *(
            (name, within([one[key] for one in noises if key in one]))
            for name, key in (("noise", "pull"), ("gain", "gain_pull"), ("read noise", "read_pull"))
        ),
        ("fitted parameters", within([one["pull"] for one in given])),
    ]
    width = max(len(name) for name, _ in lines)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in lines)


ROWS, COLUMNS = 208, 248
LAST = 0.4  # cycles per sample: 0.8 of Nyquist
# Samples, and noise: an edge that is to be seen. It must also cross a sample's middle: what runs
# along the samples shows one phase of its spread only.
SHORTEST, LEAST_CONTRAST = 24.0, 10.0
INTERVAL_MRAD, PITCH_UM, WAVELENGTH_UM, FOCAL_MM = 0.1, 10.0, 4.0, 100.0


def drawn(number, rows=ROWS, columns=COLUMNS):
    """Kind of scene, camera and frame of a case."""
    rng = np.random.default_rng([1, number])
    camera, full = drawn_camera(rng)
    kind = list(SCENES)[number % len(SCENES)]
    scene = SCENES[kind](rng, rows, columns, full)
    return kind, camera, take(scene, camera, rows=rows, columns=columns, seed=number)


def judged(number, *, fit=True, rows=ROWS, columns=COLUMNS):
    """What came of one case, as plain values."""
    kind, camera, frame = drawn(number, rows, columns)
    row = {"case": number, "kind": kind, "camera": asdict(camera)}
    start = time.process_time()
    edges = edges_of(picture=frame.picture, number=0, clip_levels=(0.0, 2.0**camera.bits - 1))
    row |= _edges(edges, camera, frame)
    noise = noise_of_picture(picture=frame.picture, offset=camera.offset_dn)
    row["measure_s"] = time.process_time() - start
    row["noise"] = _noise(noise, camera)
    if fit and row["used"] and not (camera.motion or camera.electronics):
        start = time.process_time()
        row["fit"] = _fit(camera, frame.picture, np.random.default_rng([number, 9]))
        row["fit_s"] = time.process_time() - start
    return row


def _edges(edges, camera, frame):
    used = [edge for edge in edges if edge.used and edge.curve is not None]
    curves = [_pulls(edge.curve, camera, edge.found.angle_deg) for edge in used]
    together = []
    for axis, angle in (("x", 0.0), ("y", 90.0)):
        curve, _ = pooled(edges, axis)
        if curve is not None:
            together.append(
                {"axis": axis, "edges": curve.edges, "mtf50": curve.mtf50}
                | _pulls(curve, camera, angle)
            )
    reasons = sorted({edge.why_not for edge in edges if not edge.used})
    return {
        "usable": len([edge for edge in frame.edges if _is_usable(edge, camera)]),
        "used": len(used),
        "reasons": reasons[:8],
        "edges": [
            {"x": e.found.x, "y": e.found.y, "angle_deg": e.found.angle_deg,
             "length": e.found.length, "reach": e.found.reach} | pulls
            for e, pulls in zip(used, curves, strict=True)
        ],
        "pooled": together,
    }  # fmt: skip


def _is_usable(edge, camera):
    bright = (edge.high - camera.offset_dn) * camera.gain_e_per_dn
    contrast = (edge.high - edge.low) / true_sigma(camera, bright)
    off_axis = abs((edge.angle_deg + 45) % 90 - 45)
    slant = edge.length * np.sin(np.radians(off_axis))
    return edge.length >= SHORTEST and contrast >= LEAST_CONTRAST and slant >= 1


def _pulls(curve, camera, angle_deg):
    """Departures from the truth over their errors, up to 0.8 of Nyquist."""
    near = (curve.frequency > 0) & (curve.frequency <= LAST)
    truth = true_mtf(camera, angle_deg, curve.frequency[near])
    off = curve.mtf[near] - truth
    return {
        "pulls": np.round(off / np.maximum(curve.sigma[near], 1e-12), 3).tolist(),
        "off": float(np.abs(off).max()),
        "sigma": float(np.interp(0.25, curve.frequency, curve.sigma)),
    }


def _noise(noise, camera):
    row = {"reason": noise.sigma_reason, "gain_reason": noise.gain_reason}
    if noise.sigma is not None:
        electrons = (noise.mean_level - camera.offset_dn) * camera.gain_e_per_dn
        truth = float(true_sigma(camera, electrons))
        row |= {
            "sigma": noise.sigma / truth,
            "pull": (noise.sigma - truth) / noise.sigma_error,
            "dn": truth,
        }
    if noise.gain_e_per_dn is not None:
        truth = camera.gain_e_per_dn
        row |= {
            "gain": noise.gain_e_per_dn / truth,
            "gain_pull": (noise.gain_e_per_dn - truth) / noise.gain_error,
        }
    if noise.read_noise_dn is not None:
        truth = camera.read_e / camera.gain_e_per_dn
        row |= {
            "read": noise.read_noise_dn / truth,
            "read_pull": (noise.read_noise_dn - truth) / noise.read_noise_error,
        }
    return row


def network_of(camera):
    """The chain that is the camera, and the true values of what may be fitted."""
    stages, truth = {}, {}
    if camera.cutoff is not None:
        aperture = FOCAL_MM * WAVELENGTH_UM * camera.cutoff / PITCH_UM
        stages["optics"] = (
            "diffraction_mtf",
            {"aperture_mm": aperture, "wavelengths": 1, "cut_on_um": WAVELENGTH_UM - 0.01,
             "cut_off_um": WAVELENGTH_UM + 0.01, "defocus_waves": camera.defocus,
             "obscuration_ratio": camera.obscuration},
        )  # fmt: skip
        truth["optics.aperture_mm"] = aperture
        if camera.defocus:
            truth["optics.defocus_waves"] = camera.defocus
    if any(camera.gaussian):
        x, y = (sigma * INTERVAL_MRAD for sigma in camera.gaussian)
        stages["blur"] = "gaussian_mtf", {"sigma_x_mrad": x, "sigma_y_mrad": y}
        truth |= {"blur.sigma_x_mrad": x, "blur.sigma_y_mrad": y}
    if camera.jitter:
        stages["jitter"] = "jitter_mtf", {"sigma_mrad": camera.jitter * INTERVAL_MRAD}
        if not any(camera.gaussian):
            truth["jitter.sigma_mrad"] = camera.jitter * INTERVAL_MRAD
    network = blur_network(interval_mrad=INTERVAL_MRAD, **stages)
    network["nodes"]["detector"]["params"] |= {
        "fill_x": camera.pixel[0], "fill_y": camera.pixel[1],
    }  # fmt: skip
    return network, truth


def freed(network, truth, rng):
    """One to three parameters to be fitted, which begin off the truth."""
    count = min(len(truth), int(rng.integers(1, 4)))
    free = sorted(rng.choice(sorted(truth), count, replace=False).tolist())
    for name in free:
        node, parameter = name.split(".")
        network["nodes"][node]["params"][parameter] = truth[name] * 10 ** rng.uniform(-0.4, 0.4)
    return free


def fitted(network, picture, free, clip_levels=None):
    """A fit's result by the product's own way from the picture to the errors."""
    from app.fit.chain_fit import EdgeProblem, fit_chain
    from app.fit.chain_transfer import free_parameters
    from app.fit.fit_result import result_of
    from app.fit.picture_fit import edges_in
    from core.chain.engine import Engine
    from core.errors import DataError
    from core.evaluation.work import Policy
    from core.network.file import parse_network
    from nodes.library import standard_library

    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="drawn")
    parameters = free_parameters(free, made, library)
    engine = Engine(library)
    patches, refused = edges_in(pictures=[picture], clip_levels=clip_levels)
    if not patches:
        raise DataError(f"no edge can be used: {refused}")
    work = engine.work(Policy("single", None, 1))
    problem = EdgeProblem(engine, engine.plan(made), work, parameters, patches)
    fit = fit_chain(problem)
    return result_of(fit, problem.cost)


def _fit(camera, picture, rng):
    network, truth = network_of(camera)
    if not truth:
        return None
    free = freed(network, truth, rng)
    try:
        result = fitted(network, picture, free, (0.0, 2.0**camera.bits - 1))
    except ImagechainError as error:
        return {"refused": str(error)}
    except Exception as error:  # a finding; what was measured counts all the same
        return {"fault": _fault(error)}
    row = {"chi2": result.chi2_per_degree, "warnings": list(result.warnings), "parameters": {}}
    for one in result.parameters:
        row["parameters"][one.port] = (
            None
            if one.value is None
            else {
                "pull": (one.value - truth[one.port]) / max(one.sigma, 1e-300),
                "ratio": one.value / truth[one.port],
                "share": one.sigma / truth[one.port],
            }
        )
    return row


def _case(number, *, fit):
    try:
        return judged(number, fit=fit)
    except Exception as error:  # a finding, not an end
        return {"case": number, "fault": _fault(error)}


def _fault(error):
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"


def main():
    """Carry out the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--no-fit", action="store_true")
    words = parser.parse_args()
    rows = []
    for number in range(words.first, words.first + words.count):
        rows.append(_case(number, fit=not words.no_fit))
        print(json.dumps(rows[-1]), flush=True)
    print(table(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
