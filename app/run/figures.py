"""The few figures that a network is run for: those of its sensor, its MTF and its ranges."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from app.run.evaluation import Evaluation
from app.run.terminal import four_digits, number_text, sized
from app.run.transfer_chain import Axis, Output, ancestors, find_output, mtf_at, sound_part
from core.chain.engine import Plan, realize
from core.chain.wires import Image
from core.errors import ImagechainError
from core.records import dataclass
from nodes.input_output.sample_unit import statistics

ELECTRONICS_FIGURES = (
    ("g_number", "G#"),
    ("bandwidth_Hz", "Bandwidth"),
    ("ner", "NER"),
    ("netd_detector_K", "NETD detector"),
    ("netd_system_K", "NETD system"),
    ("snr", "SNR"),
    ("quantization_rms", "Quantization"),
)
SENSOR_FIGURES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "electronics_noise": ELECTRONICS_FIGURES,
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
"""Read-outs and captions by the key of the detector's or the electronics' module."""

_MERITS: Mapping[str, tuple[tuple[tuple[str, ...], str], ...]] = {
    "measured_mtf": ((("mtf50",), "MTF50, measured"),),
    "noise_3d": ((("temporal", "fixed"), "Noise: temporal, fixed"),),
    "compare_images": ((("rmse",), "RMS difference"), (("max_error",), "Largest difference")),
    "line_by_line": ((("rms_percent",), "RMS difference"),),
    "camera_geometry": ((("swath_m",), "Swath"), (("gsd_x_m", "gsd_y_m"), "GSD")),
    "figures_of_merit": (
        (
            ("detection_range_km", "recognition_range_km", "identification_range_km"),
            "Range: detect, recognize, identify",
        ),
        (("ttp_range_km",), "TTP range"),
    ),
    "dual_gain": (
        (("dynamic_range_dB",), "Dynamic range, joined"),
        (("low_percent",), "Samples from the low gain"),
    ),
    "image_quality": ((("gsd_m",), "GSD"), (("giqe5",), "NIIRS by GIQE 5")),
}
"""Read-outs in one line and their caption, of the modules that measure and judge."""


@dataclass(frozen=True)
class Figure:
    """One line of the summary: values of one unit, and the node that they are of."""

    caption: str
    values: tuple[Any, ...]
    unit: str
    node: str


def main_figures(evaluation: Evaluation) -> list[Figure]:
    """What an engineer looks for first: about ten lines; what a network lacks is left out."""
    plan = evaluation.plan
    figures = _output_figures(evaluation)
    sensor = sensor_node(plan)
    if sensor is not None:
        declared = SENSOR_FIGURES[plan.nodes[sensor].node.module]
        figures += _of_node(evaluation, sensor, [((name,), text) for name, text in declared])
    figures += _mtf_figures(evaluation)
    for module, wanted in _MERITS.items():
        for name, node in plan.nodes.items():
            if node.node.module == module:
                figures += _of_node(evaluation, name, wanted)
    return figures


def figure_rows(
    figures: Iterable[Figure], text: Callable[[Any], str] = number_text
) -> list[tuple[str, str, str, str]]:
    """Caption, values, unit and node of each figure as text, in the sizes that data sheets use."""
    rows = []
    for figure in figures:
        shown = [sized(value, figure.unit) for value in figure.values]
        units = {unit for value, unit in shown if value}
        if len(units) > 1:  # no size suits all
            shown = [(four_digits(value), figure.unit) for value in figure.values]
            units = {figure.unit}
        values = [text(value) for value, _ in shown]
        if len(set(values)) == 1:
            del values[1:]
        rows.append((figure.caption, ", ".join(values), (*units, figure.unit)[0], figure.node))
    return rows


def sensor_node(plan: Plan, preferred: str | None = None) -> str | None:
    """The node whose figures are shown: the preferred, else the last that leads to the output."""
    nodes, links = plan.network.nodes, plan.network.links
    named = [name for name, node in nodes.items() if node.module in SENSOR_FIGURES]
    # Budgets behind a Dual Gain count the noise of its high gain: so do these figures.
    ends = ((one.source, nodes[one.target].module, one.input) for one in links)
    low = {source for source, *end in ends if end == ["dual_gain", "low"]}
    named = [name for name in named if name not in low] or named
    if not named or preferred in named:
        return preferred if named else None
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


def _of_node(
    evaluation: Evaluation, name: str, wanted: Iterable[tuple[tuple[str, ...], str]]
) -> list[Figure]:
    planned, found = evaluation.plan.nodes[name], evaluation.readouts.get(name, {})
    units = {readout.name: planned.unit(readout) for readout in planned.declaration.readouts}
    return [
        Figure(caption, tuple(found[each] for each in names), units[names[0]], name)
        for names, caption in wanted
        if all(found.get(each) is not None for each in names)
    ]


def _output_figures(evaluation: Evaluation) -> list[Figure]:
    port = evaluation.chain.final
    if port is None:
        return []
    image: Image = evaluation.plan.output(port)
    seen = statistics(realize(image, evaluation.work), for_each=evaluation.work.for_each)
    values = (seen.minimum, seen.mean, seen.maximum)
    return [Figure("Output: minimum, mean, maximum", values, image.unit, port)]


def _mtf_figures(evaluation: Evaluation) -> list[Figure]:
    chain, work = evaluation.chain, evaluation.work
    if chain.grid is None or not chain.cascade or not chain.stages:
        return []
    caption, places = "MTF at Nyquist", (chain.grid.nyquist_x, chain.grid.nyquist_y)
    of_pixels = chain.pixel_nyquist
    if of_pixels[0] is not None and of_pixels[1] is not None:
        caption, places = "MTF at the pixels' Nyquist", (of_pixels[0], of_pixels[1])
    axes: tuple[Axis, Axis] = ("x", "y")
    pairs = zip(axes, places, strict=True)
    values = tuple(mtf_at(work, chain.factors, place, axis) for axis, place in pairs)
    at = " × ".join(dict.fromkeys(f"{place:.4g}" for place in places))
    return [Figure(f"{caption} ({at} cyc/mrad)", values, "", "all stages")]
