"""Show that every network ever shipped delivers what it did, to the last bit.

    python tests/networks/picture_hashes.py --write
        store hashes and statistics of small runs for the test
    python tests/networks/picture_hashes.py --full --into BEFORE
        keep all files of runs at full size, in BEFORE/<network>/<precision>/
    python tests/networks/picture_hashes.py --full --into AFTER --against BEFORE
        make them again and compare: "equal", or the first difference, of each network

Without --into, what is compared is made in a folder that is removed; NETWORK picks some of them.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

# This file lies in a folder named like the package of the shipped networks: the root comes first.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command and the tests have it

from machine_tag import machine_tag
from network_outputs import PRECISIONS, STATE, network_files
from output_folders import first_difference, write_outputs
from picture_table import make_table, write_table

MACHINE = "machine.json"


def compare_at_full_size(names: list[str], into: Path, against: Path | None) -> int:
    """Run the networks into a folder and compare each as it is done; gives how many differ."""
    into.mkdir(parents=True, exist_ok=True)
    (into / MACHINE).write_text(json.dumps(machine_tag(), indent=1), encoding="utf-8")
    if against is not None and (difference := first_difference_of_machines(against, into)):
        print(f"another machine or other libraries: bits may differ for it ({difference})")
    differing = 0
    for name in names:
        start = time.perf_counter()
        folder = into / name
        if folder.exists():
            shutil.rmtree(folder)
        write_outputs(network_files()[name], folder)
        for precision in PRECISIONS:
            shutil.rmtree(folder / precision / STATE, ignore_errors=True)
        verdict = "written"
        if against is not None:
            verdict = compared(against / name, folder)
            differing += verdict != "equal"
        print(f"{name}: {verdict} ({time.perf_counter() - start:.1f} s)", flush=True)
    return differing


def compared(before: Path, after: Path) -> str:
    """What is said of a network's two folders."""
    if not before.is_dir():
        return f"there is no {before}"
    return first_difference(before, after) or "equal"


def first_difference_of_machines(before: Path, after: Path) -> str | None:
    """The first entry in which the machines differ that made the folders."""
    tags = [json.loads((folder / MACHINE).read_text(encoding="utf-8")) for folder in
            (before, after)]  # fmt: skip
    names = (name for name in {**tags[0], **tags[1]} if tags[0].get(name) != tags[1].get(name))
    return next(names, None)


def main() -> int:
    """Carry out the command; 1 where something differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("networks", nargs="*", metavar="NETWORK", help="all where none is given")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true", help="store the test's table")
    what.add_argument("--full", action="store_true", help="run at full size")
    parser.add_argument("--into", type=Path, metavar="FOLDER", help="where the files go")
    parser.add_argument("--against", type=Path, metavar="FOLDER", help="made before")
    given = parser.parse_args()
    if given.write:
        if given.networks or given.into or given.against:
            parser.error("--write is for the whole table, and goes with nothing else")
        write_table(make_table(lambda run: print(run, flush=True)))
        return 0
    unknown = sorted(set(given.networks) - network_files().keys())
    if unknown:
        parser.error(f"there is no network {unknown[0]}; there are {', '.join(network_files())}")
    if given.into is None and given.against is None:
        parser.error("--full needs --into FOLDER, --against FOLDER, or both")
    if given.against is not None and not (given.against / MACHINE).is_file():
        parser.error(f"--against {given.against}: not a folder that --into has made")
    if given.into and given.against and given.into.resolve() == given.against.resolve():
        parser.error("--into and --against are one folder: nothing would be left to compare with")
    names = given.networks or list(network_files())
    with tempfile.TemporaryDirectory() as place:
        into = given.into or Path(place)
        return int(compare_at_full_size(names, into.resolve(), given.against) > 0)


if __name__ == "__main__":
    sys.exit(main())
