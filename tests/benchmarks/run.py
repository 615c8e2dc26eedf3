"""What only builders measure, and the handbook's page of speed and accuracy.

    python tests/benchmarks/run.py [--only PART]... [--quick] [--size N] [--json FILE]
    python tests/benchmarks/run.py --page

With ``--page`` the tables of that page and its pictures are made anew, on a quiet machine: those of
`imagechain bench` that stand there, and the line scanner's.
"""

import argparse
import json
from importlib import import_module
from pathlib import Path

from app.bench.tables import PARTS as USERS
from app.bench.tables import chart_png, measured
from app.bench.timing import SIZE, Settings, isolate
from app.run.terminal import jsonable
from page import inserted, section

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "app/handbook/pages/speed_and_accuracy.md"
PICTURES = ROOT / "networks/pictures"
DRAWN = {"networks", "peers", "scanning"}
PARTS = {
    "editor": "The window",
    "growth": "As the picture grows",
    "blocks": "Frames beyond memory",
    "scanning": "Line by line, or the whole image at once",
    "cameras": "A camera and its frames",
}


def main() -> None:
    """Measure, print, and write what is asked for."""
    parser = argparse.ArgumentParser(description="What only builders measure.")
    parser.add_argument("--only", action="append", choices=PARTS, help="measure this part")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions and sizes")
    parser.add_argument("--size", type=int, default=SIZE, help="samples along a side")
    parser.add_argument("--json", type=Path, help="write every figure")
    parser.add_argument("--page", action="store_true", help="make the handbook's tables anew")
    given = parser.parse_args()
    isolate()
    settings = Settings(given.size, given.quick)
    if given.page:
        parts = {name: import_module(f"app.bench.{name}").MEASURES for name in ("speed", "peers")}
        parts["scanning"] = import_module("scanning").MEASURES
    else:
        parts = {name: import_module(name).MEASURES for name in given.only or PARTS}
    facts, tables = measured(parts, {**USERS, **PARTS}, settings)
    if given.json:
        given.json.write_text(json.dumps(jsonable(facts), indent=1, ensure_ascii=False) + "\n")
    if given.page:
        shown = [table for name in ("speed", "peers") for table in tables[name]]
        PAGE.write_text(inserted(PAGE.read_text(), section(facts, shown)))
        for table in (table for made in tables.values() for table in made):
            if table.name in DRAWN and (drawn := chart_png(table)):
                (PICTURES / f"bench_{table.name}.png").write_bytes(drawn)


if __name__ == "__main__":
    main()
