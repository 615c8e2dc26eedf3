"""An engine with a small network: pictures of two sizes, planes, a node without inputs."""

from app.editor.evaluation.queries import Passing
from core.chain.engine import Engine
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

SCENE = {
    "kind": "slanted_edge", "width": 48, "height": 41, "fov_x_deg": 3.0, "fov_y_deg": 2.5,
    "cut_on_um": 8.0, "cut_off_um": 12.0,
}  # fmt: skip
NODES = {
    "lonely": ("back_transform", {}),
    "scene": ("test_scene", SCENE),
    "init": ("init_trans", {"focal_length_mm": 100.0}),
    "jitter": ("jitter_mtf", {"sigma_mrad": 0.8}),
    "back": ("back_transform", {}),
    "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 1}),
    "pupil": ("exit_pupil", {"size_x": 32, "size_y": 24, "radius": 9}),
}


class PictureBench:
    """Answers picture wants, and gives the values they are made of."""

    def __init__(self):
        library = standard_library()
        self.engine = Engine(library)
        self.network = linked_network(NODES, seed=5)
        self.plan = self.engine.plan(self.network)

    def changed(self, node, name, value):
        return self.engine.plan(self.network.with_parameter(node, name, value))

    def answer(self, query, plan=None, reduced=1):
        work = self.engine.work(Policy())
        return query.answer(Passing(self.engine, plan or self.plan, work, reduced))

    def value(self, port):
        return self.engine.value(self.plan, port, self.engine.work(Policy()))
