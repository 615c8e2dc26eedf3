"""The query for what comes out of a node, small: its picture, or its transfer function's curve."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.editor.panels.illustrations.queries.shrinking import shrunk
from app.editor.panels.illustrations.queries.transfer_query import TransferQuery
from app.editor.viewers.pixels.grey_levels import between_ends, grey_levels
from core.chain.engine import Plan
from core.chain.wires import Image, Pupil
from core.errors import ImagechainError
from core.evaluation.recipes import number_bits

MOST_SAMPLES = 192  # across or along a thumbnail
LARGEST_COMPUTED = 1 << 20  # samples; a larger picture is taken only where it is there already
_DARKEST, _BRIGHTEST = 0.005, 0.995  # quantiles, as the viewers have them at first
_POINTS = 64


@dataclass(frozen=True, eq=False)
class SmallPicture:
    """A picture made small.

    Parameters
    ----------
    grey : ndarray of uint8, shape (high, wide)
        C order.
    width, height : float
        Its shape as it is seen, in any unit.
    """

    grey: NDArray[np.uint8]
    width: float
    height: float


@dataclass(frozen=True, eq=False)
class SmallCurve:
    """A curve along x, its frequencies over the highest, its values between `low` and `high`."""

    places: NDArray[np.float64]
    values: NDArray[np.float64]
    low: float
    high: float


Small = SmallPicture | SmallCurve


@dataclass(frozen=True)
class NodeThumbnailQuery(Query):
    """What comes out of a node: its first output that can be drawn.

    It waits until edits pause and all else is answered: it costs a pass nothing.
    """

    urgency: ClassVar[int] = 2
    waits: ClassVar[bool] = True

    node: str

    def key(self, plan: Plan) -> Hashable:
        """What is drawn."""
        planned = plan.node(self.node)
        if planned.error is not None:
            return str(planned.error)
        port, value = _drawn(plan, self.node)
        return port, getattr(value, "key", None), planned.node.disabled

    def answer(self, passing: Passing) -> Small | None:
        """The small picture or curve; None where nothing can be drawn."""
        try:
            port, value = _drawn(passing.plan, self.node)
        except ImagechainError:
            return None  # the badge says what is wrong
        if isinstance(value, Image):
            return _small_picture(passing, value)
        if isinstance(value, Pupil):
            samples = np.abs(np.asarray(passing.work.value(value.samples)))
            return _shown(samples, 1.0, 1.0)
        if port in ("mtf", "ptf"):
            return _small_curve(passing, self.node, port)
        return None


def _drawn(plan: Plan, node: str) -> tuple[str, Any]:
    """The output that is drawn, and its value; empty and None where there is none."""
    planned = plan.node(node)
    if planned.node.disabled:
        return "", None
    for port in planned.declaration.outputs:
        if port.types[0] in ("image", "pupil"):
            return port.name, plan.output(f"{node}.{port.name}")
    for curve in ("mtf", "ptf"):
        if planned.declaration.output(curve) is not None:
            return curve, plan.output(f"{node}.{curve}")
    return "", None


def _small_picture(passing: Passing, image: Image) -> SmallPicture | None:
    work = passing.work
    if image.rows * image.columns > LARGEST_COMPUTED and not work.has(image.recipe):
        return None
    samples = np.asarray(work.value(image.recipe))
    x, y = image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0
    return _shown(samples, image.columns * x, image.rows * y, number_bits(image.recipe))


def _shown(
    samples: NDArray[Any], width: float, height: float, bits: int | None = None
) -> SmallPicture | None:
    small = shrunk(samples, MOST_SAMPLES)
    finite = small[np.isfinite(small)]
    if not finite.size:
        return None
    low, high = (float(value) for value in np.quantile(finite, [_DARKEST, _BRIGHTEST]))
    return SmallPicture(grey_levels(small, *between_ends(low, high, bits)), width, height)


def _small_curve(passing: Passing, node: str, port: str) -> SmallCurve | None:
    lines = TransferQuery(node, "mtf" if port == "mtf" else "ptf").answer(passing)
    if lines is None:
        return None
    line = lines.x
    end = float(line.nyquist) or 1.0
    places = np.linspace(0.0, 1.0, _POINTS)
    values = np.interp(places * end, line.frequency, line.values)
    if port == "mtf":
        return SmallCurve(places, values, min(0.0, float(values.min())), 1.0)
    reach = max(float(np.abs(values).max()), 1e-9)
    return SmallCurve(places, values, -reach, reach)
