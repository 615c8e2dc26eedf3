"""Transfer functions of every filter: H(0) = 1, |H| ≤ 1, Hermitian."""

from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from battery_settings import AFFORDABLE, EXAMPLES, NOT_PASSIVE, PUPILS, SETTINGS
from core.chain.engine import Engine, Plan
from core.chain.wires import transfer_plane
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.modules.parameters import Parameter, plain
from core.transfer.factors import Product
from library_battery import (
    APPLIED,
    DECLARED,
    FILTERS,
    LIBRARY,
    SOURCES,
    assert_clear,
    double,
    planned,
)
from thorough import examples

XI = np.concatenate([[0.0], np.geomspace(1e-6, 40.0, 23)])
ETA = np.concatenate([[0.0], np.geomspace(3e-6, 30.0, 17)])


def both_signs(positive):
    return np.concatenate([-positive[:0:-1], positive])


def check_transfer(plan: Plan, *, passive: bool = True) -> None:
    """H(0) = 1, |H| ≤ 1, H(−xi, −eta) = conj H; the MTF real, the PTF odd."""
    work, outputs = double(), plan.nodes["it"].outputs
    xi, eta = both_signs(XI), both_signs(ETA)
    centre = (len(ETA) - 1, len(XI) - 1)
    factors: tuple[Any, ...] = ()
    modulus: Any = 1.0
    if "mtf" in outputs:
        mtf = transfer_plane(work, outputs["mtf"], xi, eta)
        assert np.isrealobj(mtf)
        assert np.isfinite(mtf).all()
        if passive:
            assert mtf[centre] == 1.0
            assert np.abs(mtf).max() <= 1 + 1e-15
        assert np.abs(mtf - mtf[::-1, ::-1]).max() <= 1e-13
        factors += outputs["mtf"].factors
        modulus = mtf
    if "ptf" in outputs:
        ptf = transfer_plane(work, outputs["ptf"], xi, eta)
        assert np.isrealobj(ptf)
        assert np.isfinite(ptf).all()
        assert ptf[centre] == 0.0
        # Odd as an angle: where it is π, so is its opposite, and where H is 0 it means nothing.
        turn = modulus * (np.exp(1j * ptf) - np.exp(-1j * ptf[::-1, ::-1]))
        assert np.abs(turn).max() <= 1e-11
        factors += outputs["ptf"].factors
    h = Product(factors).total(work, xi, eta)
    assert np.isfinite(h).all()
    if passive:
        assert h[centre] == 1.0
        assert np.abs(h).max() <= 1 + 1e-15
        assert Product(factors).at_zero(work) == 1.0
    assert np.abs(h - h[::-1, ::-1].conj()).max() <= 1e-11


@pytest.mark.parametrize("key", FILTERS)
def test_transfer_functions_of_settings(key, folder):
    for params in ({}, EXAMPLES[key], *SETTINGS.get(key, [])):
        if params == {} and key in {"electronics_noise", "charge_diffusion_mtf"}:
            continue
        check_transfer(planned(key, params, folder))


@pytest.mark.parametrize("pupil", PUPILS)
def test_transfer_functions_of_pupils(pupil, folder):
    for params in SETTINGS["exit_pupil_mtf"]:
        check_transfer(planned("exit_pupil_mtf", params, folder, PUPILS[pupil]))


@pytest.mark.parametrize("params", NOT_PASSIVE, ids=lambda p: p["post_filter"])
def test_transfer_functions_that_amplify(params, folder):
    check_transfer(planned("electronics_noise", params, folder), passive=False)


def drawn(parameter: Parameter) -> st.SearchStrategy[Any]:
    """A value over the declared range, and far beyond what is usual."""
    low, high = AFFORDABLE.get(parameter.name, (parameter.param.low, parameter.param.high))
    if parameter.kind == "choice":
        return st.sampled_from(parameter.choices)
    if parameter.kind == "switch":
        return st.booleans()
    if parameter.kind == "integer":
        whole = st.integers(int(low or 0), int(min(high or 10**4, 10**9)))
        return whole | st.none() if parameter.empty else whole
    if parameter.kind == "number":
        size = st.floats(-12, 12).map(lambda power: float(10.0**power))
        ends = [e for e in (low, high, 1.0, 0.0) if e is not None]
        value = st.one_of(size, size.map(lambda v: -v), st.sampled_from(ends))
        fits = value.filter(parameter._in_range)
        return fits | st.none() if parameter.empty else fits
    return st.just(plain(parameter.default))


@pytest.mark.parametrize("key", [k for k in FILTERS if k != "exit_pupil_mtf"])
@settings(
    max_examples=examples(40),
    deadline=None,
    derandomize=True,
    suppress_health_check=[*HealthCheck],
)
@given(data=st.data())
def test_transfer_functions_of_any_parameters(key, folder, data):
    params = {p.name: data.draw(drawn(p), p.name) for p in DECLARED[key].parameters}
    if key == "electronics_noise" and params["post_filter"] in ("highpass", "boost"):
        params["post_filter"] = "none"
    try:
        plan = planned(key, params, folder)
        check_transfer(plan)
    except ImagechainError as error:
        assert_clear(error, "it")


@pytest.mark.parametrize("key", APPLIED)
def test_filter_only_changes_the_wire_but_never_the_transfer_function(key, folder):
    engine = Engine(LIBRARY)
    work = engine.work(Policy(precision="double"))
    full = planned(key, EXAMPLES[key], folder)
    alone = planned(key, {**EXAMPLES[key], "apply": "filter_only"}, folder)
    for wire, transfer in (("magnitude", "mtf"), ("phase", "ptf")):
        if transfer not in full.nodes["it"].outputs:
            continue
        assert alone.output(f"it.{transfer}").key == full.output(f"it.{transfer}").key
        shown = engine.value(alone, f"it.{transfer}", work)
        assert np.array_equal(shown, engine.value(full, f"it.{transfer}", work))
        assert np.array_equal(engine.value(alone, f"it.{wire}", work), shown)
        assert alone.output(f"it.{wire}").key != full.output(f"it.{wire}").key
        before = engine.value(full, SOURCES[wire], work)
        after = engine.value(full, f"it.{wire}", work)
        expected = before * shown if wire == "magnitude" else before + shown
        assert np.allclose(after, expected, rtol=1e-13, atol=1e-13 * np.abs(before).max())
