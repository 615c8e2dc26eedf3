"""The whole chain on frames in memory and in blocks: time, memory and disk a sample.

Run as a module it is the process that is measured: ``FOLDER SIZE MEMORY`` runs the chain there.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from app.bench.measuring.bench_settings import SIZE, Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.bench.measuring.isolation import environment
from app.bench.scale.cluster_plan import Rates, frame_plan, scenes_plan
from app.bench.speed.growth import high_water
from app.run.own_process import command
from app.run.shipped import find_network

IN_MEMORY = "8TB"
REFERENCE, LARGE, HUGE = 2048, 8192, 32768
BUDGETS = {LARGE: "512MB", 16384: "1GB", HUGE: "2GB"}
TIMES_REACH, MEMORY_REACH_MB, GROWTH_REACH = 3.0, 3000.0, 1.2
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
        f"file, each once in a fresh process. Reach: {TIMES_REACH:g} × the time a sample of the "
        f"frame in memory, {MEMORY_REACH_MB / 1000:g} GB resident (mapped pages included), and "
        f"{GROWTH_REACH - 1:.0%} more a sample from the smallest frame in blocks to the largest: "
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
    brief = ("size", "way", "seconds", "ns", "times", "peak_MB", "scratch_GB")
    return Table("scale_blocks", title, heads, tuple(rows), text, brief=brief)


def _plans(rows: list[dict[str, Any]]) -> Table:
    measured = [row for row in rows if "seconds" in row]
    memory = next(row for row in measured if row["way"] == "in memory")
    blocks = [row for row in measured if row["way"] == "in blocks"][-1]
    in_memory = Rates(memory["cpu_ns"], 0.0, 0.0)
    pixels = blocks["size"] ** 2
    in_blocks = Rates(blocks["cpu_ns"], blocks["written"], 1e9 * blocks["scratch_GB"] / pixels)
    plans = [
        *(scenes_plan(in_memory, scenes=10**6, side=512, cores=cores) for cores in (2, 64, 1024)),
        *(frame_plan(in_blocks, side=10**5, cores=cores) for cores in (2, 16)),
    ]
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
    return Table("scale_plan", "From measured rates to a plan", heads,
                 tuple(plan.row() for plan in plans), text, brief=tuple(heads))  # fmt: skip


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
    environ = {**environment(), "OPENBLAS_NUM_THREADS": "1"}
    words = command("app.bench.scale.scale_blocks", folder, str(size), memory)
    done = subprocess.run(words, env=environ, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        raise RuntimeError(f"scale {size} {memory}: {lines[-1]}")
    figures: dict[str, Any] = json.loads(done.stdout)
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
