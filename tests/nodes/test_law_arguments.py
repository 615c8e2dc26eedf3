"""Arguments of transfer functions are refused when a network is planned, not when it is run."""

import math
from dataclasses import replace

import pytest

from battery_settings import EXAMPLES
from core.chain.engine import Engine
from core.errors import ParameterError
from core.transfer.factors import Law, Separable
from library_battery import LIBRARY, planned
from library_battery import network as battery_network

# Settings that the panel allows, and what they come to: beyond what a number can hold.
BEYOND = {
    "vibration_mtf": (
        {"amplitude_x_mrad": 1, "frequency_Hz": 1e300, "integration_time_s": 1e30},
        "it: vibration periods in one exposure = inf is not allowed: must be a finite number",
    ),
    "detector_mtf": (
        {"detector_x_um": 1e30, "focal_length_mm": 1e-300},
        "it: effective_ifov_mrad = inf mrad is not allowed: must be a finite number, zero or above",
    ),
    "electronics_noise": (
        {
            "scan_mirror_rate_Hz": 1e-30,
            "use_mtf": True,
            "post_filter": "lowpass",
            "post_corner_Hz": 1e300,
        },
        "it: corner_cyc_per_mrad = inf cyc/mrad is not allowed: must be a finite number above zero",
    ),
}


@pytest.mark.parametrize("key", BEYOND)
def test_it_is_refused_on_its_node_when_planned(key, folder):
    settings, line = BEYOND[key]
    params = {**EXAMPLES[key], **settings}
    plan = Engine(LIBRARY).plan(battery_network(key, params), folder=folder)
    assert isinstance(plan.nodes["it"].error, ParameterError)
    assert [str(error) for error in plan.errors()] == [line]


def laws_of(plan):
    """Laws of a plan's factors that are bound to no recipe, each with a factor that has it."""
    found = {}
    for node in plan.nodes.values():
        for value in node.outputs.values():
            for factor in getattr(value, "factors", ()):
                found |= {law.function: (law, factor) for law in factor.laws if not law.inputs}
    return found.values()


def made_again(factor, law):
    if isinstance(factor, Separable):
        return replace(factor, x=law, y=None)
    return replace(factor, law=law)


def assert_each_number_is_checked(plan):
    for law, factor in laws_of(plan):
        assert made_again(factor, law).laws == (law,)
        for name, value in law.parameters:
            if isinstance(value, bool) or not isinstance(value, int | float):
                continue
            wrong = Law.of(law.function, **{**dict(law.parameters), name: math.nan})
            with pytest.raises(ParameterError, match="nan"):
                made_again(factor, wrong)


@pytest.mark.parametrize("key", LIBRARY)
def test_no_factor_of_a_module_is_made_of_what_is_no_number(key, folder):
    assert_each_number_is_checked(planned(key, EXAMPLES[key], folder))
