"""An engine with a small network: pictures of two sizes, planes, a node without inputs."""

import json

from app.editor.evaluation.queries import Passing
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import parse_network
from nodes.library import standard_library

DOCUMENT = {
    "format": "imagechain-network",
    "version": 1,
    "seed": 5,
    "nodes": {
        "scene": {
            "module": "test_scene",
            "params": {
                "kind": "slanted_edge", "width": 48, "height": 41, "fov_x_deg": 3.0,
                "fov_y_deg": 2.5, "cut_on_um": 8.0, "cut_off_um": 12.0,
            },
        },
        "init": {"module": "init_trans", "params": {"focal_length_mm": 100.0}},
        "jitter": {"module": "jitter_mtf", "params": {"sigma_mrad": 0.8}},
        "back": {"module": "back_transform"},
        "pixels": {"module": "combine_pixels", "params": {"factor_x": 2, "factor_y": 1}},
        "lonely": {"module": "back_transform"},
        "pupil": {"module": "exit_pupil", "params": {"size_x": 32, "size_y": 24, "radius": 9}},
    },
    "links": [
        ["scene.image", "init.image"],
        ["init.context", "jitter.context"],
        ["init.magnitude", "jitter.magnitude"],
        ["jitter.magnitude", "back.magnitude"],
        ["init.phase", "back.phase"],
        ["back.image", "pixels.image"],
    ],
}  # fmt: skip


class PictureBench:
    """Answers picture wants, and gives the values they are made of."""

    def __init__(self):
        library = standard_library()
        self.engine = Engine(library)
        self.network = parse_network(json.dumps(DOCUMENT), library=library)
        self.plan = self.engine.plan(self.network)

    def changed(self, node, name, value):
        return self.engine.plan(self.network.with_parameter(node, name, value))

    def answer(self, query, plan=None, reduced=1):
        work = self.engine.work(Policy())
        return query.answer(Passing(self.engine, plan or self.plan, work, reduced))

    def value(self, port):
        return self.engine.value(self.plan, port, self.engine.work(Policy()))
