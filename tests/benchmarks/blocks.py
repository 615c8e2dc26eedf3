"""The whole chain on frames in memory and in blocks: time, memory and disk a sample.

Run as a module it is the process that is measured: ``FOLDER SIZE MEMORY`` runs the chain there.
"""

import contextlib
import io
import json
import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from app.bench.tables import Table, verdict
from app.bench.timing import SIZE, Settings
from app.run.shipped import find_network
from benchmark_processes import figures_of
from growth import high_water

IN_MEMORY = "8TB"
REFERENCE, LARGE, HUGE = 2048, 8192, 32768
BUDGETS = {LARGE: "512MB", 16384: "1GB", HUGE: "2GB"}
TIMES_REACH, MEMORY_REACH_MB, GROWTH_REACH = 3.0, 3000.0, 1.2
PICTURES_AT_ONCE = 8  # of a run in memory
SCRATCH_BYTES = 16  # of a sample that lie on disk at a time, scene and output included
_ROWS = 256
_LAY_ON_DISK = re.compile(r"^in blocks: .* up to ([0-9.]+) (kB|MB|GB) lay on disk", re.MULTILINE)
_GB_OF = MappingProxyType({"kB": 1e-6, "MB": 1e-3, "GB": 1.0})


def scale_blocks(settings: Settings) -> list[Table]:
    """Frames in memory and in blocks, and what that makes of large plans."""
    runs = _runs(settings)
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(dir=Path.cwd()) as folder:
        for size in dict.fromkeys(size for size, _ in runs):
            needed = SCRATCH_BYTES * size * size
            if needed > shutil.disk_usage(folder).free:
                rows.append({"size": size, "way": f"left out: {needed / 1e9:.0f} GB of disk"})
                continue
            _draw(Path(folder), size)
            for memory in [memory for other, memory in runs if other == size]:
                rows.append({"size": size, **_child(folder, size, memory)})
            (Path(folder) / "scene.img").unlink()
    return [_frames(rows), _plans(rows)]


def _runs(settings: Settings) -> list[tuple[int, str]]:
    """Sizes, and what their pictures may take."""
    if settings.quick or settings.size != SIZE:
        size = settings.size
        return [(size, IN_MEMORY), (size, f"{24 * size * size / 1000}kB")]
    return [(REFERENCE, IN_MEMORY), (LARGE, IN_MEMORY), *BUDGETS.items()]


def _frames(rows: list[dict[str, Any]]) -> Table:
    measured = [row for row in rows if "seconds" in row]
    memory = [row for row in measured if row["way"] == "in memory"][-1]
    blocks = [row for row in measured if row["way"] == "in blocks"]
    for row in blocks:
        row["times"] = row["ns"] / memory["ns"]
        if row["size"] > memory["size"]:
            row["verdict"] = verdict(row["times"], TIMES_REACH, 2.0)
            row["memory_verdict"] = verdict(row["peak_MB"], MEMORY_REACH_MB, MEMORY_REACH_MB / 2)
    growth = blocks[-1]["ns"] / blocks[0]["ns"]
    cpu = blocks[-1]["cpu_ns"] / blocks[0]["cpu_ns"]
    text = (
        "Kodak's optics, noises and quantizer, single precision, from an ENVI file to an ENVI "
        f"file, each once in a fresh process. Limit: {TIMES_REACH:g} × the time per sample of the "
        f"frame in memory, {MEMORY_REACH_MB / 1000:g} GB resident (mapped pages included), and "
        f"{GROWTH_REACH - 1:.0%} more per sample from the smallest frame in blocks to the largest: "
        f"it is {growth - 1:+.0%} of time, {cpu - 1:+.0%} of computing. Frames that the system's "
        "cache holds never wait for the disk; larger ones wait for what they have written."
    )
    heads = {
        "size": "size",
        "way": "way",
        "memory": "allowed",
        "seconds": "s",
        "ns": "ns a sample",
        "times": "× in memory",
        "verdict": "",
        "cpu_ns": "ns of computing",
        "peak_MB": "peak memory, MB",
        "memory_verdict": "",
        "written": "bytes written a sample",
        "scratch_GB": "scratch, GB",
    }
    title = "Frames beyond memory: the whole chain in blocks"
    return Table("scale_blocks", title, heads, rows, text)


def _plans(rows: list[dict[str, Any]]) -> Table:
    measured = [row for row in rows if "seconds" in row]
    memory = next(row for row in measured if row["way"] == "in memory")
    blocks = [row for row in measured if row["way"] == "in blocks"][-1]
    pixels = blocks["size"] ** 2
    scratch = 1e9 * blocks["scratch_GB"] / pixels
    plans = [
        *(scenes_plan(memory["cpu_ns"], 10**6, 512, cores) for cores in (2, 64, 1024)),
        *(frame_plan(blocks["cpu_ns"], blocks["written"], scratch, 10**5, cores)
          for cores in (2, 16)),
    ]  # fmt: skip
    heads = {
        "what": "what",
        "cores": "cores",
        "core_hours": "core hours",
        "hours": "hours",
        "limit": "bound by",
        "disk_GB": "disk, GB",
        "memory_GB": "memory, GB",
    }
    text = (
        f"The rates measured above, carried on in proportion: computing a sample in memory at "
        f"{memory['size']}², in blocks at {blocks['size']}². Scenes are spread over cores without "
        "loss, which a study comes close to where a scene takes a second or more; a frame is made "
        "on one machine, whose disk writes 1 GB/s. Disk holds inputs, outputs and scratch."
    )
    return Table("scale_plan", "From measured rates to a plan", heads, plans, text)


def scenes_plan(core_ns: float, scenes: int, side: int, cores: int) -> dict[str, Any]:
    """Many scenes in memory, one on each core at a time; inputs and outputs on disk."""
    samples = scenes * side * side
    hours = samples * core_ns / 3.6e12
    row = {"what": f"{scenes:,} scenes of {side}²", "cores": cores, "core_hours": hours}
    row |= {"hours": hours / cores, "limit": "computing", "disk_GB": 8e-9 * samples}
    return row | {"memory_GB": 1e-9 * cores * side * side * 4 * PICTURES_AT_ONCE}


def frame_plan(
    core_ns: float, written: float, scratch: float, side: int, cores: int
) -> dict[str, Any]:
    """One frame in blocks on a machine: as long as its computing, or as its disk writes 1 GB/s."""
    samples = side * side
    core_hours = samples * core_ns / 3.6e12
    computing, writing = core_hours / cores, samples * written / 1e9 / 3600.0
    row = {"what": f"a frame of {side:,}²", "cores": cores, "core_hours": core_hours}
    limit = "computing" if computing >= writing else "the disk"
    row |= {"hours": max(computing, writing), "limit": limit, "memory_GB": 2.0}
    return row | {"disk_GB": 1e-9 * samples * (8.0 + scratch)}


def _draw(folder: Path, size: int) -> None:
    """A scene of bars and waves, by rows, and the network that reads it."""
    columns = np.arange(size, dtype=np.float32)
    across = np.sin(columns / 37) + columns // 64 % 2
    with (folder / "scene.img").open("wb") as file:
        for top in range(0, size, _ROWS):
            rows = np.arange(top, min(top + _ROWS, size), dtype=np.float32)[:, np.newaxis]
            file.write((10 + across * np.cos(rows / 53)).astype("<f4").tobytes())
    header = f"ENVI\nsamples = {size}\nlines = {size}\nbands = 1\ndata type = 4\nbyte order = 0\n"
    (folder / "scene.img.hdr").write_text(header + "interleave = bsq\nheader offset = 0\n")
    network = json.loads(find_network("kodak_kir310").path.read_text())
    nodes = network["nodes"]
    names = ("fov_x_deg", "fov_y_deg", "cut_on_um", "cut_off_um")
    given = {name: nodes["scene"]["params"][name] for name in names}
    nodes["scene"] = {"module": "read_image", "params": {"path": "scene.img", **given}}
    del nodes["frame_grabber"], nodes["picture"]
    links = [link for link in network["links"] if not {"frame_grabber", "picture"} & _nodes(link)]
    kept = {key: network[key] for key in ("format", "version", "name", "seed") if key in network}
    text = json.dumps({**kept, "nodes": nodes, "links": links})
    (folder / "net.json").write_text(text)


def _nodes(link: list[str]) -> set[str]:
    return {end.rpartition(".")[0] for end in link}


def _child(folder: str, size: int, memory: str) -> dict[str, Any]:
    (figures,) = figures_of("blocks", folder, size, memory)
    return {**figures, "memory": "all" if memory == IN_MEMORY else memory}


def _run(folder: Path, size: int, memory: str) -> dict[str, Any]:
    from app.command.cli import main

    os.chdir(folder)
    words = ["run", "net.json", "--memory", memory, "--save", "electronics.image=out.img"]
    start, before, used = time.perf_counter(), _written(), os.times()
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        code = main([*words, "--output-dir", "out"])
    seconds = time.perf_counter() - start
    if code:
        raise SystemExit(code)
    lay = _LAY_ON_DISK.search(said.getvalue())
    now, samples = os.times(), size * size
    return {
        "way": "in memory" if lay is None else "in blocks",
        "seconds": seconds,
        "ns": 1e9 * seconds / samples,
        "cpu_ns": 1e9 * (now.user + now.system - used.user - used.system) / samples,
        "peak_MB": high_water() / 1e6,
        "written": (_written() - before) / samples,
        "scratch_GB": 0.0 if lay is None else float(lay[1]) * _GB_OF[lay[2]],
    }


def _written() -> int:
    """Bytes that this process has had written to disk, or is to."""
    try:
        lines = Path("/proc/self/io").read_text().splitlines()
        return next(int(line.split()[1]) for line in lines if line.startswith("write_bytes"))
    except (OSError, StopIteration):
        return 0


MEASURES = (scale_blocks,)

if __name__ == "__main__":
    print(json.dumps(_run(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3])))
