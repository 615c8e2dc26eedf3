"""What a module's example makes, drawn: curves, pictures before and after, read-outs."""

import base64
import html
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.handbook.module_examples import IT, NO_EXAMPLE, SHIPPED, example_network
from app.report.drawing.curves import draw_on
from app.report.drawing.picture_drawing import figure, number
from app.run.saving import encode_png, grey_levels, robust_limits
from core.chain.engine import Engine, Plan
from core.chain.wires import Curve, CurveData, Image, Pupil, Series, Transfer
from core.errors import ImagechainError, in_line
from core.evaluation.work import Policy, Work
from core.modules.declaration import Declaration

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
        return Example(reason=f"The example on this page failed: {kind}{in_line(str(error))}.")
    return example


def _draw(example: Example, declared: Declaration, engine: Engine, plan: Plan, work: Work) -> None:
    outputs = plan.nodes[IT].outputs
    shown = example.figures
    for name in ("mtf", "ptf"):
        if isinstance(outputs.get(name), Transfer):
            drawing = _transfer(outputs[name], engine.value(plan, f"{IT}.{name}", work))
            shown += [drawing] if drawing else []
    drawn = [name for name, value in outputs.items() if isinstance(value, Curve)]
    for name in drawn[:_MOST_CURVES]:
        data = engine.value(plan, f"{IT}.{name}", work)
        shown.append(curves(data, data.title))
    for name, value in outputs.items():
        if isinstance(value, Pupil):
            samples = engine.value(plan, f"{IT}.{name}", work)
            shown.append(picture(np.abs(samples), "the pupil; white areas transmit light"))
    if declared.key == "init_trans":
        spectrum = np.fft.fftshift(np.abs(engine.value(plan, f"{IT}.magnitude", work)))
        shown.append(picture(np.log(spectrum + 1e-6), "logarithm of the magnitude"))
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
        picture(samples, f"after ({made.unit or 'no unit'})", limits if same else None),
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


def _transfer(value: Transfer, samples: Samples) -> str:
    """A transfer function across and along; nothing of a phase that is 0."""
    if np.iscomplexobj(samples):
        samples = np.abs(samples)
    rows, columns = samples.shape
    grid = value.grid
    xi = np.arange(columns // 2 + 1) * grid.frequency_interval_x
    eta = np.arange(rows // 2 + 1) * grid.frequency_interval_y
    across, along = samples[0, : len(xi)], samples[: len(eta), 0]
    title = value.part.upper()
    if value.part == "ptf":
        # Of the last frequency of an even size only the real part acts.
        xi, across, eta, along = xi[:-1], across[:-1], eta[:-1], along[:-1]
        if max(np.abs(across).max(), np.abs(along).max()) < _SMALLEST_PHASE:
            return ""
    alike = bool(np.abs(np.interp(xi, eta, along) - across).max() < _ALIKE)
    series = [Series("horizontal and vertical" if alike else "horizontal (ξ)", xi, across)]
    series += [] if alike else [Series("vertical (η)", eta, along)]
    unit = " (rad)" if value.part == "ptf" else ""
    return curves(CurveData(title, "cycles/mrad", title + unit, tuple(series)), title)


def _means(samples: Samples, size: int) -> Samples:
    """Means of blocks; rows and columns left over are dropped."""
    if size < 2:
        return samples
    rows, columns = samples.shape[0] // size, samples.shape[1] // size
    blocks = samples[: rows * size, : columns * size].reshape(rows, size, columns, size)
    return np.asarray(blocks.mean(axis=(1, 3)))


def curves(data: CurveData, caption: str) -> str:
    """Curves or bars as a piece of a page."""
    rows = -(-len(data.series) // 2) if len(data.series) > 1 else 0
    bars = 0.24 * len(data.bars) * len(data.series) + 0.8 if data.bars else 0.0
    with figure(_WIDE, max(_HIGH, bars) + 0.2 * rows) as (drawn, out):
        draw_on(drawn.subplots(), data)
        if len(data.series) > 1:
            drawn.legend(loc="outside lower center", ncols=2, fontsize=7.5)
    return png_figure(out.getvalue(), caption, "curve")


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
