"""A budget of noise or blur as bars and as figures."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

import numpy as np

from core.chain.results import CurveData, Series, TableData, TableRow
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from nodes.analysis.noise.budget_shares import BlurShares, Kind, NoiseShare, NoiseShares

Show = Literal["share", "amount"]
_WORDS = {"file": "noise file", "periodic": "periodic noise"}
_TOGETHER = "All together"


def source_words(name: str) -> str:
    """A noise's name for people."""
    return _WORDS.get(name, name)


def source_title(name: str) -> str:
    """The same with a capital first; those of an abbreviation stay."""
    words = source_words(name)
    return words[:1].upper() + words[1:]


@ends_lineage
def noise_bars(work: Work, noise: NoiseShares, *, kind: Kind, show: Show, unit: str) -> CurveData:
    """A bar for each source: its share of the variance, or its deviation."""
    title = "Noise" if kind == "all" else f"{kind.capitalize()} noise"
    if not noise.shares:
        return CurveData(f"{title}: none in this picture", "source", "share (%)", ())
    pairs = [(source_title(share.name), share.node) for share in noise.shares]
    names = _distinct(pairs)
    kinds = [
        k for k in ("temporal", "fixed") if any(getattr(s, k) is not None for s in noise.shares)
    ]
    if show == "share":
        label = "share of the variance (%)"
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
def blur_bars(work: Work, blur: BlurShares, *, show: Show) -> CurveData:
    """Two bars for each stage, across and along: its share of −ln |MTF|, or that itself."""
    title = "Blur" if blur.before is None else f"Blur behind {blur.before}"
    if not blur.shares:
        return CurveData(f"{title}: none known", "stage", "share (%)", ())
    names = tuple(stage.label for stage in blur.shares)
    if show == "share":
        label = "share of −ln |MTF| (%)"
        heights = [[100.0 * stage.share[axis] for stage in blur.shares] for axis in (0, 1)]
    else:
        label = "−ln |MTF|"
        names = (*names, _TOGETHER)
        losses = [[stage.losses[axis] for stage in blur.shares] for axis in (0, 1)]
        heights = [[*along, math.fsum(along)] for along in losses]
    return _bars(title, "stage", label, names, zip(("across", "along"), heights, strict=True))


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


def _distinct(names: list[tuple[str, str]]) -> tuple[str, ...]:
    """Names for the bars, with their node where two are alike."""
    plain = [name for name, _ in names]
    return tuple(f"{name} ({node})" if plain.count(name) > 1 else name for name, node in names)


@ends_lineage
def budget_table(
    work: Work, noise: NoiseShares, blur: BlurShares, *, kind: Kind, unit: str
) -> TableData:
    """Every source and every stage with its share, then all together."""
    rows = [row for share in noise.shares for row in _source_rows(share, unit)]
    if not noise.shares:
        what = "noise" if kind == "all" else f"{kind} noise"
        rows.append(TableRow("noise", "none", "", f"there is no {what} in this picture"))
    rows += [
        TableRow("sigma", noise.sigma, unit, "all noise"),
        TableRow("sigma_temporal", noise.temporal, unit, "all temporal noise"),
        TableRow("sigma_fixed", noise.fixed, unit, "all fixed patterns"),
        TableRow("mean", noise.mean, unit, "mean of the picture without noise"),
    ]
    rows += _blur_rows(blur)
    return TableData(tuple(rows))


def _source_rows(share: NoiseShare, unit: str) -> Iterable[TableRow]:
    name, words = f"{share.node}.{share.name}", source_words(share.name)
    for kind, sigma, part in (
        ("temporal", share.temporal, share.share_temporal),
        ("fixed", share.fixed, share.share_fixed),
    ):
        if sigma is not None:
            yield TableRow(f"{name}.{kind}", sigma, unit, f"σ of {words}, {kind}")
            yield TableRow(f"{name}.{kind}_share", 100.0 * part, "%", "share of the variance")


def _blur_rows(blur: BlurShares) -> list[TableRow]:
    nodes = [stage.node for stage in blur.shares]
    rows = []
    for stage in blur.shares:
        name = stage.node if nodes.count(stage.node) == 1 else f"{stage.node}.{_snake(stage.label)}"
        for axis, direction in ((0, "x"), (1, "y")):
            meaning = f"|MTF| of {stage.label}"
            rows.append(TableRow(f"{name}.mtf_{direction}", stage.mtf[axis], "", meaning))
            share = 100.0 * stage.share[axis]
            rows.append(TableRow(f"{name}.share_{direction}", share, "%", "share of −ln |MTF|"))
    if not rows:
        rows.append(TableRow("blur", "none", "", "no transfer function other than 1 is known"))
    for axis, direction, words in ((0, "x", "across"), (1, "y", "along")):
        rows.append(TableRow(f"mtf_{direction}", blur.mtf[axis], "", f"|MTF| of all, {words}"))
    for axis, name in ((0, "xi"), (1, "eta")):
        rows.append(TableRow(name, blur.frequency[axis], "cyc/mrad", "where the MTFs are taken"))
    if blur.before is not None:
        meaning = "what it does, and what is before it, is not known as transfer functions"
        rows.append(TableRow("blur_behind", blur.before, "", meaning))
    return rows


def _snake(label: str) -> str:
    return "".join(character if character.isalnum() else "_" for character in label.lower())
