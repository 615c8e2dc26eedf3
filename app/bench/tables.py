"""Results of a benchmark: tables that terminal, JSON file and page share, and their pictures."""

import math
import textwrap
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from app.bench.timing import Settings, machine_facts, machine_words
from app.report.drawing.picture_drawing import figure, load_matplotlib
from app.run.terminal import columns
from core.evaluation.work import Policy
from core.records import dataclass

Row = Mapping[str, Any]
NONE = "-"
T0_HEADS = {"t0": "T0", "ms": "ms"}


@dataclass(frozen=True)
class Chart:
    """How to draw a table: its columns ``t0`` and ``error``, or a bar for each row in T0.

    `error` says what the error is, without it bars are drawn; `label` and `group` are columns of
    the words beside the points and of what has a colour, and a line if `lines`, of its own; `where`
    chooses rows by a column's value; `by_colour` writes the words in colour and names no group.
    """

    error: str = ""
    label: str = ""
    group: str = ""
    lines: bool = True
    title: str = ""
    where: tuple[str, Any] | None = None
    by_colour: bool = False

    def draws(self, row: Row) -> bool:
        values = (row.get(name) for name in (("t0", "error") if self.error else ("value", "ms")))
        finite = all(isinstance(one, int | float) and math.isfinite(one) for one in values)
        return finite and (self.where is None or row.get(self.where[0]) == self.where[1])


@dataclass(frozen=True)
class Table:
    """Rows of figures by column, and a text on them: for a choice, its default and why."""

    name: str
    title: str
    heads: Mapping[str, str]
    rows: Sequence[Row]
    text: str = ""
    chart: Chart | None = None

    def facts(self) -> dict[str, Any]:
        return {
            "name": self.name,
            "title": self.title,
            "columns": dict(self.heads),
            "rows": [dict(row) for row in self.rows],
            "text": self.text,
        }

    def cells(self) -> list[list[str]]:
        return [[figure_text(row.get(name)) for name in self.heads] for row in self.rows]

    def numeric(self) -> list[int]:
        return [
            index
            for index, name in enumerate(self.heads)
            if any(isinstance(row.get(name), int | float) for row in self.rows)
        ]

    def terminal(self) -> str:
        rows = [list(self.heads.values()), *self.cells()]
        lines = [self.title, columns(rows, right=self.numeric())]
        return "\n".join([*lines, *([textwrap.fill(self.text, 100)] if self.text else [])])


def figure_text(value: Any) -> str:
    """A measured figure in three digits: more would be noise."""
    if value is None:
        return NONE
    if isinstance(value, float):
        short = f"{value:.3g}"
        if 1e3 <= abs(float(short)) < 1e6:
            return f"{float(short):.0f}"
        return "0" if value == 0 else short.replace("e-0", "e-").replace("e+0", "e")
    return str(value)


def verdict(value: float, reach: float | None, aim: float | None = None) -> str:
    if reach is None:
        return ""
    if value > reach:
        ratio = value / reach
        return f"missed: {ratio:.2f} × limit" if ratio >= 1.005 else f"missed: {ratio:.4f} × limit"
    if aim is None or value <= aim:
        return "met" if aim is None else "met, target too"
    return f"met; {value / aim:.2f} × target"


def judged(value: float, reach: float | None, aim: float | None = None) -> dict[str, Any]:
    return {"reach": reach, "aim": aim, "verdict": verdict(value, reach, aim)}


# Pictures of tables: time against error, and bars with their targets.

WIDTH, HEIGHT = 8.2, 4.9  # inches
# Distinct in every kind of colour vision (Okabe and Ito 2008), their light ones darkened for
# letters on white.
COLOURS = ("#0072B2", "#D55E00", "#00805C", "#A8508A", "#8A6D00", "#2B2B2B", "#3C9BD6")
FAINT, DARK, OTHER = "#8a8a8a", "#333333", "#9a9a9a"
MARKS = "osD^vPX"
LEAST = 1e-16  # no error at all has no place on a logarithmic axis: it is drawn at rounding
STYLE: Any = {"font.size": 10.5, "axes.labelsize": 11.0, "axes.axisbelow": True}


def chart_png(table: Table, *, titled: bool = True) -> bytes | None:
    chart = table.chart
    rows = [row for row in table.rows if chart is not None and chart.draws(row)]
    if chart is None or not rows:
        return None
    height = HEIGHT if chart.error else 1.5 + 0.42 * len(rows)
    with figure(WIDTH, height) as (drawn, out), load_matplotlib().rc_context(STYLE):
        drawn.get_layout_engine().set(w_pad=0.1, h_pad=0.08)
        if titled:
            title = textwrap.fill(chart.title or table.title, 84)
            drawn.suptitle(title, x=0.012, ha="left", fontsize=12.0, fontweight="bold")
        axis = drawn.subplots()
        if chart.error:
            _draw_errors(axis, chart, rows)
        else:
            _draw_bars(axis, rows)
    return bytes(out.getvalue())


def _draw_errors(axis: Any, chart: Chart, rows: Sequence[Row]) -> None:
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        groups.setdefault(row[chart.group] if chart.group else "", []).append(row)
    named = bool(chart.group) and not chart.by_colour
    points, words = [], []
    for number, (group, members) in enumerate(groups.items()):
        colour = COLOURS[number % len(COLOURS)]
        places = [(float(row["t0"]), max(float(row["error"]), LEAST)) for row in members]
        points += places
        axis.plot(
            *zip(*places, strict=True), marker=MARKS[number % len(MARKS)], color=colour,
            ms=7, mec="white", mew=0.8, ls="-" if chart.lines and chart.group else "none", lw=1.4,
            label=figure_text(group), zorder=3,
        )  # fmt: skip
        shown = colour if chart.by_colour else DARK
        texts = [row.get(chart.label) for row in members]
        words += [(text, *each, shown) for text, each in zip(texts, places, strict=True)]
    _scale(axis, points)
    taken: list[tuple[float, float]] = []
    for text, t0, error, colour in words:
        if text is None:
            continue
        x, y = axis.transData.transform((t0, error))
        heights = [y + up for up in (5, -17, 27, -39)]  # pixels
        free = (h for h in heights if all(abs(h - o) > 19 or abs(x - p) > 200 for p, o in taken))
        taken.append((x, next(free, heights[0])))
        axis.annotate(
            figure_text(text), (t0, error), xytext=(8, 0.72 * (taken[-1][1] - y)),
            textcoords="offset points", fontsize=9.5, color=colour,
        )  # fmt: skip
    axis.set_xlabel(
        "time in multiples of T0, the time for one forward and one inverse Fourier transform"
    )
    axis.set_ylabel(chart.error)
    if named:
        axis.figure.legend(loc="outside lower center", ncols=min(len(groups), 4), frameon=False)
    axis.annotate(
        "↙ faster and more accurate", (0.0, 0.0), xycoords="axes fraction", xytext=(5, 4),
        textcoords="offset points", fontsize=8.5, color=FAINT,
    )  # fmt: skip
    low, high = axis.get_xlim()
    if low < 1.0 < high:
        axis.axvline(1.0, color=FAINT, lw=1.0, ls=(0, (4, 3)), zorder=1)


def _scale(axis: Any, points: Sequence[tuple[float, float]]) -> None:
    """Logarithmic, with room about the points for their names, and at least 1.6 decades high."""
    x, y = np.log10(np.array(points)).T
    reaches = max(np.ptp(x), 0.5), max(np.ptp(y), 1.6)
    (low, high), (bottom, top) = (
        10.0 ** (0.5 * (values.min() + values.max()) + reach * np.array([-0.66, 0.66]))
        for values, reach in zip((x, y), reaches, strict=True)
    )
    axis.set(xscale="log", yscale="log", xlim=(low, high), ylim=(bottom, top))


def _draw_bars(axis: Any, rows: Sequence[Row]) -> None:
    for place, row in enumerate(rows):
        value, reach, aim = float(row["value"]), row.get("reach"), row.get("aim")
        colour = OTHER if reach is None else COLOURS[value > reach]
        axis.barh(place, value, height=0.62, color=colour, zorder=2)
        for target, width, dashes in ((reach, 2, "-"), (aim, 1, ":")):
            if target is not None:
                ends = [place - 0.42, place + 0.42]
                axis.plot([target, target], ends, color=DARK, lw=width, ls=dashes, zorder=3)
        said = f"{figure_text(value)} T0, {figure_text(float(row['ms']))} ms"
        axis.annotate(said, (max(value, reach or 0.0), place), xytext=(7, 0),
                      textcoords="offset points", va="center", fontsize=10)  # fmt: skip
    axis.set_yticks(range(len(rows)), [textwrap.fill(row["subject"], 30) for row in rows])
    axis.set_ylim(len(rows) - 0.4, -0.6)
    axis.set_xlim(0, 1.3 * max(max(row["value"], row.get("reach") or 0.0) for row in rows))
    axis.grid(visible=False, axis="y")
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)
    axis.axvline(1.0, color=FAINT, lw=1.0, ls=(0, (4, 3)), zorder=1)
    axis.set_xlabel(
        "time in multiples of T0, the time for one forward and one inverse Fourier transform of "
        "the scene\ndashed line: T0; solid mark: limit; dotted mark: target; blue: limit met; "
        "orange: limit missed",
        fontsize=10,
    )


# What a run measures, part by part, and its page.

PARTS = {
    "speed": "Speed",
    "precision": "Time against error",
    "peers": "Comparison with other programs",
    "studies": "Studies",
    "measure": "Measuring and fitting pictures",
}
TITLE = "Imagechain: run time against error"
LEAD = (
    "Times are in multiples of T0, the time of irfft2(rfft2(image)) for the same image, data type "
    "and threads. Any Fourier method takes at least T0. Each method and T0 are timed alternately; "
    "the figures are medians of the ratios."
)
Measures = Sequence[Callable[[Settings], list[Table]]]
Measured = Mapping[str, Sequence[Table]]


def measured(
    parts: Mapping[str, Measures],
    titles: Mapping[str, str],
    settings: Settings,
    *,
    say: Callable[[str], object] = print,
) -> tuple[dict[str, Any], Measured]:
    start = time.perf_counter()
    machine = machine_facts()
    facts: dict[str, Any] = {
        "format": "imagechain-bench",
        "version": 1,
        "date": time.strftime("%Y-%m-%d %H:%M %z"),
        "machine": machine,
        "settings": {"parts": list(parts), "size": settings.size, "quick": settings.quick,
                     "pairs": settings.pairs, "threads": Policy().workers},
    }  # fmt: skip
    versions = ", ".join(f"{name} {release}" for name, release in machine["versions"].items())
    say(
        f"{machine['processor']}, {machine['usable_cores']} of {machine['cores']} cores, load "
        f"{machine['load']:.1f}; {versions}; transforms by {machine['fft']}\nT0 = "
        "scipy.fft.irfft2(scipy.fft.rfft2(image)), on the same image, data type and threads, timed "
        "alternately with each method"
    )
    tables: dict[str, list[Table]] = {}
    for name, measures in parts.items():
        say(f"\n== {titles[name]} ==")
        tables[name] = []
        for table in (table for measure in measures for table in measure(settings)):
            say("\n" + table.terminal())
            tables[name].append(table)
    facts["seconds"] = time.perf_counter() - start
    facts["parts"] = {name: [table.facts() for table in made] for name, made in tables.items()}
    return facts, tables


def bench_page(facts: Mapping[str, Any], parts: Measured) -> str:
    from app.report import html_page as html

    settings = facts["settings"]
    run = [*machine_words(facts["machine"]), f"{settings['threads']} threads"]
    run += [*(["quick"] if settings["quick"] else []), facts["date"], f"{facts['seconds']:.0f} s"]
    blocks = [
        html.paragraph(LEAD, "lead"),
        html.paragraph(" · ".join(run), "run"),
    ]
    for name, tables in parts.items():
        blocks.append(html.heading(2, PARTS[name]))
        for table in tables:
            blocks += [
                html.heading(3, table.title),
                html.paragraph(table.text) if table.text else "",
            ]
            drawn = chart_png(table, titled=False)
            if drawn is not None and table.chart is not None:
                blocks.append(html.drawn(drawn, table.chart.title or table.title, table.title))
            cells = table.cells()
            told = {cell for row in cells for cell in row if cell.startswith(("met", "missed"))}
            marks = {cell: "good" if cell.startswith("met") else "bad" for cell in told}
            judged = {index: marks for index, head in enumerate(table.heads) if head == "verdict"}
            if cells:
                heads = list(table.heads.values())
                blocks.append(html.grid(heads, cells, numbers=table.numeric(), marks=judged))
    return html.page(TITLE, blocks)
