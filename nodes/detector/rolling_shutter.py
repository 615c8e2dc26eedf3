"""Rolling Shutter: lines are exposed one after the other while the image moves."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import Region, Seen, by_region
from core.evaluation.work import Work
from core.modules.declaration import Caution, Formula, NodeContext, param, readout, warning
from core.physics.detector.readout import REACH, sinc_weights
from core.transfer.factors import Edges
from nodes.shared.context_defaults import pitch_in_samples
from nodes.shared.module_ports import BeforeDigits, ImageOutput
from nodes.shared.steps import stepped
from nodes.transform.interpolate import within_frame

_AROUND = np.arange(1 - REACH, REACH + 1)
_BLOCK = 64  # rows


class RollingShutter(
    BeforeDigits, key="rolling_shutter", title="Rolling Shutter", group="Detector"
):
    """Skew and stretch the picture: lines are exposed in turn while the image moves.

    The top line is exposed first. Velocities refer to the image on the detector, in pixels per
    second. Put this module before Sample Pixels or Combine Pixels: all samples of a line of pixels
    are exposed together. Put modules that add noise after Rolling Shutter. A windowed sinc
    interpolates between samples. Detail above 70 % of the samples' Nyquist frequency loses
    contrast, and sharp edges show ringing. Beyond its edges, the frame is extended as in
    Interpolate. Use Relative Motion MTF for the blur within one exposure. Predicted MTFs and
    budgets assume an image at rest. Source: Liang, Chang and Chen 2008, IEEE Transactions on Image
    Processing 17, 1323.
    """

    formulas = (
        Formula(
            r"L'(x,y)=L\left(x-v_xt_ln,\;y-v_yt_ln\right)",
            where="x, y: pixels to the right and down; n: line number, 0 at the top; v: image "
            "velocity; t_l: line_time_s",
        ),
    )

    image_velocity_x: float = param(
        0.0, "velocity of the image to the right", (-1e6, 1e6), unit="px/s", slider=(-5000, 5000)
    )
    image_velocity_y: float = param(
        0.0, "velocity of the image downwards", (-1e6, 1e6), unit="px/s", slider=(-5000, 5000)
    )
    line_time_s: float = param(2e-5, "time from one line to the next", (0, 1), slider=(0, 1e-4))

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        steps = [self.line_time_s * v for v in (self.image_velocity_x, self.image_velocity_y)]
        if steps == [0.0, 0.0]:
            return ImageOutput(image)
        x, y = (max(1.0, pitch_in_samples(axis, image) or 1.0) for axis in ("x", "y"))
        how = {"step_x": steps[0] * x, "step_y": steps[1] * y, "line": y, "edges": image.edges}
        step = here.step(skewed, image.recipe, shape=image.shape, **how)
        return ImageOutput(stepped(image, step))

    @warning
    def away(self, image: Image) -> Caution | None:
        """The image leaves the frame before the last line is exposed."""
        for axis, samples in (("x", image.columns), ("y", image.rows)):
            velocity = getattr(self, f"image_velocity_{axis}")
            moved = abs(velocity) * self.line_time_s * self._lines(image)
            pixels = samples / max(1.0, pitch_in_samples(axis, image) or 1.0)
            if moved >= pixels:
                return Caution(
                    "the image leaves the frame before the last line is exposed: it moves "
                    f"{moved:.4g} pixels along {axis} in a frame of {pixels:.4g} pixels",
                    f"check image_velocity_{axis} = {velocity:g} px/s and line_time_s = "
                    f"{self.line_time_s:g} s",
                )
        return None

    @readout("px")
    def skew_px(self, image: Image) -> float:
        """Shift of the last line to the right, relative to the first."""
        return self.image_velocity_x * self.line_time_s * self._lines(image)

    def _lines(self, image: Image) -> float:
        return float((image.rows - 0.5) // max(1.0, pitch_in_samples("y", image) or 1.0))


@picture_step()
@by_region(lambda _, *, shape, **__: shape, lambda region, shape: region.rows / shape[0])
def skewed(
    work: Work,
    region: Region,
    picture: Seen,
    *,
    shape: tuple[int, int],
    step_x: float,
    step_y: float,
    line: float,
    edges: Edges | None,
) -> Array:
    rows, columns = shape
    here = np.arange(region.top, region.bottom)
    lines = (here + 0.5) // line
    base, along = _taps(here - step_y * lines)
    above = within_frame(base[:, np.newaxis] + _AROUND, rows, edges)
    left, across = _taps(-step_x * lines)
    wanted = np.unique(above)
    runs = np.split(wanted, np.flatnonzero(np.diff(wanted) > 1) + 1)
    parts = [picture(Region(int(run[0]), 0, len(run), columns)) for run in runs]
    source = parts[0] if len(parts) == 1 else np.concatenate(parts)
    places = np.searchsorted(wanted, above)
    made: Array = np.empty((region.rows, region.columns), work.policy.dtype)

    def block(start: int) -> None:
        for row in range(start, min(start + _BLOCK, len(made))):
            seen = _weighted(source[places[row]], along[row])
            beyond = np.arange(_AROUND[0], columns + REACH) + left[row]
            seen = seen[within_frame(beyond, columns, edges)]
            whole = _weighted(sliding_window_view(seen, columns), across[row])
            made[row] = whole[region.slices[1]]

    work.for_each(block, range(0, len(made), _BLOCK))
    return made


def _taps(places: Array) -> tuple[Array, Array]:
    base = np.floor(places)
    return base.astype(np.int64), sinc_weights(fraction=places - base)


def _weighted(lines: Array, weights: Array) -> Array:
    total = np.zeros(lines.shape[1])
    for line, weight in zip(lines, weights, strict=True):
        if weight:
            total += weight * line
    return total
