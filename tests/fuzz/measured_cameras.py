"""Random cameras, measured and fitted, judged by what is true of them.

    python tests/fuzz/measured_cameras.py --family development --count 100 --workers 2
    python tests/fuzz/measured_cameras.py --family held_out --case 17

Pictures and truth come from `tests/support/oversampled_camera.py`, which shares no code with what
is judged. `--file` writes a line for each case and leaves out those it has. Development goes by
the scenes of `camera_scenes`; those of `held_out_scenes` are for the last word alone. The two
families of `tails` have 3 to 15 % of the light in tails of 8 to 30 samples; they are measured only.
"""

from __future__ import annotations

import argparse
import importlib
import json
import multiprocessing
import sys
import time
import traceback
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[1] / "support"), str(HERE.parents[2])]

from app.measure.measuring import edges_of, pooled  # noqa: E402
from camera_scenes import drawn_camera, drawn_tail  # noqa: E402
from core.errors import ImagechainError  # noqa: E402
from core.physics.measurement.noise.picture_noise import noise_of_picture  # noqa: E402
from edge_truth import blur_network  # noqa: E402
from oversampled_camera import take, true_mtf, true_sigma  # noqa: E402


def share(good, of):
    """A share in words, with how many it is of."""
    return f"{100 * good / of:6.2f} % of {of}" if of else "none"


def _of(values, limit):
    values = np.abs(np.asarray(values, float))
    return share(int((values <= limit).sum()), values.size)


def _with(values, key):
    return sum(key in one for one in values)


def fit_pulls(rows):
    """Pulls of every fitted parameter that was given, with its case and name."""
    return [
        (row["case"], name, one["pull"], one)
        for row in rows
        for name, one in ((row.get("fit") or {}).get("parameters") or {}).items()
        if one is not None
    ]


def table(rows):
    """One line for each thing that is judged."""
    faults = [row for row in rows if "fault" in row]
    rows = [row for row in rows if "fault" not in row]
    with_edges = [row for row in rows if row["usable"]]
    without = [row for row in rows if row["kind"] in NO_EDGE]
    single = [pull for row in rows for edge in row["edges"] for pull in edge["pulls"]]
    pooled = [pull for row in rows for one in row["pooled"] for pull in one["pulls"]]
    noises = [row["noise"] for row in rows]
    sigma = [one["sigma"] - 1 for one in noises if "sigma" in one]
    gain = [one["gain"] - 1 for one in noises if "gain" in one]
    pulls = [pull for _, _, pull, _ in fit_pulls(rows)]
    fits = [row["fit"] for row in rows if row.get("fit")]
    unsaid = sum(one is None for fit in fits for one in (fit.get("parameters") or {}).values())
    seen = sum(bool(row["used"]) for row in with_edges)
    none = sum(not row["used"] for row in without)

    def noise_pulls(key):
        return [one[key] for one in noises if key in one]

    lines = [
        ("cameras", f"{len(rows)}, faults {len(faults)}"),
        ("edges used where there are any", share(seen, len(with_edges))),
        ("scenes without edge, none used", share(none, len(without))),
        ("edges used", str(sum(row["used"] for row in rows))),
        ("MTF of one edge within 3 errors", _of(single, 3)),
        ("MTF of one edge within 1 error", _of(single, 1)),
        ("pooled MTF within 3 errors", _of(pooled, 3)),
        ("pooled MTF within 1 error", _of(pooled, 1)),
        ("median error at 0.25 cyc/sample", _median(rows)),
        ("noise given", share(len(sigma), len(rows))),
        ("noise within 3 %", _of(sigma, 0.03)),
        ("noise within 3 errors", _of(noise_pulls("pull"), 3)),
        ("gain given", share(len(gain), len(rows))),
        ("gain within 5 %", _of(gain, 0.05)),
        ("gain within 3 errors", _of(noise_pulls("gain_pull"), 3)),
        ("read noise within 3 errors", _of(noise_pulls("read_pull"), 3)),
        ("fits", f"{len(fits)}, refused {_with(fits, 'refused')}, faults {_with(fits, 'fault')}"),
        ("parameters given, not given", f"{len(pulls)}, {unsaid}"),
        ("parameters within 3 errors", _of(pulls, 3)),
        ("parameters within 1 error", _of(pulls, 1)),
        ("seconds of a measurement", _mean(rows, "measure_s")),
        ("seconds of a fit", _mean(rows, "fit_s")),
    ]
    width = max(len(name) for name, _ in lines)
    text = "\n".join(f"{name:<{width}}  {value}" for name, value in lines)
    faults += [
        {"case": row["case"], "fault": row["fit"]["fault"]}
        for row in rows
        if "fault" in (row.get("fit") or {})
    ]
    return text + "".join(f"\nFAULT case {row['case']}: {row['fault']}" for row in faults)


NO_EDGE = frozenset(
    ("discs", "texture", "points", "flat", "clouds", "ripples", "ellipses", "blobs")
)


def _median(rows):
    texts = []
    for name, key in (("edge", "edges"), ("pooled", "pooled")):
        values = [one["sigma"] for row in rows for one in row[key]]
        if values:
            texts.append(f"{name} {np.median(values):.4f}")
    return "; ".join(texts)


def _mean(rows, key):
    values = [row[key] for row in rows if key in row]
    return f"mean {np.mean(values):.2f}, most {max(values):.2f}" if values else "none"


def worst(rows, most=10):
    """The worst cases of each kind, with what to repeat them by."""
    rows = [row for row in rows if "fault" not in row]
    missed = [
        f"case {row['case']} {row['kind']}: no edge of {row['usable']}: "
        + "; ".join(row["reasons"])[:150]
        for row in rows
        if row["usable"] and not row["used"]
    ]
    lines = missed[:most] + _worst_curves(rows, "edges", most) + _worst_curves(rows, "pooled", most)
    for key, name, limit in (("sigma", "noise", 0.03), ("gain", "gain", 0.05)):
        off = [row for row in rows if abs(row["noise"].get(key, 1) - 1) > limit]
        off.sort(key=lambda row: -abs(row["noise"][key] - 1))
        lines += [
            f"case {row['case']} {row['kind']}: {name} {row['noise'][key]:.3f} of the truth "
            f"({row['camera']['bits']} bits, true sigma {row['noise'].get('dn', 0):.2f} DN)"
            for row in off[:most]
        ]
    fits = sorted(fit_pulls(rows), key=lambda entry: -abs(entry[2]))
    lines += [
        f"case {number}: fit {name} pull {pull:+.1f}, {one['ratio']:.3f} of the truth"
        for number, name, pull, one in fits[:most]
        if abs(pull) > 2.5
    ]
    return "\n".join(lines)


def _worst_curves(rows, key, most):
    curves = [(float(np.abs(one["pulls"]).max()), row, one) for row in rows for one in row[key]]
    curves.sort(key=lambda entry: -entry[0])
    lines = []
    for pull, row, one in curves[:most]:
        if pull > 3:
            at = int(np.argmax(np.abs(one["pulls"])))
            place = (
                f"x {one['x']:.0f} y {one['y']:.0f} angle {one['angle_deg']:.1f} "
                f"length {one['length']:.0f} reach {one['reach']:.1f}"
                if "x" in one
                else f"axis {one['axis']}, {one['edges']} edges"
            )
            lines.append(
                f"case {row['case']} {row['kind']} {key}: pull {one['pulls'][at]:+.1f} at "
                f"{(at + 1) / 64:.3f}, off {one['off']:.3f}, {place}"
            )
    return lines


FAMILIES = {
    "development": ("camera_scenes", "DEVELOPMENT"),
    "held_out": ("held_out_scenes", "HELD_OUT"),
    "tails": ("camera_scenes", "TAILS"),
    "tails_held_out": ("held_out_scenes", "HELD_OUT_TAILS"),
}
TAIL_FINE, TAIL_MARGIN = 4, 120  # cells of a sample, and samples about a frame with long tails
ROWS, COLUMNS = 208, 248
LAST = 0.4  # cycles per sample: 0.8 of Nyquist
# Samples, and noise: an edge that is to be seen. It must also cross a sample's middle: what runs
# along the samples shows one phase of its spread only.
SHORTEST, LEAST_CONTRAST = 24.0, 10.0
INTERVAL_MRAD, PITCH_UM, WAVELENGTH_UM, FOCAL_MM = 0.1, 10.0, 4.0, 100.0


def scenes(family):
    """The scenes of a family by their names."""
    module, name = FAMILIES[family]
    return getattr(importlib.import_module(module), name)


def drawn(family, number, rows=ROWS, columns=COLUMNS):
    """Kind of scene, camera and frame of a case."""
    kinds = scenes(family)
    rng = np.random.default_rng([sorted(FAMILIES).index(family), number])
    camera, full = drawn_camera(rng)
    kind = list(kinds)[number % len(kinds)]
    scene = kinds[kind](rng, rows, columns, full)
    if not family.startswith("tails"):
        return kind, camera, take(scene, camera, rows=rows, columns=columns, seed=number)
    camera = replace(camera, tail=drawn_tail(rng), cutoff=camera.cutoff or 2.0)
    grid = {"fine": TAIL_FINE, "margin": TAIL_MARGIN}
    return kind, camera, take(scene, camera, rows=rows, columns=columns, seed=number, **grid)


def judged(family, number, *, fit=True, rows=ROWS, columns=COLUMNS):
    """What came of one case, as plain values."""
    kind, camera, frame = drawn(family, number, rows, columns)
    row = {"case": number, "kind": kind, "camera": asdict(camera)}
    start = time.process_time()
    edges = edges_of(picture=frame.picture, number=0, clip_levels=(0.0, 2.0**camera.bits - 1))
    row |= _edges(edges, camera, frame)
    noise = noise_of_picture(picture=frame.picture, offset=camera.offset_dn)
    row["measure_s"] = time.process_time() - start
    row["noise"] = _noise(noise, camera)
    if fit and row["used"] and camera.tail is None and not (camera.motion or camera.electronics):
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
    from app.fit.chain_transfer import ChainAt
    from app.fit.fit_result import result_of
    from app.fit.free_parameter import free_parameters
    from app.fit.picture_fit import edges_in, refit_of
    from core.chain.engine import Engine
    from core.errors import DataError
    from core.evaluation.policy import Policy
    from core.network.parsing import parse_network
    from nodes.library import standard_library

    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="drawn")
    parameters = free_parameters(free, made, library)
    engine = Engine(library)
    choice = edges_in(pictures=[picture], clip_levels=clip_levels)
    if not choice.patches:
        raise DataError(f"no edge can be used: {choice.reasons}")
    chain = ChainAt(engine, engine.plan(made), [one.target for one in parameters])
    work = engine.work(Policy("single", None, 1))
    problem = EdgeProblem(chain, work, parameters, choice.patches)
    fit = fit_chain(problem)
    return result_of(fit, problem.cost, refit_of(problem, fit.values))


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


def _case(words):
    family, number, how = words
    try:
        return judged(family, number, **how)
    except Exception as error:  # a finding, not an end
        return {"case": number, "fault": _fault(error)}


def _fault(error):
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"


def _rows(words):
    """The rows of all cases: those in the file, then the new ones as they come."""
    done = []
    if words.file is not None and words.file.exists():
        done = [json.loads(line) for line in words.file.read_text().splitlines()]
        done = [row for row in done if words.first <= row["case"] < words.first + words.count]
    have = {row["case"] for row in done}
    todo = [n for n in range(words.first, words.first + words.count) if n not in have]
    how = {"fit": not words.no_fit, "rows": words.rows, "columns": words.columns}
    jobs = [(words.family, n, how) for n in todo]
    end = time.monotonic() + words.seconds
    with multiprocessing.get_context("spawn").Pool(min(2, words.workers)) as pool:
        for row in pool.imap(_case, jobs):
            done.append(row)
            if words.file is not None:
                with words.file.open("a") as file:
                    file.write(json.dumps(row) + "\n")
            if time.monotonic() > end:
                pool.terminate()
                break
    return done


def main():
    """Carry out the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--family", choices=FAMILIES, default="development")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seconds", type=float, default=600, help="after which no more begin")
    parser.add_argument("--workers", type=int, default=1, help="processes, 1 or 2")
    parser.add_argument("--no-fit", action="store_true")
    parser.add_argument("--rows", type=int, default=ROWS, help="of a frame")
    parser.add_argument("--columns", type=int, default=COLUMNS)
    parser.add_argument("--file", type=Path, help="of results, a line each; goes on where it ends")
    parser.add_argument("--case", type=int, help="this one alone, in full")
    words = parser.parse_args()
    if words.case is not None:
        how = {"fit": not words.no_fit, "rows": words.rows, "columns": words.columns}
        print(json.dumps(judged(words.family, words.case, **how), indent=1))
        return 0
    rows = _rows(words)
    print(table(rows))
    print(worst(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
