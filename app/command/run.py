"""``imagechain run``: evaluate a network and write its files, all of them or none."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from app.command.results import Progress, say, show
from app.options.command_options import Options
from app.options.option_values import Save
from app.options.overrides import with_disabled, with_final, with_settings
from app.options.stopping import too_late
from app.run.evaluation import Evaluation, TimedWork, evaluate, needed_later, planned
from app.run.figures import Figure, figure_rows, main_figures
from app.run.output import find_output, how_to_choose
from app.run.readout_tables import columns, json_text, readout_rows, warning_lines
from app.run.responses import mtf_csv
from app.run.saving import (
    MOST_FRAMES,
    check_suffix,
    cube_of,
    encode_png,
    format_for_frames,
    grey_levels,
    is_cube,
    robust_limits,
    save_frames,
    save_value,
    series_of,
)
from app.run.shipped import Place, find_network
from app.run.staging import Staging, check_folder, existing_folder
from app.run.way_of_running import (
    WayOfRunning,
    blocks_of,
    check_streamed,
    is_streamed,
    reduced,
    way_in_words,
    way_of_running,
)
from app.run.write_rules import OPTION, WriteRules, write_rules
from core.atomic import write_bytes, write_text
from core.chain.engine import Engine, Plan
from core.chain.realize import realize
from core.chain.skipped import Skip, skips
from core.chain.wires import Image
from core.errors import ImagechainError, NetworkError, UsageError
from core.evaluation.policy import Policy
from core.evaluation.region import Region
from core.evaluation.store import Store
from core.modules.declaration import Library, NodeContext
from core.modules.panel_sections import Caution
from core.names import close, in_line, shown
from core.network.file import read_network
from core.network.network import Network
from core.network.validation import NetworkProblems, check_network, plain_network
from nodes.files.common.file_format import ZARR
from nodes.files.frame_writing import (
    STORE,
    FrameFormat,
    FrameSeries,
    header_beside_frames,
    refuse_without_room,
)
from nodes.files.read import check_finite
from nodes.library import standard_library

FINAL, MTF, READOUTS = "final.png", "mtf.csv", "readouts.json"
KEPT_BYTES = 1 << 29
_OF_SCENE = ("scene_unit", "scene_fov_deg", "scene_band_um", "scene_range_m", "scene_sample_m")
WARNINGS = "imagechain.warnings"  # in the read-outs; no node's name has a dot


def carry_out(options: Options, stop: threading.Event) -> None:
    library, place, network = opened(options)
    left_out: tuple[str, ...] = ()
    while True:
        try:
            return _run(network, place, options, stop, left_out)
        except ImagechainError as error:
            from app.run.own_scene import without_judges

            spare, only = [save.node for save in options.saves], not options.scenes
            smaller = without_judges(network, error, library, spare, figures_only=only)
            if smaller is None:
                raise
            network, more = smaller
            say(options, *map(in_line, more))
            left_out += more


def _run(
    network: Network,
    place: Place,
    options: Options,
    stop: threading.Event,
    left_out: tuple[str, ...],
) -> None:
    start = time.perf_counter()
    library = standard_library()
    policy = policy_of(options)
    plan = planned(Engine(library, Store(0)), network, place.folder)
    way = way_of_running(plan, policy, options.memory_bytes)
    # All that a run needs is known and held; reports may need more, and again.
    engine = Engine(library, way.store(None if options.reports else Store(KEPT_BYTES)))
    folder = options.output_dir or Path(f"{place.name}-output")
    check_folder(folder)
    rules = rules_of(options, place, folder)
    with Staging(folder, [place.path, *input_files(plan, place.folder)]) as staging:
        with Progress(len(plan.nodes)) as progress:
            work = TimedWork(policy, engine.store, progress, stop)
            figures: list[Figure] = []
            look: Any = lambda evaluation: figures.extend(main_figures(evaluation))  # noqa: E731
            stage = Stage(folder, staging, rules, look=look, way=way)
            evaluation, skipped = stage.prepare(engine, plan, work, options, start=start)
        work.check()
        too_late(stop)
        forgotten = rules.commit(staging)
    written = sink_targets(plan, place.folder).values()
    others = [*(save.text for save in options.saves), *map(str, (*options.reports, *written))]
    lines = summary(evaluation, skipped, figures, folder, options, others)
    if forgotten:
        needs = f"could not record the files, so the next run needs {OPTION}: {forgotten}"
        lines.append(in_line(needs))

    def facts() -> dict[str, Any]:
        return {
            "figures": [asdict(figure) for figure in figures],
            "readouts": evaluation.readouts,
            "warnings": [asdict(caution) for caution in evaluation.cautions],
            "skipped": [asdict(skip) for skip in skipped],
            "left_out": list(left_out),
            "way": evaluation.way,
            "files": [*map(str, own_files(plan, folder)), *others],
        }

    show(options, facts, *lines)


def summary(
    evaluation: Evaluation,
    skipped: tuple[Skip, ...],
    figures: Sequence[Figure],
    folder: Path,
    options: Options,
    others: Sequence[str],
) -> list[str]:
    shown = []
    readouts = readout_rows(evaluation)
    if figures and not options.all:
        rows = [(name, f"{value} {unit}", node) for name, value, unit, node in figure_rows(figures)]
        shown += [columns(rows), f"all {len(readouts)} read-outs: --all, or {READOUTS}\n"]
    elif readouts:
        shown.append(columns(readouts, right=(2,)) + "\n")
    if warnings := warning_lines(evaluation.cautions):
        shown.append("\n".join(warnings) + "\n")
    lines = []
    left_out = [
        f"{skip.node} (at most {skip.bound:.2g})" for skip in skipped if skip.kind == "below_budget"
    ]
    if left_out:
        budget = evaluation.work.policy.budget
        lines.append(f"left out within the error budget of {budget:.3g}: {', '.join(left_out)}")
    lines += [
        f"{skip.node}: {skip.text} (at most {skip.bound:.2g} of their contrast)"
        for skip in skipped
        if skip.kind == "wavelengths"
    ]
    names = [FINAL, MTF, READOUTS] if evaluation.chain.final is not None else [MTF, READOUTS]
    lines.append(f"{folder}: {', '.join(names)}")
    if evaluation.chain.final is None:
        output = find_output(evaluation.plan)
        lines.append(f"no {FINAL}: {how_to_choose(output) or output.missing}")
    if evaluation.chain.missing and evaluation.chain.grid is not None:
        lines.append(f"no total in {MTF}: {evaluation.chain.missing}")
    if evaluation.way.get("way") == "in blocks" or options.memory_bytes is not None:
        lines.append(way_in_words(evaluation.way))
    if others:
        lines.append(f"also {', '.join(others)}")
    return [*shown, *map(in_line, lines)]


_IN_MEMORY = WayOfRunning(None, None)


@dataclass(frozen=True)
class Stage:
    """Where the files of a run are prepared: their folder, and what they may be."""

    folder: Path  # the output folder
    staging: Staging  # collects the files until all of them are put in place
    rules: WriteRules  # what the network may write
    # called with the number of frames written, after each
    done: Callable[[int], None] | None = None
    # called with the evaluation while its pictures are held
    look: Callable[[Evaluation], object] | None = None
    way: WayOfRunning = _IN_MEMORY  # in memory or in blocks, as it was chosen
    only_report: bool = False

    def prepare(
        self, engine: Engine, plan: Plan, work: TimedWork, options: Options, *, start: float
    ) -> tuple[Evaluation, tuple[Skip, ...]]:
        staging, place = self.staging, plan.folder
        way = self.way
        writers = _claim(plan, options, staging, way)
        if not self.only_report:
            own, sinks = own_files(plan, self.folder), sink_targets(plan, place)
            _claim_guarded(own, sinks, self.rules, staging)
        work.check()
        ports = [saved.port for saved in writers]
        how: dict[str, Any] = {"ports": ports, "report": bool(options.reports)}
        scratch = options.scratch or existing_folder(self.folder)
        with (
            blocks_of(way, engine, plan, work.policy, scratch=scratch, **how) as work.blocks,
            work.hold(needed_later(plan, **how, in_blocks=way.in_blocks)),
        ):
            evaluation = evaluate(engine, plan, work, place)
            evaluation.seconds["total"] = time.perf_counter() - start
            evaluation.way.update(way.facts(work.blocks))
            if self.only_report:
                sink_files(evaluation)  # made as a run does, which counts what was left out
            else:
                _write(evaluation, writers, self)
            if self.look is not None:
                self.look(evaluation)
            skipped = skips(plan, work)  # before the reports, whose pictures need more
            _write_reports(evaluation, skipped, options, staging)
        return evaluation, skipped


def opened(options: Options) -> tuple[Library, Place, Network]:
    """The network with its macros written out and the command line's changes, valid."""
    library, place = standard_library(), find_network(options.network)
    network = read_network(place.path, library=library)
    return library, place, with_options(network, place, options, library)


def with_options(network: Network, place: Place, options: Options, library: Library) -> Network:
    if not network.nodes:
        raise NetworkError(f"{shown(str(place.path))}: the network has no nodes")
    network = plain_network(network, library=library)
    given = [name for name in _OF_SCENE if getattr(options, name) is not None]
    if given and not options.scenes:
        raise UsageError(f"--{given[0].replace('_', '-')} needs --scene FILE")
    for text in options.scenes:
        network = _with_scene(network, text, place, options, library)
    network = with_settings(network, options.settings, library=library)
    network = with_disabled(network, options.disabled, library=library)
    if options.final is not None:
        network = with_final(network, options.final, library=library)
    if options.seed is not None:
        network = network.with_seed(options.seed)
    check_network(network, library=library)
    return network


def _with_scene(
    network: Network, text: str, place: Place, options: Options, library: Library
) -> Network:
    """The network with a picture in place of a scene, ``[NODE=]FILE``."""
    from app.run.own_scene import OwnScene, scene_nodes, with_own_scene

    node, _, file = text.partition("=")
    named = file and node in scene_nodes(network, library)
    replaced = with_own_scene(
        network,
        OwnScene(
            Path(file if named else text),
            options.scene_fov_deg,
            options.scene_range_m,
            options.scene_sample_m,
            options.scene_band_um,
            options.scene_unit or "",
            "--scene-",
        ),
        library=library,
        plan=Engine(library, Store(0)).plan(network, folder=place.folder),
        node=node if named else None,
    )
    say(options, *(in_line(f"{replaced.node}: {line}") for line in replaced.lines))
    return replaced.network


def rules_of(options: Options, place: Place, folder: Path) -> WriteRules:
    return write_rules(
        place,
        folder,
        named=options.output_dir is not None,
        allowed=options.allowed,
        given=(setting.node for setting in options.settings if setting.name == "path"),
    )


def policy_of(options: Options) -> Policy:
    return Policy(options.precision, options.tolerance, options.threads)


def input_files(plan: Plan, folder: Path) -> list[Path]:
    """Files that the network reads: no output may take their place."""
    files = []
    for node in plan.nodes.values():
        if node.module is None or node.declaration.sink:
            continue
        for parameter in node.declaration.parameters:
            value = getattr(node.module, parameter.name)
            if parameter.kind == "path" and value is not None:
                files.append(folder / value)
    return files


@dataclass(frozen=True)
class _Saved:
    path: Path
    port: str
    value: Any
    region: Region | None
    frames: int | None  # of an image, as many as were wanted

    def count(self, *, on_disk: bool) -> int | None:
        """Frames that it is written as; None where it is written in another way."""
        if not isinstance(self.value, Image):
            return None
        streamed = self.frames is None and is_streamed(self.value, self.path, on_disk=on_disk)
        return 1 if streamed else self.frames

    def series(self, policy: Policy, *, on_disk: bool) -> tuple[FrameFormat, FrameSeries] | None:
        """Format and header of a file of frames or bands; None of any other file."""
        count = self.count(on_disk=on_disk)
        if count is not None:
            kind = format_for_frames(self.port, self.path)
            return kind, series_of(self.value, kind, policy, frames=count, region=self.region)
        if not is_cube(self.value, self.path):
            return None
        cube = cube_of(self.value, policy, self.region)
        return format_for_frames(self.port, self.path), cube.series


def _claim(plan: Plan, options: Options, staging: Staging, way: WayOfRunning) -> list[_Saved]:
    """Reserve early what will be written; gives what is saved."""
    if options.frames is not None and not 1 <= options.frames <= MOST_FRAMES:
        raise UsageError(f"--frames {options.frames}: give a whole number from 1 to {MOST_FRAMES}")
    values = [_port_value(plan, save.node, save.name) for save in options.saves]
    if options.frames is not None and not any(isinstance(value, Image) for value in values):
        example = find_output(plan).port or "NODE.PORT"
        raise UsageError(
            f"--frames {options.frames} needs --save, which names the picture and the file: "
            f"--save {example}=frames.npy"
        )
    saves, files, policy = [], [], policy_of(options)
    for save, value in zip(options.saves, values, strict=True):
        path, region = Path(save.text), _region(save, value)
        saved = _Saved(path, save.port, value, region, options.frames)
        found = saved.series(policy, on_disk=way.on_disk(value, policy))
        if found is None:
            check_suffix(save.port, value, path)
            if ZARR.matches(path):
                found = STORE, series_of(value, STORE, policy, frames=1, region=region)
        files += [] if found is None else [(path, *found)]
        saves.append(saved)
        staging.claim(path)
    for path, kind, _ in files:
        if kind.beside is not None:
            staging.claim(header_beside_frames(path))
    refuse_without_room(files)
    for saved in saves:
        if way.on_disk(saved.value, policy):
            check_streamed(saved.port, saved.value, saved.path, options.frames)
    for path in options.reports:
        staging.claim(path)
    return saves


def _claim_guarded(
    own: list[Path], sinks: dict[str, Path], rules: WriteRules, staging: Staging
) -> None:
    refused = rules.refused(sinks, own, staging)
    if refused:
        raise NetworkProblems(refused) from refused[0]
    for path in own:
        staging.claim(path, rules.check_own if os.path.islink(path) else None)  # noqa: PTH114
    for node, path in sinks.items():
        try:
            staging.claim(path, partial(rules.check, node))
        except ImagechainError as error:
            raise error.at(node) from error


def own_files(plan: Plan, folder: Path) -> list[Path]:
    names = (FINAL, MTF, READOUTS) if find_output(plan).port is not None else (MTF, READOUTS)
    return [folder / name for name in names]


def sink_targets(plan: Plan, folder: Path) -> dict[str, Path]:
    targets = {}
    for name, node in plan.nodes.items():
        target = getattr(node.module, "target", None)
        if node.declaration.sink and not node.node.disabled and target is not None:
            targets[name] = target(NodeContext(name, plan.network.seed, folder))
    return targets


def _port_value(plan: Plan, node: str, port: str) -> Any:
    name, _, output = plan.network.port_names.get(f"{node}.{port}", "").rpartition(".")
    if name:  # of a macro
        return plan.nodes[name].outputs[output]
    known = plan.nodes.get(node)
    if known is None:
        hint = close(node, plan.nodes) or f"; it has {', '.join(plan.nodes)}"
        raise UsageError(f"--save {node}.{port}: the network has no node {node!r:.80}{hint}")
    if port not in known.outputs:
        hint = close(port, known.outputs) or f"; it has {', '.join(known.outputs) or 'none'}"
        raise UsageError(f"--save {node}.{port}: {node} has no output {port!r:.80}{hint}")
    return known.outputs[port]


def _region(save: Save, value: Any) -> Region | None:
    if isinstance(value, Image):
        return save.region(value.rows, value.columns)
    if save.bounds:
        raise UsageError(f"{save.shown}: only an image has a region, not a {value.port_type}")
    return None


def _write(evaluation: Evaluation, saves: list[_Saved], stage: Stage) -> None:
    staging, folder, work = stage.staging, stage.folder, evaluation.work
    for saved in saves:
        staging.write(saved.path, partial(_save, evaluation, saved, stage.done))
        found = saved.series(work.policy, on_disk=_is_on_disk(saved.value, work))
        if found is not None and found[0].beside is not None:
            text = found[0].beside(found[1])
            staging.write(header_beside_frames(saved.path), partial(write_text, content=text))
    for node, path, writer in sink_files(evaluation):
        staging.write(path, writer, partial(stage.rules.check, node))
    if evaluation.chain.final is not None:
        staging.write(folder / FINAL, partial(_final_png, evaluation, evaluation.chain.final))
    staging.write(folder / MTF, partial(write_text, content=mtf_csv(evaluation.responses)))
    readouts = {**evaluation.readouts, **_warnings(evaluation.cautions)}
    staging.write(folder / READOUTS, partial(write_text, content=json_text(readouts)))


def _warnings(cautions: Iterable[Caution]) -> dict[str, dict[str, list[str]]]:
    """The nodes' warnings, under a name that no node can have; empty where there are none."""
    nodes: dict[str, list[str]] = {}
    for caution in cautions:
        nodes.setdefault(caution.node, []).append(caution.text)
    return {WARNINGS: nodes} if nodes else {}


def _write_reports(
    evaluation: Evaluation, skipped: tuple[Skip, ...], options: Options, staging: Staging
) -> None:
    for path in options.reports:
        from app.report.report_facts import write_report

        staging.write(path, partial(write_report, evaluation, skipped))


def _save(
    evaluation: Evaluation, saved: _Saved, done: Callable[[int], None] | None, path: Path
) -> None:
    value, work = saved.value, evaluation.work
    frames = saved.count(on_disk=_is_on_disk(value, work))
    how: dict[str, Any] = {"port": saved.port, "region": saved.region}
    try:
        if frames is not None:
            save_frames(value, path, work, frames=frames, done=done, **how)
        else:
            save_value(value, path, work, **how)
    except ImagechainError as error:
        raise error.at(saved.port.rpartition(".")[0]) from error


def _is_on_disk(value: Any, work: TimedWork) -> bool:
    return work.blocks is not None and isinstance(value, Image) and value.key in work.blocks.shapes


def sink_files(evaluation: Evaluation) -> list[tuple[str, Path, Callable[[Path], None]]]:
    files: list[tuple[str, Path, Callable[[Path], None]]] = []
    for name, node in evaluation.plan.nodes.items():
        if not node.declaration.sink or node.node.disabled:
            continue
        here = NodeContext(name, evaluation.network.seed, evaluation.folder)
        module: Any = node.module
        try:
            files += [(name, *file) for file in module.files(node.inputs, here, evaluation.work)]
        except ImagechainError as error:
            raise error.at(name) from error
    return files


def _final_png(evaluation: Evaluation, port: str, path: Path) -> None:
    samples = realize(evaluation.plan.output(port), evaluation.work)
    check_finite(samples, port)
    samples = reduced(samples, evaluation.work)
    write_bytes(path, encode_png(grey_levels(*robust_limits(samples), samples)))
