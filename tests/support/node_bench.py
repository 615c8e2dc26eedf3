"""A network, or nodes linked in their order if not otherwise, planned and evaluated."""

import numpy as np
import pytest

from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.work import Policy
from core.modules.declaration import NodeContext
from core.network.file import load_network
from core.network.network import Network
from linked_network import linked_network
from nodes.library import standard_library


def fov_of(shape, interval_mrad):
    """The fields of a picture whose samples are that far apart."""
    sides = zip("yx", shape, strict=True)
    return {f"fov_{a}_deg": float(np.degrees(interval_mrad * 1e-3 * n)) for a, n in sides}


def square_detectors(pitch_um, focal_length_mm, f_number, **more):
    """Parameters of Init & Trans for square detectors."""
    detectors = {"detector_x_um": pitch_um, "detector_y_um": pitch_um}
    return {**detectors, "focal_length_mm": focal_length_mm, "f_number": f_number, **more}


def shipped_bench(name, **policy):
    """A shipped network as it stands."""
    path = shipped_networks()[name]
    network = load_network(path, library=standard_library())
    return NodeBench(path.parent, network, **policy)


class NodeBench:
    """What nodes give and write in a folder, of the standard library if of no other."""

    def __init__(self, folder, nodes, links=None, *, library=None, precision="double", **policy):
        self.engine = Engine(library or standard_library())
        self.folder = folder
        network = nodes if isinstance(nodes, Network) else linked_network(nodes, links)
        self.plan = self.engine.plan(network, folder=folder)
        self.work = self.engine.work(Policy(precision, **policy))

    def error(self, node):
        return self.plan.nodes[node].error

    def port(self, port):
        return self.plan.output(port)

    def value(self, port):
        return self.engine.value(self.plan, port, self.work)

    def readouts(self, node):
        return self.engine.readouts(self.plan, node, self.work)

    def refusal(self, port, node):
        """The line in which a node refuses what is needed for a port."""
        errors = self.plan.errors()
        if not errors:
            with pytest.raises(ImagechainError) as caught:
                self.value(port)
            errors = [caught.value]
        assert (errors[0].node, errors[0].exit_code) == (node, 2)
        assert "\n" not in str(errors[0])
        return str(errors[0])

    def warnings(self):
        return self.engine.warnings(self.plan, self.work)

    def write(self, node):
        planned = self.plan.nodes[node]
        assert planned.error is None, planned.error
        here = NodeContext(node, 0, self.folder)
        written = planned.module.files(planned.inputs, here, self.work)
        for path, writer in written:
            writer(path)
        return [path for path, _ in written]
