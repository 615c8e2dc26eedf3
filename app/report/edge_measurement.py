"""The chain judged by measurement: an edge replaces the source, and the final picture is measured.

Every noise is left out. An upright edge is measured as Tantalo did, by the mean of rows, one turned
by 5° as in ISO 12233.
"""

import math
from collections.abc import Iterable
from itertools import product
from typing import Any, Literal

import numpy as np

from app.report import html_page as html
from app.report.drawing.picture_drawing import COLOURS, figure, named, short
from app.run.evaluation import Evaluation
from core.arrays import Array, Vector
from core.chain.random_fields import Remaking
from core.chain.step_lineage import Axis, Linear, lineage_of, source_step
from core.chain.wires import Image
from core.errors import FAULTS, DataError, ImagechainError
from core.evaluation.recipes import Recipe, Region, Step
from core.evaluation.work import Work
from core.physics.measurement.row_average import row_average
from core.physics.measurement.slanted_edge import falls_to
from core.physics.numerics import sinc
from core.physics.sampling.detector_sampling import folded
from core.transfer.factors import factor_at
from nodes.analysis.lineage import ImageTransfer, transfer_of
from nodes.analysis.measured_mtf import Measured, measured_rows, measured_slanted
from nodes.scenes.draw import draw_target
from nodes.scenes.scene_canvas import Canvas
from nodes.transform.resampling import InterpolationMTF

Fact = dict[str, Any]
Direction = Literal["horizontal", "vertical"]
Method = Literal["slanted_edge", "row_average"]

SLANT_DEG = 5.0
_SAMPLES = 257
_SMALL = 64  # samples: a picture no wider is measured whole
_DIRECTIONS: tuple[Direction, ...] = ("horizontal", "vertical")
_METHODS: tuple[Method, ...] = ("slanted_edge", "row_average")
_METHOD_WORDS = {"slanted_edge": "slanted edge", "row_average": "row average"}
_LOOKS = {"slanted_edge": (COLOURS[0], "o", "k", "-"), "row_average": (COLOURS[1], "^", "k", ":")}
_MARKS = 32  # of measured points along a curve
_NO_ERROR = 5e-7


def judged_facts(evaluation: Evaluation) -> dict[str, Any]:
    """Every way to measure, each with its figures or the reason why it has none."""
    reason, silenced = _reason(evaluation), set[str]()
    if reason is not None:
        return {"reason": reason, "measurements": []}
    source, picture = evaluation.chain.sources[0], str(evaluation.chain.final)
    scene: Image = evaluation.plan.output(source)
    image: Image = evaluation.plan.output(picture)
    try:
        chain = _Chain(scene, image, silenced)
    except ImagechainError as error:
        return {"reason": str(error), "measurements": []}
    work = evaluation.engine.work(evaluation.work.policy)
    measurements = []
    for direction, method in product(_DIRECTIONS, _METHODS):
        evaluation.work.check()
        measurements.append(_measurement(chain, work, direction, method))
    grid, responses = image.grid(), evaluation.responses
    intervals = dict(zip(_DIRECTIONS, (grid.interval_x_mrad, grid.interval_y_mrad), strict=True))
    whole = responses.products[-1]
    lines = (responses.xi, whole.x.mtf), (responses.eta, whole.y.mtf)
    return {
        "reason": None,
        "source": source,
        "picture": picture,
        "silenced": tuple(name for name in evaluation.plan.nodes if name in silenced),
        "interval_mrad": intervals,
        # Modulus of the stages' product, by cycles per sample of the picture.
        "stages": {
            name: {"frequency_cyc_per_sample": frequency * intervals[name], "mtf": np.abs(mtf)}
            for name, (frequency, mtf) in zip(_DIRECTIONS, lines, strict=True)
        },
        "measurements": measurements,
    }


def _reason(evaluation: Evaluation) -> str | None:
    chain = evaluation.chain
    if evaluation.work.blocks is not None:
        return (
            "the pictures are computed in blocks, but edges can only be measured in whole pictures"
        )
    if chain.final is None:
        return "the network has no final picture"
    if not chain.cascade:
        return f"the final picture, {chain.final}, is not the end of a chain of transfer functions"
    if len(chain.sources) != 1:
        sources = ", ".join(chain.sources)
        return (
            f"{chain.final} comes from more than one picture ({sources}): one edge cannot replace "
            "all of them"
        )
    source = chain.sources[0]
    bands = evaluation.plan.output(source).bands
    if bands is not None:
        return (
            f"{source} has {bands.count} wavelength bands, but the edge that would replace it has "
            "only one"
        )
    return None


class _Chain:
    def __init__(self, scene: Image, image: Image, silenced: set[str]) -> None:
        self.scene = scene
        self.final = image
        self._silenced = silenced
        passed = transfer_of(self.picture(0.0))
        if passed.source.key != self.edge(0.0).key:
            raise DataError(f"{passed.source.node or 'a node'} has no known transfer function")

    def edge(self, angle_deg: float) -> Step:
        """The edge, its normal turned by this from across towards along."""
        scene = self.scene
        return Step.of(
            edge_drawn, scene.recipe, width=scene.columns, height=scene.rows, angle_deg=angle_deg
        )

    def picture(self, angle_deg: float) -> Image:
        def change(recipe: Recipe) -> Recipe | None:
            if recipe.key == self.scene.recipe.key:
                return self.edge(angle_deg)
            lineage = lineage_of(recipe)
            if lineage is None or lineage.noise is None or lineage.picture is None:
                return None
            if lineage.linear.by_chance:
                raise DataError(lineage.linear.by_chance)
            self._silenced.add(recipe.node or "")
            return made.of(lineage.picture)

        made = Remaking(change)
        return self.final.with_recipe(made.of(self.final.recipe))


@source_step(area_means=True)
def edge_drawn(work: Work, scene: Array, *, width: int, height: int, angle_deg: float) -> Array:
    low, high = float(scene.min()), float(scene.max())
    if low == high:
        high = low + (0.1 * abs(low) or 1.0)
    canvas = Canvas(width, height, work.policy.dtype, work.for_each)
    return draw_target("slanted_edge", canvas, background=low, signal=high, angle_deg=angle_deg)


def _measurement(chain: _Chain, work: Work, direction: Direction, method: Method) -> dict[str, Any]:
    """One measurement beside what was to be expected, from 0 to Nyquist."""
    facts = {"direction": direction, "method": method, "reason": None}
    measure = _slanted if method == "slanted_edge" else _rows
    try:
        measured, expected = measure(chain, work, direction)
    except FAULTS as error:  # the run itself has not failed
        return facts | {"reason": str(error)}
    inside = measured.frequency <= 0.5
    per_mrad = measured.per_mrad
    assert per_mrad is not None

    def scaled(value: float | None) -> float | None:
        return None if value is None else value * per_mrad

    away = (measured.mtf - expected)[inside]
    largest = int(np.argmax(np.abs(away)))
    expected_mtf50 = falls_to(frequency=measured.frequency, mtf=expected, level=0.5)
    return facts | {
        "angle_deg": measured.angle_deg,
        "frequency_cyc_per_sample": measured.frequency[inside],
        "mtf": measured.mtf[inside],
        "mtf_error": measured.error[inside],
        "expected": expected[inside],
        "mtf50_cyc_per_mrad": scaled(measured.mtf50[0]),
        "mtf50_error_cyc_per_mrad": scaled(measured.mtf50[1]),
        "expected_mtf50_cyc_per_mrad": scaled(expected_mtf50),
        "nyquist_cyc_per_mrad": 0.5 * per_mrad,
        "at_nyquist": measured.nyquist[0],
        "at_nyquist_error": measured.nyquist[1],
        "expected_at_nyquist": float(expected[inside][-1]),
        "largest_difference": float(away[largest]),
        "largest_difference_at_cyc_per_mrad": float(measured.frequency[largest]) * per_mrad,
    }


def _slanted(chain: _Chain, work: Work, direction: Direction) -> tuple[Measured, Vector]:
    image = chain.picture(SLANT_DEG if direction == "horizontal" else 90.0 - SLANT_DEG)
    where = _middle(image, direction)
    how = _settings(image, where, direction) | {"window": "tukey", "samples": _SAMPLES}
    measured: Measured = work.value(Step.of(measured_slanted, image.recipe, **how))
    turned = math.radians(measured.angle_deg)
    # How much of the picture the edge runs through.
    if direction == "horizontal":
        seen_x = abs(math.tan(turned)) * where.rows / image.columns
        seen_y = where.rows / image.rows
    else:
        seen_x = where.columns / image.columns
        seen_y = abs(math.tan(math.pi / 2 - turned)) * where.columns / image.rows
    f = measured.frequency
    waves = f * math.cos(turned), f * math.sin(turned)
    return measured, expected_mtf(transfer_of(image), work, waves, (seen_x, seen_y))


def _rows(chain: _Chain, work: Work, direction: Direction) -> tuple[Measured, Vector]:
    across = direction == "horizontal"
    angle_deg = 0.0 if across else 90.0
    image = chain.picture(angle_deg)
    where = _middle(image, direction)
    samples = chain.scene.columns if across else chain.scene.rows
    row = edge_row(work, image.recipe, chain.edge(angle_deg), "x" if across else "y", samples)
    first, count = (where.left, where.columns) if across else (where.top, where.rows)
    one = row_average(picture=np.tile(row[first : first + count], (2, 1)))
    # Given, not measured: where a tenth of the step is left, rounding can move them by a sample.
    how = _settings(image, where, direction) | {"clip_left": one.left, "clip_right": one.right}
    measured: Measured = work.value(Step.of(measured_rows, image.recipe, **how))
    return measured, one.mtf


def _settings(image: Image, where: Region, direction: Direction) -> dict[str, Any]:
    intervals = image.interval_x_mrad, image.interval_y_mrad
    return {"where": where, "intervals": intervals, "direction": direction, "target": "edge"}


def _middle(image: Image, direction: Direction) -> Region:
    """Half of the picture across the edge, three quarters along it: the more places it crosses."""
    shares = (2, 4 / 3) if direction == "horizontal" else (4 / 3, 2)
    width, height = (
        max(int(size / share), min(size, _SMALL))
        for size, share in zip((image.columns, image.rows), shares, strict=True)
    )
    return Region((image.rows - height) // 2, (image.columns - width) // 2, height, width)


# The MTF that a slanted edge in the final picture should show: every step from the scene to it.
#
# The stages' product is not all there is to it. A sample of the scene is a mean over its area,
# pixels are combined, a frame grabber interpolates: each blurs too.


def expected_mtf(
    passed: ImageTransfer, work: Work, waves: tuple[Vector, Vector], seen: tuple[float, float]
) -> Vector:
    """Modulus of all steps at pairs of frequencies in cycles per sample of the final picture.

    An interpolated picture differs from place to place: what counts is the mean over the shares of
    the frame's width and height, about its middle, that are seen.
    """
    xi, eta = waves[0] / passed.grid.interval_x_mrad, waves[1] / passed.grid.interval_y_mrad
    scene = passed.source_grid
    fx, fy = xi * scene.interval_x_mrad, eta * scene.interval_y_mrad
    total = sinc(fx) * sinc(fy)  # samples of the scene are means over their area
    # A filter of samples repeats itself beyond their Nyquist frequency.
    within = folded(fx) / scene.interval_x_mrad, folded(fy) / scene.interval_y_mrad
    for factor in passed.factors:
        if factor.part != "mtf":
            continue
        work.check()
        if isinstance(factor, InterpolationMTF):
            if factor.x is not None:
                total = total * factor.mean_over(factor.x, xi, seen[0])
            if factor.y is not None:
                total = total * factor.mean_over(factor.y, eta, seen[1])
        else:
            total = total * factor_at(work, factor, *within)
    return np.asarray(np.abs(total), np.float64)


# What the thesis' row average of an upright edge should show, computed in one dimension.
#
# The edge lies at one place among the samples. What they cannot show of it beyond their Nyquist
# frequency is folded back, and an interpolated picture differs from place to place: no product of
# MTFs gives what is measured. But all rows are alike, so that one of them is soon followed through
# every step, and measured in the same way.


def edge_row(work: Work, recipe: Recipe, source: Recipe, axis: Axis, samples: int) -> Vector:
    """A row, or column, of a picture whose source is an edge through the middle of `samples`."""
    changes: list[Linear] = []
    while recipe.key != source.key:
        lineage = lineage_of(recipe)
        if lineage is None or lineage.picture is None:
            raise DataError(f"the effect of {recipe.node} on the picture is unknown")
        changes.append(lineage.linear)
        recipe = lineage.picture
    row = np.clip(np.arange(samples) + 1.0 - samples / 2, 0.0, 1.0)
    for change in reversed(changes):
        row = change.row(work, row, axis)
    return np.asarray(row, np.float64)


def judged(facts: Fact) -> str:
    edges, drawn_as = facts["judged"], facts["drawn_as"]
    blocks = html.heading(2, "Checked by measurement")
    if edges["reason"]:
        return blocks + html.paragraph(f"Not measured: {edges['reason']}.")
    good = [measurement for measurement in edges["measurements"] if measurement["reason"] is None]
    if good:
        blocks += html.paragraph(_introduction(edges))
        caption = _caption(drawn_as.get("judged"))
        blocks += html.drawn(judged_png(edges), caption, "measured and expected MTF")
        blocks += _table(good)
    for measurement in edges["measurements"]:
        if measurement["reason"] is not None:
            what = f"{measurement['direction']}, {_METHOD_WORDS[measurement['method']]}"
            blocks += html.paragraph(f"Not measured ({what}): {measurement['reason']}.")
    return blocks


def _introduction(edges: Fact) -> str:
    text = (
        f"An edge between the lowest and the highest value of {edges['source']} replaces this "
        f"picture and passes through the whole chain. The MTF is measured in {edges['picture']}"
    )
    if edges["silenced"]:
        text += f", without the noise of {', '.join(edges['silenced'])}"
    return text + "."


def _caption(published: str | None) -> str:
    text = (
        "MTF measured (marks, with their standard errors) and expected (lines). For the slanted "
        "edge, the expected MTF is the product of the stages' MTFs and the MTF of sampling (sample "
        "area in the scene, pixel combining, interpolation along the edge). "
        "Because of aliasing, the measured MTF scatters about the expected MTF. "
        "The row average samples a vertical edge at a single "
        "position relative to the pixels, so frequencies beyond the pixels' Nyquist frequency are "
        "aliased. The row average also takes differences between neighbours, which multiply the "
        "MTF by 0.64 at Nyquist. The expected MTF of the row average is computed along one row "
        "and includes this aliasing."
    )
    if published:
        text += (
            " The row average is the method of the thesis. The thesis gives no numbers for "
            "its curves from pictures of real cameras, so they are not drawn here."
        )
    return named(text, published)


def judged_png(edges: Fact) -> bytes:
    """Horizontal and vertical MTF beside each other, in cycles per sample of the picture."""
    with figure(10.0, 4.6) as (drawn, out):
        axes = drawn.subplots(1, 2, sharey=True)
        lines: dict[str, Any] = {}
        for axis, direction in zip(axes, ("horizontal", "vertical"), strict=True):
            _panel(axis, edges, direction)
            axis.set_title(f"{direction.capitalize()} MTF")
            interval = edges["interval_mrad"][direction]
            axis.set_xlabel(f"frequency (cycles/sample of {short(interval)} mrad)")
            handles, labels = axis.get_legend_handles_labels()
            lines |= dict(zip(labels, handles, strict=True))
        axes[0].set_ylabel("MTF")
        drawn.legend(lines.values(), lines.keys(), loc="outside lower center", ncols=3, fontsize=8)
    return out.getvalue()


def _panel(axis: Any, edges: Fact, direction: str) -> None:
    stages = edges["stages"][direction]
    x = stages["frequency_cyc_per_sample"]
    inside = x <= 0.5 + 1e-9
    y = stages["mtf"][inside]
    axis.plot(x[inside], y, color="#999999", lw=1.2, ls="--", label="stages alone")
    highest = 1.0
    for measurement in edges["measurements"]:
        if measurement["direction"] != direction or measurement["reason"] is not None:
            continue
        colour, mark, line, dash = _LOOKS[measurement["method"]]
        name = _METHOD_WORDS[measurement["method"]]
        frequency = measurement["frequency_cyc_per_sample"]
        y = measurement["expected"]
        axis.plot(frequency, y, color=line, ls=dash, lw=1.4, label=f"expected for the {name}")
        few = slice(None, None, max(1, len(frequency) // _MARKS))
        x, y, error = frequency[few], measurement["mtf"][few], measurement["mtf_error"][few]
        axis.errorbar(
            x, y, error, fmt=mark, ms=3.6, color=colour, mfc="none", mew=1.0, elinewidth=0.8,
            label=f"measured, {name}",
        )  # fmt: skip
        highest = max(highest, float(y.max()))
    axis.axhline(0, color="#555555", lw=0.8)
    axis.set_ylim(-0.03, highest * 1.06)
    axis.set_xlim(0.0, 0.51)


def _table(measurements: Iterable[Fact]) -> str:
    rows = [
        (
            measurement["direction"],
            _METHOD_WORDS[measurement["method"]],
            _with_error(measurement["mtf50_cyc_per_mrad"], measurement["mtf50_error_cyc_per_mrad"]),
            short(measurement["expected_mtf50_cyc_per_mrad"]),
            _with_error(measurement["at_nyquist"], measurement["at_nyquist_error"]),
            short(measurement["expected_at_nyquist"]),
            short(measurement["largest_difference"], 2),
            short(measurement["largest_difference_at_cyc_per_mrad"], 3),
        )
        for measurement in measurements
    ]
    heads = (
        "direction", "edge", "MTF50 (cyc/mrad)", "expected", "MTF at Nyquist", "expected",
        "largest difference", "at (cyc/mrad)",
    )  # fmt: skip
    return html.report_grid(heads, rows, numbers=range(2, 8))


def _with_error(value: float | None, error: float | None) -> str:
    """A figure with its standard error, where that is more than rounding."""
    text = short(value)
    known = value is not None and error is not None and error > _NO_ERROR
    return f"{text} ± {short(error, 2)}" if known else text
