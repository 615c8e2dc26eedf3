"""Regions of a picture, each evaluated on its own and compared with the whole."""

import numpy as np

from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.recipes import Region
from core.evaluation.work import Policy
from core.transfer.periodic import backend
from nodes.library import standard_library

LIBRARY = standard_library()


def places(rows, columns):
    """Corners, lines, one sample, something in the middle, and all but the rim."""
    found = [
        Region(0, 0, 1, 1),
        Region(rows - 1, columns - 1, 1, 1),
        Region(rows // 2, columns // 3, 1, columns - columns // 3),
        Region(rows // 3, columns // 2, rows - rows // 3, 1),
        Region(rows // 3, columns // 4, (rows + 2) // 3, (columns + 1) // 2),
    ]
    if rows > 2 and columns > 2:
        found.append(Region(1, 1, rows - 2, columns - 2))
    # The whole last: of a whole that is known, parts are only cut.
    return [*(each for each in found if each.shape != (rows, columns)), Region(0, 0, rows, columns)]


def assert_parts(network, ports, folder, *, precision="single", where=places, threads=1):
    """Every region is what the whole picture has there, whether or not the whole is known."""
    policy = Policy(precision=precision, threads=threads)
    known = Engine(LIBRARY)
    plan = known.plan(network, folder=folder)
    for port in ports:
        try:
            whole = known.value(plan, port, known.work(policy))
        except ImagechainError:
            continue
        fresh = Engine(LIBRARY)
        for source in sources(plan, port):  # costs more than all else
            picture = known.value(plan, source, known.work(policy))
            fresh.store.get(f"{plan.output(source).key}/{policy.key}", picture.copy)
        for region in where(*whole.shape):
            expected = whole[region.slices]
            made = fresh.value(plan, port, fresh.work(policy), region)
            assert made.dtype == whole.dtype
            assert not made.flags.writeable
            assert_same(made, expected, f"{port}[{region}]")
            cut = known.value(plan, port, known.work(policy), region)
            np.testing.assert_array_equal(cut, expected)


def sources(plan, port):
    """Ports of pictures that are made of nothing, but for the one asked about."""
    made_of_nothing = (each for each in image_ports(plan) if not plan.nodes[node_of(each)].inputs)
    return [each for each in made_of_nothing if each != port]


def node_of(port):
    return port.rpartition(".")[0]


def assert_same(made, expected, what):
    if backend() == "scipy.fft":
        np.testing.assert_array_equal(made, expected, err_msg=what)
    else:
        rounding = 4e-6 if made.dtype == np.float32 else 2e-12
        error = np.abs(made - expected).max(initial=0)
        assert error <= rounding * np.abs(expected).max(initial=0), what


def image_ports(plan):
    return [
        f"{name}.{port}"
        for name, planned in plan.nodes.items()
        for port, value in planned.outputs.items()
        if getattr(value, "port_type", None) == "image"
    ]
