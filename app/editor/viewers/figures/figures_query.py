"""The query of the figures strip: the sensor's figures among the electronics' read-outs."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from app.editor.error_text import error_text
from app.editor.evaluation.queries import Passing, Query
from app.editor.viewers.network_ports import HOW_TO_MARK
from app.run.output import Output, ancestors, find_output
from app.run.sound_plan import sound_part
from core.chain.engine import Plan
from core.errors import ImagechainError

ELECTRONICS = "electronics_noise"
SHOWN = (
    ("g_number", "G#"),
    ("bandwidth_Hz", "Bandwidth"),
    ("ner", "NER"),
    ("netd_detector_K", "NETD detector"),
    ("netd_system_K", "NETD system"),
    ("snr", "SNR"),
    ("quantization_rms", "Quantization"),
)
BY_MODULE: Mapping[str, tuple[tuple[str, str], ...]] = MappingProxyType(
    {
        ELECTRONICS: SHOWN,
        "focal_plane": (
            ("well_fill_percent", "Well fill"),
            ("signal_e", "Signal"),
            ("temporal_noise_e", "Noise"),
            ("fixed_pattern_e", "Fixed pattern"),
            ("netd_K", "NETD"),
            ("snr", "SNR"),
            ("dynamic_range_dB", "Dynamic range"),
        ),
        "microbolometer": (
            ("netd_K", "NETD"),
            ("white_netd_K", "White noise"),
            ("flicker_K", "1/f noise"),
            ("fixed_pattern_K", "Fixed pattern"),
            ("noise_radiance", "NER"),
            ("snr", "SNR"),
            ("lag_percent", "Lag"),
        ),
    }
)
"""Read-outs and captions by the key of the detector's or the electronics' module."""


@dataclass(frozen=True)
class Figure:
    """One read-out; `value` None where there is none, `reason` why, where that is known."""

    name: str
    caption: str
    value: Any
    unit: str
    meaning: str
    reason: str = ""


@dataclass(frozen=True)
class Figures:
    """The read-outs of one node.

    Parameters
    ----------
    node : str or None
        The electronics; None where there is none, or it is not clear which leads to the output.
    figures : tuple of Figure
        Its read-outs.
    output : str or None
        Port of the picture that the network delivers.
    missing : str
        Why there is none, in one line.
    choices : tuple of str
        Ports of the pictures that could be meant, where none is marked.
    """

    node: str | None
    figures: tuple[Figure, ...] = ()
    output: str | None = None
    missing: str = ""
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class FiguresQuery(Query):
    """Figures of the electronics that lead to the final picture.

    Parameters
    ----------
    preferred : str or None
        The node to show if there are several; else it is the last one.
    """

    urgency: ClassVar[int] = 1

    preferred: str | None = None

    def key(self, plan: Plan) -> Hashable:
        """The node and what its figures are made of."""
        output = _output_of(plan)
        name = self.node(plan)
        if name is None:
            return self, output
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        table = planned.outputs.get("table")
        return self, output, name, planned.node.disabled, getattr(table, "key", None)

    def answer(self, passing: Passing) -> Figures:
        """The figures."""
        plan = passing.plan
        output = _output_of(plan)
        name = self.node(plan)
        if name is None:
            return Figures(None, (), *output)
        planned = plan.node(name)
        if planned.error is not None:
            raise planned.error
        engine, values, reasons = passing.engine, dict[str, Any](), dict[str, str]()
        if not planned.node.disabled:
            values = engine.readouts(plan, name, passing.work)
            reasons = {
                readout: engine.why_none(plan, name, passing.work, readout)
                for readout, _ in BY_MODULE[planned.node.module]
                if values.get(readout) is None
            }
        declared = {readout.name: readout for readout in planned.declaration.readouts}
        return Figures(
            name,
            tuple(
                Figure(
                    readout,
                    caption,
                    values.get(readout),
                    declared[readout].unit,
                    declared[readout].meaning,
                    reasons.get(readout, ""),
                )
                for readout, caption in BY_MODULE[planned.node.module]
            ),
            *output,
        )

    def node(self, plan: Plan) -> str | None:
        """Id of the node whose figures are shown; None without a detector or electronics.

        Of several, the preferred one, else the last one that leads to the output, else the last of
        all; None where none of several pictures is marked as the output.
        """
        named = [name for name, node in plan.network.nodes.items() if node.module in BY_MODULE]
        if not named or self.preferred in named:
            return self.preferred if named else None
        leading = set(named)
        try:
            output = find_output(sound_part(plan))
        except ImagechainError:
            output = Output(None)
        if output.choices and len(named) > 1:
            return None
        if output.port is not None:
            last = output.port.rpartition(".")[0]
            leading = ancestors(plan.network, last) | {last}
        order = [name for name in plan.nodes if name in named]
        return next((name for name in reversed(order) if name in leading), order[-1])


def _output_of(plan: Plan) -> tuple[str | None, str, tuple[str, ...]]:
    """The picture that the network delivers, or why there is none, and the candidates for it."""
    try:
        output = find_output(sound_part(plan))
    except ImagechainError as error:
        return None, error_text(error), ()
    missing = f"{output.missing}; {HOW_TO_MARK}" if output.choices else output.missing
    return output.port, missing, output.choices
