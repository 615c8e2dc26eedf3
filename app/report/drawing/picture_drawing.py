"""Pictures with colour bars in radiance and temperature, and printed numbers, for reports."""

import contextlib
import io
import logging
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run import saving, terminal
from app.run.evaluation import Evaluation
from core.arrays import Array
from core.chain.engine import realize
from core.chain.wires import Image, Pupil, SampledTransfer, Transfer
from core.errors import ImagechainError, NetworkError, close, printable
from core.network.network import Network
from core.physics.detector.photon_conversion import SHORTEST_THERMAL_UM
from core.physics.radiometry.planck import band_radiance, brightness_temperature

Panel = tuple[str, Array, tuple[float, float, float, float], str]
"""Title, samples, their extent (left, right, bottom, top) and its unit."""
DPI = 144
MOST_PANELS = 8
MOST_DRAWN = 24
"""Curves or bars of one figure; more could not be distinguished."""
RADIANCE = "W/m²/sr"
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
COLOURS = (
    "#1f77b4", "#d95f02", "#2a9d4a", "#c2267f", "#7a5cc2", "#8c6d31", "#17a2b8", "#e0a100",
    "#6b6b6b",
)  # fmt: skip
LEGEND_LETTERS = 0.075  # inches of a letter of a legend, about
_LEGEND_LINE, _LEGEND_ROW = 0.75, 0.2  # of the line before a name with its gaps, and of a row
_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#555555",
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "figure.facecolor": "white",
}


def strongest(strengths: Sequence[float]) -> list[int]:
    """Places of the `MOST_DRAWN` greatest, in order."""
    ranked = sorted(range(len(strengths)), key=lambda place: -strengths[place])
    return sorted(ranked[:MOST_DRAWN])


def note(axis: Any, text: str, place: Any, away: tuple[float, float], **look: Any) -> None:
    """Write a text so many points away from a place."""
    axis.annotate(text, place, xytext=away, textcoords="offset points", **look)


def legend_below(axis: Any, away: float, size: float) -> None:
    axis.legend(
        loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=away, ncols=2, fontsize=size
    )


@contextmanager
def figure(width: float, height: float) -> Iterator[tuple[Any, io.BytesIO]]:
    """A matplotlib figure of that size in inches, written as PNG when the block ends."""
    mpl = load_matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    out = io.BytesIO()
    with mpl.rc_context(_STYLE):
        drawn = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(drawn)
        yield drawn, out
        as_written(drawn)
        # Without a date and version in it, the same run gives the same picture.
        drawn.savefig(out, format="png", dpi=DPI, metadata={"Software": None})


def pictures_png(pictures: list[tuple[str, Image, Array]], beside: int = 2) -> bytes:
    """Pictures side by side, each with grey levels of its own between its 0.1 % quantiles."""
    tallest = max(image.rows / image.columns * _aspect(image) for _, image, _ in pictures)
    number_across = max(len(pictures), beside, 2)
    width = 10.0 / number_across
    # Too low a figure would push the titles out of it.
    with figure(width * len(pictures), width * min(tallest, 2.0) + 1.2) as (drawn, out):
        axes = drawn.subplots(1, len(pictures), squeeze=False)[0]
        for axis, (title, image, samples) in zip(axes, pictures, strict=True):
            axis.set_title(title)
            bar = _show(drawn, axis, image, samples, along="bottom", ticks=8 - number_across)
            quantity = "radiance" if image.unit == RADIANCE else "value"
            bar.set_label(f"{quantity} ({_unit(image.unit)})" if image.unit else "value")
            _temperatures(bar, image, *bar.mappable.get_clim())
    return out.getvalue()


def panels_png(panels: Sequence[Panel]) -> bytes:
    columns = 4
    rows = -(-len(panels) // columns)
    with figure(10.0, 2.6 * rows) as (drawn, out):
        axes = drawn.subplots(rows, columns, squeeze=False).ravel()
        for axis in axes[len(panels) :]:
            axis.set_visible(False)
        for axis, (title, values, extent, unit) in zip(axes, panels, strict=False):
            axis.imshow(values, cmap="gray", extent=extent, aspect="equal")
            axis.set_title(title, fontsize=8)
            axis.set_xlabel(unit, fontsize=7)
            axis.tick_params(labelsize=7)
            axis.locator_params(nbins=4)
            axis.grid(visible=False)
    return out.getvalue()


def noise_png(pictures: list[tuple[str, Image, Array]]) -> bytes:
    with figure(10.0, 3.5 * len(pictures)) as (drawn, out):
        axes = drawn.subplots(len(pictures), 2, squeeze=False, width_ratios=(1, 1.15))
        for (left, right), (title, image, samples) in zip(axes, pictures, strict=True):
            left.set_title(title)
            bar = _show(drawn, left, image, samples, along="right", ticks=7)
            bar.ax.tick_params(labelsize=7.5)
            histogram(right, image, samples)
    return out.getvalue()


def _show(drawn: Any, axis: Any, image: Image, samples: Array, *, along: str, ticks: int) -> Any:
    from matplotlib.ticker import MaxNLocator

    low, high = saving.robust_limits(samples)
    if not high > low:
        reach = abs(low) * 1e-3 or 1.0
        low, high = low - reach, high + reach
    shown = axis.imshow(samples, cmap="gray", vmin=low, vmax=high, aspect=_aspect(image))
    axis.set_xticks([])
    axis.set_yticks([])
    axis.grid(visible=False)
    for spine in axis.spines.values():
        spine.set(visible=True, color="#bbbbbb", linewidth=0.5)
    size: Any = {"pad": 0.03, "aspect": 32, "shrink": 0.92} if along == "bottom" else {"pad": 0.02}
    size |= {"location": along, "extend": "both", "ticks": MaxNLocator(ticks)}
    bar = drawn.colorbar(shown, ax=axis, **size)
    bar.outline.set_linewidth(0.5)
    return bar


def _aspect(image: Image) -> float:
    """Height of a sample over its width in the scene: samples need not be square."""
    if image.interval_x_mrad and image.interval_y_mrad:
        return image.interval_y_mrad / image.interval_x_mrad
    return 1.0


def _temperatures(bar: Any, image: Image, low: float, high: float) -> None:
    """A second scale on the colour bar: the blackbody temperature of the same band radiance."""
    from matplotlib.ticker import MaxNLocator

    if image.unit != RADIANCE or image.band_um is None or low <= 0:
        return
    if image.band_um[0] < SHORTEST_THERMAL_UM:  # reflected light
        return
    band = {"cut_on_um": image.band_um[0], "cut_off_um": image.band_um[1]}
    try:
        ends = [float(brightness_temperature(radiance=level, **band)) for level in (low, high)]
    except ImagechainError:  # no temperature radiates that much
        return
    ticks = [t for t in MaxNLocator(6).tick_values(*ends) if ends[0] <= t <= ends[1]]
    scale = bar.ax.secondary_xaxis("top")
    scale.set_xticks([float(band_radiance(temperature_K=t, **band)) for t in ticks])
    scale.set_xticklabels([f"{t:g} K" for t in ticks], fontsize=7.5, color="#444444")
    scale.tick_params(length=2.5, color="#888888", pad=1.5)
    scale.spines["top"].set_visible(False)


def histogram(axis: Any, image: Image, samples: Array) -> None:
    from matplotlib.ticker import MaxNLocator

    values = samples.ravel().astype(np.float64)
    mean, sigma = float(values.mean()), float(values.std())
    axis.set_title(f"mean {number(mean)}   σ {number(sigma)}", fontweight="normal")
    low, high = float(values.min()), float(values.max())
    whole = high - low <= 120 and bool(np.all(values == np.rint(values)))  # as counts of photons
    bins = np.arange(low - 0.5, high + 1.0) if whole else np.linspace(low, high, 121)
    counts, edges = np.histogram(values, bins=bins)
    axis.stairs(counts, edges, fill=True, color="#6d8fb3")
    axis.set_xlim(edges[0], edges[-1])
    # Few: labels of many digits must not meet.
    axis.xaxis.set_major_locator(MaxNLocator(5, integer=whole))
    axis.ticklabel_format(axis="x", scilimits=(-4, 5), useMathText=True)
    if counts.max() > 0.5 * counts.sum():  # a few events among many zeros
        axis.set_yscale("log")
    axis.set_axisbelow(True)
    axis.set_xlabel(f"noise ({_unit(image.unit)})" if image.unit else "noise")
    axis.set_ylabel("samples")


def _unit(unit: str) -> str:
    return unit.replace(RADIANCE, "W m⁻² sr⁻¹")


# Matplotlib without the user's settings, and without messages on standard error.


def load_matplotlib() -> Any:
    """Import matplotlib as it was made: pictures are the same for every user and folder.

    Where the user's cache folder cannot be written, it makes a temporary one itself and removes it.
    """
    if "matplotlib" not in sys.modules:
        logging.getLogger("matplotlib").setLevel(logging.CRITICAL + 1)
        spec = find_spec("matplotlib")
        assert spec is not None
        assert spec.submodule_search_locations is not None
        own = Path(spec.submodule_search_locations[0]) / "mpl-data"
        wanted = {"MPLBACKEND": "Agg", "MATPLOTLIBRC": str(own / "matplotlibrc")}
        before = {name: os.environ.get(name) for name in wanted}
        os.environ.update(wanted)
        # A settings file in the current folder goes before any other.
        here = Path("matplotlibrc").exists()
        try:
            with contextlib.chdir(own) if here else contextlib.nullcontext():
                import matplotlib.backends.backend_agg
                import matplotlib.figure
        finally:
            for name, value in before.items():
                os.environ.pop(name)
                os.environ |= {} if value is None else {name: value}
    import matplotlib as mpl

    return mpl


# Texts of a figure as they are written: a dollar sign is a dollar sign, and begins no formula.


def as_written(drawn: Any) -> None:
    """Have the figure's texts drawn letter by letter, not as formulas: they are the network's."""
    from matplotlib.axis import Axis
    from matplotlib.text import Text
    from matplotlib.ticker import FuncFormatter

    of_axes: set[int] = set()
    for axis in drawn.findobj(Axis):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, FuncFormatter):  # of labels that are given
            formatter.func = lambda *place, named=formatter.func: printable(named(*place)).replace(
                "$", r"\$"
            )
        ticks = (*axis.get_major_ticks(), *axis.get_minor_ticks())
        of_axes.update(id(text) for tick in ticks for text in (tick.label1, tick.label2))
        of_axes.add(id(axis.get_offset_text()))
    for text in drawn.findobj(Text):
        if id(text) not in of_axes:
            text.set_parse_math(False)
            text.set_text(printable(text.get_text()))


# Which figures of a publication those of the report are drawn as.
#
# A network may carry a field for it, `drawn_as`, with a text for each of these of our figures:
# `stages`, the MTF of every stage; `total`, all of them together; `judged`, the MTF measured in the
# final picture.

FIGURES = ("stages", "total", "judged")


def drawn_as(network: Network) -> dict[str, str]:
    given = network.extra.get("drawn_as", {})
    if not isinstance(given, Mapping):
        raise NetworkError("drawn_as must be an object with a string for each figure")
    for name, text in given.items():
        if name not in FIGURES:
            hint = close(name, FIGURES) or f"; allowed: {', '.join(FIGURES)}"
            raise NetworkError(f"drawn_as has an unknown figure {name!r:.80}{hint}")
        if not isinstance(text, str):
            raise NetworkError(f"drawn_as: {name} must be a string")
    return dict(given)


def named(caption: str, figure: str | None) -> str:
    return f"As {figure}. {caption}" if figure else caption


# A family of curves, one for each value of a parameter.


def family_colours(count: int) -> list[Any]:
    """Colours of so many curves: of few each its own, of many from dark to bright."""
    if count <= len(COLOURS):
        return list(COLOURS[:count])
    import matplotlib as mpl

    brightest = 0.92  # beyond it yellow is lost on white
    return [mpl.colormaps["viridis"](brightest * place / (count - 1)) for place in range(count)]


def legend_columns(names: Sequence[str], width_in: float) -> int:
    widest = _LEGEND_LINE + LEGEND_LETTERS * max(map(len, names))
    return max(1, min(len(names), int(width_in / widest)))


def legend_height_in(names: Sequence[str], width_in: float) -> float:
    """How much higher a picture is with a legend below it, its title included."""
    return _LEGEND_ROW * (1 - -len(names) // legend_columns(names, width_in))


def by_rows(items: Sequence[Any], columns: int) -> list[Any]:
    """In the order in which a legend, which goes down its columns, shows them row by row."""
    return [item for first in range(columns) for item in items[first::columns]]


def pupil_panels(evaluation: Evaluation) -> tuple[list[Panel], list[str]]:
    """Pupils, then MTFs at frequencies of their own; and the ports there was no place for."""
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
            panels += [panel] if np.any(panel[1]) else []
    return panels, [port for port, _ in wanted[MOST_PANELS:]]


def _panel(evaluation: Evaluation, port: str, value: Pupil | Transfer) -> Panel:
    if isinstance(value, Pupil):
        samples = _real(realize(value, evaluation.work))
        rows, columns = samples.shape
        return port, samples, (-0.5, columns - 0.5, rows - 0.5, -0.5), "samples"
    assert value.own is not None
    sampled: SampledTransfer = evaluation.work.value(value.own)
    centred = np.fft.fftshift(_real(sampled.values))
    left, right = ends(centred.shape[1], sampled.interval_x)
    top, bottom = ends(centred.shape[0], sampled.interval_y)
    return port, centred, (left, right, bottom, top), "cyc/mrad"


def _real(values: NDArray[Any]) -> NDArray[Any]:
    return np.abs(values) if np.iscomplexobj(values) else values


def ends(count: int, interval: float) -> tuple[float, float]:
    """Outer edges of the first and last sample, frequency 0 being sample count // 2."""
    first = -(count // 2)
    return (first - 0.5) * interval, (first + count - 0.5) * interval


def number(value: Any, unit: str | None = None) -> str:
    """As `number_text`, with a true minus sign and powers of ten in print."""
    if value is None:
        return "–"
    if unit is not None:
        value = terminal.without_rounding(value, unit)
    text = terminal.number_text(value)
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        return text
    mantissa, exponent, power = text.replace("-", "−").partition("e")
    if not exponent:
        return mantissa
    raised = str(int(power.replace("−", "-"))).translate(_RAISED)
    factor = mantissa.removesuffix("1") if mantissa in ("1", "−1") else f"{mantissa}·"
    return f"{factor}10{raised}"


def short(value: float | None, digits: int = 4) -> str:
    return number(None if value is None else float(f"{value:.{digits}g}"))
