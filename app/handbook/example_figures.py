"""What a module's example makes, drawn: curves, pictures before and after, read-outs."""

import base64
import html
import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.handbook.module_examples import IT, NO_EXAMPLE, SHIPPED, example_network
from app.report.drawing.curves import draw_on
from app.report.drawing.picture_drawing import as_written, load_matplotlib, number
from app.run.saving import encode_png, grey_levels, robust_limits
from core.chain.engine import Engine, Plan
from core.chain.results import CurveData
from core.chain.wires import Curve, Image, Pupil, Transfer
from core.errors import ImagechainError
from core.evaluation.policy import Policy
from core.evaluation.work import Work
from core.modules.declaration import Declaration
from core.names import in_line

_WIDE, _HIGH = 5.2, 3.2  # inches of a plot
_SMALLEST_PHASE = 1e-9
_ALIKE = 2e-3
_MOST_CURVES = 3
_LARGEST = 640  # samples; of a larger picture the means of blocks are shown
_LARGE = 240  # samples; a smaller picture is shown by larger squares

Samples = NDArray[Any]


@dataclass
class Example:
    """The drawings of a module's example as pieces of a page, or why there are none."""

    figures: list[str] = field(default_factory=list)
    settings: list[tuple[str, str]] = field(default_factory=list)
    readouts: list[tuple[str, str, str]] = field(default_factory=list)
    reason: str = ""

    @property
    def rows(self) -> list[list[str]]:
        """Curves, and below them pictures."""
        drawn = [drawing for drawing in self.figures if 'class="curve"' in drawing[:40]]
        return [row for row in (drawn, [one for one in self.figures if one not in drawn]) if row]


def example_of(declared: Declaration, engine: Engine) -> Example:
    """Run the module's example, and draw it."""
    if declared.key in NO_EXAMPLE:
        return Example(reason=NO_EXAMPLE[declared.key])
    network = example_network(declared, engine.library)
    plan = engine.plan(network, folder=SHIPPED)
    work = engine.work(Policy())
    example = Example(
        settings=[(name, _shown(value)) for name, value in network.nodes[IT].params.items()]
    )
    try:
        _draw(example, declared, engine, plan, work)
        example.readouts = _readouts(declared, engine, plan, work)
    except Exception as error:
        # A plug-in's module may need more than the nodes that stand before it here, or be at fault:
        # its page states it, and the others are made.
        kind = "" if isinstance(error, ImagechainError) else f"{type(error).__name__}: "
        return Example(reason=f"This page's example was not run: {kind}{in_line(str(error))}.")
    return example


def _draw(example: Example, declared: Declaration, engine: Engine, plan: Plan, work: Work) -> None:
    outputs = plan.nodes[IT].outputs
    shown = example.figures
    for name in ("mtf", "ptf"):
        if isinstance(outputs.get(name), Transfer):
            drawing = _transfer(declared, outputs[name], engine.value(plan, f"{IT}.{name}", work))
            shown += [drawing] if drawing else []
    drawn = [name for name, value in outputs.items() if isinstance(value, Curve)]
    for name in drawn[:_MOST_CURVES]:
        data = engine.value(plan, f"{IT}.{name}", work)
        shown.append(curves(f"{declared.key}-{name}", data, data.title))
    for name, value in outputs.items():
        if isinstance(value, Pupil):
            samples = engine.value(plan, f"{IT}.{name}", work)
            shown.append(picture(np.abs(samples), "the pupil: white lets light through"))
    if declared.key == "init_trans":
        spectrum = np.fft.fftshift(np.abs(engine.value(plan, f"{IT}.magnitude", work)))
        shown.append(picture(np.log(spectrum + 1e-6), "the magnitude, its logarithm"))
        return
    shown += _before_and_after(plan, engine, work)


def _before_and_after(plan: Plan, engine: Engine, work: Work) -> list[str]:
    after = "seen.image" if "seen" in plan.nodes else f"{IT}.image"
    if not isinstance(plan.nodes[after.partition(".")[0]].outputs.get("image"), Image):
        return []
    made = plan.output(after)
    before = next(
        (
            f"{link.source}.{link.output}"
            for link in plan.network.links
            if link.target == ("init" if "seen" in plan.nodes else IT) and link.input == "image"
        ),
        None,
    )
    samples = engine.value(plan, after, work)
    if before is None:
        return [picture(samples, f"the picture ({made.unit or 'no unit'})")]
    given, first = plan.output(before), engine.value(plan, before, work)
    same = made.unit == given.unit
    limits = robust_limits(first)
    drawings = [
        picture(first, f"before ({given.unit})", limits),
        picture(samples, f"behind it ({made.unit or 'no unit'})", limits if same else None),
    ]
    noise = plan.nodes[IT].outputs.get("noise")
    if isinstance(noise, Image):
        drawings.append(picture(engine.value(plan, f"{IT}.noise", work), "the noise alone"))
    return drawings


def picture(samples: Samples, caption: str, limits: tuple[float, float] | None = None) -> str:
    """A picture in grey as a piece of a page."""
    low, high = limits or robust_limits(samples)
    samples = _means(samples, -(-max(samples.shape) // _LARGEST))
    levels = grey_levels(low, high, samples)
    times = max(1, _LARGE // max(levels.shape))
    levels = np.repeat(np.repeat(levels, times, axis=0), times, axis=1)
    rows, columns = levels.shape
    size = f'width="{columns}" height="{rows}" '
    return png_figure(encode_png(levels), caption, "picture", size)


def png_figure(content: bytes, caption: str, kind: str, size: str = "") -> str:
    data, text = base64.b64encode(content).decode(), html.escape(caption)
    return (
        f'<figure class="{kind}"><img alt="{text}" {size}src="data:image/png;base64,{data}">'
        f"<figcaption>{text}</figcaption></figure>"
    )


def _transfer(declared: Declaration, value: Transfer, samples: Samples) -> str:
    """A transfer function across and along; nothing of a phase that is 0."""
    if np.iscomplexobj(samples):
        samples = np.abs(samples)
    rows, columns = samples.shape
    grid = value.grid
    xi = np.arange(columns // 2 + 1) * grid.frequency_interval_x
    eta = np.arange(rows // 2 + 1) * grid.frequency_interval_y
    across, along = samples[0, : len(xi)], samples[: len(eta), 0]
    if value.part == "ptf":
        # Of the last frequency of an even size only the real part acts.
        xi, across, eta, along = xi[:-1], across[:-1], eta[:-1], along[:-1]
        if max(np.abs(across).max(), np.abs(along).max()) < _SMALLEST_PHASE:
            return ""
    name = f"{declared.key}-{value.part}"
    with plot(name, _WIDE, _HIGH) as (drawn, out):
        axis = drawn.subplots()
        alike = bool(np.abs(np.interp(xi, eta, along) - across).max() < _ALIKE)
        both = "horizontal and vertical" if alike else "horizontal (ξ)"
        axis.plot(xi, across, color=COLOURS[0], lw=1.8, label=both)
        if not alike:
            axis.plot(eta, along, color=COLOURS[1], lw=1.8, ls="--", label="vertical (η)")
        axis.set_xlabel("cycles/mrad")
        axis.set_ylabel("MTF" if value.part == "mtf" else "PTF (rad)")
        axis.margins(x=0)
        axis.legend(loc="best", fontsize=8)
        if value.part == "mtf":
            low = min(float(across.min()), float(along.min()))
            axis.set_ylim(min(-0.02, low * 1.1), 1.05)
    title = "MTF" if value.part == "mtf" else "PTF"
    return f'<figure class="curve">{out.getvalue()}<figcaption>{title}</figcaption></figure>'


def _means(samples: Samples, size: int) -> Samples:
    """Means of blocks; rows and columns left over are dropped."""
    if size < 2:
        return samples
    rows, columns = samples.shape[0] // size, samples.shape[1] // size
    blocks = samples[: rows * size, : columns * size].reshape(rows, size, columns, size)
    return np.asarray(blocks.mean(axis=(1, 3)))


def curves(name: str, data: CurveData, caption: str) -> str:
    """Curves or bars as a piece of a page; `name` is the drawing's own on it."""
    rows = -(-len(data.series) // 2) if len(data.series) > 1 else 0
    bars = 0.24 * len(data.bars) * len(data.series) + 0.8 if data.bars else 0.0
    with plot(name, _WIDE, max(_HIGH, bars) + 0.2 * rows) as (drawn, out):
        axis = drawn.subplots()
        draw_on(axis, data)
        if len(data.series) > 1:
            drawn.legend(loc="outside lower center", ncols=2, fontsize=7.5)
    text = html.escape(caption)
    return f'<figure class="curve">{out.getvalue()}<figcaption>{text}</figcaption></figure>'


def _readouts(
    declared: Declaration, engine: Engine, plan: Plan, work: Work
) -> list[tuple[str, str, str]]:
    values = engine.readouts(plan, IT, work)
    units = {readout.name: readout.unit for readout in declared.readouts}
    return [
        (name, _shown(value), units.get(name, ""))
        for name, value in values.items()
        if value is not None
    ]


def _shown(value: Any) -> str:
    if isinstance(value, Sequence) and not isinstance(value, str):
        return ", ".join(_shown(one) for one in value)
    if isinstance(value, bool | str):
        return str(value)
    return number(float(value))


# Plots as drawings within a page, in the page's own colours, light or dark.

_INK, _GRID = "#010203", "#040506"
_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": _INK,
    "axes.labelcolor": _INK,
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "grid.color": _GRID,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "path",
}
# Colours that are bright enough on dark paper and dark enough on light.
COLOURS = ("#2f81c8", "#e0701a", "#35a05a", "#d0438c", "#8a6fd1", "#a08040")
_DARK = re.compile(r"#(?:000000|555555|666666|010203|888888)\b")


@contextmanager
def plot(name: str, width: float, height: float) -> Iterator[tuple[Any, io.StringIO]]:
    """A figure of that size in inches; what is written is a piece of a page.

    On one page no two plots have the same name; the size is in inches.
    """
    mpl = load_matplotlib()
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    out = io.StringIO()
    # The salt makes names within the drawing, the same for the same plot.
    with mpl.rc_context({**_STYLE, "svg.hashsalt": name}):
        drawn = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasSVG(drawn)
        yield drawn, out
        as_written(drawn)
        written = io.StringIO()
        drawn.savefig(
            written,
            format="svg",
            metadata={"Date": None, "Creator": None, "Format": None, "Type": None},
        )
    out.write(_within_a_page(written.getvalue(), name))


def _within_a_page(svg: str, name: str) -> str:
    """Without the head of a file, in the colours of the text, names of its own."""
    body = svg[svg.index("<svg") :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    # It would be one of the whole page; the page's own has it for its plots.
    body = re.sub(r'<style type="text/css">.*?</style>', "", body, flags=re.DOTALL)
    opening, rest = body.split(">", 1)
    view = re.search(r'viewBox="([^"]+)"', opening)
    assert view is not None
    rest = _DARK.sub("currentColor", rest).replace(_GRID, "var(--grid)")
    # Groups are numbered alike in every drawing; names on a page must differ.
    rest = re.sub(r' id="(?!m|D|p|image|[a-z]+[0-9a-f]{8})[\w-]+"', "", rest)
    mark = re.sub(r"\W", "", name)
    rest = re.sub(r'(\bid="|"#|\(#)', rf"\g<1>{mark}-", rest)
    return (
        f'<svg class="plot" role="img" viewBox="{view[1]}" xmlns:xlink="http://www.w3.org/1999/xlink">'
        + re.sub(r"\s*\n\s*", "\n", rest)
    )
