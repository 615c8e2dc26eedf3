"""Every network ever shipped, run headless as ``imagechain run`` does: the files it delivers."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from app.run.transfer_chain import find_output
from child_process import ROOT
from command_line import run_here
from core.chain.engine import Engine, Plan
from core.network.file import load_network
from nodes.library import standard_library
from region_checks import image_ports

PRECISIONS = ("single", "double")
PICTURE, MTF, READOUTS = "final.npy", "mtf.csv", "readouts.json"
REPORTS = ("report.json", "report.html")
STATE = "state"  # beside the outputs: what runs remember stays out of the user's own folder


def network_files() -> dict[str, Path]:
    """The shipped networks and all their earlier versions, by name."""
    folders = (ROOT / "networks", ROOT / "tests" / "networks" / "ever_shipped")
    paths = [path for folder in folders for path in sorted(folder.glob("*.json"))]
    files = {path.stem: path for path in paths}
    assert len(files) == len(paths), "two network files of one name"
    return files


def plan_of(path: Path) -> Plan:
    """The network planned; nothing is computed."""
    library = standard_library()
    return Engine(library).plan(load_network(path, library=library), folder=path.parent)


def smaller_scenes(plan: Plan, largest: int) -> list[str]:
    """Words for ``run`` that make each side of a test scene at most so many samples.

    A camera that looks down on them gets samples as much larger, so that it sees the same ground.
    """
    modules: dict[str, Any] = {name: node.module for name, node in plan.nodes.items()}
    keys = {name: node.declaration.key for name, node in plan.nodes.items()}
    words, shrunk = [], 1.0
    for name, module in modules.items():
        if keys[name] == "test_scene":
            for side in ("width", "height"):
                samples = getattr(module, side)
                if samples > largest:
                    words.append(f"--set={name}.{side}={largest}")
                    shrunk = max(shrunk, samples / largest)
    for name, module in modules.items():
        if keys[name] == "camera_geometry" and shrunk > 1:
            words.append(f"--set={name}.ground_interval_m={module.ground_interval_m * shrunk}")
    return words


def run_network(path: Path, folder: Path, *words: str, precision: str, threads: int = 1) -> None:
    """Run the network; `folder` gets its files and the samples of its final picture.

    Raises
    ------
    RuntimeError
        If the run fails, with what it says.
    """
    port = find_output(plan_of(path)).port
    assert port is not None, f"{path.stem} delivers no picture"
    _run(path, folder, f"--save={port}={folder / PICTURE}", *words, f"--threads={threads}",
         f"--precision={precision}")  # fmt: skip


def run_with_reports(path: Path, folder: Path, *, precision: str) -> dict[str, np.ndarray]:
    """Run the network with both reports; gives the samples of every picture of its nodes.

    Its clock stands still, so that the reports hold the same times whenever they are made.
    """
    files = {port: folder / f"{port}.npy" for port in image_ports(plan_of(path))}
    words = [f"--save={port}={file}" for port, file in files.items()]
    words += [f"--report={folder / name}" for name in REPORTS]
    with _standing_clock():
        _run(path, folder, *words, f"--precision={precision}", "--threads=1")
    pictures = {port: np.load(file) for port, file in files.items()}
    for file in files.values():
        file.unlink()
    return pictures


def _run(path: Path, folder: Path, *words: str) -> None:
    folder.parent.mkdir(parents=True, exist_ok=True)
    state = {"XDG_STATE_HOME": str(folder.parent / STATE)}
    done = run_here("run", path, f"--output-dir={folder}", *words, folder=folder.parent, env=state)
    if done.returncode != 0:
        raise RuntimeError(f"{path.stem}: {done.stderr.strip()}")


@contextlib.contextmanager
def _standing_clock() -> Iterator[None]:
    with (
        patch("time.perf_counter", return_value=0.0),
        patch("time.strftime", return_value="(date)"),
    ):
        yield
