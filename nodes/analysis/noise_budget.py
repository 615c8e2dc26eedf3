"""Noise Budget: which source makes how much of a picture's noise, which stage of its blur."""

from typing import NamedTuple

from core.chain.wires import Curve, Image, Table
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from nodes.analysis import budget_shares
from nodes.analysis.budget_shares import Kind, Show
from nodes.analysis.lineage import NoiseOf, transfer_of
from nodes.shared.module_ports import TableFigures


class BudgetOutputs(NamedTuple):
    noise: Curve
    blur: Curve
    table: Table


class NoiseBudget(Module, key="noise_budget", title="Noise Budget", group="Analysis"):
    """Show how much each source contributes to the noise, and each stage to the blur.

    Everything is computed from the picture's chain; no noise is drawn. The noise of each source is
    propagated to the picture through all later filters, pixel combining and interpolation.
    Variances of independent noises add, so each source has a share of the sum. `fixed` means the
    patterns that stay the same from frame to frame, averaged over all sensors of this kind.
    Rounding counts as noise. Moduli of MTFs multiply, so −ln |MTF| adds; at one frequency the share
    of a Gaussian blur is proportional to its variance. A stage that amplifies has a negative share:
    it recovers part of the loss. A stage with an MTF of zero is assigned all of the blur. Phases do
    not count as blur.
    """

    formulas = (
        Formula(
            r"\mathrm{share}_k=\frac{\sigma_k^2}{\sum_j\sigma_j^2}",
            where="σ_k: standard deviation of one source's noise in the picture, after all filters",
        ),
        Formula(
            r"\mathrm{share}_k(f)=\frac{-\ln|M_k(f)|}{-\sum_j\ln|M_j(f)|}",
            where="M_k: MTF of a stage",
        ),
    )

    frequency: float = param(
        0.5,
        "frequency at which the blur is budgeted, as a fraction of the picture's Nyquist frequency",
        (0, 1),
        unit="Nyquist",
        above=True,
        slider=(0.05, 1),
    )
    noise: Kind = param(
        "all", "all noise, noise that changes from frame to frame, or fixed patterns"
    )
    show: Show = param(
        "share",
        "length of the bars: share in percent, or amount (standard deviation of the noise, "
        "−ln of the MTF for the blur)",
    )

    panel = (Section("Noise and blur", ("noise", "frequency", "show")),)

    def run(self, image: Image, here: NodeContext) -> BudgetOutputs:
        node, grid, passed = here.node, image.grid(), transfer_of(image)
        noise = here.step(budget_shares.noise_shares, NoiseOf(image, node), kind=self.noise)
        blur = here.step(
            budget_shares.blur_shares,
            stages=passed.part("mtf"),
            frequency=(self.frequency * grid.nyquist_x, self.frequency * grid.nyquist_y),
            before=budget_shares.unknown_before(passed),
        )
        noise_kind = {"kind": self.noise, "unit": image.unit}
        return BudgetOutputs(
            Curve(here.step(budget_shares.noise_bars, noise, show=self.show, **noise_kind)),
            Curve(here.step(budget_shares.blur_bars, blur, show=self.show)),
            Table(here.step(budget_shares.budget_table, noise, blur, **noise_kind)),
        )

    figures_0 = TableFigures(
        ("sigma", "", "Standard deviation of all noise."),
        ("sigma_temporal", "", "Standard deviation of all temporal noise."),
        ("sigma_fixed", "", "Standard deviation of all fixed patterns."),
        unit_of="image",
    )
    figures_1 = TableFigures(
        ("mtf_x", "", "Horizontal MTF of all stages, at the budget's frequency."),
        ("mtf_y", "", "Vertical MTF of all stages, at the budget's frequency."),
        ("xi", "cyc/mrad", "Horizontal frequency at which the blur is budgeted."),
        ("eta", "cyc/mrad", "Vertical frequency at which the blur is budgeted."),
    )
