"""Running a chain: the right mean, finite numbers, or one clear error."""

import math
from typing import Any

import numpy as np

from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.work import Policy
from drawn_chains import LIBRARY, Chain

MEAN_ERROR = {"double": 1e-12, "single": 1e-6}


def picture_of(kind: str, shape: tuple[int, int]) -> np.ndarray:
    random = np.random.default_rng(7)
    uniform = random.uniform(20, 60, shape)
    return {
        "scene": lambda: uniform,
        "constant": lambda: np.full(shape, 37.25),
        "zero": lambda: np.zeros(shape),
        "huge": lambda: 1e30 * uniform,
        "tiny": lambda: 1e-30 * uniform,
        "edge of single": lambda: 5e36 * uniform,
        "edge of double": lambda: 2.9e306 * uniform,
        "least": lambda: 5e-324 * np.rint(uniform),
        "wide": lambda: 10.0 ** random.uniform(-6, 6, shape),
        "negative": lambda: uniform - 45.0,
        "below zero": lambda: -uniform,
        "point": lambda: np.where(
            np.arange(uniform.size).reshape(shape) == uniform.size // 2, 1.0, 0.0
        ),
    }[kind]()


def not_nan(value: Any) -> bool:
    return not (isinstance(value, float) and math.isnan(value))


def run(chain: Chain, picture: np.ndarray, folder, precision: str, threads: int = 1) -> None:
    """Everything the network can show is finite, or there is one clear error."""
    np.save(folder / "in.npy", picture)
    run_on_file(chain, picture, folder, precision, Engine(LIBRARY), threads)


def run_on_file(
    chain: Chain, picture: np.ndarray, folder, precision: str, engine: Engine, threads: int = 1
) -> None:
    """As `run`, with the picture in its file already, and what the engine knows of before."""
    work = engine.work(Policy(precision=precision, threads=threads))
    try:
        plan = engine.plan(chain.network, folder=folder)
        for error in plan.errors():
            raise error
        final = engine.value(plan, f"{chain.last}.image", work)
    except ImagechainError as error:
        assert_clear(error, chain)
    else:
        assert final.shape == plan.output(f"{chain.last}.image").shape
        assert np.isfinite(final).all()
        if chain.keeps_mean:
            # Below the least normal number there are no digits to keep.
            scale = np.abs(picture).max() + np.finfo(final.dtype).tiny / MEAN_ERROR[precision]
            error = abs(final.mean(dtype=np.longdouble) - picture.mean(dtype=np.longdouble))
            assert error <= MEAN_ERROR[precision] * scale
    for name, node in plan.nodes.items():
        if node.error is not None:
            continue
        for output in node.outputs:
            try:
                value = engine.value(plan, f"{name}.{output}", work)
            except ImagechainError as error:
                assert_clear(error, chain)
                continue
            if isinstance(value, np.ndarray):
                assert np.isfinite(value).all(), f"{name}.{output}"
        try:
            figures = engine.readouts(plan, name, work)
        except ImagechainError as error:
            assert_clear(error, chain)
            continue
        assert all(not_nan(figure) for figure in figures.values()), (name, figures)


def assert_clear(error: ImagechainError, chain: Chain) -> None:
    assert error.exit_code == 2, error
    assert error.node in chain.network.nodes
    assert "\n" not in str(error)
    assert len(str(error)) < 400
