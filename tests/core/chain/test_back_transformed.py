"""Delivered pictures against direct sums that share no code with the engine."""

import numpy as np
import pytest

from core.chain.back_transformed import back_transform, combine_pixels
from core.chain.wires import Image, Magnitude, Phase
from core.evaluation.policy import Policy
from core.evaluation.recipes import Step
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.transfer.factors import Grid, Law, Planar, Separable
from slow_reference.filtering import filtered

TOLERANCE = {"double": 1e-12, "single": 2e-6}


def samples(work, *, rows, columns, seed):
    noise = np.random.default_rng(seed).uniform(20, 60, (rows, columns))
    return noise.astype(work.policy.dtype)


def gaussian(frequency, sigma_mrad):
    return np.exp(-2 * (np.pi * sigma_mrad * frequency) ** 2)


def delay(frequency, delay_mrad):
    return -2 * np.pi * frequency * delay_mrad


def lag(frequency, tau):
    return -np.arctan(2 * np.pi * frequency * tau)


def disc(rho, cutoff):
    r = np.minimum(rho / cutoff, 1)
    return 2 / np.pi * (np.arccos(r) - r * np.sqrt(1 - r * r))


def smear(xi, eta, bx, by):
    return np.sinc(bx * xi + by * eta)


def coma(xi, eta, a):
    """Any complex Hermitian function, not even in either axis."""
    return np.exp(-((0.3 * xi) ** 2) - (0.2 * eta) ** 2) * np.exp(
        1j * a * (xi**3 + xi * eta**2 + 0.3 * eta**3 + eta)
    )


BLUR = Separable(Law.of(gaussian, sigma_mrad=0.4), Law.of(gaussian, sigma_mrad=0.7))
LAG_X = Separable(Law.of(lag, tau=0.35), None, part="ptf")
LAG_Y = Separable(None, Law.of(delay, delay_mrad=0.3), part="ptf")
DISC = Planar(Law.of(disc, cutoff=1.1), radial=True)
SMEAR = Planar(Law.of(smear, bx=0.8, by=0.5), symmetric=False)
COMA_MTF = Planar(Law.of(coma, a=0.5), symmetric=False, take="modulus")
COMA_PTF = Planar(Law.of(coma, a=0.5), symmetric=False, take="phase")

CHAINS = {
    "nothing": ((), ()),
    "blur": ((BLUR,), ()),
    "disc": ((BLUR, DISC), ()),
    "lag across": ((BLUR, DISC), (LAG_X,)),
    "lag along": ((BLUR,), (LAG_Y,)),
    "lag both": ((DISC,), (LAG_X, LAG_Y)),
    "smear": ((SMEAR, BLUR), (LAG_X,)),
    "coma": ((COMA_MTF, BLUR), (COMA_PTF,)),
    "coma and lag": ((COMA_MTF, SMEAR), (COMA_PTF, LAG_X, LAG_Y)),
}


def plain_h(chain, xi, eta):
    """H written down again, for xi in a row and eta in a column."""
    x, y = np.broadcast_arrays(xi, eta)
    h = np.ones(x.shape, complex)
    for factor in (*CHAINS[chain][0], *CHAINS[chain][1]):
        if factor is BLUR:
            h *= gaussian(x, 0.4) * gaussian(y, 0.7)
        elif factor is LAG_X:
            h *= np.exp(1j * lag(x, 0.35))
        elif factor is LAG_Y:
            h *= np.exp(1j * delay(y, 0.3))
        elif factor is DISC:
            h *= disc(np.hypot(x, y), 1.1)
        elif factor is SMEAR:
            h *= smear(x, y, 0.8, 0.5)
        elif factor is COMA_MTF:
            h *= np.abs(coma(x, y, 0.5))
        else:
            h *= np.exp(1j * np.angle(coma(x, y, 0.5)))
    return h


def direct(image, chain, grid, edges):
    """Matrix DFT, multiply, matrix inverse: no FFT."""
    steps = np.float64(grid.interval_x_mrad), np.float64(grid.interval_y_mrad)
    return filtered(image, lambda xi, eta: plain_h(chain, xi, eta), steps, edges)


def picture(shape, chain, edges, precision, fold=(1, 1)):
    rows, columns = shape
    grid = Grid(rows, columns, 0.9, 0.6)
    image = Image(Step.of(samples, rows=rows, columns=columns, seed=3), rows, columns, 0.9, 0.6)
    work = Work(Policy(precision=precision), Store())
    mtf, ptf = CHAINS[chain]
    out = back_transform(
        Magnitude(image, grid, edges).times(*mtf), Phase(image, grid, edges).plus(*ptf)
    )
    if fold != (1, 1):
        out = combine_pixels(out, factor_x=fold[1], factor_y=fold[0])
    return work.value(image.recipe).astype(float), work.value(out.recipe), grid


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (6, 1), (8, 12), (13, 9), (12, 10)])
class TestEdges:
    def test_periodic_equals_direct_sum(self, shape, chain, precision):
        image, got, grid = picture(shape, chain, "periodic", precision)
        expected = direct(image, chain, grid, "periodic")
        assert np.abs(got - expected).max() <= TOLERANCE[precision] * np.abs(expected).max()

    def test_mirrored_equals_doubled_frame(self, shape, chain, precision):
        image, got, grid = picture(shape, chain, "reflect", precision)
        expected = direct(image, chain, grid, "reflect")
        assert np.abs(got - expected).max() <= TOLERANCE[precision] * np.abs(expected).max()


@pytest.mark.thorough(but=32)
@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(
    ("shape", "fold"),
    [((8, 12), (2, 2)), ((12, 9), (3, 3)), ((12, 20), (4, 5)), ((6, 10), (6, 10)), ((5, 8), (1, 4)),
     ((15, 14), (5, 7)), ((24, 18), (8, 6))],
)  # fmt: skip
def test_folding_equals_block_mean(shape, fold, chain, edges):
    _, fine, _ = picture(shape, chain, edges, "double")
    _, folded, _ = picture(shape, chain, edges, "double", fold)
    rows, columns = shape[0] // fold[0], shape[1] // fold[1]
    expected = fine.reshape(rows, fold[0], columns, fold[1]).mean(axis=(1, 3))
    assert np.abs(folded - expected).max() <= 1e-13 * np.abs(expected).max()
    _, single, _ = picture(shape, chain, edges, "single", fold)
    assert np.abs(single - expected).max() <= 1e-6 * np.abs(expected).max()
