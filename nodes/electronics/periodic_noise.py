"""Periodic Noise: a sinusoid over the picture, plain or modulated."""

import math

import numpy as np

from core.chain.engine import PlannedNode
from core.chain.step_lineage import Array, picture_step
from core.chain.wires import Image
from core.evaluation.recipes import Region, by_region, ends_lineage, pointwise
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.modules.preview import Axis, Curve, Plot, Preview, brief
from core.physics.noise.flicker_noise import periodic_pattern
from core.transfer.factors import Grid
from nodes.shared.module_ports import NoiseOutputs
from nodes.shared.steps import even

_BLOCK_SAMPLES = 1 << 16
_POINTS = 801  # of the preview
_PERIODS, _ENVELOPES = 6.0, 1.5
_MOST_PERIODS = 60.0  # more would be a grey area
_NO_NOISE = "no noise is added, because the amplitude is 0"


class PeriodicNoise(
    Module, key="periodic_noise", title="Periodic Noise", group="Electronics & Noise"
):
    """Add sinusoidal noise, such as pick-up from a power supply, optionally modulated in amplitude.

    The noise is amplitude·(1 + modulation·sin(2π(ξₘx + ηₘy) + φₘ))·sin(2π(ξx + ηy) + φ). The
    coordinates x and y are 0 at the first sample. Frequencies beyond Nyquist are aliased. An
    amplitude of 0 changes nothing. Source: Tantalo 1996, chapter 3.
    """

    formulas = (
        Formula(
            r"n=A\left[1+m\,\sin\left(2\pi(\xi_mx+\eta_my)+\phi_m\right)\right]\sin\left(2\pi("
            r"\xi x+\eta y)+\phi\right)",
            where="n: noise added to the picture; A: amplitude; m: modulation; x, y: mrad from the "
            "first sample",
        ),
    )

    amplitude: float = param(0.0, "amplitude, in the picture's unit", slider=(0, 10))
    xi: float = param(0.1, "horizontal frequency", unit="cyc/mrad", slider=(-1, 1))
    eta: float = param(0.0, "vertical frequency", unit="cyc/mrad", slider=(-1, 1))
    phase_deg: float = param(0.0, "phase at the first sample", slider=(-180, 180))
    modulation: float = param(0.0, "modulation depth", (0, 1))
    modulation_xi: float = param(
        0.01, "horizontal frequency of the modulation", unit="cyc/mrad", slider=(-1, 1)
    )
    modulation_eta: float = param(
        0.0, "vertical frequency of the modulation", unit="cyc/mrad", slider=(-1, 1)
    )
    modulation_phase_deg: float = param(
        0.0, "phase of the modulation at the first sample", slider=(-180, 180)
    )

    preview_lines = 9.5
    panel = (
        Section("Sinusoid", "amplitude xi eta phase_deg"),
        Section("Modulation", "modulation modulation_xi modulation_eta modulation_phase_deg"),
    )

    def run(self, image: Image, here: NodeContext) -> NoiseOutputs:
        if self.amplitude == 0.0:
            # No interval is needed where there is nothing to draw.
            flat = here.step(even, shape=image.shape, value=0.0)
            return NoiseOutputs(image, image.with_recipe(flat))
        pattern = here.step(drawn, grid=image.grid(), **self._pattern())
        total = here.step(with_pattern, image.recipe, pattern)
        return NoiseOutputs(image.with_recipe(total), image.with_recipe(pattern))

    def _pattern(self) -> dict[str, float]:
        values = self.values()
        for name in ("phase", "modulation_phase"):
            values[f"{name}_rad"] = math.radians(values.pop(f"{name}_deg"))
        return values

    def preview(self, _planned: PlannedNode, _work: Work, _here: NodeContext) -> Preview:
        if self.amplitude == 0:
            return Preview(_NO_NOISE, (_NO_NOISE,))
        end = self._end_mrad()
        places, start = np.linspace(0.0, end, _POINTS), np.zeros(1)
        size = 1.1 * abs(self.amplitude) * (1 + self.modulation)
        values = self._pattern()
        x = periodic_pattern(x_mrad=places, y_mrad=start, **values)
        y = periodic_pattern(x_mrad=start, y_mrad=places, **values)
        curves = Curve(places, x, name="x"), Curve(places, y, 1, "dashed", name="y")
        across = Axis(0.0, end, "distance from the first sample (mrad)")
        words = (
            f"sinusoid of amplitude {brief(self.amplitude)} at {brief(self.xi)} cyc/mrad "
            f"horizontally and {brief(self.eta)} vertically"
        )
        if self.modulation > 0:
            words += f", modulated by {brief(100 * self.modulation)} %"
        return Preview(words, (Plot(across, Axis(-size, size, "noise"), curves),))

    def _end_mrad(self) -> float:
        """How far it is drawn: some periods, or enough to see the modulation."""
        highest = max(abs(self.xi), abs(self.eta))
        end = _PERIODS / highest if highest > 0 else 100.0
        slow = [f for f in (abs(self.modulation_xi), abs(self.modulation_eta)) if f > 0]
        if self.modulation > 0 and slow:
            end = max(end, _ENVELOPES / max(slow))
        return min(end, _MOST_PERIODS / highest) if highest > 0 else end


@ends_lineage
@by_region(lambda *, grid, **_: grid.shape)
def drawn(work: Work, region: Region, *, grid: Grid, **values: float) -> Array:
    pattern = np.empty(region.shape, work.policy.dtype)
    rows, columns = region.slices
    x_mrad = np.arange(columns.start, columns.stop) * grid.interval_x_mrad
    y_mrad = np.arange(rows.start, rows.stop)[:, np.newaxis] * grid.interval_y_mrad

    def block(lines: slice) -> None:
        pattern[lines] = periodic_pattern(x_mrad=x_mrad, y_mrad=y_mrad[lines], **values)

    step = max(1, _BLOCK_SAMPLES // region.columns)
    work.for_each(block, [slice(start, start + step) for start in range(0, region.rows, step)])
    return pattern


@picture_step(noise=lambda at, *_: [at.known("periodic")])
@pointwise
def with_pattern(work: Work, image: Array, noise: Array) -> Array:
    return np.add(image, noise, dtype=work.policy.dtype)
