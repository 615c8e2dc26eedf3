"""The table of what every network delivers: hashes of one machine, statistics for all others."""

import json
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from child_process import ROOT
from machine_tag import machine_tag
from network_outputs import PRECISIONS, network_files, plan_of, run_network, smaller_scenes
from output_statistics import PARTS, TOLERANCE, differences, hashes_of, statistics_of

TABLE = ROOT / "tests" / "networks" / "picture_hashes.json"
LARGEST = 256  # side of a scene: what is computed is the same, and costs half of the full size
MOST_SAID = 4
_KEY_LENGTH = 16

Table = dict[str, dict[str, Any]]


def read_table() -> Table:
    """The stored table."""
    table: Table = json.loads(TABLE.read_text(encoding="utf-8"))
    return table


def make_table(report: Callable[[str], object]) -> Table:
    """The table as this machine makes it."""
    runs: dict[str, Any] = {}
    statistics: dict[str, Any] = {}
    for name, path in network_files().items():
        for precision in PRECISIONS:
            with tempfile.TemporaryDirectory() as place:
                folder = small_run(path, Path(place), precision)
                hashes, figures = hashes_of(folder), statistics_of(folder)
            runs[f"{name} {precision}"] = hashes
            # Versions of one network mostly deliver the same, which is written once.
            statistics |= {_key(part, hashes[part]): figures[part] for part in PARTS}
            report(f"{name} {precision}")
    return {"machine": machine_tag(), "runs": runs, "statistics": statistics}


def write_table(table: Mapping[str, Mapping[str, Any]]) -> None:
    """Store the table, an entry a line."""
    sections = []
    for section, entries in table.items():
        lines = (f"  {json.dumps(name)}: {json.dumps(entry)}" for name, entry in entries.items())
        sections.append(f"{json.dumps(section)}: {{\n" + ",\n".join(lines) + "\n}")
    TABLE.write_text("{\n" + ",\n".join(sections) + "\n}\n", encoding="utf-8")


def small_run(path: Path, place: Path, precision: str) -> Path:
    """Run the network with small scenes; gives the folder of its files."""
    folder = place / path.stem
    run_network(path, folder, *smaller_scenes(plan_of(path), LARGEST), precision=precision)
    return folder


def disagreements(
    table: Table, machine: Mapping[str, Any], name: str, precision: str, folder: Path
) -> list[str]:
    """Where a run differs from the table: in any bit on the table's machine, else beyond rounding.

    Empty where they agree.
    """
    stored, present = table["runs"][f"{name} {precision}"], hashes_of(folder)
    parts = [part for part in PARTS if stored[part] != present[part]]
    figures = statistics_of(folder) if parts else {}
    lines = []
    for part in parts:
        before = table["statistics"][_key(part, stored[part])]
        beyond = differences(part, before, figures[part], TOLERANCE[precision])
        lines += beyond[:MOST_SAID]
        if len(beyond) > MOST_SAID:
            lines.append(f"{part}: {len(beyond) - MOST_SAID} more figures")
        if not beyond and machine == table["machine"]:
            lines.append(f"{part}: other bits on the same machine, alike within {precision}")
    return lines


def _key(part: str, digest: str) -> str:
    return f"{part} {digest[:_KEY_LENGTH]}"
