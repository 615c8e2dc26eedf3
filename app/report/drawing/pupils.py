"""Pictures of exit pupils and of their raw autocorrelations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from app.run.evaluation import Evaluation
from core.chain.realize import realize
from core.chain.results import SampledTransfer
from core.chain.wires import Pupil, Transfer

MOST_PANELS = 8


@dataclass(frozen=True)
class Panel:
    """A small picture with axes; `extent` is left, right, bottom, top."""

    title: str
    values: NDArray[Any]
    extent: tuple[float, float, float, float]
    unit: str


def pupil_panels(evaluation: Evaluation) -> tuple[list[Panel], list[str]]:
    """Pupils, then MTFs at frequencies of their own; and the ports there was no place for.

    A phase that is 0 everywhere is no picture.
    """
    ports = [
        (f"{name}.{port}", value)
        for name, node in evaluation.plan.nodes.items()
        if not node.node.disabled
        for port, value in node.outputs.items()
    ]
    wanted = [entry for entry in ports if isinstance(entry[1], Pupil)]
    raw = [entry for entry in ports if isinstance(entry[1], Transfer) and entry[1].own is not None]
    wanted += [entry for entry in raw if entry[1].part == "mtf"]
    panels = [_panel(evaluation, port, value) for port, value in wanted[:MOST_PANELS]]
    for port, value in raw:
        if value.part == "ptf" and len(panels) < MOST_PANELS:
            panel = _panel(evaluation, port, value)
            panels += [panel] if np.any(panel.values) else []
    return panels, [port for port, _ in wanted[MOST_PANELS:]]


def _panel(evaluation: Evaluation, port: str, value: Pupil | Transfer) -> Panel:
    if isinstance(value, Pupil):
        samples = _real(realize(value, evaluation.work))
        rows, columns = samples.shape
        return Panel(port, samples, (-0.5, columns - 0.5, rows - 0.5, -0.5), "samples")
    assert value.own is not None
    sampled: SampledTransfer = evaluation.work.value(value.own)
    centred = scipy.fft.fftshift(_real(sampled.values))
    left, right = ends(centred.shape[1], sampled.interval_x)
    top, bottom = ends(centred.shape[0], sampled.interval_y)
    return Panel(port, centred, (left, right, bottom, top), "cyc/mrad")


def _real(values: NDArray[Any]) -> NDArray[Any]:
    return np.abs(values) if np.iscomplexobj(values) else values


def ends(count: int, interval: float) -> tuple[float, float]:
    """Outer edges of the first and last sample, frequency 0 being sample count // 2."""
    first = -(count // 2)
    return (first - 0.5) * interval, (first + count - 0.5) * interval
