"""Running a network: finite numbers, or one clear error."""

import math

import numpy as np

from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.network.network import Network


def arrays_of(
    network: Network, folder, precision: str, engine: Engine, threads: int = 1
) -> dict[str, np.ndarray]:
    """Arrays by port, all finite as the figures are, without what a clear error refuses."""
    work = engine.work(Policy(precision=precision, threads=threads))
    plan = engine.plan(network, folder=folder)
    for error in plan.errors():
        assert_clear(error, network)
    found = {}
    for name, node in plan.nodes.items():
        if node.error is not None:
            continue
        for port in (f"{name}.{output}" for output in node.outputs):
            try:
                value = engine.value(plan, port, work)
            except ImagechainError as error:
                assert_clear(error, network)
                continue
            if isinstance(value, np.ndarray):
                assert np.isfinite(value).all(), port
                if port.endswith(".image"):
                    assert value.shape == plan.output(port).shape, port
                found[port] = value
        try:
            figures = engine.readouts(plan, name, work)
        except ImagechainError as error:
            assert_clear(error, network)
            continue
        numbers = [figure for figure in figures.values() if isinstance(figure, float)]
        assert not any(map(math.isnan, numbers)), (name, figures)
    return found


def assert_clear(error: ImagechainError, network: Network) -> None:
    assert error.exit_code == 2, error
    assert error.node in network.nodes
    assert "\n" not in str(error)
    assert len(str(error)) < 400
