"""Variances of filtered noise against the chain itself, which is given every sample's impulse."""

import numpy as np
import pytest

from core.chain.back_transformed import back_transform, combine_pixels
from core.chain.engine import Engine
from core.chain.noise_power import NoisePower
from core.chain.wires import Image, Magnitude, Phase
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from core.physics.detector.detector_mtf import charge_transfer_mtf, charge_transfer_ptf
from core.physics.optics.veiling_glare import gaussian_mtf
from core.transfer.factors import Grid, Law, Planar
from nodes.library import standard_library
from nodes.shared.factors import radial, separable
from nodes.transform.interpolate import interpolator, resampled

ROWS, COLUMNS = 8, 12
GRID = Grid(ROWS, COLUMNS, 1.0, 1.2)


def gaussians(*, rho, sigma_mrad):
    return np.exp(-2 * (np.pi * sigma_mrad * rho) ** 2)


BLUR = separable(gaussian_mtf, x={"sigma_mrad": 0.6}, y={"sigma_mrad": 0.4}, label="blur")
TRANSFER = {"transfers": 640, "efficiency": 0.9993, "model": "exact"}
SCALE = {"argument": "phase_per_transfer", "scale_x": 2 * np.pi}
ODD = (
    *separable(charge_transfer_mtf, x=TRANSFER, **SCALE),
    *separable(charge_transfer_ptf, x=TRANSFER, part="ptf", **SCALE),
)
PUPIL = radial(gaussians, sigma_mrad=0.3)
CHAINS = {"even": BLUR, "odd": (*BLUR, *ODD), "plane": (*BLUR, *PUPIL), "all": (*PUPIL, *ODD)}


@pytest.fixture(scope="module")
def work():
    return Engine(standard_library()).work(Policy(precision="double"))


def impulse(_, *, place):
    frame = np.zeros(ROWS * COLUMNS)
    frame[place] = 1.0
    return frame.reshape(ROWS, COLUMNS)


def through(image, factors, edges):
    wires = [tuple(f for f in factors if f.part == part) for part in ("mtf", "ptf")]
    grid = Grid(*image.shape, image.interval_x_mrad, image.interval_y_mrad)
    return back_transform(
        Magnitude(image, grid, edges).times(*wires[0]), Phase(image, grid, edges).plus(*wires[1])
    )


def by_impulses(work, chain, weights=None):
    """Sums over all samples of the square of what a unit there makes of the last picture."""
    totals = np.zeros(4)
    for place in range(ROWS * COLUMNS):
        start = Image(Step.of(impulse, place=place), ROWS, COLUMNS, 1.0, 1.2)
        made = work.value(chain(start).recipe)
        weight = 1.0 if weights is None else weights.ravel()[place]
        totals += weight * np.array(
            [
                np.mean(made**2),
                np.mean(made.mean(axis=1) ** 2),
                np.mean(made.mean(axis=0) ** 2),
                made.mean() ** 2,
            ]
        )
    return totals


def told(power):
    m = power.moments()
    return [m.sample, m.row_mean, m.column_mean, m.frame_mean]


@pytest.mark.thorough(but=12)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("factors", [(1, 1), (3, 2), (5, 1), (1, 3)])
def test_filtered_and_combined(work, edges, chain, factors):
    x, y = factors
    expected = by_impulses(
        work,
        lambda image: combine_pixels(through(image, CHAINS[chain], edges), factor_x=x, factor_y=y),
    )
    axes = "mirrored" if edges == "reflect" else "periodic"
    filtered = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, CHAINS[chain], GRID, axes)
    power = filtered.averaged(x, y)
    assert (power.rows, power.columns) == (ROWS // y, COLUMNS // x)
    assert told(power) == pytest.approx(list(expected), rel=1e-11)


def smear(*, xi, eta):
    return np.sinc(2.1 * xi + 1.3 * eta) * np.exp(1j * (xi**2 * eta))


@pytest.mark.parametrize("factors", [(1, 1), (3, 2)])
def test_by_a_law_that_mixes_the_axes(work, factors):
    """At the Nyquist row and column the mean of both signs acts, on all factors together."""
    x, y = factors
    law = Law.of(smear)
    mixed = [Planar(law, symmetric=False, take=take) for take in ("modulus", "phase")]
    chain = (*mixed, *ODD)
    expected = by_impulses(
        work,
        lambda image: combine_pixels(through(image, chain, "periodic"), factor_x=x, factor_y=y),
    )
    filtered = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, chain, GRID, "periodic")
    power = filtered.averaged(x, y)
    assert told(power) == pytest.approx(list(expected), rel=1e-11)


def test_samples_of_different_variances(work):
    weights = np.random.default_rng(4).uniform(0.2, 3.0, (ROWS, COLUMNS))
    expected = by_impulses(work, lambda image: through(image, BLUR, "reflect"), weights)
    power = NoisePower.white(ROWS, COLUMNS, weights)
    assert told(power)[0] == pytest.approx(weights.mean(), rel=1e-14)
    assert told(power.filtered(work, BLUR, GRID, "mirrored")) == pytest.approx(
        list(expected), rel=1e-11
    )


@pytest.mark.thorough(but=11)
@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize("new", [(11, 9), (5, 12), (16, 30)])
@pytest.mark.parametrize("edges", ["reflect", "periodic", None])
def test_resampled(work, order, new, edges):
    frame = "periodic" if edges == "periodic" else "reflect"

    def chain(image):
        blurred = through(image, BLUR, frame)
        how = {"old": (ROWS, COLUMNS), "new": new, "order": order, "edges": edges}
        return blurred.with_recipe(Step.of(resampled, blurred.recipe, **how))

    axes = "periodic" if edges == "periodic" else "mirrored"
    power = NoisePower.white(ROWS, COLUMNS, 1.0).filtered(work, BLUR, GRID, axes)
    found = power.resampled(
        new, interpolator(ROWS, new[0], order, edges), interpolator(COLUMNS, new[1], order, edges)
    )
    assert told(found) == pytest.approx(list(by_impulses(work, chain)), rel=1e-11)


def test_of_a_pattern_and_scaled():
    samples = np.random.default_rng(2).standard_normal((ROWS, COLUMNS))
    power = NoisePower.of_pattern(samples).scaled(3.0)
    expected = [
        np.mean(samples**2),
        np.mean(samples.mean(axis=1) ** 2),
        np.mean(samples.mean(axis=0) ** 2),
        samples.mean() ** 2,
    ]
    assert told(power) == pytest.approx([9 * each for each in expected], rel=1e-12)
