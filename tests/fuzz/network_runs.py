"""Drawn networks through `check`, `run`, `tradeoff`: whole and finite, or refused in one line."""

import contextlib
import json
import math
import shutil
from pathlib import Path
from random import Random

import numpy as np
from cases import Case
from commands import contents, ended
from library_networks import Document, Network

from core.modules.declaration import declaration
from nodes.files.formats import read_pixels
from nodes.library import standard_library

NAME = "net.json"
OUTPUT = "out"
FIGURES, PAGE = "report.json", "report.html"
IMAGES = (".npy", ".exr", ".tif", ".png", ".csv", ".tiff")
SUFFIXES = {"table": (".csv",), "context": (".csv",), "curve": (".csv", ".npy", ".exr", ".tif")}


def try_network(case: Case) -> None:
    """Draw a network and run it in one of several ways."""
    random = case.random
    drawn = Network(random, case.folder)
    document = drawn.document()
    Path(NAME).write_text(json.dumps(document))
    inputs = contents(case.folder)
    checked = ended(case, ["check", NAME])
    if random.random() < 0.1:
        _trade_off(case, random, document)
        return
    words = ["run", NAME, "--output-dir", OUTPUT, *_options(random, drawn)]
    end = ended(case, words)
    if end.code:
        _expect_nothing_written(case, inputs)
        return
    case.expect(checked.code == 0, f"run succeeds where check says {checked.err!r}")
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
    if ended(case, words).code == 0:
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
        end = ended(case, [*chosen, "--threads", random.choice(("1", "2", "3"))])
    case.expect(end.code == 0, f"succeeds once, and then says {end.err!r}")
    for name, content in made.items():
        if name not in (FIGURES, PAGE):  # a report gives the time it took
            case.expect((again / name).read_bytes() == content, f"{name} differs the second time")
    case.counts["same bits twice"] += 1
