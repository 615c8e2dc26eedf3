"""Random networks through the real commands: checked, run, varied, run again.

    python tests/fuzz/networks.py --count 50000 --seed 1

A finding is printed with the words that repeat it; the figures come at the end. Of the networks
90 % are run and 10 % varied by `tradeoff`. Of the runs 15 % of those that succeed are repeated with
another number of threads, to the same bits; 25 % write a report as JSON, 0.6 % as HTML. Every file
a run writes is whole, and finite where it holds numbers. Pictures have sides of 1 to 64; of 100
networks 4 have pictures of a single line and 2 large ones of up to 509.

Case N of seed S is the same whatever is run before it. A case that hangs, fills memory or crashes
ends the command; it has said its number, and says where every thread stood.
"""

import argparse
import contextlib
import faulthandler
import io
import json
import math
import os
import resource
import shutil
import sys
import tempfile
import time
import traceback
import types
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

# As the command itself has it; numpy, which reads it, is imported here before the command runs.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Else argparse looks for translations of its words on the disk, two dozen times a command.
os.environ.setdefault("LANGUAGE", "C")

# This file is named like the package of the shipped networks: the root comes before its folder.
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np
from library_networks import Document, Network

import app.command.cli
from core.modules.declaration import declaration
from nodes.files.formats import read_pixels
from nodes.library import standard_library

LIMIT_S = 600.0
MEMORY = 6 * 2**30  # bytes of address space; threads' stacks are part of it
NAME = "net.json"
OUTPUT = "out"
FIGURES, PAGE = "report.json", "report.html"
IMAGES = (".npy", ".exr", ".tif", ".png", ".csv", ".tiff")
SUFFIXES = {"table": (".csv",), "context": (".csv",), "curve": (".csv", ".npy", ".exr", ".tif")}


class FindingError(AssertionError):
    """Something that must not happen; the message says what."""


@dataclass
class Case:
    """One case: its own random numbers, an empty folder, and what it counts for the table."""

    seed: int
    number: int
    folder: Path
    counts: Counter[str] = field(default_factory=Counter)

    @property
    def random(self) -> Random:
        """The case's random numbers, from their beginning."""
        return Random(f"{self.seed}/{self.number}")

    def expect(self, good: bool, message: str) -> None:
        """Raise a finding unless it is good."""
        if not good:
            raise FindingError(message)


# The command ignores warnings; here each is an error, and so a finding.
app.command.cli.warnings = types.SimpleNamespace(
    catch_warnings=warnings.catch_warnings, simplefilter=lambda *_: warnings.simplefilter("error")
)


def ended(case: Case, words: list[str]) -> tuple[int, str]:
    """Exit code and stderr of a command; other ends than 0, or 2 with one line, are findings."""
    told = io.StringIO()
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(told):
        code = app.command.cli.main(words)
    error = told.getvalue()
    said = f"imagechain {' '.join(words)}: exit code {code}: {error[:600]!r}"
    case.expect(code in (0, 2), said)
    line = error.removesuffix("\n")
    begins = line.startswith("imagechain: ") and len(line) > len("imagechain: ") + 8
    one_line = error.endswith("\n") and line.isprintable() and begins
    case.expect(one_line if code else not error, f"not one plain line, or one too many: {said}")
    case.counts[f"{words[0]}: exit code {code}"] += 1
    return code, error


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder with its bytes."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def try_network(case: Case) -> None:
    """Draw a network and run it in one of several ways."""
    random = case.random
    drawn = Network(random, case.folder)
    document = drawn.document()
    Path(NAME).write_text(json.dumps(document))
    inputs = contents(case.folder)
    checked, problems = ended(case, ["check", NAME])
    if random.random() < 0.1:
        _trade_off(case, random, document)
        return
    words = ["run", NAME, "--output-dir", OUTPUT, *_options(random, drawn)]
    if ended(case, words)[0]:
        _expect_nothing_written(case, inputs)
        return
    case.expect(checked == 0, f"run succeeds where check says {problems!r}")
    written = contents(case.folder)
    case.expect(
        all(written.get(name) == content for name, content in inputs.items()),
        "run has changed a file that is not its own",
    )
    made = {name: content for name, content in written.items() if name not in inputs}
    for name, content in made.items():
        _expect_whole(case, name, content)
    for name in ("mtf.csv", "readouts.json"):
        case.expect(f"{OUTPUT}/{name}" in made, f"{name} is missing")
    if random.random() < 0.15:
        _expect_same_bits(case, random, words, made)


def _expect_nothing_written(case: Case, inputs: dict[str, bytes]) -> None:
    left = contents(case.folder)
    more = sorted(left.keys() ^ inputs.keys())
    case.expect(left == inputs, f"refused, but files have changed: {more}")
    folders = [path.name for path in case.folder.iterdir() if path.is_dir()]
    case.expect(not folders, f"refused, but folders are left: {folders}")


def _options(random: Random, drawn: Network) -> list[str]:
    words: list[str] = []
    suffix = ""
    # Of a node that was taken away there is nothing to save, which is refused.
    there = {
        kind: [port for port in ports if port.rpartition(".")[0] in drawn.nodes]
        for kind, ports in drawn.ports.items()
    }
    kinds = [kind for kind, ports in there.items() if ports]
    for number in range(random.choice((0, 0, 1, 3)) if kinds else 0):
        kind = random.choice(kinds)
        port = random.choice(there[kind])
        suffix = random.choice(SUFFIXES.get(kind, IMAGES))
        if kind == "image" and random.random() < 0.2:
            port += f"[{random.choice(('', '0', '1'))}:,:{random.choice(('', '1', '7'))}]"
        words += ["--save", f"{port}=saved{number}{suffix}"]
    if suffix == ".npy" and random.random() < 0.5:
        words += ["--frames", str(random.randint(1, 3))]
    if random.random() < 0.25:
        words += ["--report", FIGURES]
    if random.random() < 0.006:
        words += ["--report", PAGE]
    if random.random() < 0.3:
        words += ["--precision", "double"]
    if random.random() < 0.2:
        words += ["--tolerance", random.choice(("0", "1e-6", "0.01", "0.9"))]
    if random.random() < 0.3:
        words += ["--threads", random.choice(("1", "2"))]
    if random.random() < 0.2:
        words += ["--seed", str(random.getrandbits(random.choice((3, 63))))]
    return words


def _trade_off(case: Case, random: Random, document: Document) -> None:
    """Vary a number of the network; a value at which it fails is a gap, not a failure."""
    numbers = [
        (name, parameter.name)
        for name, node in document["nodes"].items()
        for parameter in declaration(standard_library()[node["module"]]).parameters
        if parameter.kind == "number"
    ]
    node, parameter = random.choice(numbers)
    values = random.choice(("0.5:2:3", "1,2", "1e-3:10:4:log", "0,1", "-1:1:3"))
    words = ["tradeoff", NAME, "--vary", f"{node}.{parameter}={values}", "--output", "figures.json"]
    if random.random() < 0.3:
        words += ["--output", "figures.csv"]
    if random.random() < 0.02:
        words += ["--output", "figures.html"]
    if ended(case, words)[0] == 0:
        _expect_whole(case, "figures.json", Path("figures.json").read_bytes())


def _expect_whole(case: Case, name: str, content: bytes) -> None:
    """A file that can be read and holds finite numbers alone."""
    path = Path(name)
    case.expect(bool(content), f"{name} is empty")
    if path.suffix == ".json":
        json.loads(content, parse_constant=lambda text: case.expect(False, f"{name} holds {text}"))
    elif path.suffix == ".npy":
        samples = np.load(path)
        case.expect(bool(np.isfinite(samples).all()), f"{name} holds samples that are not finite")
    elif path.suffix in (".exr", ".tif", ".tiff"):
        samples = read_pixels(path)
        case.expect(bool(np.isfinite(samples).all()), f"{name} holds samples that are not finite")
    elif path.suffix == ".csv":
        cells = [cell for line in content.decode().splitlines() for cell in line.split(",")]
        bad = [cell for cell in cells if _is_not_finite(cell)]
        case.expect(not bad, f"{name} holds {bad[:3]}")
    elif path.suffix == ".png":
        case.expect(content[:4] == b"\x89PNG" and content[-8:-4] == b"IEND", f"{name} is no PNG")
    elif path.suffix == ".html":
        case.expect(content.rstrip().endswith(b"</html>"), f"{name} has no end")
    case.counts[f"files {path.suffix}"] += 1


def _is_not_finite(cell: str) -> bool:
    try:
        return not math.isfinite(float(cell))
    except ValueError:
        return False


def _expect_same_bits(case: Case, random: Random, words: list[str], made: dict[str, bytes]) -> None:
    """The same command again, in a copy of the folder, with another number of threads."""
    again = case.folder / "again"
    again.mkdir()
    for path in case.folder.iterdir():
        if path.is_file() and path.name not in made:
            shutil.copy(path, again)
    # Threads may be given once; a page, which nothing is compared with, takes longest.
    chosen = [*words[:2]]
    for option, value in zip(words[2::2], words[3::2], strict=True):
        if option != "--threads" and value != PAGE:
            chosen += [option, value]
    with contextlib.chdir(again):
        code, error = ended(case, [*chosen, "--threads", random.choice(("1", "2", "3"))])
    case.expect(code == 0, f"succeeds once, and then says {error!r}")
    for name, content in made.items():
        if name not in (FIGURES, PAGE):  # a report gives the time it took
            case.expect((again / name).read_bytes() == content, f"{name} differs the second time")
    case.counts["same bits twice"] += 1


def finding(case: Case) -> str | None:
    """Carry out a case in its folder; what it found."""
    try:
        with contextlib.chdir(case.folder):
            try_network(case)
    except FindingError as error:
        return str(error)
    except Exception as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"
    return None


def main() -> int:
    """The command line; 1 where there are findings."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=1000, help="cases (default 1000)")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default 1)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case (default 0)")
    words = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    # In memory flushing a file costs nothing.
    place = "/dev/shm" if "TMPDIR" not in os.environ and os.access("/dev/shm", os.W_OK) else None
    start, counts = time.monotonic(), Counter[str]()
    for number in range(words.first, words.first + words.count):
        print(f"--seed {words.seed} --first {number}", end="\r", file=sys.stderr, flush=True)
        faulthandler.dump_traceback_later(LIMIT_S, exit=True)
        with tempfile.TemporaryDirectory(prefix="fuzz-", dir=place) as folder:
            found = finding(Case(words.seed, number, Path(folder), counts))
        if found:
            counts["findings"] += 1
            print(f"FINDING --seed {words.seed} --first {number}: {found}", flush=True)
    faulthandler.cancel_dump_traceback_later()
    figures = {"cases": words.count, **dict(sorted(counts.items())), "findings": counts["findings"]}
    for name, value in {**figures, "seconds": round(time.monotonic() - start)}.items():
        print(f"{name:<40}  {value:>9,}")
    return 1 if counts["findings"] else 0


if __name__ == "__main__":
    sys.exit(main())
