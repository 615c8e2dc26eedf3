"""What was not computed, and why: the report's section on it."""

from __future__ import annotations

from typing import Any

from app.report.blocks import MOST_ROWS, Block, Grid, Heading
from app.report.drawing.printed_numbers import short

Fact = dict[str, Any]

# For each kind: what was not computed, and why.
_KINDS = {
    "disabled": ("the node", "it is switched off"),
    "identity": ("the node", "its setting changes nothing"),
    "below_budget": ("a stage", "it changes less than the error budget, {budget} of the range"),
    "wavelengths": ("transforms of every band", "a few wavelengths stand for all"),
    "pupil_centre": ("the pupil's OTF beyond the band", "it does not reach the picture"),
    "mirrored_edges": ("a frame padded for its edges", "cosine transforms mirror by themselves"),
    "folded": ("the picture before its pixels are combined", "the spectrum is folded instead"),
    "region": ("pictures beyond a region", "no more of them is used"),
    "unchanged": ("values that were there", "nothing they are made of has changed"),
    "unseen": ("whole arrays of outputs", "they are not used"),
}


def economy(facts: dict[str, Any]) -> list[Block]:
    """The section; empty where all there is was computed."""
    budget = short(facts["run"]["tolerance"], 2)
    rows = []
    for kind, (what, why) in _KINDS.items():
        where = [
            node + _detail(fact)
            for node, listed in facts["skipped"].items()
            for fact in listed
            if fact["kind"] == kind and fact["share"] != 1  # a region may take the whole picture
        ]
        if where:
            more = f" and {len(where) - MOST_ROWS:,} more" if len(where) > MOST_ROWS else ""
            rows.append((what, why.format(budget=budget), ", ".join(where[:MOST_ROWS]) + more))
    if not rows:
        return []
    heads = ("not computed", "because", "where")
    return [Heading(2, "What was not computed, and why"), Grid(heads, rows, kind="economy")]


def state(listed: list[Fact]) -> str:
    """A node's state in a word or two; empty where its own work was done."""
    for fact in listed:
        if fact["kind"] == "disabled":
            return "disabled"
        if fact["kind"] == "identity":
            return "neutral: skipped"
        if fact["kind"] == "below_budget":
            return f"left out: at most {short(fact['bound'], 2)}"
    return ""


def _detail(fact: Fact) -> str:
    template = {
        "below_budget": "at most {bound}",
        "wavelengths": "{share} % of them, at most {bound} of the contrast",
        "pupil_centre": "{share} % of it evaluated",
        "mirrored_edges": "{share} % of its samples transformed",
        "folded": "inverse of {share} % of its samples",
        "region": "{share} % computed",
        "unchanged": "{share} % of its steps computed",
        "unseen": "{ports}",
    }.get(fact["kind"])
    if template is None:
        return ""
    bound = short(fact["bound"], 2)
    share = short(None if fact["share"] is None else 100 * fact["share"], 2)
    return f" ({template.format(bound=bound, share=share, ports=', '.join(fact['ports']))})"
