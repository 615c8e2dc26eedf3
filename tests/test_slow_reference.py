"""The slow reference shares no code with what it judges, and filters as the definition says.

Its formulas stand beside the engine's in random networks, and the engine's beside mpmath elsewhere.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

import slow_reference
from slow_reference.filtering import filtered, filtered_lines
from source_imports import imports, package

FILES = sorted(Path(slow_reference.__file__).parent.rglob("*.py"))


def test_it_imports_numpy_and_itself_alone():
    assert len(FILES) > 5
    for path in FILES:
        allowed = {"numpy", "slow_reference"} | set(sys.stdlib_module_names)
        assert set(map(package, imports(path))) <= allowed, path
        text = path.read_text(encoding="utf-8")
        assert "__import__" not in text, path
        assert "importlib" not in text, path


def extended(*numbers):
    return np.array(numbers, np.longdouble)


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
