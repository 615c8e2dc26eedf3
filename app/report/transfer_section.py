"""The section on transfer functions: figures of every stage and of their product, and a table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from app.report.drawing.curves import Part, product_png, stages_png
from app.report.drawing.drawn_as import named
from app.report.drawing.printed_numbers import number
from app.report.markup import figure, of_many, table
from app.run.evaluation import Evaluation
from app.run.responses import Responses

Fact = dict[str, Any]


def transfer(found: Evaluation, facts: Fact) -> str:
    """The section; empty where nothing has a transfer function."""
    responses, chain = found.responses, found.chain
    acting = any(stage.acts for stage in responses.stages)
    if not acting and not responses.beside:
        return ""
    text = "<h2>Transfer functions</h2>"
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
        text += _stages(found, responses, named(caption, drawn_as.get("stages")), "every stage")
    if acting and responses.products:
        caption = "The product of all stages, across and along."
        if responses.products[1:]:
            caption = "The product of all stages with the electronics, across and along."
        drawn = product_png(responses, chain)
        text += figure(drawn, named(caption, drawn_as.get("total")), "product of the MTFs")
    if responses.beside:
        alone = replace(responses, stages=responses.beside, products=())
        caption = "Transfer functions that do not lead to the output shown."
        text += _stages(found, alone, caption, "further stages")
    return text + _at_nyquist(responses, facts["transfer"]["at_nyquist"])


def _stages(found: Evaluation, shown: Responses, caption: str, what: str) -> str:
    """MTFs, and PTFs where there are any."""
    text = ""
    captions: tuple[tuple[Part, str], ...] = (("mtf", caption), ("ptf", "Their PTFs in radians."))
    for part, told in captions:
        acting = sum(s.has_phase if part == "ptf" else s.has_blur for s in shown.stages)
        if acting:
            drawn = stages_png(shown, found.chain, part)
            text += figure(drawn, told + of_many(acting), f"{part.upper()} of {what}")
    return text


def _at_nyquist(responses: Responses, nyquist: Fact) -> str:
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
    heads = ("at Nyquist", "node", "MTF x", "PTF x (rad)", "MTF y", "PTF y (rad)")
    return table(heads, rows, numbers=(2, 3, 4, 5))
