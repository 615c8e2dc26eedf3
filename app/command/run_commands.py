"""``imagechain edit``, ``run`` and ``check``: the editor, and a network's picture and errors."""

from __future__ import annotations

import os
import socket
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.command import options
from app.run import option_values, shipped
from app.run import option_values as values
from app.run.terminal import Stop, too_late
from core.errors import ImagechainError, InputError, UsageError, in_line, several
from core.records import asdict
from nodes.files.file_format import PNG, suffixes

if TYPE_CHECKING:
    from app.editor.theme import Look
    from app.run.overrides import GivenNetwork
    from core.evaluation.work import Policy

OFFSCREEN = "offscreen"
_PARTS = ("window", "canvas", "panel", "curves", "picture")  # of the window
_X_SOCKETS = Path("/tmp/.X11-unix")


@options.command()
@options.argument(
    "network", "[NETWORK]", "a network file, or the name of an example network", required=False,
)  # fmt: skip
@options.option(
    "--screenshot", "FILE", "save the window as .png and exit; needs no display",
    values.ending_in(PNG))  # fmt: skip
@options.option(
    "--part", f"[{'|'.join(_PARTS)}]",
    "what to save: window (default), canvas, panel, curves or picture (of the first viewer, "
    "scaled down if larger than --size)",
    options.one_of(*_PARTS), default="window")  # fmt: skip
@options.option(
    "--size", "WxH",
    "size of the window (default: the last size; at the first start, a size that fits the "
    "screen; for a screenshot, 1600x900)", values.window_size)  # fmt: skip
@options.option(
    "--look", "[dark|light]", "colour theme (default: the last one used)",
    options.one_of("dark", "light"),
)  # fmt: skip
def edit(
    stop: Stop,
    network: str,
    screenshot: Path | None,
    part: str,
    size: tuple[int, int] | None,
    look: Look | None,
) -> None:
    """Open the editor, or save a screenshot of it."""
    if network:
        shipped.find_network(network)  # a misspelt name is told before what takes long to load
    from app.editor import qt_libraries as qt

    if screenshot is not None:
        os.environ.setdefault("QT_QPA_PLATFORM", OFFSCREEN)
    elif sys.platform.startswith("linux"):
        check_display(os.environ)
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    qt.check_libraries(window=platform in ("", "xcb"))
    try:
        import PySide6.QtWidgets  # noqa: F401
    except ImportError as error:
        raise UsageError(f"the editor needs Qt, which cannot be loaded: {error}") from error
    qt.leave_sources_unread()
    with qt.nothing_collected(), qt.names_looked_up():
        from app.editor.window.start import start

    start(stop, network, look=look, size=size, screenshot=screenshot, part=part)


def check_display(environment: os._Environ[str] | dict[str, str]) -> None:
    """Refuse to start without a display: Qt itself would end the process with a core dump."""
    platform = environment.get("QT_QPA_PLATFORM", "").partition(":")[0]
    if platform and platform not in ("xcb", "wayland"):
        return
    if platform != "xcb" and environment.get("WAYLAND_DISPLAY"):
        return
    display = environment.get("DISPLAY", "")
    if not display:
        raise UsageError(
            "the editor needs a display: DISPLAY and WAYLAND_DISPLAY are empty (imagechain "
            "run needs no display)"
        )
    if not _answers(display):
        raise UsageError(f"the editor needs a display: no response from DISPLAY = {display:.80}")


def _answers(display: str) -> bool:
    host, _, number = display.rpartition(":")
    try:
        screen = int(number.partition(".")[0])
        path = str(_X_SOCKETS / f"X{screen}")
        # Some servers listen on the abstract name alone.
        places: list[Any] = [(socket.AF_UNIX, prefix + path) for prefix in ("", "\0")]
        if host not in ("", "unix"):
            places = [(socket.AF_INET, (host, 6000 + screen))]
        for family, address in places:
            with socket.socket(family, socket.SOCK_STREAM) as trial:
                trial.settimeout(3)
                if trial.connect_ex(address) == 0:
                    return True
    except (OSError, OverflowError, ValueError):
        pass
    return False


@options.command()
@options.network_options
@options.save_option(
    "NODE.PORT=FILE",
    f"write the value of a port, as {options.SAVED}. NODE.PORT[TOP:BOTTOM,LEFT:RIGHT]=FILE writes "
    "part of an image: these rows and columns, counted from 0 and excluding BOTTOM and RIGHT "
    "(default: the image's bounds). .bsq and .img (ENVI) keep all bands of an image; .zarr "
    "accepts pictures of any size. May be repeated")  # fmt: skip
@options.option(
    "--frames", "N",
    "save N frames of each picture, each with its own temporal noise; the first is the picture "
    "without --frames. Formats: .npy (frames, rows, columns), .tif .tiff (one page each), .bsq "
    ".img (ENVI, one band each)", values.whole_number)  # fmt: skip
@options.place_options
@options.flag(
    "--all", "print the read-outs of all nodes instead of the main figures", to="every_readout"
)
@options.option(
    "--memory", "SIZE",
    "memory for pictures, such as 2GB or 500MB (default: half of the memory available). If "
    "a network needs more, it runs in blocks with its pictures on disk; the results are the same",
    values.size_in_bytes, to="memory_bytes", group=options.RARER)  # fmt: skip
@options.option(
    "--scratch", "DIR",
    "folder for pictures that do not fit in memory (default: beside the output)",
    values.file_path, group=options.RARER)  # fmt: skip
@options.option(
    "--report", "FILE",
    f"write a report, {' or '.join(suffixes(*values.REPORTS))}; may be repeated",
    values.report_path, many=True, to="reports")  # fmt: skip
@options.numerical_options
@options.json_flag
def run(
    stop: Stop,
    asked: GivenNetwork,
    policy: Policy,
    saves: tuple[option_values.Save, ...],
    frames: int | None,
    output_dir: Path | None,
    allowed: tuple[Path, ...],
    every_readout: bool,
    memory_bytes: int | None,
    scratch: Path | None,
    reports: tuple[Path, ...],
    json: bool,
) -> None:
    """Compute a network's picture and figures.

    The files are written to the output folder only after everything has succeeded.
    """
    from app.command.network_run import KEPT_BYTES, NetworkRun
    from app.run.evaluation import TimedWork, planned
    from app.run.staging import OPTION, Staging, write_rules
    from core.chain.engine import Engine
    from core.evaluation.recipes import Store

    library, place, network = options.opened(asked, json)
    left_out: tuple[str, ...] = ()

    def once() -> tuple[NetworkRun, str]:
        start = time.perf_counter()
        # All that a run needs is known and held; reports may need more, and again.
        engine = Engine(library, None if reports else Store(KEPT_BYTES))
        plan = planned(engine, network, place.folder)
        folder, rules = write_rules(place, output_dir, allowed, asked.settings)
        with Staging(folder, [place.path]) as staging:
            with options.Progress(len(plan.nodes)) as progress:
                work = TimedWork(policy, engine.store, stop, progress)
                made = NetworkRun(
                    engine, plan, work, folder, staging, rules, saves=saves, frames=frames,
                    reports=reports, memory_bytes=memory_bytes, scratch=scratch,
                ).prepare(start=start)  # fmt: skip
            work.check()
            too_late(stop)
            return made, rules.commit(staging)

    while True:
        try:
            made, forgotten = once()
            break
        except ImagechainError as error:
            from app.run.transfer_chain import without_judges

            spare = [save.node for save in saves]
            smaller = without_judges(network, error, library, spare, figures_only=not asked.scenes)
            if smaller is None:
                raise
            network, more = smaller
            options.say(json, *map(in_line, more))
            left_out += more
    lines = made.lines(every_readout=every_readout, on_memory=memory_bytes is not None)
    if forgotten:
        needs = f"could not record which files this run wrote ({forgotten}); to let the next run"
        needs += f" replace them, add {OPTION} DIR"
        lines.append(in_line(needs))
    options.show(json, lambda: made.facts(left_out), *lines)


@options.command()
@options.network_options
@options.place_options
@options.json_flag
def check(
    _stop: Stop, asked: GivenNetwork, output_dir: Path | None, allowed: tuple[Path, ...], json: bool
) -> None:
    """Print a network's errors and warnings, and the files that a run would write."""
    from app.command.network_run import FINAL, input_files, own_files, sink_targets
    from app.run import terminal, transfer_chain
    from app.run.evaluation import planned
    from app.run.staging import Staging, write_rules
    from core.chain.engine import Engine
    from core.network.validation import NetworkProblems

    written: list[str] = []
    try:
        library, place, network = options.opened(asked, json)
        plan = planned(Engine(library), network, place.folder)
        folder, rules = write_rules(place, output_dir, allowed, asked.settings)
        own, sinks = own_files(plan, folder), sink_targets(plan)
        written.append(f"run writes {', '.join(map(str, own))}")
        written += [f"{node}: run writes {target}" for node, target in sinks.items()]
        staging = Staging(folder, [place.path, *input_files(plan)])
        if refused := rules.claim(sinks, own, staging):
            raise NetworkProblems(refused)
    except InputError as error:
        problems = error.problems if isinstance(error, NetworkProblems) else (error,)
        lines = [*map(in_line, written), *(in_line(str(problem)) for problem in problems)]
        facts = [{"node": problem.node, "message": problem.message} for problem in problems]
        options.show(json, lambda: {"errors": facts}, *lines)
        name = asked.place.name
        raised = InputError(f"{name}: {several(len(problems), 'error')}, the first: {problems[0]}")
        raised.exit_code = error.exit_code  # 1 for the fault of a plug-in
        raise raised from None
    cautions = plan.warnings()
    warnings = terminal.warning_lines(cautions)
    if choose := transfer_chain.how_to_choose(transfer_chain.find_output(plan)):
        warnings.append(f"warning: no {FINAL}: {choose}")
    count = f", {several(len(warnings), 'warning')}" if warnings else ""
    size = f"{several(len(network.nodes), 'node')}, {several(len(network.links), 'link')}"
    summary = f"{place.name}: no errors{count} ({size})"
    options.show(
        json,
        lambda: {"errors": [], "warnings": [asdict(caution) for caution in cautions]},
        *map(in_line, [*warnings, summary, *written]),
    )
