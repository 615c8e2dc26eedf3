"""``imagechain bench``: run time against error, in units of a bare Fourier round trip."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from app.bench.tables import Table
from app.bench.timing import SIZE, Settings, isolate, machine_facts, machine_words
from app.options.command_options import Options
from app.run.readout_tables import jsonable
from app.run.staging import Staging
from core.atomic import write_text
from core.evaluation.policy import Policy

PARTS = {
    "speed": "Speed",
    "precision": "Time against error",
    "peers": "Beside other programs",
    "studies": "Studies",
    "measure": "Measuring pictures, and fitting to them",
}
TITLE = "Imagechain: run time against error"
LEAD = (
    "Time is given in T0, the bare round trip irfft2(rfft2(image)) of the same image, type and "
    "threads, measured in turn with the subject: what any Fourier method has to pay. Medians of "
    "the ratios of pairs."
)
Measures = Sequence[Callable[[Settings], list[Table]]]
Measured = Mapping[str, Sequence[Table]]


def bench(options: Options) -> None:
    """Measure and print the parts of the options; write their files when all is done.

    Raises
    ------
    ImagechainError
        If a file cannot be written, or a size cannot be taken.
    """
    isolate()
    settings = Settings(SIZE if options.size is None else options.size, options.quick)
    files = [path for path in (options.bench_json, options.bench_html) if path is not None]
    with Staging(None) as staging:
        for path in files:
            staging.claim(path)
        names = [name for name in PARTS if name in (options.parts or PARTS)]
        wanted = {name: import_module(f"app.bench.{name}").MEASURES for name in names}
        facts, parts = measured(wanted, PARTS, settings)
        if options.bench_json is not None:
            text = json.dumps(jsonable(facts), indent=1, ensure_ascii=False, allow_nan=False)
            _stage(staging, options.bench_json, text + "\n")
        if options.bench_html is not None:
            _stage(staging, options.bench_html, _page(facts, parts))
        staging.commit()
    print(f"{facts['seconds']:.0f} s" + "".join(f"; wrote {path}" for path in files))


def measured(
    parts: Mapping[str, Measures], titles: Mapping[str, str], settings: Settings
) -> tuple[dict[str, Any], Measured]:
    """Facts of the JSON file, and the tables of each part; printed as soon as they are there."""
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
    print(
        f"{machine['processor']}, {machine['usable_cores']} of {machine['cores']} cores, "
        f"load {machine['load']:.1f}; {versions}; periodic frames by {machine['fft']}\n"
        "T0 = scipy.fft.irfft2(scipy.fft.rfft2(image)), same image, type and threads, measured in "
        "turn with the subject",
        flush=True,
    )
    tables: dict[str, list[Table]] = {}
    for name, measures in parts.items():
        print(f"\n== {titles[name]} ==", flush=True)
        tables[name] = []
        for table in (table for measure in measures for table in measure(settings)):
            print("\n" + table.terminal(), flush=True)
            tables[name].append(table)
    facts["seconds"] = time.perf_counter() - start
    facts["parts"] = {name: [table.facts() for table in made] for name, made in tables.items()}
    return facts, tables


def _page(facts: Mapping[str, Any], parts: Measured) -> str:
    """One HTML page that needs no other file."""
    from app.bench.charts import chart_png
    from app.report.blocks import Block, Drawn, Grid, Heading, Text
    from app.report.html_page import html_page

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


def _stage(staging: Staging, target: Path, text: str) -> None:
    staging.write(target, lambda path: write_text(path, text))
