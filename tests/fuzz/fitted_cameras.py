"""Random cameras, and whether the fit recovers them: bias, coverage, times.

    python tests/fuzz/fitted_cameras.py [COUNT] [FIRST SEED]

Pictures are made by `tests/support/oversampled_camera.py`, which shares no code with the fit. Each
camera has optics with defocus, a Gaussian blur, jitter or motion, a pixel, shot and read noise, 8
to 14 bits; two to four of its parameters are fitted.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from app.fit.chain_fit import EdgeProblem, fit_chain
from app.fit.chain_transfer import ChainAt
from app.fit.fit_result import result_of
from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import edges_in, refit_of
from core.chain.engine import Engine
from core.evaluation.policy import Policy
from core.network.parsing import parse_network
from edge_truth import blur_network
from nodes.library import standard_library
from oversampled_camera import Camera, take
from oversampled_scene import Scene, Shape

INTERVAL = 0.1  # mrad
WAVELENGTH_UM, PITCH_UM = 4.0, 10.0


def scene(rng, rows, columns, low, high):
    """A few turned squares on a background."""
    shapes = []
    across = max(1, columns // 110)
    down = max(1, rows // 110)
    for i in range(down):
        for j in range(across):
            middle = np.array([(j + 0.5) * columns / across, (i + 0.5) * rows / down])
            half = rng.uniform(27, 32)
            turn = math.radians(rng.uniform(3, 42) * rng.choice([-1, 1]))
            corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
            rotation = np.array(
                [[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]
            )
            shapes.append(Shape(corners @ rotation.T + middle + rng.uniform(-4, 4, 2), high))
    return Scene(background=low, shapes=tuple(shapes))


def drawn(seed):
    """A camera, the network that is it, and the true values of its free parameters."""
    rng = np.random.default_rng(seed)
    f_number = rng.uniform(1.5, 4.5)
    cutoff = PITCH_UM / (WAVELENGTH_UM * f_number)
    defocus = rng.uniform(0.15, 0.6)
    sigma = rng.uniform(0.2, 0.8, 2)
    fill = rng.uniform(0.7, 1.0)
    jitter = rng.uniform(0.15, 0.4)
    bits = int(rng.choice([8, 10, 12, 14]))
    top = 2.0**bits - 1
    full_well = 10 ** rng.uniform(4.0, 5.3)
    low, high = full_well * 0.15, full_well * rng.uniform(0.5, 0.85)
    read = rng.uniform(0.5, 3.0) * math.sqrt(low) / 2
    camera = Camera(
        cutoff=cutoff, defocus=defocus, gaussian=tuple(sigma), jitter=jitter,
        pixel=(fill, fill), read_e=read, gain_e_per_dn=full_well / top, bits=bits,
    )  # fmt: skip
    network = blur_network(
        interval_mrad=INTERVAL,
        optics=(
            "diffraction_mtf",
            {"aperture_mm": 100.0 / f_number, "wavelengths": 1, "cut_on_um": WAVELENGTH_UM - 0.01,
             "cut_off_um": WAVELENGTH_UM + 0.01, "defocus_waves": defocus},
        ),
        blur=(
            "gaussian_mtf",
            {"sigma_x_mrad": sigma[0] * INTERVAL, "sigma_y_mrad": sigma[1] * INTERVAL},
        ),
        jitter=("jitter_mtf", {"sigma_mrad": jitter * INTERVAL}),
    )  # fmt: skip
    network["nodes"]["detector"]["params"] |= {"fill_x": fill, "fill_y": fill}
    truth = {
        "blur.sigma_x_mrad": sigma[0] * INTERVAL, "blur.sigma_y_mrad": sigma[1] * INTERVAL,
        "optics.defocus_waves": defocus, "optics.aperture_mm": 100.0 / f_number,
    }  # fmt: skip
    count = int(rng.integers(2, 5))
    names = ["blur.sigma_x_mrad", "blur.sigma_y_mrad"]
    names += list(rng.permutation(["optics.defocus_waves", "optics.aperture_mm"])[: count - 2])
    for name in names:  # the fit is not to begin at the truth
        node, parameter = name.split(".")
        network["nodes"][node]["params"][parameter] = truth[name] * 10 ** rng.uniform(-0.5, 0.5)
    return camera, network, {name: truth[name] for name in names}, (low, high)


def fitted(seed, rows=220, columns=330):
    """Pulls of a camera's parameters, and what else there is to say."""
    camera, network, truth, (low, high) = drawn(seed)
    rng = np.random.default_rng([seed, 7])
    picture = take(
        scene(rng, rows, columns, low, high), camera, rows=rows, columns=columns, seed=seed
    ).picture
    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="drawn")
    free = free_parameters(list(truth), made, library)
    engine = Engine(library)
    plan = engine.plan(made)
    work = engine.work(Policy("single", None, 1))
    start = time.process_time()
    choice = edges_in(pictures=[picture])
    found = time.process_time() - start
    problem = EdgeProblem(
        ChainAt(engine, plan, [p.target for p in free]), work, free, choice.patches
    )
    fit = fit_chain(problem)
    result = result_of(fit, problem.cost, refit_of(problem, fit.values))
    took = time.process_time() - start
    return truth, result, len(choice.patches), found, took


def main(count=50, first=0):
    """Print each camera, then all pulls together."""
    pulls, times = {}, []
    for seed in range(first, first + count):
        truth, result, edges, found, took = fitted(seed)
        times.append(took)
        parts = []
        for one in result.parameters:
            if one.value is None:
                parts.append(f"{one.port} none")
                continue
            pull = (one.value - truth[one.port]) / one.sigma
            pulls.setdefault(one.port, []).append(pull)
            share = one.sigma / truth[one.port]
            parts.append(f"{one.port} {pull:+.2f} ({100 * share:.1f} %)")
        misfit = result.fit.misfit
        print(
            f"{seed}: {edges} edges {found:.1f} s {took:.1f} s {result.fit.evaluations} "
            f"evaluations chi2 {misfit.chi2_per_degree:.3f} shape {misfit.shape_per_degree:.3f}; "
            + "; ".join(parts),
            flush=True,
        )
        for line in result.warnings:
            print("   ", line)
    everything = [pull for values in pulls.values() for pull in values]
    for name, values in [*pulls.items(), ("all", everything)]:
        seen = np.array(values)
        error = seen.std() / math.sqrt(len(seen))
        print(
            f"{name}: {len(seen)}; mean pull {seen.mean():+.3f} ± {error:.3f}, spread "
            f"{seen.std():.3f}, within 1: {np.mean(np.abs(seen) < 1):.3f}, within 3: "
            f"{np.mean(np.abs(seen) < 3):.3f}"
        )
    print(f"seconds: median {np.median(times):.2f}, most {max(times):.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
