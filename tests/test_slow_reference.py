"""The slow reference shares no code with what it judges, and is right where it can be judged."""

import ast
import sys
from itertools import pairwise
from pathlib import Path

import mpmath
import numpy as np
import pytest

import slow_reference
from slow_reference.filtering import filtered, filtered_lines
from slow_reference.pupil import annulus, defocused_disc
from slow_reference.pupil_area import inside, overlap
from slow_reference.pupil_samples import NOLL, autocorrelation
from slow_reference.resampling import weights
from slow_reference.transfer import fried_r0_m, vibration

EPS = float(np.finfo(np.longdouble).eps)  # 1e-19 where the processor has extended precision
FILES = sorted(Path(slow_reference.__file__).parent.rglob("*.py"))


def imported(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            found.add(str(node.module).split(".")[0])
    return found


def test_it_imports_numpy_and_itself_alone():
    assert len(FILES) > 5
    for path in FILES:
        assert imported(path) <= {"numpy", "slow_reference"} | set(sys.stdlib_module_names), path
        text = path.read_text(encoding="utf-8")
        assert "__import__" not in text, path
        assert "importlib" not in text, path


def extended(*numbers):
    return np.array(numbers, np.longdouble)


@pytest.mark.parametrize("lag", [0.0, 0.3, 0.55, 1.2, 1.7, 2.1])
def test_overlap_of_rings(lag):
    with mpmath.workdps(30):
        d, a, b = mpmath.mpf(lag), mpmath.mpf(1), mpmath.mpf(0.4)

        def lens(p, q):
            if d >= p + q or d <= abs(p - q):
                return mpmath.mpf(0) if d >= p + q else mpmath.pi * min(p, q) ** 2
            half = lambda r, s: r * r * mpmath.acos((d * d + r * r - s * s) / (2 * d * r))  # noqa: E731
            heron = (p + q - d) * (d + p - q) * (d - p + q) * (d + p + q)
            return half(p, q) + half(q, p) - mpmath.sqrt(heron) / 2

        expected = float((lens(a, a) - 2 * lens(a, b) + lens(b, b)) / (mpmath.pi * (a * a - b * b)))
    ring = {"shape": "cassegrain", "radius": 1.0, "obscuration_radius": 0.4}
    assert abs(float(annulus(ring, extended(lag))[0]) - expected) <= 1e-15
    area = overlap(ring, extended(lag * 0.6, 0), extended(lag * 0.8, 0))
    assert abs(float(area[0] / area[1]) - expected) <= 1e-15


def test_overlap_of_straight_outlines_by_counting():
    """Against a fine grid of points: coarse, but with nothing in common but the definition."""
    spider = {
        "shape": "spider", "radius": 1.0, "obscuration_radius": 0.3, "vanes": 3, "vane_width": 0.2,
    }  # fmt: skip
    slit = {"shape": "cassegrain_slit", "radius": 1.0, "obscuration_radius": 0.3, "slit_width": 0.4}
    moon = {"shape": "half_moon", "radius": 1.0}
    points = 2001
    x = np.linspace(-1, 1, points)
    y = x[:, np.newaxis]
    for pupil in (spider, slit, moon):
        for a, b in ((0.0, 0.0), (0.23, 0.0), (0.4, -0.3), (0.1, 1.1)):
            lit = inside(pupil, x, y) & inside(pupil, x - a, y - b)
            found = float(overlap(pupil, extended(a), extended(b))[0])
            assert abs(found - lit.sum() * (2 / (points - 1)) ** 2) <= 4e-3


@pytest.mark.parametrize("size", [0.0, 0.7, 14.0, 300.0])
def test_vibration(size):
    sign = np.array([1, -1])
    whole = vibration(sign * extended(size), None)
    assert abs(whole - float(mpmath.besselj(0, size))).max() <= 1e-15
    turns = (0.3, 2.3)
    for periods, found in zip(turns, [vibration(extended(size), extended(t)[0]) for t in turns],
                              strict=True):  # fmt: skip
        ends = [k / 4 for k in range(int(4 * periods) + 1)] + [periods]
        mean = sum(
            mpmath.quad(
                lambda u: mpmath.expj(-size * mpmath.sin(2 * mpmath.pi * u)),
                mpmath.linspace(start, end, 2 + int(size / 5)),
            )
            for start, end in pairwise(ends)
        ) / periods  # fmt: skip
        assert abs(float(found[0]) - float(abs(mean))) <= 1e-14


def test_coherence_through_the_profile():
    p = {"cn2": 1.7e-14, "view": "vertical"}
    with mpmath.workdps(25):
        length = mpmath.mpf(3000)

        def cn2(z):
            high = mpmath.mpf("0.00594") * (mpmath.mpf(21) / 27) ** 2 * (z / 10**5) ** 10
            return (high * mpmath.exp(-z / 1000) + mpmath.mpf("2.7e-16") * mpmath.exp(-z / 1500)
                    + mpmath.mpf("1.7e-14") * mpmath.exp(-z / 100))  # fmt: skip

        moment = mpmath.quad(
            lambda z: cn2(z) * (z / length) ** (mpmath.mpf(5) / 3), [0, 100, 300, 1000, 3000]
        )
        k = 2 * mpmath.pi / mpmath.mpf("4e-6")
        expected = float((mpmath.mpf("0.423") * k**2 * moment) ** (-mpmath.mpf(3) / 5))
    assert float(fried_r0_m(p, {"range_m": 3000.0}, 4.0)) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(("v", "w20"), [(0.1, 0.5), (0.5, -1.2), (0.9, 3.0), (0.3, 0.0)])
def test_defocus(v, w20):
    def strip(x):
        return mpmath.cos(8 * mpmath.pi * w20 * v * x) * mpmath.sqrt(max(0, 1 - (x + v) ** 2))

    expected = 4 / mpmath.pi * mpmath.quad(strip, mpmath.linspace(0, 1 - v, 9))
    assert abs(float(defocused_disc(extended(v), w20)[0]) - float(expected)) <= 1e-14


def test_zernike_polynomials_are_orthonormal():
    radius, weight = np.polynomial.legendre.leggauss(12)
    square = (radius + 1) / 2
    angle = 2 * np.pi * np.arange(24) / 24
    x = np.sqrt(square)[:, np.newaxis] * np.cos(angle)
    y = np.sqrt(square)[:, np.newaxis] * np.sin(angle)
    values = np.array([polynomial(x, y).ravel() for polynomial in NOLL])
    area = np.repeat(weight / 2 / 24, 24)
    assert np.abs(values * area @ values.T - np.eye(len(NOLL))).max() <= 1e-14


def test_autocorrelation_term_by_term():
    random = np.random.default_rng(3)
    pupil = random.normal(size=(3, 4)) + 1j * random.normal(size=(3, 4))
    found = autocorrelation(pupil)
    for dy in range(-2, 3):
        for dx in range(-3, 4):
            terms = [
                pupil[y + dy, x + dx] * np.conj(pupil[y, x])
                for y in range(3) for x in range(4)
                if 0 <= y + dy < 3 and 0 <= x + dx < 4
            ]  # fmt: skip
            expected = sum(terms) / (np.abs(pupil) ** 2).sum()
            assert abs(found[dy + 2, dx + 3] - expected) <= 1e-15


@pytest.mark.parametrize("shape", [(1, 1), (2, 3), (5, 4)])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
def test_filtering_term_by_term(shape, edges):
    """Four nested sums over samples and frequencies, nothing else."""
    samples = np.random.default_rng(1).uniform(0, 1, shape)
    step_x, step_y = 0.7, 1.1

    def transfer(xi, eta):
        return np.exp(-(xi**2) - 0.3 * eta**2 + 2j * (xi + 0.2 * eta))

    frame = samples
    if edges == "reflect":
        frame = np.pad(samples, ((0, shape[0]), (0, shape[1])), mode="symmetric")
    rows, columns = frame.shape
    expected = np.zeros(shape, complex)
    for l in range(rows):  # noqa: E741
        for k in range(columns):
            near = [((n if 2 * n <= size else n - size), size) for n, size in
                    ((k, columns), (l, rows))]  # fmt: skip
            signs = [(1, -1) if 2 * n == size else (1,) for n, size in near]
            h = np.mean([
                transfer(s * near[0][0] / (columns * step_x), t * near[1][0] / (rows * step_y))
                for s in signs[0] for t in signs[1]
            ])  # fmt: skip
            y, x = np.mgrid[:rows, :columns]
            part = np.sum(frame * np.exp(-2j * np.pi * (k * x / columns + l * y / rows)))
            y, x = np.mgrid[: shape[0], : shape[1]]
            expected += h * part * np.exp(2j * np.pi * (k * x / columns + l * y / rows))
    expected = expected.real / (rows * columns)
    steps = extended(step_x, step_y)
    found = filtered(samples.astype(np.longdouble), transfer, steps, edges)
    assert np.abs(found - expected).max() <= 1e-14
    if shape[0] == 1:
        lines = filtered_lines(
            samples.astype(np.longdouble), lambda xi: transfer(xi, 0 * xi), steps[0], edges
        )
        assert np.abs(lines - expected).max() <= 1e-14


def test_weights_of_interpolation_by_hand():
    assert weights(np.float64, 2, 4, 1, None).tolist() == [
        [1, 0],
        [0.75, 0.25],
        [0.25, 0.75],
        [0, 1],
    ]
    assert weights(np.float64, 3, 1, 0, None).tolist() == [[0, 1, 0]]
    assert weights(np.float64, 2, 1, 0, None).tolist() == [[0, 1]]
    cubic = weights(np.float64, 4, 2, 3, None)
    assert cubic[0].tolist() == [0.5625 - 0.0625, 0.5625, -0.0625, 0]
    assert np.abs(weights(np.longdouble, 7, 12, 3, None).sum(axis=1) - 1).max() <= 8 * EPS
