"""What one factor is, shown on a plane and at pairs of frequencies."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from core.chain.back_transformed import Delivered, back_transform
from core.chain.wires import Image, Magnitude, Phase
from core.evaluation.recipes import Step, Store
from core.evaluation.work import Policy, Work
from core.transfer.factors import Grid, Law, Planar, Separable, spend, stage_bound
from thorough import examples

XI, ETA = np.array([0.0, 0.3, -0.4, 0.5]), np.array([0.1, -0.2, 0.7])
ALONG, ACROSS = np.meshgrid(ETA, XI, indexing="ij")


def turned(xi, eta):
    """A modulus that is never the real part, and a phase odd in each axis."""
    return np.exp(-(xi**2) - 2 * eta**2) * np.exp(1j * (xi + 3 * eta))


@pytest.mark.parametrize(
    ("take", "expected"),
    [
        ("real", np.exp(-(ACROSS**2) - 2 * ALONG**2) * np.cos(ACROSS + 3 * ALONG)),
        ("modulus", np.exp(-(ACROSS**2) - 2 * ALONG**2)),
        ("phase", ACROSS + 3 * ALONG),  # within ±π on these
    ],
)
def test_a_complex_law_is_shown_as_what_its_wire_carries(take, expected):
    factor = Planar(Law.of(turned), symmetric=False, take=take)
    assert factor.plane(None, XI, ETA) == pytest.approx(expected, rel=1e-14, abs=1e-15)


# What the error budget leaves out, and how little that changes.


def samples(work, *, seed, rows, columns):
    return np.random.default_rng(seed).uniform(20, 60, (rows, columns)).astype(work.policy.dtype)


def gaussian(frequency, sigma):
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


def delay(frequency, by):
    return -2 * np.pi * frequency * by


def round_gaussian(rho, sigma):
    return np.exp(-2 * (np.pi * sigma * rho) ** 2)


def any_plane(xi, eta):
    return np.exp(-(xi**2) - eta**2)


def work_with(tolerance, precision="double"):
    return Work(Policy(precision=precision, tolerance=tolerance), Store())


def picture(work, mtf, ptf, edges, shape=(24, 31), seed=1):
    grid = Grid(*shape, 1.0, 1.2)
    image = Image(Step.of(samples, seed=seed, rows=shape[0], columns=shape[1]), *shape, 1.0, 1.2)
    out = back_transform(
        Magnitude(image, grid, edges).times(*mtf), Phase(image, grid, edges).plus(*ptf)
    )
    assert isinstance(out.recipe, Delivered)
    return work.value(out.recipe), out.recipe.spent(work)[1]


small = st.floats(1e-4, 0.3)


@settings(max_examples=examples(60), deadline=None, derandomize=True)
@given(
    sigmas=st.lists(st.tuples(small, small), min_size=1, max_size=4),
    shift=small,
    radial=small,
    tolerance=st.floats(1e-7, 0.5),
    edges=st.sampled_from(["reflect", "periodic"]),
    seed=st.integers(0, 99),
)
def test_the_rms_change_is_within_the_tolerance(sigmas, shift, radial, tolerance, edges, seed):
    mtf = [
        *(Separable(Law.of(gaussian, sigma=a), Law.of(gaussian, sigma=b)) for a, b in sigmas),
        Planar(Law.of(round_gaussian, sigma=radial), radial=True),
    ]
    ptf = [Separable(Law.of(delay, by=shift), None, part="ptf")]
    exact, none = picture(work_with(0.0), mtf, ptf, edges, seed=seed)
    assert none == ()
    got, skipped = picture(work_with(tolerance), mtf, ptf, edges, seed=seed)
    assert sum(bound for _, bound in skipped) <= tolerance
    original = work_with(0.0).value(Step.of(samples, seed=seed, rows=24, columns=31))
    rms = np.sqrt(np.mean((got - exact) ** 2))
    assert rms <= tolerance * np.ptp(original) + 1e-12


@pytest.mark.parametrize("precision", ["single", "double"])
def test_the_default_leaves_out_what_rounding_hides(precision):
    work = work_with(None, precision)
    faint = Separable(Law.of(gaussian, sigma=1e-5 if precision == "single" else 1e-9), None)
    seen = Separable(Law.of(gaussian, sigma=1e-2), None, label="seen")
    xi = np.linspace(0, 0.5, 100)
    kept, skipped = spend(work, (faint, seen), xi, xi)
    assert kept == (seen,)
    assert len(skipped) == 1


def test_the_smallest_changes_go_first_and_keep_their_names():
    stages = [
        Separable(Law.of(gaussian, sigma=s), None, label=name, node=name)
        for s, name in ((0.1, "large"), (0.01, "small"), (0.02, "middle"))
    ]
    xi = np.linspace(0, 0.5, 100)
    kept, skipped = spend(work_with(0.004), stages, xi, xi)
    assert [stage.label for stage in kept] == ["large"]
    assert [stage.node for stage, _ in skipped] == ["small", "middle"]


def test_a_plane_of_no_cheap_bound_is_kept():
    plane = Planar(Law.of(any_plane))
    xi = np.linspace(0, 0.5, 10)
    assert stage_bound(work_with(0.9), plane, xi, xi) == np.inf
    assert spend(work_with(0.9), (plane,), xi, xi) == ((plane,), ())


@pytest.mark.parametrize(("a", "b"), [(0.3, 0.0), (0.2, 0.4)])
def test_the_bound_covers_the_plane(a, b):
    factor = Separable(Law.of(gaussian, sigma=a), Law.of(gaussian, sigma=b))
    xi, eta = np.linspace(0, 0.5, 50), np.linspace(0, 0.4, 60)
    true = np.abs(1 - np.outer(gaussian(eta, b), gaussian(xi, a))).max()
    assert true <= stage_bound(work_with(0.1), factor, xi, eta) <= 2 * true + 1e-15
