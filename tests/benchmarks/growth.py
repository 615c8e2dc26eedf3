"""The whole chain as the picture grows: time and peak memory, each in a fresh process.

Run as a module it is that process: ``time FILE SIZE PAIRS`` draws the scene, keeps it in FILE and
times the chain; ``memory FILE SIZE`` reads the scene from there as a user's own picture is read;
``draw FILE SIZE`` draws it and no more.
"""

import json
import math
import os
import resource
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

from app.bench.tables import Table, verdict
from app.bench.timing import LARGEST, SIZE, STEADY, Settings
from benchmark_processes import figures_of

ELECTRONICS = "electronics"
MEMORY_REACH, MEMORY_AIM = 3.0, 2.0
TIMES_REACH, HUGE_MEMORY_REACH = 5.0, 6.0
HUGE = 16384
SMALL, LARGE = 512, 8192  # the targets are for sizes between, that of memory for the largest


def growth(settings: Settings) -> list[Table]:
    """T0-ratio and peak memory for each size."""
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes_of(settings):
            file = str(Path(folder) / "scene.npy")
            row = {"size": size, **_child("time", file, size, _pairs(size, settings), steady=True)}
            row |= _child("memory", file, size, steady=False)
            if size == LARGE:
                row["memory_reach"] = MEMORY_REACH
                row["memory_verdict"] = verdict(row["images"], MEMORY_REACH, MEMORY_AIM)
            rows.append(row)
    trend = judge_steps(rows)
    text = (
        f"Limit: the T0 ratio rises in no step from {SMALL}² to {LARGE}²; target: it falls. "
        f"{trend} A step is the ratio of neighbouring sizes' medians, ± twice its standard error. "
        f"Memory at {LARGE}²: limit {MEMORY_REACH:g}, target {MEMORY_AIM:g} images in addition to "
        "the loaded one."
    )
    heads = {
        "size": "size",
        "t0": "T0",
        "low": "25 %",
        "high": "75 %",
        "pairs": "pairs",
        "step": "step, ×",
        "margin": "±",
        "step_verdict": "",
        "ms": "ms",
        "t0_ms": "T0 ms",
        "alone_ms": "T0 ms, back to back",
        "images": "peak memory, images",
        "memory_verdict": "",
    }
    title = "Whole chain with every noise, single precision, as the picture grows"
    tables = [Table("growth", title, heads, rows, text)]
    return [*tables, _beyond(rows[-1])] if rows[-1]["size"] == LARGE else tables


def sizes_of(settings: Settings) -> list[int]:
    """From a quarter of the picture, at most 256², to the largest, doubled each time."""
    last = settings.size if settings.quick or settings.size != SIZE else LARGEST
    sizes = [min(256, settings.size // 2)]
    while 2 * sizes[-1] <= last:
        sizes.append(2 * sizes[-1])
    return sizes


def _beyond(largest: dict[str, Any]) -> Table:
    """Time and memory of pictures beyond what a store used to keep, beside the largest's."""
    rows = [{name: largest[name] for name in ("size", "seconds", "images")}]
    with tempfile.TemporaryDirectory() as folder:
        file = str(Path(folder) / "scene.npy")
        _child("draw", file, HUGE, steady=False)
        measured = _child("memory", file, HUGE, steady=False)
    times = measured["seconds"] / largest["seconds"]
    rows.append(
        {
            "size": HUGE,
            **measured,
            "times": times,
            "times_verdict": verdict(times, TIMES_REACH, 4.0),
            "memory_verdict": verdict(measured["images"], HUGE_MEMORY_REACH, MEMORY_REACH),
        }
    )
    heads = {
        "size": "size",
        "seconds": "s",
        "times": f"× {LARGE}²",
        "times_verdict": "",
        "images": "peak memory, images",
        "memory_verdict": "",
    }
    text = (
        f"Whole chain and read-outs, once in a fresh process, the picture in memory. Limit: "
        f"{TIMES_REACH:g} × the time of {LARGE}² and {HUGE_MEMORY_REACH:g} images in addition to "
        f"the loaded one; four times as many samples would take 4 ×, memory as at {LARGE}²."
    )
    title = f"No cliff by size: {HUGE}² beside {LARGE}²"
    return Table("beyond", title, heads, rows, text)


def judge_steps(rows: list[dict[str, Any]]) -> str:
    """Judge each row against the one before, and of all whether the ratio increases.

    A rise counts, however small; one within its uncertainty is marked as such.
    """
    judged = [row for row in rows if SMALL <= row["size"] <= LARGE]
    rises: list[str] = []
    unsure: list[str] = []
    for before, after in pairwise(judged):
        step = after["t0"] / before["t0"]
        margin = 2 * step * math.hypot(_relative_error(before), _relative_error(after))
        after |= {"step": step, "margin": margin}
        if step <= 1:
            after["step_verdict"] = "met: falls"
            continue
        within = step - 1 <= margin
        after["step_verdict"] = "rises, within ±" if within else f"missed: rises by {step - 1:.0%}"
        (unsure if within else rises).append(
            f"{before['size']}² → {after['size']}² by {step - 1:.0%} ± {margin:.0%}"
        )
    if len(judged) < 2:
        return f"Not judged: fewer than two sizes from {SMALL}² to {LARGE}²."
    whole = judged[-1]["t0"] / judged[0]["t0"]
    ends = f"{judged[0]['size']}² to {judged[-1]['size']}², all that was measured: {whole:.2f} ×."
    if rises:
        also = f"; perhaps {', '.join(unsure)}" if unsure else ""
        return f"Missed: rises {', '.join(rises)}{also}. From {ends}"
    if unsure:
        return f"Undecided: rises {', '.join(unsure)}, which the spread can explain. From {ends}"
    return f"Met, target too: every step falls. From {ends}"


def _relative_error(row: dict[str, Any]) -> float:
    """Standard error of a median of ratios, over it, from their quartiles as if normal."""
    sigma = (row["high"] - row["low"]) / 1.349
    return float(1.253 * sigma / math.sqrt(row["pairs"]) / row["t0"])


def _pairs(size: int, settings: Settings) -> int:
    least = 3 if settings.quick else 7
    return max(least, min(settings.pairs, settings.pairs * 2**20 * 2 // size**2))


def _child(what: str, file: str, *numbers: int, steady: bool) -> dict[str, Any]:
    (figures,) = figures_of("growth", what, file, *numbers, **(STEADY if steady else {}))
    return figures


def _timed(file: str, size: int, pairs: int) -> dict[str, Any]:
    import numpy as np

    from app.bench.timing import FINAL, Kodak, paired, round_trip

    kodak = Kodak(size)
    np.save(file, kodak.scene)
    return paired(
        lambda: kodak.cold(kodak.network, FINAL, (ELECTRONICS,)),
        round_trip(kodak.scene, kodak.policy.workers),
        pairs=pairs,
        warm_up=1,
    )


def _peak(file: str, size: int) -> dict[str, Any]:
    from dataclasses import replace

    from app.bench.timing import FINAL, SCENE, kodak_network
    from app.command.network_run import KEPT_BYTES
    from core.chain.engine import Engine, asked_for
    from core.evaluation.recipes import Recipe, Store
    from core.evaluation.work import Policy
    from core.network.network import Node
    from nodes.library import standard_library

    network = kodak_network(size)
    scene = network.nodes["scene"].params
    field_and_band = {n: scene[n] for n in ("fov_x_deg", "fov_y_deg", "cut_on_um", "cut_off_um")}
    source = Node("scene", "read_image", {"path": file, **field_and_band})
    network = replace(network, nodes={**network.nodes, "scene": source})
    engine = Engine(standard_library(), Store(KEPT_BYTES))  # as in a run
    work = engine.work(Policy())
    plan = engine.plan(network)
    readouts = engine.planned_readouts(plan, ELECTRONICS).values()
    asked = [value for value in readouts if isinstance(value, Recipe)]
    with work.hold([*asked_for(plan.output(FINAL)), *asked]):
        image = engine.value(plan, SCENE, work).nbytes
        loaded, start = _start_peak(), time.perf_counter()
        engine.value(plan, FINAL, work)
        engine.readouts(plan, ELECTRONICS, work)
        seconds = time.perf_counter() - start
    images = (high_water() - loaded) / image
    return {"images": images, "image_bytes": image, "seconds": seconds}


def _draw(file: str, size: int) -> dict[str, Any]:
    import numpy as np

    from app.bench.timing import SCENE, kodak_network
    from core.chain.engine import Engine
    from core.evaluation.work import Policy
    from nodes.library import standard_library

    engine = Engine(standard_library())
    np.save(file, engine.value(engine.plan(kodak_network(size)), SCENE, engine.work(Policy())))
    return {}


def _start_peak() -> int:
    """Begin the peak of memory here, where the system can; gives the bytes in use."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return high_water()
    return high_water()


def high_water() -> int:
    """The most memory of this process so far, bytes."""
    # A child's ru_maxrss starts at what its parent held; VmHWM is its own.
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(int(line.split()[1]) << 10 for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


def _main(words: list[str]) -> None:
    what, file, size = words[0], words[1], int(words[2])
    if what == "time":
        figures = _timed(file, size, int(words[3]))
    else:
        figures = {"memory": _peak, "draw": _draw}[what](file, size)
    print(json.dumps(figures))
    sys.stdout.flush()
    os._exit(0)  # giving 8192² pictures back page by page takes longer than the measurement


MEASURES = (growth,)

if __name__ == "__main__":
    _main(sys.argv[1:])
