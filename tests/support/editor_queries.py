"""Questions and modules for the tests of the editor's worker."""

import threading
import time
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np

from app.editor.evaluation.queries import Query
from core.chain.wires import Image
from core.evaluation.recipes import Step
from core.modules.declaration import Module, NodeContext
from core.modules.parameters import Param
from nodes.shared.module_ports import ImageOutput


@dataclass(frozen=True)
class Samples(Query):
    """The picture of a port as it is."""

    port: str
    urgency = 0
    from_preview = True

    def key(self, plan):
        return plan.output(self.port).key

    def answer(self, passing):
        return passing.engine.value(passing.plan, self.port, passing.work)


@dataclass(frozen=True)
class Readouts(Query):
    """The read-outs of a node."""

    node: str
    urgency = 1

    def key(self, plan):
        planned = plan.node(self.node)
        if planned.error is not None:
            raise planned.error
        return tuple(value.key for value in planned.outputs.values()), repr(planned.module)

    def answer(self, passing):
        return passing.engine.readouts(passing.plan, self.node, passing.work)


@dataclass(frozen=True)
class Asking(Query):
    """Calls a function with the pass; asked anew each time."""

    function: Any
    urgency: int = 2

    def key(self, plan):  # noqa: ARG002
        return None

    def answer(self, passing):
        return self.function(passing)


@dataclass(frozen=True)
class Gate:
    """A function for `Asking` that goes on once it is opened, or stopped at `work.check`."""

    entered: threading.Event = field(default_factory=threading.Event, hash=False)
    opened: threading.Event = field(default_factory=threading.Event, hash=False)

    def __call__(self, passing):
        self.entered.set()
        while not self.opened.wait(0.005):
            passing.work.check()
        return "went on"


class SlowCopy(Module, key="slow_copy", title="Slow Copy", group="Test"):
    """Passes the picture on, taking a time for each sample."""

    added: Annotated[float, Param("what is added")] = 0.0
    ns_per_sample: Annotated[float, Param("time", unit="ns", low=0)] = 0.0

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        """Plan the copy."""
        recipe = Step.of(
            _slowly, image.recipe, node=here.node, added=self.added, ns=self.ns_per_sample
        )
        return ImageOutput(image.with_recipe(recipe))


def _slowly(work, image, *, added, ns):
    until = time.perf_counter() + image.size * ns * 1e-9
    while time.perf_counter() < until:
        work.check()
        time.sleep(0.002)
    return np.asarray(image + image.dtype.type(added))
