"""``imagechain bench``: run time against error, in units of a bare Fourier round trip."""

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from app.bench.tables import Table
from app.bench.timing import Settings, machine_facts, machine_words
from core.evaluation.work import Policy

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
    from app.bench.tables import chart_png
    from app.report.html_page import Block, Drawn, Grid, Heading, Text, html_page

    settings = facts["settings"]
    run = [*machine_words(facts["machine"]), f"{settings['threads']} threads"]
    run += [*(["quick"] if settings["quick"] else []), facts["date"], f"{facts['seconds']:.0f} s"]
    blocks: list[Block] = [Heading(1, TITLE), Text(LEAD, "lead"), Text(" · ".join(run), "run")]
    for name, tables in parts.items():
        blocks.append(Heading(2, PARTS[name]))
        for table in tables:
            blocks += [Heading(3, table.title), *([Text(table.text)] if table.text else [])]
            drawn = chart_png(table, titled=False)
            if drawn is not None and table.chart is not None:
                blocks.append(Drawn(drawn, table.chart.title or table.title, table.title))
            cells = table.cells()
            told = {cell for row in cells for cell in row if cell.startswith(("met", "missed"))}
            marks = {cell: "good" if cell.startswith("met") else "bad" for cell in told}
            judged = {index: marks for index, head in enumerate(table.heads) if head == "verdict"}
            if cells:
                heads = list(table.heads.values())
                blocks.append(Grid(heads, cells, numbers=table.numeric(), marks=judged))
    return html_page(TITLE, blocks)
