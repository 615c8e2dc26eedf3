"""Each parameter of each module at the ends of its range."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from chain_runs import not_nan, picture_of, run, run_on_file
from core.chain.engine import Engine
from core.errors import DataError, ParameterError
from core.evaluation.policy import Policy
from drawn_chains import GIVEN, LIBRARY, PICTURE, SENSOR, SPECTRUM
from extreme_chains import each_extreme, fixed_chain
from linked_network import linked_network


def test_faults_in_worker_threads_are_errors_too(folder):
    """Where rows are shared out among threads, an overflow is no less an error."""
    picture = np.random.default_rng(3).uniform(20, 60, (300, 310))
    cases = [
        ("periodic_noise", {"amplitude": 1e300, "modulation": 0.5}, picture),
        ("electronics_noise", {**GIVEN["electronics_noise"], "use_mtf": True}, 1e37 * picture / 60),
        ("electronics_noise", {**GIVEN["electronics_noise"], "amplifier_snr": 1e-60}, picture),
        ("interpolate", {"width": 700, "height": 300, "order": 3}, 5e36 * picture),
        ("jitter_mtf", {}, 5e36 * picture),
        ("charge_eff_phase", {"efficiency": 0.9}, 5e36 * picture),
        ("poisson_noise", {"percent": 90}, 5e36 * picture),
        ("combine_pixels", {"factor_x": 7, "mode": "sum"}, 5e36 * picture),
        ("anti_alias", {"factor": 5, "kernel": "lanczos"}, 5e36 * picture),
    ]
    for key, values, samples in cases:
        run(fixed_chain(key, values), samples, folder, "single", threads=2)


@pytest.mark.parametrize("key", [*SPECTRUM, *PICTURE, "init_trans", "exit_pupil"])
def test_each_parameter_at_its_extremes(folder, key, request):
    """One engine for all settings, as in the window: what they do not change is made once."""
    picture = picture_of("scene", (3, 4))
    np.save(folder / "in.npy", picture)
    engine, faults = Engine(LIBRARY), []
    for values, precision in each_extreme(key, thorough=request.config.option.thorough):
        try:
            run_on_file(fixed_chain(key, values), picture, folder, precision, engine)
        except (ArithmeticError, AssertionError, ValueError, Warning) as fault:
            reason = str(fault).splitlines()[0] if str(fault) else ""
            faults.append(f"{precision} {values}: {type(fault).__name__} {reason}")
    assert not faults, "\n".join([f"{len(faults)} settings fail", *faults[:8]])


@pytest.mark.parametrize("name", ["fov_x_deg", "fov_y_deg"])
@pytest.mark.parametrize("key", ["test_scene", "read_image", "init_trans"])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
def test_fields_of_view_next_to_nothing(folder, key, name, edges):
    """Below 1e-30° nothing is computed of; from there on all numbers are finite, or one error."""
    np.save(folder / "in.npy", picture_of("scene", (11, 15)))
    for value in (5e-324, 1e-308, 1e-150, 9e-31, 1e-30, 1e-12):
        document = chain_from(key, {name: value}, edges)
        plan = Engine(LIBRARY).plan(document, folder=folder)
        refused = [error for error in plan.errors() if isinstance(error, ParameterError)]
        if value < 1e-30:
            assert f"{name} = {value} deg is not allowed: at least 1e-30" in str(refused[0])
            continue
        assert plan.errors() == []
        engine, work = Engine(LIBRARY), Engine(LIBRARY).work(Policy(precision="double"))
        for port in ("back.image", "slices.curve", "blur.mtf"):
            with suppress(DataError):
                engine.value(plan, port, work)
        for node in ("init", "blur"):
            assert all(not_nan(figure) for figure in engine.readouts(plan, node, work).values())


@pytest.mark.parametrize("name", ["altitude_m", "ground_interval_m", "ground_interval_y_m"])
def test_lengths_of_a_camera(folder, name):
    """Largest and least numbers: a picture and figures, or one error of the camera's own."""
    base = {"fov_x_deg": 1.1, "columns": 9, "rows": 7, "ground_interval_m": 0.1}
    refused = []
    for value in (5e-324, 1e-308, 1e-30, 1e30, 1e300, 1.7976931348623157e308):
        nodes = {
            "scene": ("test_scene", {"width": 15, "height": 11, "fov_x_deg": 1.5}),
            "camera": ("camera_geometry", {**base, name: value}),
        }
        engine = Engine(LIBRARY)
        plan = engine.plan(linked_network(nodes, [("scene.image", "camera.image")]))
        work = engine.work(Policy(precision="double"))
        if plan.errors():
            refused += [error.node for error in plan.errors()]
            continue
        try:
            assert np.isfinite(engine.value(plan, "camera.image", work)).all()
            figures = engine.readouts(plan, "camera", work).values()
        except DataError as error:
            refused.append(error.node)
            continue
        assert all(np.isfinite(each) for each in figures if isinstance(each, float))
    assert set(refused) <= {"camera"}


def chain_from(key, values, edges):
    """A picture through a blur, with what is drawn of it."""
    field = {"fov_x_deg": 1.5, "fov_y_deg": 1.1}
    nodes = {
        "file": ("read_image", {"path": "in.npy", **field}),
        "init": ("init_trans", {**SENSOR, "edges": edges}),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": 1.0}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "slices": ("mtf_slices", {}),
    }
    name = "init" if key == "init_trans" else "file"
    base = {"width": 15, "height": 11} if key == "test_scene" else nodes[name][1]
    nodes[name] = (key, {**base, **values})
    links = [
        ("file.image", "init.image"), ("init.context", "blur.context"),
        ("init.context", "detector.context"), ("init.magnitude", "blur.magnitude"),
        ("blur.magnitude", "detector.magnitude"), ("detector.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"), ("detector.magnitude", "slices.transfer"),
    ]  # fmt: skip
    return linked_network(nodes, links)
