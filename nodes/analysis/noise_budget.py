"""Noise Budget: which source makes how much of a picture's noise, which stage of its blur."""

import math
from collections.abc import Iterable
from typing import Any, Literal, NamedTuple

import numpy as np

from core.chain.wires import Curve, CurveData, Image, Series, Table, TableData
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.modules.declaration import Formula, Module, NodeContext, Section, param
from core.physics.noise.noise_equivalent import loss, shares_of_losses
from core.records import dataclass
from nodes.analysis import lineage
from nodes.shared.module_ports import TableFigures

Kind = Literal["all", "temporal", "fixed"]
_KINDS = ("temporal", "fixed")
_NOTHING = 1e-20  # of the variance: what a source of two kinds has so little of, it has not
_ROUNDING = 1e-12


@dataclass(frozen=True)
class NoiseShare:
    """A source's deviations, None of a kind that it has not, and its shares of the variance."""

    node: str
    name: str
    temporal: float | None
    fixed: float | None
    share_temporal: float
    share_fixed: float

    @property
    def sigma(self) -> float:
        return math.hypot(self.temporal or 0.0, self.fixed or 0.0)


@dataclass(frozen=True)
class NoiseShares:
    """Every noise in the picture; the deviations `temporal` and `fixed` are those of all."""

    shares: tuple[NoiseShare, ...]
    temporal: float
    fixed: float
    mean: float

    @property
    def sigma(self) -> float:
        return math.hypot(self.temporal, self.fixed)


@dataclass(frozen=True)
class BlurShare:
    """One stage's |MTF| across and along, and its share of what is lost (negative: sharpens)."""

    node: str
    label: str
    mtf: tuple[float, float]
    share: tuple[float, float]


BlurShares = tuple[BlurShare, ...]


def mtf_of_all(shares: BlurShares, axis: int) -> float:
    return math.prod((share.mtf[axis] for share in shares), start=1.0)


@ends_lineage
def noise_shares(work: Work, noise: lineage.ImageNoise, *, kind: Kind) -> NoiseShares:
    noise.require_known()
    variances: dict[tuple[str, str], dict[str, float]] = {}
    for term in noise.terms:
        of_source = variances.setdefault((term.node, term.name), {})
        of = "temporal" if term.temporal else "fixed"
        of_source[of] = of_source.get(of, 0.0) + max(term.variances.total, 0.0)
    whole = {of: math.fsum(one.get(of, 0.0) for one in variances.values()) for of in _KINDS}
    counted = _KINDS if kind == "all" else (kind,)
    total = math.fsum(whole[of] for of in counted)
    shares = []
    for (node, name), of_source in variances.items():
        scant = [of for of in of_source if of_source[of] < _NOTHING * sum(whole.values())]
        for of in scant[: len(of_source) - 1]:
            del of_source[of]
        there = {of: of_source[of] for of in counted if of in of_source}
        if there:
            sigma = {of: math.sqrt(variance) for of, variance in there.items()}
            temporal, fixed = (there.get(of, 0.0) / total if total else 0.0 for of in _KINDS)
            pair = sigma.get("temporal"), sigma.get("fixed")
            shares.append(NoiseShare(node, name, *pair, temporal, fixed))
    temporal, fixed = (math.sqrt(whole[of]) for of in _KINDS)
    return NoiseShares(tuple(shares), temporal, fixed, noise.mean)


@ends_lineage
def blur_shares(
    work: Work, *, stages: lineage.Stages, frequency: tuple[float, float]
) -> BlurShares:
    """Shares of the stages at a frequency across and one along; those that do nothing left out."""
    moduli = []
    lines = lineage.HORIZONTAL, lineage.VERTICAL
    for line, cyc_per_mrad in zip(lines, frequency, strict=True):
        work.check()
        place = np.array([cyc_per_mrad])
        values = (abs(float(lineage.stage_along(work, s, "mtf", line, place)[0])) for s in stages)
        # What is 1 but for rounding is 1.
        moduli.append([1.0 if abs(value - 1.0) < _ROUNDING else value for value in values])
    shared = [shares_of_losses(losses=[loss(mtf=mtf) for mtf in along]) for along in moduli]
    of_axes = zip(stages, zip(*moduli, strict=True), zip(*shared, strict=True), strict=True)
    return tuple(
        BlurShare(
            next((f.node for f in stage.factors if f.node), stage.label), stage.label, mtf, share
        )
        for stage, mtf, share in of_axes
        if mtf != (1.0, 1.0)
    )


def unknown_before(transfer: lineage.ImageTransfer) -> str | None:
    """The node whose transfer function is not known, so that nothing before it counts."""
    source = transfer.source
    if transfer.area_means or not source.inputs:
        return None
    return source.node or "a node"


Show = Literal["share", "amount"]
_WORDS = {"file": "noise file", "periodic": "periodic noise"}
_TOGETHER = "All together"


def source_words(name: str) -> str:
    return _WORDS.get(name, name)


def source_title(name: str) -> str:
    words = source_words(name)
    return words[:1].upper() + words[1:]


@ends_lineage
def noise_bars(work: Work, noise: NoiseShares, *, kind: Kind, show: Show, unit: str) -> CurveData:
    title = "Noise" if kind == "all" else f"{kind.capitalize()} noise"
    if not noise.shares:
        return CurveData(f"{title}: none in this picture", "source", "share (%)", ())
    pairs = [(source_title(share.name), share.node) for share in noise.shares]
    names = distinct(pairs)
    kinds = [k for k in _KINDS if any(getattr(s, k) is not None for s in noise.shares)]
    if show == "share":
        label = "share of the noise variance (%)"
        heights = [
            [100.0 * getattr(share, f"share_{one}") for share in noise.shares] for one in kinds
        ]
    else:
        label = f"σ ({unit})" if unit else "σ"
        names = (*names, _TOGETHER)
        heights = [
            [*(getattr(share, one) or 0.0 for share in noise.shares), getattr(noise, one)]
            for one in kinds
        ]
    return _bars(title, "source", label, names, zip(kinds, heights, strict=True))


@ends_lineage
def blur_bars(work: Work, blur: BlurShares, *, before: str | None, show: Show) -> CurveData:
    title = "Blur" if before is None else f"Blur after {before}"
    if not blur:
        return CurveData(f"{title}: none known", "stage", "share (%)", ())
    names = tuple(stage.label for stage in blur)
    if show == "share":
        label = "share of −ln |MTF| (%)"
        heights = [[100.0 * stage.share[axis] for stage in blur] for axis in (0, 1)]
    else:
        label = "−ln |MTF|"
        names = (*names, _TOGETHER)
        losses = [[loss(mtf=stage.mtf[axis]) for stage in blur] for axis in (0, 1)]
        heights = [[*along, math.fsum(along)] for along in losses]
    return _bars(
        title, "stage", label, names, zip(("horizontal", "vertical"), heights, strict=True)
    )


def _bars(
    title: str,
    what: str,
    label: str,
    names: tuple[str, ...],
    heights: Iterable[tuple[str, list[float]]],
) -> CurveData:
    places = np.arange(float(len(names)))
    series = tuple(Series(name, places, np.array(column)) for name, column in heights)
    return CurveData(title, what, label, series, bars=names)


def distinct(names: list[tuple[str, str]]) -> tuple[str, ...]:
    plain = [name for name, _ in names]
    return tuple(f"{name} ({node})" if plain.count(name) > 1 else name for name, node in names)


@ends_lineage
def budget_table(
    work: Work, noise: NoiseShares, blur: BlurShares, *, kind: Kind, unit: str, **seen: Any
) -> TableData:
    rows = [row for share in noise.shares for row in _source_rows(share, unit)]
    if not noise.shares:
        what = "noise" if kind == "all" else f"{kind} noise"
        rows.append(("noise", "none", "", f"this picture has no {what}"))
    return NoiseBudget.figures.table(
        *rows,
        ("sigma", noise.sigma),
        ("sigma_temporal", noise.temporal),
        ("sigma_fixed", noise.fixed),
        ("mean", noise.mean, unit, "mean of the noise-free picture"),
        *_blur_rows(blur, **seen),
        unit=unit,
    )


def _source_rows(share: NoiseShare, unit: str) -> Iterable[tuple[Any, ...]]:
    name, words = f"{share.node}.{share.name}", source_words(share.name)
    for kind, sigma, part in (
        ("temporal", share.temporal, share.share_temporal),
        ("fixed", share.fixed, share.share_fixed),
    ):
        if sigma is not None:
            yield f"{name}.{kind}", sigma, unit, f"σ of {words}, {kind}"
            meaning = "share of the variance of all noise in the budget"
            yield f"{name}.{kind}_share", 100.0 * part, "%", meaning


def _blur_rows(
    blur: BlurShares, *, frequency: tuple[float, float], before: str | None
) -> Iterable[tuple[Any, ...]]:
    nodes = [stage.node for stage in blur]
    for stage in blur:
        name = stage.node if nodes.count(stage.node) == 1 else f"{stage.node}.{_snake(stage.label)}"
        for axis, direction in ((0, "x"), (1, "y")):
            yield f"{name}.mtf_{direction}", stage.mtf[axis], "", f"|MTF| of {stage.label}"
            share, meaning = 100.0 * stage.share[axis], "share of −ln |MTF| of all stages"
            yield f"{name}.share_{direction}", share, "%", meaning
    if not blur:
        yield "blur", "none", "", "all stages have a transfer function of 1"
    yield "mtf_x", mtf_of_all(blur, 0)
    yield "mtf_y", mtf_of_all(blur, 1)
    yield from zip(("xi", "eta"), frequency, strict=True)
    if before is not None:
        meaning = "the transfer functions up to and including this stage are unknown"
        yield "blur_behind", before, "", meaning


def _snake(label: str) -> str:
    return "".join(character if character.isalnum() else "_" for character in label.lower())


class BudgetOutputs(NamedTuple):
    noise: Curve
    blur: Curve
    table: Table


class NoiseBudget(Module, key="noise_budget", title="Noise Budget", group="Analysis"):
    """Show how much each source contributes to the noise, and each stage to the blur.

    Everything is computed from the picture's chain; no noise is simulated. The noise of each source
    is propagated to the picture through all later filters, pixel combining and interpolation.
    Variances of independent noises add, so each source has a share of the sum. `fixed` means
    fixed-pattern noise, the same in every frame, averaged over all sensors of the same design.
    Quantization noise is included. Moduli of MTFs multiply, so −ln |MTF| adds; at one frequency the
    share of a Gaussian blur is proportional to its variance. A stage that amplifies has a negative
    share: it recovers part of the loss. A stage with an MTF of zero is assigned all of the blur.
    Phases do not count as blur.
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
        "all",
        "noise in the budget: all noise, temporal noise (changes from frame to "
        "frame), or fixed-pattern noise",
    )
    show: Show = param(
        "share",
        "length of the bars: share in per cent, or amount (standard deviation of the noise, "
        "−ln of the MTF for the blur)",
    )

    panel = (Section("Noise and blur", "noise frequency show"),)

    def run(self, image: Image, here: NodeContext) -> BudgetOutputs:
        node, grid, passed = here.node, image.grid(), lineage.transfer_of(image)
        noise = here.step(noise_shares, lineage.NoiseOf(image, node), kind=self.noise)
        frequency = self.frequency * grid.nyquist_x, self.frequency * grid.nyquist_y
        before = unknown_before(passed)
        blur = here.step(blur_shares, stages=passed.part("mtf"), frequency=frequency)
        noise_kind = {"kind": self.noise, "unit": image.unit}
        seen: Any = {"frequency": frequency, "before": before}
        return BudgetOutputs(
            Curve(here.step(noise_bars, noise, show=self.show, **noise_kind)),
            Curve(here.step(blur_bars, blur, before=before, show=self.show)),
            Table(here.step(budget_table, noise, blur, **noise_kind, **seen)),
        )

    figures = TableFigures(
        ("sigma", None, "Standard deviation of all noise."),
        ("sigma_temporal", None, "Standard deviation of all temporal noise."),
        ("sigma_fixed", None, "Standard deviation of all fixed-pattern noise."),
        ("mtf_x", "", "Horizontal MTF of all stages, at the budget's frequency."),
        ("mtf_y", "", "Vertical MTF of all stages, at the budget's frequency."),
        ("xi", "cyc/mrad", "Horizontal frequency at which the blur is budgeted."),
        ("eta", "cyc/mrad", "Vertical frequency at which the blur is budgeted."),
        unit_of="image",
    )
