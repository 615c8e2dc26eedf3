"""Each parameter of each module at the ends of its range."""

from __future__ import annotations

import numpy as np
import pytest

from chain_runs import picture_of, run
from drawn_chains import GIVEN, PICTURE, SPECTRUM
from extreme_chains import each_extreme, fixed_chain


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
def test_each_parameter_at_its_extremes(folder, key):
    picture = picture_of("scene", (3, 4))
    faults = []
    for values, precision in each_extreme(key):
        try:
            run(fixed_chain(key, values), picture, folder, precision)
        except (ArithmeticError, AssertionError, ValueError, Warning) as fault:
            reason = str(fault).splitlines()[0] if str(fault) else ""
            faults.append(f"{precision} {values}: {type(fault).__name__} {reason}")
    assert not faults, "\n".join([f"{len(faults)} settings fail", *faults[:8]])
