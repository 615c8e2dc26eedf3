"""``imagechain bench``: run time against error, in units of a bare Fourier round trip."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from app.bench import LEAD, PARTS, TITLE, Measured, measured
from app.bench.timing import SIZE, Settings, isolate, machine_words
from app.command.results import say, show, written
from app.options.command_options import Options
from app.run.readout_tables import json_text


def carry_out(options: Options, stop: threading.Event) -> None:
    isolate()
    settings = Settings(SIZE if options.size is None else options.size, options.quick)
    files = [path for path in (options.json_file, options.html) if path is not None]
    names = [name for name in PARTS if name in (options.only or PARTS)]

    def made() -> tuple[dict[str, Any], Measured]:
        wanted = {name: import_module(f"app.bench.{name}").MEASURES for name in names}
        return measured(wanted, PARTS, settings, say=partial(say, options))

    def content(made: tuple[dict[str, Any], Measured], path: Path) -> str:
        return json_text(made[0], 1) if path == options.json_file else _page(*made)

    facts, _ = written(files, (), stop, made, content)
    end = f"{facts['seconds']:.0f} s" + "".join(f"; wrote {path}" for path in files)
    show(options, lambda: facts, end)


def _page(facts: Mapping[str, Any], parts: Measured) -> str:
    from app.bench.charts import chart_png
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
