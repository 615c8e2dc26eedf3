"""Image Quality: the interpretability of a picture by the image quality equations."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from core.chain.wires import Context, Curve, Image, Table
from core.evaluation.recipes import Recipe, Step, ends_lineage
from core.evaluation.work import Work
from core.modules.caution import Caution
from core.modules.declaration import Module, NodeContext, warning
from core.modules.formula import Formula
from core.modules.panel_sections import Section
from core.modules.parameters import Param
from core.physics.electrons.photon_conversion import SHORTEST_THERMAL_UM
from nodes.analysis.lineage import NoiseOf, transfer_of
from nodes.analysis.merit.edge_quality import (
    View,
    edge_curve,
    edge_quality,
    limits_caution,
    quality_table,
    signal_over_noise,
)
from nodes.shared.context_defaults import given, with_interval
from nodes.shared.table_figures import table_figure


class QualityOutputs(NamedTuple):
    """Edge responses, and the equations with what they are made of."""

    edge: Curve
    table: Table


@ends_lineage
def typed_snr(work: Work, *, snr: float) -> float:
    """The SNR that is typed in."""
    return snr


class ImageQuality(Module, key="image_quality", title="Image Quality", group="Analysis"):
    """Estimate the interpretability (NIIRS) of a picture by GIQE 3, 4 and 5.

    Ground sample distance is the picture's interval times the range, stretched along by the view
    off nadir. The relative edge response (how far an edge rises within a sample about it) and the
    overshoot H (its height 1 to 3 samples beside it) follow from the chain's transfer functions,
    the SNR from its mean signal and temporal noise: nothing is drawn or measured. All are geometric
    means across and along. Connect the picture as the sensor samples it, before a frame grabber
    interpolates it.

    GIQE 3: 11.81 + 3.32·lg(RER/GSD) − 1.48·H − G/SNR. GIQE 4: 10.251 − a·lg GSD + b·lg RER −
    0.656·H − 0.344·G/SNR (a = 3.32, b = 1.559; below an RER of 0.9, a = 3.16, b = 2.817). GIQE 5:
    9.57 − 3.32·lg GSD + 3.32·(1 − e^(−1.9/SNR))·lg RER − 2·lg⁴ RER − 1.8/SNR. GSD in inches. The
    first two are of sharpened pictures, with the noise gain G of the sharpening. Fitted to visible
    pictures with GSD 3 to 80 inches, RER 0.2 to 1.3, H 0.9 to 1.9 and SNR 2 to 130 (version 4; the
    limits of the others could not be checked): a warning names what lies beyond.

    Sources: Leachtenauer et al. 1997, Appl. Opt. 36, 8322 (GIQE 3 and 4); Harrington et al. 2015
    (GIQE 5).
    """

    formulas = (
        Formula(
            r"\mathrm{NIIRS}=11.81+3.32\,\lg\frac{\mathrm{RER}}{\mathrm{GSD}}-1.48\,H-\frac{G}{"
            r"\mathrm{SNR}}",
            where="GSD: inches; RER: relative edge response; H: overshoot; G: noise gain of the "
            "sharpening",
            when="GIQE 3",
        ),
        Formula(
            r"\mathrm{NIIRS}=10.251-a\,\lg\mathrm{GSD}+b\,\lg\mathrm{RER}-0.656\,H-\frac{0.344"
            r"\,G}{\mathrm{SNR}}",
            where="a = 3.32, b = 1.559; below an RER of 0.9 a = 3.16, b = 2.817",
            when="GIQE 4",
        ),
        Formula(
            r"\mathrm{NIIRS}=9.57-3.32\,\lg\mathrm{GSD}+3.32\left(1-e^{-1.9/\mathrm{SNR}}"
            r"\right)\lg\mathrm{RER}-2\,\lg^4\mathrm{RER}-\frac{1.8}{\mathrm{SNR}}",
            when="GIQE 5",
        ),
        Formula(
            r"E(d)=\frac{1}{2}+\frac{1}{\pi}\int_0^\infty\frac{H(\xi)\,\sin(2\pi\xi d)}{\xi}\,d"
            r"\xi",
            where="edge response at distance d; RER = E(½) − E(−½) in samples",
        ),
    )

    range_m: Annotated[
        float | None,
        Param("range to the ground; empty: that of Init & Trans", unit="m", low=0),
    ] = None
    off_nadir_deg: Annotated[
        float,
        Param(
            "view off nadir along, which stretches the ground sample",
            unit="deg", low=0, high=89, slider=(0, 60),
        ),
    ] = 0.0  # fmt: skip
    snr: Annotated[
        float | None, Param("SNR typed in; empty: mean signal over temporal noise", low=0)
    ] = None
    overshoot: Annotated[
        float | None,
        Param("overshoot H typed in; empty: that of the chain", low=0, slider=(0.8, 2)),
    ] = None
    noise_gain: Annotated[
        float, Param("noise gain G of the sharpening", low=0, high=1e6, slider=(0, 20))
    ] = 1.0

    panel = (
        Section("View", ("range_m", "off_nadir_deg")),
        Section("Noise", ("snr",)),
        Section("Sharpening", ("overshoot", "noise_gain")),
    )

    def run(self, context: Context, image: Image, here: NodeContext) -> QualityOutputs:
        """Plan edge, noise and figures as values of their own."""
        image = with_interval(image, context)
        passed, grid, node = transfer_of(image), image.grid(), here.node
        edge = Step.of(edge_quality, node=node, stages=passed.part("mtf"), grid=grid)
        if self.snr is not None:
            snr: Recipe = Step.of(typed_snr, node=node, snr=self.snr)
        else:
            snr = Step.of(
                signal_over_noise,
                NoiseOf(image, node, uniform=True),
                *passed.levels,
                node=node,
                gain=passed.gain,
                gain_before=passed.gain_before,
            )
        view = View(
            given("range_m", self.range_m, context, unit="m"),
            self.off_nadir_deg,
            self.noise_gain,
            self.overshoot,
        )
        table = Step.of(quality_table, edge, snr, node=node, grid=grid, view=view)
        return QualityOutputs(Curve(Step.of(edge_curve, edge, node=node)), Table(table))

    @warning
    def band(self, image: Image, context: Context) -> Caution | None:
        """A thermal picture, for which the equations are not."""
        band = image.band_um or context.band_um
        if band is None or band[0] < SHORTEST_THERMAL_UM:
            return None
        return Caution(
            f"the picture's band, {band[0]:g} to {band[1]:g} µm, is thermal, and these equations "
            "are fitted to visible pictures",
            "take figures_of_merit, or NIIRS as a comparison of like cameras alone",
        )

    @warning
    def limits(self, outputs: QualityOutputs) -> Recipe:
        """Values outside those that the equations were fitted to."""
        return Step.of(limits_caution, outputs.table.recipe)

    giqe5 = table_figure("giqe5", "NIIRS", "Interpretability by GIQE 5.")
    giqe4 = table_figure("giqe4", "NIIRS", "Interpretability by GIQE 4.")
    giqe3 = table_figure("giqe3", "NIIRS", "Interpretability by GIQE 3.")
    gsd_m = table_figure("gsd_m", "m", "Ground sample distance, geometric mean.")
    rer = table_figure("rer", "", "Relative edge response, geometric mean.")
    overshoot_figure = table_figure("overshoot", "", "Edge overshoot, geometric mean.")
    snr_figure = table_figure("snr", "", "Mean signal over temporal noise; none without noise.")
