"""``imagechain bench``: run time against error, in units of a bare Fourier round trip."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from app.bench.measuring.bench_settings import PARTS, Settings
from app.bench.measuring.bench_tables import Table, terminal_text
from app.bench.measuring.isolation import isolate
from app.bench.measuring.machine import machine_facts
from app.bench.pages.bench_files import Facts, Files
from app.editor.qt_libraries import check_libraries
from app.options.command_options import Options

_MEASURED_BY = {
    "speed": "speed.network_speed",
    "precision": "precision.precision_parts",
    "peers": "peers.peers_compared",
    "editor": "speed.editor_speed",
    "scale": "scale.scale_parts",
    "measure": "speed.measure_parts",
}


def bench(options: Options) -> None:
    """Measure and print the parts of the options; write their files when all is done.

    Raises
    ------
    ImagechainError
        If a file cannot be written, or the window is to be measured and Qt cannot be loaded.
    """
    isolate(options)
    settings = Settings.of(options)
    if "editor" in settings.parts:
        check_libraries(window=False)
    start = time.perf_counter()
    facts: Facts = {
        "format": "imagechain-bench",
        "version": 1,
        "date": time.strftime("%Y-%m-%d %H:%M %z"),
        "machine": machine_facts(),
        "settings": settings.facts(),
    }
    files = Files.of(options, settings)
    with files.staging() as staging:
        print(_heading(facts), flush=True)
        parts = {name: _measured(name, settings) for name in settings.parts}
        facts["seconds"] = time.perf_counter() - start
        facts["parts"] = {name: [t.facts() for t in tables] for name, tables in parts.items()}
        files.write(staging, facts, parts, settings)
        staging.commit()
    print(f"{facts['seconds']:.0f} s" + "".join(f"; wrote {path}" for path in files.named()))


def _measured(name: str, settings: Settings) -> list[Table]:
    print(f"\n== {PARTS[name]} ==", flush=True)
    tables = []
    for measure in _measures(name):
        for table in measure(settings):
            print("\n" + terminal_text(table), flush=True)
            tables.append(table)
    return tables


def _measures(name: str) -> Sequence[Callable[[Settings], list[Table]]]:
    module: Any = import_module(f"app.bench.{_MEASURED_BY[name]}")
    measures: Sequence[Callable[[Settings], list[Table]]] = module.MEASURES
    return measures


def _heading(facts: Facts) -> str:
    machine = facts["machine"]
    versions = ", ".join(f"{name} {release}" for name, release in machine["versions"].items())
    return (
        f"{machine['processor']}, {machine['usable_cores']} of {machine['cores']} cores, "
        f"load {machine['load']:.1f}; {versions}; periodic frames by {machine['fft']}\n"
        "T0 = scipy.fft.irfft2(scipy.fft.rfft2(image)), same image, type and threads, measured in "
        "turn with the subject"
    )
