"""Pictures of the speed tables: bars with their targets, and what grows with the picture."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

from app.bench.measuring.bench_tables import Row, figure_text
from app.bench.pages.chart_looks import COLOURS, DARK, FAINT, drawing

MET, MISSED, OTHER = COLOURS[0], COLOURS[1], "#9a9a9a"
NAME_WIDTH = 30  # letters of a line beside a bar


def bars_png(rows: Sequence[Row], title: str) -> bytes:
    """A bar for each row, its targets as marks upon it."""
    with drawing(1.5 + 0.42 * len(rows), title) as (drawn, out):
        axis = drawn.subplots()
        widest = max(max(float(row["value"]), float(row.get("reach") or 0.0)) for row in rows)
        for place, row in enumerate(rows):
            value, reach, aim = float(row["value"]), row.get("reach"), row.get("aim")
            colour = OTHER if reach is None else MISSED if value > reach else MET
            axis.barh(place, value, height=0.62, color=colour, zorder=2)
            farthest = value
            if reach is not None:
                axis.plot([reach, reach], [place - 0.42, place + 0.42], color=DARK, lw=2, zorder=3)
                farthest = max(value, reach)
            if aim is not None:
                axis.plot(
                    [aim, aim], [place - 0.42, place + 0.42], color=DARK, lw=1, ls=":", zorder=3
                )
            axis.annotate(
                f"{figure_text(value)} T0, {figure_text(float(row['ms']))} ms",
                (farthest, place),
                xytext=(7, 0),
                textcoords="offset points",
                va="center",
                fontsize=10,
            )
        names = [textwrap.fill(row["subject"], NAME_WIDTH) for row in rows]
        axis.set_yticks(range(len(rows)), names)
        axis.set_ylim(len(rows) - 0.4, -0.6)
        axis.set_xlim(0, 1.3 * widest)
        axis.grid(visible=False, axis="y")
        axis.tick_params(axis="y", length=0)
        axis.spines["left"].set_visible(False)
        axis.axvline(1.0, color=FAINT, lw=1.0, ls=(0, (4, 3)), zorder=1)
        axis.set_xlabel(
            "time in T0, the bare Fourier round trip of the scene (dashed)\n"
            "solid mark: target, dotted: aim; blue meets its target, orange misses it",
            fontsize=10,
        )
    return bytes(out.getvalue())


def growth_png(rows: Sequence[Row], title: str) -> bytes:
    """Time on the left, memory on the right, over the size of the picture."""
    with drawing(4.2, title) as (drawn, out):
        left, right = drawn.subplots(1, 2)
        sizes = [int(row["size"]) for row in rows]
        times = [float(row["t0"]) for row in rows]
        left.fill_between(
            sizes, [row["low"] for row in rows], [row["high"] for row in rows],
            color=COLOURS[0], alpha=0.2, lw=0,
        )  # fmt: skip
        left.set_title("time, T0 (band: quartiles)", fontweight="normal", fontsize=10.5)
        right.set_title("peak memory, loaded images", fontweight="normal", fontsize=10.5)
        memory = [float(row["images"]) for row in rows]
        for axis, values in ((left, times), (right, memory)):
            axis.plot(sizes, values, marker="o", color=COLOURS[0], ms=6, lw=1.6, zorder=3)
            axis.set_xscale("log", base=2)
            axis.set_xticks(sizes, [f"{size}²" for size in sizes])
            axis.minorticks_off()
            axis.set_xlim(sizes[0] / 1.35, sizes[-1] * 1.35)
            axis.set_ylim(0, 1.18 * max(*values, *([3.4] if axis is right else [])))
            axis.set_xlabel("samples of the scene")
            _values(axis, sizes, values)
        for row in rows:
            if row.get("memory_verdict"):
                size, target = int(row["size"]), float(row["memory_reach"])
                right.plot([size / 1.2, size * 1.2], [target, target], color=DARK, lw=2)
                right.annotate("target", (size / 1.2, target), xytext=(-4, 0),
                               textcoords="offset points", ha="right", va="center",
                               fontsize=9, color=DARK)  # fmt: skip
    return bytes(out.getvalue())


def _values(axis: Any, sizes: Sequence[int], values: Sequence[float]) -> None:
    for size, value in zip(sizes, values, strict=True):
        axis.annotate(
            figure_text(value),
            (size, value),
            xytext=(4, 7),
            textcoords="offset points",
            fontsize=9.5,
        )
