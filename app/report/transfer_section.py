"""The section on transfer functions: figures of every stage and of their product, and a table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from app.report.blocks import Block, Drawn, Grid, Heading, of_many
from app.report.drawing.curves import Part, product_png, stages_png
from app.report.drawing.drawn_as import named
from app.report.drawing.printed_numbers import number
from app.run.evaluation import Evaluation
from app.run.responses import Responses

Fact = dict[str, Any]


def transfer(evaluation: Evaluation, facts: Fact) -> list[Block]:
    """The section; empty where nothing has a transfer function."""
    responses, chain = evaluation.responses, evaluation.chain
    acting = any(stage.acts for stage in responses.stages)
    if not acting and not responses.beside:
        return []
    blocks: list[Block] = [Heading(2, "Transfer functions")]
    drawn_as = facts["drawn_as"]
    if acting:
        caption = (
            "MTF of every stage, signed, at the frequencies of the picture's FFT, a. across and b. "
            "along. "
        )
        caption += (
            "Total: the product before pixels are combined."
            if chain.cascade
            else f"The stages stand side by side and have no product (total): {chain.missing}."
        )
        blocks += _stages(
            evaluation, responses, named(caption, drawn_as.get("stages")), "every stage"
        )
    if acting and responses.products:
        caption = "The product of all stages, across and along."
        if responses.products[1:]:
            caption = "The product of all stages with the electronics, across and along."
        drawn = product_png(responses, chain)
        blocks.append(Drawn(drawn, named(caption, drawn_as.get("total")), "product of the MTFs"))
    if responses.beside:
        alone = replace(responses, stages=responses.beside, products=())
        caption = "Transfer functions that do not lead to the output shown."
        blocks += _stages(evaluation, alone, caption, "further stages")
    return [*blocks, _at_nyquist(responses, facts["transfer"]["at_nyquist"])]


def _stages(evaluation: Evaluation, shown: Responses, caption: str, what: str) -> list[Block]:
    """MTFs, and PTFs where there are any."""
    blocks: list[Block] = []
    captions: tuple[tuple[Part, str], ...] = (("mtf", caption), ("ptf", "Their PTFs in radians."))
    for part, text in captions:
        acting = sum(s.has_phase if part == "ptf" else s.has_blur for s in shown.stages)
        if acting:
            drawn = stages_png(shown, evaluation.chain, part)
            blocks.append(Drawn(drawn, text + of_many(acting), f"{part.upper()} of {what}"))
    return blocks


def _at_nyquist(responses: Responses, nyquist: Fact) -> Block:
    rows = [
        (
            stage.title,
            "" if stage.is_product else stage.name,
            *(
                number(nyquist[f"{stage.name}.{part}_nyquist_{axis}"], unit="rad")
                for axis in ("x", "y")
                for part in ("mtf", "ptf")
            ),
        )
        for stage in (*responses.stages, *responses.beside, *responses.products)
    ]
    heads = ("at Nyquist of the FFT", "node", "MTF x", "PTF x (rad)", "MTF y", "PTF y (rad)")
    return Grid(heads, rows, numbers=(2, 3, 4, 5))
