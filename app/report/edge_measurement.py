"""The chain judged by measurement: an edge runs through it, and its final picture is measured.

The source's picture is replaced by an edge of the same size, field and band, from its lowest to its
highest value, and every noise is left out; all else is the network's own. An upright edge is
measured as Tantalo did, by the mean of rows, one turned by 5° as in ISO 12233.
"""

from __future__ import annotations

import math
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.run.evaluation import Evaluation
from core.chain.frame_sequence import Remaking
from core.chain.linear_change import Axis, Linear, PlaceDependent
from core.chain.step_lineage import lineage_of, source_step
from core.chain.wires import Image
from core.errors import Cancelled, DataError, ImagechainError
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work
from core.physics.measurement.edges.row_average import row_average
from core.physics.measurement.edges.slanted_edge import falls_to
from core.physics.numerics import sinc
from core.physics.sampling.interpolation import folded
from core.transfer.factors import factor_at
from nodes.analysis.lineage import ImageTransfer, transfer_of
from nodes.analysis.mtf_measuring import Measured, Rectangle, measured_rows, measured_slanted
from nodes.scenes.scene_canvas import Canvas
from nodes.scenes.scene_targets import draw_target

Array = NDArray[Any]
Vector = NDArray[np.float64]
Direction = Literal["horizontal", "vertical"]
Method = Literal["slanted_edge", "row_average"]

SLANT_DEG = 5.0
_SAMPLES = 257
_SMALL = 64  # samples: a picture no wider is measured whole
_DIRECTIONS: tuple[Direction, ...] = ("horizontal", "vertical")
_METHODS: tuple[Method, ...] = ("slanted_edge", "row_average")


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
            "the pictures are computed in blocks, but edges can be measured only in whole pictures"
        )
    if chain.final is None:
        return "the network has no final picture"
    if not chain.cascade:
        return f"no chain of transfer functions ends in the final picture, {chain.final}"
    if len(chain.sources) != 1:
        sources = ", ".join(chain.sources)
        return (
            f"{chain.final} comes from more than one picture ({sources}): one edge cannot "
            "replace them all"
        )
    source = chain.sources[0]
    bands = evaluation.plan.output(source).bands
    if bands is not None:
        return (
            f"{source} has {bands.count} wavelength bands, but the edge that would replace "
            "it has one"
        )
    return None


class _Chain:
    def __init__(self, scene: Image, image: Image, silenced: set[str]) -> None:
        self.scene = scene
        self.final = image
        self._silenced = silenced
        passed = transfer_of(self.picture(0.0))
        if passed.source.key != self.edge(0.0).key:
            raise DataError(
                f"the effect of {passed.source.node or 'a node'} on the picture is not a known "
                "transfer function"
            )

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
            if lineage is None or lineage.noise is None:
                return None
            if lineage.linear.by_chance:
                raise DataError(lineage.linear.by_chance)
            self._silenced.add(recipe.node or "")
            return made.of(lineage.noise.picture)

        made = Remaking(change)
        return self.final.with_recipe(made.of(self.final.recipe))


@source_step(area_means=True)
def edge_drawn(work: Work, scene: Array, *, width: int, height: int, angle_deg: float) -> Array:
    """An edge through the middle, from the scene's lowest to its highest value."""
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
    except Cancelled:
        raise
    except ImagechainError as error:  # the run itself has not failed
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
        "mtf50_cyc_per_mrad": scaled(measured.mtf50.value),
        "mtf50_error_cyc_per_mrad": scaled(measured.mtf50.error),
        "expected_mtf50_cyc_per_mrad": scaled(expected_mtf50),
        "nyquist_cyc_per_mrad": 0.5 * per_mrad,
        "at_nyquist": measured.nyquist.value,
        "at_nyquist_error": measured.nyquist.error,
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
        seen_x = abs(math.tan(turned)) * where.height / image.columns
        seen_y = where.height / image.rows
    else:
        seen_x = where.width / image.columns
        seen_y = abs(math.tan(math.pi / 2 - turned)) * where.width / image.rows
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
    first, count = (where.left, where.width) if across else (where.top, where.height)
    one = row_average(picture=np.tile(row[first : first + count], (2, 1)))
    # Given, not measured: where a tenth of the step is left, rounding can move them by a sample.
    how = _settings(image, where, direction) | {"clip_left": one.left, "clip_right": one.right}
    measured: Measured = work.value(Step.of(measured_rows, image.recipe, **how))
    return measured, one.mtf


def _settings(image: Image, where: Rectangle, direction: Direction) -> dict[str, Any]:
    intervals = image.interval_x_mrad, image.interval_y_mrad
    return {"where": where, "intervals": intervals, "direction": direction, "target": "edge"}


def _middle(image: Image, direction: Direction) -> Rectangle:
    """Half of the picture across the edge, three quarters along it: the more places it crosses.

    Not all: beyond the frame the edge is mirrored.
    """
    shares = (2, 4 / 3) if direction == "horizontal" else (4 / 3, 2)
    width, height = (
        max(int(size / share), min(size, _SMALL))
        for size, share in zip((image.columns, image.rows), shares, strict=True)
    )
    return Rectangle((image.columns - width) // 2, (image.rows - height) // 2, width, height)


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
        if isinstance(factor, PlaceDependent):
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
            raise DataError(f"the effect of {recipe.node} on the picture is not known")
        changes.append(lineage.linear)
        recipe = lineage.picture
    row = np.clip(np.arange(samples) + 1.0 - samples / 2, 0.0, 1.0)
    for change in reversed(changes):
        row = change.row(work, row, axis)
    return np.asarray(row, np.float64)
