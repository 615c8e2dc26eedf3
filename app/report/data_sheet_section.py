"""The section that reads as a camera's data sheet."""

from __future__ import annotations

from typing import Any

from app.report.blocks import Block, Grid, Heading, Text
from app.report.drawing.printed_numbers import number
from app.report.facts.data_sheet_facts import TIMES
from app.run.readout_tables import four_digits, sized

Fact = dict[str, Any]


def data_sheet(facts: Fact) -> list[Block]:
    """The section; empty of a network without a camera of today."""
    sheet = facts["data_sheet"]
    if sheet is None:
        return []
    blocks: list[Block] = [Heading(2, "Data sheet")]
    for group in sheet["groups"]:
        rows = [
            (row["label"], *_values(row["values"], row["unit"], row["between"]))
            for row in group["rows"]
        ]
        if rows:
            blocks.append(Heading(3, group["title"], group["node"]))
            blocks.append(Grid(("figure", "value", "unit"), rows, numbers=(1,)))
    for noise in sheet["noises"]:
        rows = [
            (row["label"], *(" ".join(_quantity(row[unit], unit)) for unit in ("e-", "K")))
            for row in noise["rows"]
        ]
        blocks.append(Heading(3, "Noise by source", noise["node"]))
        blocks.append(Grid(("noise", "electrons", "kelvin"), rows, numbers=(1, 2)))
    mtf = sheet["mtf"]
    if mtf is not None:
        where = f"{_rounded(mtf['nyquist_x'])} cyc/mrad across, {_rounded(mtf['nyquist_y'])} along"
        blocks.append(Heading(3, "MTF at the pixels' Nyquist frequency"))
        blocks.append(Text(f"At {where}: half a cycle in a pixel of the delivered picture."))
        shown = [(r["label"], r["node"], _rounded(r["x"]), _rounded(r["y"])) for r in mtf["rows"]]
        blocks.append(Grid(("stage", "node", "across", "along"), shown, numbers=(2, 3)))
    return blocks


def _values(values: list[Any], unit: str, between: str) -> tuple[str, str]:
    """One value, or both with what stands between them, and the unit.

    Values across × along that are alike are one, unless they are counts of pixels.
    """
    if len(values) == 1:
        return _quantity(values[0], unit)
    written = {_quantity(value, unit)[1] for value in values}
    shown = [_rounded(value) for value in values]
    if len(written) == 1:
        shown = [_quantity(value, unit)[0] for value in values]
        (unit,) = written
    if between == TIMES and shown[0] == shown[1] and not isinstance(values[0], int):
        return shown[0], unit
    return between.join(shown), unit


def _quantity(value: Any, unit: str) -> tuple[str, str]:
    value, unit = sized(value, unit)
    return number(value), unit


def _rounded(value: Any) -> str:
    return number(four_digits(value))
